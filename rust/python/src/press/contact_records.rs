//! Records of a contact: of its regions, of a drag, of what is left of the equations and of how the solve ended.

use crate::conversion::arrays::triple;
use crate::conversion::record::record;
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use thenar_contact::{Convergence, RegionResult, Residual, Shear, Warning};

/// A list of records; `names` is empty or has one name per region.
pub fn regions(py: Python<'_>, results: &[RegionResult], names: &[String]) -> PyResult<Py<PyAny>> {
    let each = results.iter().map(|region| region_of(py, region, names));
    let records = each.collect::<PyResult<Vec<_>>>()?;
    Ok(PyList::new(py, records)?.into_any().unbind())
}

/// A list of records, one per warning.
pub fn remarks(py: Python<'_>, warnings: &[Warning]) -> PyResult<Py<PyAny>> {
    let each = warnings.iter().map(|warning| {
        let entries = PyDict::new(py);
        entries.set_item(intern!(py, "kind"), warning.kind())?;
        entries.set_item(intern!(py, "grade"), warning.grade().name())?;
        entries.set_item(intern!(py, "text"), warning.to_string())?;
        entries.set_item(intern!(py, "vertex"), warning.vertex())?;
        entries.set_item(intern!(py, "region"), warning.region())?;
        record(entries)
    });
    let records = each.collect::<PyResult<Vec<_>>>()?;
    Ok(PyList::new(py, records)?.into_any().unbind())
}

/// None without a drag.
pub fn friction(py: Python<'_>, shear: Option<&Shear>) -> PyResult<Py<PyAny>> {
    let Some(shear) = shear else {
        return Ok(py.None());
    };
    let entries = PyDict::new(py);
    entries.set_item(intern!(py, "total_force_n"), triple(py, shear.total))?;
    entries.set_item(intern!(py, "slide_mm"), triple(py, shear.travel))?;
    entries.set_item(intern!(py, "twist_rad"), triple(py, shear.turn))?;
    entries.set_item(intern!(py, "dissipated_nmm"), shear.dissipated)?;
    entries.set_item(intern!(py, "stored_nmm"), shear.stored)?;
    entries.set_item(intern!(py, "residual"), shear.residual)?;
    record(entries)
}

pub fn residual(py: Python<'_>, residual: &Residual) -> PyResult<Py<PyAny>> {
    let entries = PyDict::new(py);
    entries.set_item(intern!(py, "complementarity"), residual.complementarity)?;
    entries.set_item(intern!(py, "penetration_mm"), residual.penetration_mm)?;
    entries.set_item(intern!(py, "load_balance"), residual.load_balance)?;
    entries.set_item(intern!(py, "far_field"), residual.far_field)?;
    record(entries)
}

pub fn convergence(py: Python<'_>, convergence: &Convergence) -> PyResult<Py<PyAny>> {
    let entries = PyDict::new(py);
    entries.set_item(intern!(py, "has_converged"), convergence.has_converged)?;
    entries.set_item(intern!(py, "passes"), convergence.passes)?;
    entries.set_item(intern!(py, "pivots"), convergence.pivots)?;
    entries.set_item(intern!(py, "cg_steps"), convergence.cg_steps)?;
    record(entries)
}

/// Wall time by stage, in their order.
pub fn seconds(py: Python<'_>, stages: &[(&'static str, f64)]) -> PyResult<Py<PyAny>> {
    let entries = PyDict::new(py);
    for (stage, time) in stages {
        entries.set_item(stage, time)?;
    }
    record(entries)
}

fn region_of(py: Python<'_>, region: &RegionResult, names: &[String]) -> PyResult<Py<PyAny>> {
    let entries = PyDict::new(py);
    entries.set_item(intern!(py, "index"), region.index)?;
    entries.set_item(intern!(py, "name"), names.get(region.index))?;
    entries.set_item(intern!(py, "force_n"), region.force)?;
    entries.set_item(intern!(py, "area_mm2"), region.area)?;
    entries.set_item(intern!(py, "peak_mpa"), region.peak)?;
    entries.set_item(intern!(py, "mean_mpa"), region.mean)?;
    entries.set_item(intern!(py, "dmax_mm"), region.max_penetration)?;
    entries.set_item(intern!(py, "g_mpa"), region.shear_modulus)?;
    record(entries)
}
