//! `thenar.Mat` and `thenar.observe`: what a measuring set-up makes of a contact.

use crate::conversion::arrays::{Argument, column, rows, table};
use crate::conversion::errors::{MeshError, SolveError};
use crate::conversion::record::record;
use crate::press::contact::Contact;
use crate::press::effects::{Effect, effects_of};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use thenar_contact::instrument::{MatLayout, PointLoad, Signals};
use thenar_surface::Vec3;

/// Numbers of one load: x, y, z (mm), N, mm2.
pub const LOAD: usize = 5;
const CHANNELS: [&str; 4] = ["depth_mm", "force_n", "area_mm2", "tangential_force_n"];

/// A mat of sensels, flat or wrapped around anything, that averages pressure over each sensel.
///
/// `centers_mm` (s, 3) in the product's frame (or the skin's, if the mat is worn), `areas_mm2` (s,); missing cells are left out.
/// `normals` (s, 3), None: those of the planes through neighboring sensels; `along` (3,): the mat's first direction, roughly,
/// None: towards the neighbor nearest to its middle; the second is normal x first.
///
/// Raises `MeshError` for a sensel that cannot be used.
#[pyclass(frozen, module = "thenar")]
pub struct Mat(thenar_contact::instrument::Mat);

#[pymethods]
impl Mat {
    #[new]
    #[pyo3(signature = (centers_mm, areas_mm2, normals=None, along=None))]
    fn new(
        centers_mm: &Bound<'_, PyAny>,
        areas_mm2: &Bound<'_, PyAny>,
        normals: Option<&Bound<'_, PyAny>>,
        along: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Mat> {
        let centers = Argument::mesh("centers_mm", centers_mm).points()?;
        let layout = MatLayout {
            areas: Argument::mesh("areas_mm2", areas_mm2).numbers_of(centers.len())?,
            normals: match normals {
                Some(normals) => Argument::mesh("normals", normals).points()?,
                None => Vec::new(),
            },
            along: along
                .map(|along| Argument::mesh("along", along).vector())
                .transpose()?,
            centers,
        };
        let mat = thenar_contact::instrument::Mat::new(layout);
        mat.map(Mat)
            .map_err(|error| MeshError::new_err(error.to_string()))
    }

    /// (s,) kPa: what the mat reads of a `Contact` and the positions that were pressed, `vertices_mm` (n, 3), or of loads
    /// (k, 5) as in `Course.loads`.
    ///
    /// The mat lies on the product: it goes along where force control moves that.
    #[pyo3(signature = (contact, vertices_mm=None))]
    fn read(
        &self,
        py: Python<'_>,
        contact: &Bound<'_, PyAny>,
        vertices_mm: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Py<PyAny>> {
        let loads = match (contact.cast::<Contact>(), vertices_mm) {
            (Ok(contact), Some(vertices)) => of_contact(py, contact.get(), vertices)?,
            (Ok(_), None) => {
                return Err(SolveError::new_err(
                    "vertices_mm: missing; give the positions that were pressed",
                ));
            }
            (Err(_), _) => loads_of(&Argument::solve("contact", contact))?,
        };
        Ok(column(py, self.0.read(&loads)))
    }

    /// N, on the whole mat by a reading (s,) in kPa.
    fn force_n(&self, frame_kpa: &Bound<'_, PyAny>) -> PyResult<f64> {
        let frame = Argument::solve("frame_kpa", frame_kpa).numbers_of(self.0.len())?;
        Ok(self.0.force_n(&frame))
    }

    /// mm2, of the sensels that read more than `threshold_kpa`.
    #[pyo3(signature = (frame_kpa, threshold_kpa=0.0))]
    fn area_mm2(&self, frame_kpa: &Bound<'_, PyAny>, threshold_kpa: f64) -> PyResult<f64> {
        let frame = Argument::solve("frame_kpa", frame_kpa).numbers_of(self.0.len())?;
        Ok(self.0.area_mm2(&frame, threshold_kpa))
    }

    /// (s, 3), mm.
    #[getter]
    fn centers_mm(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        rows(py, self.0.centers())
    }

    /// (s, 3), unit length; of either sign where none were given.
    #[getter]
    fn normals(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        rows(py, self.0.normals())
    }

    /// (s,), mm2.
    #[getter]
    fn areas_mm2(&self, py: Python<'_>) -> Py<PyAny> {
        column(py, self.0.areas().to_vec())
    }

    /// (s, 2), mm, places on the unrolled mat from its middle, in its first and second direction.
    #[getter]
    fn flat_mm(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        table(py, self.0.flat().concat(), 2)
    }

    fn __len__(&self) -> usize {
        self.0.len()
    }

    fn __repr__(&self) -> String {
        let [first, second] = self.0.pitch_mm();
        format!(
            "<thenar.Mat: {} sensels, pitch {first:.2} x {second:.2} mm>",
            self.0.len()
        )
    }
}

/// What a measuring set-up shows of what happens at the skin.
///
/// `signals`: a dict of `time_s` (t,) and any of `depth_mm`, `force_n`, `area_mm2`, `tangential_force_n` (t,), `frames_kpa` (t, s), and
/// `loads`, a list of t arrays (k, 5) as in `Course.loads`, which `mat` then reads into frames. `effects`: a list of `Effect` of
/// kind "instrument"; they act in the catalogue's order, amplitude 0 changes nothing. Returns a record of the channels as
/// shown. Raises `SolveError`.
#[pyfunction]
#[pyo3(signature = (signals, mat=None, effects=None))]
pub fn observe(
    py: Python<'_>,
    signals: &Bound<'_, PyDict>,
    mat: Option<PyRef<'_, Mat>>,
    effects: Option<Vec<PyRef<'_, Effect>>>,
) -> PyResult<Py<PyAny>> {
    let sensels = mat.as_ref().map_or(0, |mat| mat.0.len());
    let given = signals_of(signals, sensels)?;
    let effects = effects_of(effects);
    let mat = mat.as_ref().map(|mat| &mat.0);
    let shown = thenar_contact::instrument::observe(&given, mat, &effects)
        .map_err(|error| SolveError::new_err(error.to_string()))?;
    let entries = PyDict::new(py);
    entries.set_item("time_s", column(py, shown.time_s))?;
    let channels = [
        shown.depth_mm,
        shown.force_n,
        shown.area_mm2,
        shown.tangential_force_n,
    ];
    for (name, values) in CHANNELS.iter().zip(channels) {
        if !values.is_empty() {
            entries.set_item(name, column(py, values))?;
        }
    }
    if !shown.frames.is_empty() {
        entries.set_item("frames_kpa", table(py, shown.frames.concat(), sensels)?)?;
    }
    record(entries)
}

fn signals_of(given: &Bound<'_, PyDict>, sensels: usize) -> PyResult<Signals> {
    for name in given.keys() {
        let name: String = name.extract()?;
        let known = ["time_s", "frames_kpa", "loads"].contains(&name.as_str());
        if !known && !CHANNELS.contains(&name.as_str()) {
            return Err(SolveError::new_err(format!(
                "signals: there is no channel {name:?}; there are time_s, {}, frames_kpa and loads",
                CHANNELS.join(", ")
            )));
        }
    }
    let Some(times) = given.get_item("time_s")? else {
        return Err(SolveError::new_err(
            "signals: time_s is missing; give one time per instant, s",
        ));
    };
    let count = times.len()?;
    let channel = |name: &str| match given.get_item(name)? {
        Some(values) => Argument::solve(name, &values).numbers_of(count),
        None => Ok(Vec::new()),
    };
    let mut signals = Signals {
        time_s: channel("time_s")?,
        depth_mm: channel("depth_mm")?,
        force_n: channel("force_n")?,
        area_mm2: channel("area_mm2")?,
        tangential_force_n: channel("tangential_force_n")?,
        ..Signals::default()
    };
    if let Some(frames) = given.get_item("frames_kpa")? {
        let frames = Argument::solve("frames_kpa", &frames).table_of(count, sensels)?;
        signals.frames = frames
            .chunks_exact(sensels.max(1))
            .map(<[f64]>::to_vec)
            .collect();
    }
    if let Some(loads) = given.get_item("loads")? {
        for each in loads.try_iter()? {
            signals
                .loads
                .push(loads_of(&Argument::solve("loads", &each?))?);
        }
    }
    Ok(signals)
}

/// Loads as rows of x, y, z (mm), N and mm2.
pub fn loads_table(py: Python<'_>, loads: &[PointLoad]) -> PyResult<Py<PyAny>> {
    let row = |load: &PointLoad| {
        let at = load.position;
        [at.x, at.y, at.z, load.force_n, load.area_mm2]
    };
    table(py, loads.iter().flat_map(row).collect(), LOAD)
}

fn loads_of(argument: &Argument<'_, '_>) -> PyResult<Vec<PointLoad>> {
    let count = argument.value.len()?;
    let numbers = argument.table_of(count, LOAD)?;
    if let Some(bad) = numbers.iter().position(|n| !n.is_finite()) {
        return Err(argument.fault(format_args!("row {} is not finite", bad / LOAD)));
    }
    let load = |row: &[f64]| PointLoad {
        position: Vec3::new(row[0], row[1], row[2]),
        force_n: row[3],
        area_mm2: row[4].max(0.0),
    };
    Ok(numbers.chunks_exact(LOAD).map(load).collect())
}

fn of_contact(
    py: Python<'_>,
    contact: &Contact,
    vertices: &Bound<'_, PyAny>,
) -> PyResult<Vec<PointLoad>> {
    let argument = Argument::mesh("vertices_mm", vertices);
    let (posed, pressed) = (argument.points()?, contact.pressed(py)?);
    if posed.len() != pressed.displacement.len() {
        return Err(argument.fault(format_args!(
            "{} rows for a contact of {} vertices; give the positions that were pressed",
            posed.len(),
            pressed.displacement.len()
        )));
    }
    let shift = pressed.direction * pressed.offset;
    let load = |(vertex, position): (usize, &Vec3)| {
        let (force, pressure) = (pressed.force[vertex], pressed.pressure[vertex]);
        (force > 0.0).then(|| PointLoad {
            position: position + pressed.displacement[vertex] - shift,
            force_n: force,
            area_mm2: if pressure > 0.0 {
                force / pressure
            } else {
                0.0
            },
        })
    };
    Ok(posed.iter().enumerate().filter_map(load).collect())
}
