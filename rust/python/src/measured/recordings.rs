//! `thenar.read_recording`: measurement files as records of numpy arrays.

use crate::conversion::arrays::{column, table};
use crate::conversion::errors::Failure;
use crate::conversion::record::record;
use crate::conversion::running::Hooks;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use std::path::PathBuf;
use thenar_recordings::{Channel, Check, Curve, PressureMap, PressureUnit, ReadOptions, Source};

/// Reads a measurement file of any maker; the format follows from what it holds.
///
/// `columns` names the columns of a table that calls them otherwise or does not say what they are: `{"travel_mm": "-Extension"}`, where a
/// minus turns the sign; `run` is the one run to read of a file with several.
///
/// Returns a record: `format`, `maps` and `curves`, a record each, and `notes` of what was not read. A map has `pressure_kpa` or `counts` (frames, sensels), NaN
/// where there is no sensel, `is_clipped` of the same shape, `time_s` (frames,) or None, `row`, `column`, `number` (sensels,), -1
/// where not known, `center_mm` (sensels, 2) and `area_mm2` (sensels,), NaN where not known, `force_n` (frames,) or None. A curve
/// has `channels`, a record of arrays by name (`time_s`, `force_n`, `depth_mm` from first touch, `travel_mm` from any zero). Both
/// have `checks` of the file's own totals, `unknown` and `warnings`. Raises `RecordingError`.
#[pyfunction]
#[pyo3(signature = (file, *, columns=None, run=None))]
pub fn read_recording(
    py: Python<'_>,
    file: &Bound<'_, PyAny>,
    columns: Option<&Bound<'_, PyDict>>,
    run: Option<String>,
) -> PyResult<Py<PyAny>> {
    let file = path("file", file)?;
    let mut options = ReadOptions {
        run,
        ..ReadOptions::default()
    };
    for (key, header) in columns.into_iter().flatten() {
        let (key, header) = (key.extract::<String>()?, header.extract::<String>()?);
        let added = options.columns.add(&key, &header);
        added.map_err(|problem| {
            crate::conversion::errors::RecordingError::new_err(format!("columns: {problem}"))
        })?;
    }
    let read = crate::conversion::running::run(py, &Hooks::new(None, None)?, move |_| {
        thenar_recordings::read_with(&file, &options).map_err(Failure::Recording)
    })?;
    let entries = PyDict::new(py);
    entries.set_item("format", read.format.name())?;
    let maps: Vec<_> = read
        .maps
        .iter()
        .map(|map| map_record(py, map))
        .collect::<PyResult<_>>()?;
    entries.set_item("maps", PyList::new(py, maps)?)?;
    let curves: Vec<_> = read
        .curves
        .iter()
        .map(|curve| curve_record(py, curve))
        .collect::<PyResult<_>>()?;
    entries.set_item("curves", PyList::new(py, curves)?)?;
    entries.set_item("notes", read.notes)?;
    record(entries)
}

/// A path argument: text or anything with `__fspath__`.
pub fn path(name: &str, value: &Bound<'_, PyAny>) -> PyResult<PathBuf> {
    value.extract::<PathBuf>().map_err(|_| {
        let kind = value
            .get_type()
            .name()
            .map_or_else(|_| "an object".into(), |name| name.to_string());
        crate::conversion::errors::RecordingError::new_err(format!(
            "{name}: expected a path, got {kind}; give a text or a pathlib.Path"
        ))
    })
}

/// A map as a record of arrays.
pub fn map_record(py: Python<'_>, map: &PressureMap) -> PyResult<Py<PyAny>> {
    let entries = PyDict::new(py);
    let sensels = map.sensels.len();
    entries.set_item("name", &map.name)?;
    entries.set_item("source", source_record(py, &map.source)?)?;
    let values = table(py, map.values.clone(), sensels)?;
    let is_calibrated = map.unit == PressureUnit::Kilopascal;
    entries.set_item("pressure_kpa", is_calibrated.then(|| values.clone_ref(py)))?;
    entries.set_item("counts", (!is_calibrated).then_some(values))?;
    entries.set_item("unit", unit_name(map.unit))?;
    let is_clipped = map
        .values
        .iter()
        .map(|value| map.is_clipped(*value))
        .collect();
    entries.set_item("is_clipped", table::<bool>(py, is_clipped, sensels)?)?;
    entries.set_item("time_s", map.time_s.clone().map(|times| column(py, times)))?;
    put_sensels(py, map, &entries)?;
    let forces: Option<Vec<f64>> = (0..map.frames()).map(|frame| map.force_n(frame)).collect();
    entries.set_item("force_n", forces.map(|forces| column(py, forces)))?;
    entries.set_item("clipped_from", map.clipped_from)?;
    entries.set_item(
        "threshold",
        map.threshold
            .map(|threshold| (threshold.value, unit_name(threshold.unit))),
    )?;
    entries.set_item("pitch_mm", map.pitch_mm.map(|[row, column]| (row, column)))?;
    let [rows, columns] = map.is_mirrored;
    entries.set_item("is_mirrored", (rows, columns))?;
    entries.set_item("channels", channels_record(py, &map.channels)?)?;
    entries.set_item("phases", &map.phases)?;
    entries.set_item("checks", checks(py, &map.checks)?)?;
    entries.set_item("unknown", &map.unknown)?;
    entries.set_item("warnings", &map.warnings)?;
    record(entries)
}

fn put_sensels(py: Python<'_>, map: &PressureMap, entries: &Bound<'_, PyDict>) -> PyResult<()> {
    let place = |axis: usize| {
        map.sensels
            .iter()
            .map(|sensel| sensel.place.map_or(-1, |place| i64::from(place[axis])))
            .collect()
    };
    entries.set_item("row", column::<i64>(py, place(0)))?;
    entries.set_item("column", column::<i64>(py, place(1)))?;
    let numbers = map
        .sensels
        .iter()
        .map(|sensel| sensel.number.map_or(-1, i64::from))
        .collect();
    entries.set_item("number", column::<i64>(py, numbers))?;
    let centers = map
        .sensels
        .iter()
        .flat_map(|sensel| sensel.center_mm.unwrap_or([f64::NAN; 2]))
        .collect();
    entries.set_item("center_mm", table::<f64>(py, centers, 2)?)?;
    let areas = map
        .sensels
        .iter()
        .map(|sensel| sensel.area_mm2.unwrap_or(f64::NAN))
        .collect();
    entries.set_item("area_mm2", column::<f64>(py, areas))?;
    entries.set_item("grid", map.grid().map(|grid| (grid.rows, grid.columns)))
}

/// A curve as a record of arrays.
pub fn curve_record(py: Python<'_>, curve: &Curve) -> PyResult<Py<PyAny>> {
    let entries = PyDict::new(py);
    entries.set_item("name", &curve.name)?;
    entries.set_item("source", source_record(py, &curve.source)?)?;
    entries.set_item("channels", channels_record(py, &curve.channels)?)?;
    let segments = curve
        .segments
        .iter()
        .map(|segment| (&segment.name, segment.start, segment.end));
    entries.set_item("segments", segments.collect::<Vec<_>>())?;
    let facts = PyDict::new(py);
    for fact in &curve.facts {
        facts.set_item(&fact.name, fact.value)?;
    }
    entries.set_item("facts", record(facts)?)?;
    entries.set_item("protocol", &curve.protocol)?;
    entries.set_item("checks", checks(py, &curve.checks)?)?;
    entries.set_item("unknown", &curve.unknown)?;
    entries.set_item("warnings", &curve.warnings)?;
    record(entries)
}

fn channels_record(py: Python<'_>, channels: &[Channel]) -> PyResult<Py<PyAny>> {
    let entries = PyDict::new(py);
    for channel in channels {
        entries.set_item(&channel.name, column(py, channel.values.clone()))?;
    }
    record(entries)
}

fn source_record(py: Python<'_>, source: &Source) -> PyResult<Py<PyAny>> {
    let entries = PyDict::new(py);
    entries.set_item("maker", source.maker)?;
    entries.set_item("product", &source.product)?;
    entries.set_item("sensor", &source.sensor)?;
    record(entries)
}

fn checks<'py>(py: Python<'py>, checks: &[Check]) -> PyResult<Bound<'py, PyList>> {
    let rows: Vec<_> = checks
        .iter()
        .map(|check| check_record(py, check))
        .collect::<PyResult<_>>()?;
    PyList::new(py, rows)
}

fn check_record(py: Python<'_>, check: &Check) -> PyResult<Py<PyAny>> {
    let entries = PyDict::new(py);
    entries.set_item("what", check.what)?;
    entries.set_item("unit", check.unit)?;
    entries.set_item("compared", check.compared)?;
    entries.set_item("largest_difference", check.largest_difference)?;
    entries.set_item("frame", check.frame)?;
    entries.set_item("tolerance", check.tolerance)?;
    entries.set_item("agrees", check.agrees())?;
    entries.set_item("text", check.to_string())?;
    record(entries)
}

fn unit_name(unit: PressureUnit) -> &'static str {
    match unit {
        PressureUnit::Kilopascal => "kPa",
        PressureUnit::RawCounts => "raw counts",
        PressureUnit::NotStated => "not stated",
    }
}
