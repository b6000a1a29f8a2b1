//! What instruments read beside what the simulation says, as records of arrays: mats, their frames, and scans.

use crate::conversion::arrays::{column, rows};
use crate::conversion::record::record;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use thenar_comparison::{Frame, RecordingComparison, Scanned};
use thenar_inference::Mat;

/// A scan: heights over the skin at rest by place, mm.
pub fn scan(py: Python<'_>, scan: &Scanned) -> PyResult<Py<PyAny>> {
    let entries = PyDict::new(py);
    entries.set_item("position_mm", rows(py, &scan.places)?)?;
    entries.set_item("vertex", column(py, scan.vertices.clone()))?;
    entries.set_item("measured_mm", column(py, scan.measured.clone()))?;
    entries.set_item("simulated_mm", column(py, scan.simulated.clone()))?;
    entries.set_item("residual_mm", column(py, scan.residual.clone()))?;
    entries.set_item("noise_mm", column(py, scan.sigma.clone()))?;
    record(entries)
}

/// A placed mat: a row per sensel.
pub fn mat(py: Python<'_>, mat: &Mat) -> PyResult<Py<PyAny>> {
    let entries = PyDict::new(py);
    let place = |axis: usize| {
        let place = mat.places.iter();
        place
            .map(|place| place.map_or(-1, |place| i64::from(place[axis])))
            .collect()
    };
    entries.set_item("center_mm", rows(py, &mat.centers)?)?;
    entries.set_item("normal", rows(py, &mat.normals)?)?;
    entries.set_item("area_mm2", column(py, mat.areas.clone()))?;
    entries.set_item("row", column::<i64>(py, place(0)))?;
    entries.set_item("column", column::<i64>(py, place(1)))?;
    record(entries)
}

/// A frame of a mat: a value per sensel.
pub fn frame(
    py: Python<'_>,
    recording: &RecordingComparison,
    frame: &Frame,
) -> PyResult<Py<PyAny>> {
    let entries = PyDict::new(py);
    let moment = &recording.moments[frame.moment as usize];
    entries.set_item("why", frame.why.clone())?;
    entries.set_item("time_s", moment.time_s)?;
    entries.set_item("depth_mm", moment.depth_mm)?;
    entries.set_item("measured", column(py, frame.measured.clone()))?;
    entries.set_item("simulated", column(py, frame.simulated.clone()))?;
    entries.set_item("residual", column(py, frame.residual.clone()))?;
    entries.set_item("residual_sigmas", column(py, frame.sigmas.clone()))?;
    entries.set_item("contact_from", frame.contact_from)?;
    record(entries)
}
