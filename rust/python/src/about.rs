//! What this build is and which numbers a material has.

use crate::conversion::record::record;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use thenar_contact::parameters::PARAMETERS;

/// The table of material numbers: name, symbol, unit, default, low, high, meaning, source of each.
#[pyfunction]
pub fn parameters(py: Python<'_>) -> PyResult<Vec<Py<PyAny>>> {
    let row = |parameter: &thenar_contact::parameters::Parameter| {
        let entries = PyDict::new(py);
        entries.set_item("name", parameter.name)?;
        entries.set_item("symbol", parameter.symbol)?;
        entries.set_item("unit", parameter.unit)?;
        entries.set_item("default", parameter.default)?;
        entries.set_item("low", parameter.low)?;
        entries.set_item("high", parameter.high)?;
        entries.set_item("meaning", parameter.meaning)?;
        entries.set_item("source", parameter.source)?;
        record(entries)
    };
    PARAMETERS.iter().map(row).collect()
}

/// Version, target and profile of the native module.
#[pyfunction]
pub fn build_info(py: Python<'_>) -> PyResult<Py<PyAny>> {
    let entries = PyDict::new(py);
    entries.set_item("version", env!("CARGO_PKG_VERSION"))?;
    entries.set_item(
        "target",
        format!("{}-{}", std::env::consts::ARCH, std::env::consts::OS),
    )?;
    entries.set_item(
        "profile",
        if cfg!(debug_assertions) {
            "debug"
        } else {
            "release"
        },
    )?;
    entries.set_item("abi", "abi3-py311")?;
    entries.set_item("threads", rayon::current_num_threads())?;
    record(entries)
}
