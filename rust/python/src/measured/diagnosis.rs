//! `thenar.diagnose`: what a study's recordings show that the model leaves out, as JSON and a page.

use crate::conversion::arrays::column;
use crate::conversion::ending;
use crate::conversion::record::record;
use crate::conversion::running::{Hooks, run};
use crate::measured::study::Study;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::sync::Arc;
use thenar_diagnosis::Curve;
use thenar_diagnosis::{DiagnoseOptions, findings_json};
use thenar_report::diagnosis_html;

/// What a study's recordings show that the model leaves out.
#[pyclass(frozen, module = "thenar")]
pub struct Diagnosis {
    inner: Arc<thenar_diagnosis::Diagnosis>,
}

/// Says what physics a study's recordings show that the model leaves out.
///
/// `seed` is where all that is drawn begins: the same seed gives the same result. `progress` and `cancel` as in `Skin.press`.
/// Raises `RecordingError` for a study that cannot be compared, and `Cancelled`.
#[pyfunction]
#[pyo3(signature = (study, progress=None, cancel=None, *, seed=1))]
pub fn diagnose(
    py: Python<'_>,
    study: &Study,
    progress: Option<Bound<'_, PyAny>>,
    cancel: Option<Bound<'_, PyAny>>,
    seed: u64,
) -> PyResult<Diagnosis> {
    let hooks = Hooks::new(cancel, progress)?;
    let study = study.whole();
    let inner = run(py, &hooks, move |control| {
        let options = DiagnoseOptions { seed };
        Ok(thenar_diagnosis::diagnose(&study, &options, control)?)
    })?;
    Ok(Diagnosis {
        inner: Arc::new(inner),
    })
}

#[pymethods]
impl Diagnosis {
    /// findings.json, schema 1.
    fn to_json(&self, py: Python<'_>) -> String {
        let inner = Arc::clone(&self.inner);
        ending::call(py, move || findings_json(&inner))
    }

    /// The self-contained page: the diagnosis, then the comparison that it started from.
    fn report_html(&self, py: Python<'_>) -> String {
        let inner = Arc::clone(&self.inner);
        ending::call(py, move || diagnosis_html(&inner))
    }

    /// What a designer reads first.
    #[getter]
    fn sentence(&self) -> &str {
        &self.inner.sentence
    }

    /// The verdict's word, as in findings.json.
    #[getter]
    fn verdict(&self) -> &'static str {
        self.inner.verdict.word()
    }

    /// Effects that explain more than noise would and that a gate refused: suspected only, no findings.
    /// With insufficient_data no gate was asked and the noise is not known; friction of a single slide passes no gate.
    #[getter]
    fn suspected(&self) -> Vec<&'static str> {
        self.inner.suspected.clone()
    }

    /// Records: recording, and by sample time_s, depth_mm, measured_n, before_n (parameters alone) and after_n (with what was found).
    #[getter]
    fn curves(&self, py: Python<'_>) -> PyResult<Vec<Py<PyAny>>> {
        self.inner
            .curves
            .iter()
            .map(|each| curve(py, each))
            .collect()
    }

    fn __repr__(&self) -> String {
        format!("Diagnosis({})", self.inner.verdict.word())
    }
}

fn curve(py: Python<'_>, curve: &Curve) -> PyResult<Py<PyAny>> {
    let entries = PyDict::new(py);
    entries.set_item("recording", &curve.recording)?;
    for (name, values) in [
        ("time_s", &curve.time_s),
        ("depth_mm", &curve.depth_mm),
        ("measured_n", &curve.measured_n),
        ("before_n", &curve.before_n),
        ("after_n", &curve.after_n),
    ] {
        entries.set_item(name, column(py, values.clone()))?;
    }
    record(entries)
}
