//! `thenar.compare` and `thenar.compare_map`: recordings beside simulation, as records of arrays, JSON and a page.

use crate::conversion::arrays::{Argument, column};
use crate::conversion::ending;
use crate::conversion::errors::RecordingError;
use crate::conversion::record::record;
use crate::conversion::running::{Hooks, run};
use crate::measured::prints::printed;
use crate::measured::readings::{frame, mat, scan};
use crate::measured::study::Study;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use std::sync::Arc;
use thenar_comparison::{
    Measure, RecordingComparison, Series, Still, WorstPlace, compare_still, on_skin,
};
use thenar_inference::{Estimate, Mat, Options, Target};
use thenar_report::{comparison_html, comparison_json};
use thenar_surface::{Mesh, Vec3, vertex_areas};

/// What separates simulation and recordings.
#[pyclass(frozen, module = "thenar")]
pub struct Comparison {
    inner: Arc<thenar_comparison::Comparison>,
}

/// Fits a study's parameters to its recordings and compares what is left.
///
/// `seed` is where all that is drawn begins: the same seed gives the same result. `progress` and `cancel` as in `Skin.press`.
/// Raises `RecordingError` for a study that cannot be compared, and `Cancelled`.
#[pyfunction]
#[pyo3(signature = (study, progress=None, cancel=None, *, seed=1))]
pub fn compare(
    py: Python<'_>,
    study: &Study,
    progress: Option<Bound<'_, PyAny>>,
    cancel: Option<Bound<'_, PyAny>>,
    seed: u64,
) -> PyResult<Comparison> {
    let hooks = Hooks::new(cancel, progress)?;
    let study = study.whole();
    let inner = run(py, &hooks, move |control| {
        let options = Options {
            seed,
            ..Options::default()
        };
        Ok(thenar_comparison::compare(&study, &options, control)?)
    })?;
    Ok(Comparison::new(inner))
}

/// Compares one frame of a mat with a contact that was solved, sensel by sensel; nothing is fitted.
///
/// `values` (n,), kPa or with `calibrated=False` counts, NaN for missing cells; `mat` a record as `place_mat` gives it. The contact:
/// `vertices_mm` (m, 3) of the skin in contact, in the mat's frame, `triangles`, and `force_n` (m,). `threshold` and `clipped_from` are
/// the instrument's limits and `noise` the standard deviation of a reading, in the values' unit, if known. Raises `MeshError`,
/// `RecordingError`.
#[pyfunction]
#[pyo3(signature = (values, mat, vertices_mm, triangles, force_n, *, name="recording", product="product", hand="hand", calibrated=true,
    threshold=None, clipped_from=None, noise=None, time_s=0.0, unknown=Vec::new()))]
#[expect(
    clippy::too_many_arguments,
    reason = "keywords of the public interface"
)]
pub fn compare_map(
    py: Python<'_>,
    values: &Bound<'_, PyAny>,
    mat: &Bound<'_, PyAny>,
    vertices_mm: &Bound<'_, PyAny>,
    triangles: &Bound<'_, PyAny>,
    force_n: &Bound<'_, PyAny>,
    name: &str,
    product: &str,
    hand: &str,
    calibrated: bool,
    threshold: Option<f64>,
    clipped_from: Option<f64>,
    noise: Option<f64>,
    time_s: f64,
    unknown: Vec<String>,
) -> PyResult<Comparison> {
    let (mat, cells) = mat_of(mat)?;
    let values = Argument::solve("values", values).numbers_of(cells.len())?;
    let values: Vec<f64> = (0..values.len())
        .filter(|k| cells[*k])
        .map(|k| values[k])
        .collect();
    let positions = Argument::mesh("vertices_mm", vertices_mm).points()?;
    let triangles = Argument::mesh("triangles", triangles).triangles(positions.len())?;
    let force_n = Argument::solve("force_n", force_n).numbers_of(positions.len())?;
    let (name, product, hand) = (name.to_string(), product.to_string(), hand.to_string());
    let inner = run(py, &Hooks::none(), move |_| {
        let mesh = Mesh::new(positions, triangles)?;
        let still = Still {
            name: &name,
            product: &product,
            hand: &hand,
            positions: mesh.positions(),
            areas: &vertex_areas(&mesh),
            force_n: &force_n,
            mat,
            values: &values,
            is_calibrated: calibrated,
            threshold,
            clipped_from,
            noise,
            time_s,
            unknown,
        };
        Ok(compare_still(still)?)
    })?;
    Ok(Comparison::new(inner))
}

/// Values of sensels (n,), NaN for missing, at positions (m, 3) on the mat or near it, mm: hand or product.
///
/// A position takes the mean of the sensels nearer than their side, with weights that fall linearly to that distance; NaN away from
/// the mat. `depth_mm` is how far the mat has gone into the skin where the positions are those before contact. Raises `MeshError`.
#[pyfunction]
#[pyo3(signature = (values, mat, positions_mm, depth_mm=0.0))]
pub fn spread_map(
    py: Python<'_>,
    values: &Bound<'_, PyAny>,
    mat: &Bound<'_, PyAny>,
    positions_mm: &Bound<'_, PyAny>,
    depth_mm: f64,
) -> PyResult<Py<PyAny>> {
    let (mat, cells) = mat_of(mat)?;
    let given = Argument::solve("values", values).numbers_of(cells.len())?;
    let values: Vec<f64> = (0..given.len())
        .filter(|k| cells[*k])
        .map(|k| given[k])
        .collect();
    let positions = Argument::mesh("positions_mm", positions_mm).points()?;
    let carried = ending::call(py, move || on_skin(&positions, &mat, &values, depth_mm));
    Ok(column(py, carried))
}

/// The mat of a record, and which of its cells have a place.
pub fn mat_of(mat: &Bound<'_, PyAny>) -> PyResult<(Mat, Vec<bool>)> {
    let item = |name: &str| {
        mat.get_item(name).map_err(|_| {
            RecordingError::new_err(format!(
                "mat: it has no {name}; give the record that thenar.place_mat returns"
            ))
        })
    };
    let areas = item("area_mm2")?;
    let count = areas.len()?;
    let area = Argument::solve("mat.area_mm2", &areas).numbers_of(count)?;
    let is_placed: Vec<bool> = area.iter().map(|area| !area.is_nan()).collect();
    let points = |name: &'static str| -> PyResult<Vec<Vec3>> {
        let value = item(name)?;
        let flat = Argument::solve(name, &value).table_of(count, 3)?;
        let kept = (0..count).filter(|k| is_placed[*k]);
        Ok(kept
            .map(|k| Vec3::new(flat[3 * k], flat[3 * k + 1], flat[3 * k + 2]))
            .collect())
    };
    let whole = |name: &str| -> PyResult<Vec<i64>> {
        let numbers: Vec<i64> = item(name)?.call_method0("tolist")?.extract()?;
        if numbers.len() == count {
            return Ok(numbers);
        }
        let found = numbers.len();
        Err(RecordingError::new_err(format!(
            "mat.{name}: {found} numbers for {count} sensels; give one each"
        )))
    };
    let (row, column) = (whole("row")?, whole("column")?);
    let place = |k: usize| Some([u32::try_from(row[k]).ok()?, u32::try_from(column[k]).ok()?]);
    let kept = || (0..count).filter(|k| is_placed[*k]);
    let mat = Mat {
        centers: points("center_mm")?,
        normals: points("normal")?,
        areas: kept().map(|k| area[k]).collect(),
        places: kept().map(place).collect(),
    };
    Ok((mat, is_placed))
}

impl Comparison {
    /// Of the library's.
    pub fn new(inner: thenar_comparison::Comparison) -> Comparison {
        Comparison {
            inner: Arc::new(inner),
        }
    }
}

#[pymethods]
impl Comparison {
    /// comparison.json.
    fn to_json(&self, py: Python<'_>) -> String {
        let inner = Arc::clone(&self.inner);
        ending::call(py, move || comparison_json(&inner))
    }

    /// The self-contained page.
    fn report_html(&self, py: Python<'_>) -> String {
        let inner = Arc::clone(&self.inner);
        ending::call(py, move || comparison_html(&inner))
    }

    #[getter]
    fn title(&self) -> &str {
        &self.inner.title
    }

    /// What a designer reads first.
    #[getter]
    fn sentence(&self) -> &str {
        &self.inner.sentence
    }

    #[getter]
    fn lack_of_fit_p(&self) -> Option<f64> {
        self.inner.lack_of_fit_p
    }

    #[getter]
    fn notes(&self) -> Vec<String> {
        self.inner.notes.clone()
    }

    /// Records: name, region, recording, start, value, low, high, is_at_bound.
    #[getter]
    fn estimates(&self, py: Python<'_>) -> PyResult<Vec<Py<PyAny>>> {
        self.inner
            .estimates
            .iter()
            .map(|each| estimate(py, each))
            .collect()
    }

    /// Records: name, sentence, indenter, site, protocol, is_calibrated, has_noise, measures, series by name, mat, frames, scan, print, worst,
    /// residual_kpa (one per skin vertex, NaN away from the mat, or None), unknown.
    #[getter]
    fn recordings(&self, py: Python<'_>) -> PyResult<Vec<Py<PyAny>>> {
        self.inner
            .recordings
            .iter()
            .map(|each| recording(py, each))
            .collect()
    }

    fn __repr__(&self) -> String {
        format!(
            "<Comparison of {} recordings: {}>",
            self.inner.recordings.len(),
            self.inner.sentence
        )
    }
}

fn estimate(py: Python<'_>, estimate: &Estimate) -> PyResult<Py<PyAny>> {
    let entries = PyDict::new(py);
    let (region, recording) = match &estimate.target {
        Target::Region(name) => (Some(name), None),
        Target::Recording(name) => (None, Some(name)),
        Target::Instrument => (None, None),
    };
    entries.set_item("name", &estimate.name)?;
    entries.set_item("region", region)?;
    entries.set_item("recording", recording)?;
    entries.set_item("start", estimate.start)?;
    entries.set_item("value", estimate.value)?;
    entries.set_item("low", estimate.low)?;
    entries.set_item("high", estimate.high)?;
    entries.set_item("is_at_bound", estimate.is_at_bound)?;
    record(entries)
}

fn recording(py: Python<'_>, recording: &RecordingComparison) -> PyResult<Py<PyAny>> {
    let entries = PyDict::new(py);
    entries.set_item("name", &recording.name)?;
    entries.set_item("sentence", &recording.sentence)?;
    entries.set_item("indenter", &recording.indenter)?;
    entries.set_item("site", &recording.site)?;
    entries.set_item("protocol", &recording.protocol)?;
    entries.set_item("is_calibrated", recording.is_calibrated)?;
    entries.set_item("has_noise", recording.has_noise)?;
    entries.set_item("measures", list(py, &recording.measures, measure)?)?;
    let all = PyDict::new(py);
    for each in &recording.series {
        all.set_item(each.name, series(py, recording, each)?)?;
    }
    entries.set_item("series", record(all)?)?;
    entries.set_item(
        "mat",
        recording
            .mat
            .as_ref()
            .map(|each| mat(py, each))
            .transpose()?,
    )?;
    let frames = recording
        .frames
        .iter()
        .map(|each| frame(py, recording, each));
    entries.set_item("frames", frames.collect::<PyResult<Vec<_>>>()?)?;
    let seen = recording.scan.as_ref().map(|each| scan(py, each));
    entries.set_item("scan", seen.transpose()?)?;
    let print = recording.print.as_ref().map(|each| printed(py, each));
    entries.set_item("print", print.transpose()?)?;
    entries.set_item("worst", list(py, &recording.worst, worst)?)?;
    let residual =
        (!recording.residual_kpa.is_empty()).then(|| column(py, recording.residual_kpa.clone()));
    entries.set_item("residual_kpa", residual)?;
    entries.set_item("unknown", &recording.unknown)?;
    record(entries)
}

fn list<'py, T>(
    py: Python<'py>,
    items: &[T],
    each: impl Fn(Python<'py>, &T) -> PyResult<Py<PyAny>>,
) -> PyResult<Bound<'py, PyList>> {
    let items: Vec<_> = items
        .iter()
        .map(|item| each(py, item))
        .collect::<PyResult<_>>()?;
    PyList::new(py, items)
}

fn measure(py: Python<'_>, measure: &Measure) -> PyResult<Py<PyAny>> {
    let entries = PyDict::new(py);
    entries.set_item("name", measure.name)?;
    entries.set_item("label", measure.label)?;
    entries.set_item("unit", measure.unit)?;
    entries.set_item("of", measure.of)?;
    entries.set_item("measured", measure.measured)?;
    entries.set_item("noise", measure.noise)?;
    entries.set_item("simulated_before", measure.before)?;
    entries.set_item("simulated", measure.after)?;
    record(entries)
}

fn series(py: Python<'_>, recording: &RecordingComparison, series: &Series) -> PyResult<Py<PyAny>> {
    let entries = PyDict::new(py);
    let moments = || {
        series
            .moments
            .iter()
            .map(|moment| &recording.moments[*moment as usize])
    };
    let times = moments().map(|moment| moment.time_s).collect();
    let depths = moments().map(|moment| moment.depth_mm).collect();
    entries.set_item("time_s", column::<f64>(py, times))?;
    entries.set_item("depth_mm", column::<f64>(py, depths))?;
    entries.set_item("measured", column(py, series.measured.clone()))?;
    entries.set_item("simulated", column(py, series.simulated.clone()))?;
    entries.set_item("simulated_before", column(py, series.before.clone()))?;
    entries.set_item("noise", column(py, series.sigma.clone()))?;
    record(entries)
}

fn worst(py: Python<'_>, place: &WorstPlace) -> PyResult<Py<PyAny>> {
    let entries = PyDict::new(py);
    entries.set_item("quantity", place.kind.label())?;
    entries.set_item("time_s", place.time_s)?;
    entries.set_item("depth_mm", place.depth_mm)?;
    entries.set_item("phase", place.phase.name())?;
    entries.set_item("sensel", place.sensel)?;
    entries.set_item("row", place.place.map(|place| place[0]))?;
    entries.set_item("column", place.place.map(|place| place[1]))?;
    entries.set_item("position_mm", place.position_mm)?;
    let vertices = place
        .vertices
        .iter()
        .map(|vertex| i64::from(*vertex))
        .collect();
    entries.set_item("vertices", column::<i64>(py, vertices))?;
    entries.set_item("measured", place.measured)?;
    entries.set_item("simulated", place.simulated)?;
    entries.set_item("residual", place.residual)?;
    entries.set_item("residual_sigmas", place.sigmas)?;
    record(entries)
}
