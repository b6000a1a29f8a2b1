//! `thenar.Study`: a folder of recordings with their setting, as records of numpy arrays.

use crate::conversion::arrays::{column, rows, table, triple};
use crate::conversion::errors::Failure;
use crate::conversion::record::record;
use crate::conversion::running::{Hooks, run};
use crate::measured::prints::Print;
use crate::measured::recordings::{curve_record, map_record, path};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use std::sync::Arc;
use thenar_recordings::meshes::MeshFile;
use thenar_recordings::study::{
    Data, Indenter, Instrument, PlacedSensel, Shape, Site, StudyRecording, StudySkin,
};
use thenar_surface::Vec3;

/// Recordings, and the skin, tools and places they were taken with, in mm, N, s, kPa for maps and MPa for moduli.
#[pyclass(frozen, module = "thenar")]
pub struct Study {
    whole: Arc<thenar_recordings::Study>,
    /// Path of the folder.
    #[pyo3(get)]
    folder: Py<PyAny>,
    #[pyo3(get)]
    title: String,
    /// Record: vertices_mm (n, 3), triangles (m, 3), regions (n,) or None, region_names, materials by region name.
    #[pyo3(get)]
    skin: Py<PyAny>,
    /// Record by name: shape, and radius_mm, axis, vertices_mm, triangles where the shape has them.
    #[pyo3(get)]
    indenters: Py<PyAny>,
    /// Record by name: point_mm (3,), direction (3,), distance_mm to the skin.
    #[pyo3(get)]
    sites: Py<PyAny>,
    /// List of records: name, kind, file, indenter, site, protocol, subject, day, temperature_c, rest_s, order, and by kind
    /// `curve`, `map` with `sensels` and `motion`, `vertices_mm`, `triangles`, `at_time_s`, `depth_mm`, `motion`, or `print` with `sensels`,
    /// `ink_kpa`, `depth_mm`, `force_n`, `motion`.
    #[pyo3(get)]
    recordings: Py<PyAny>,
    /// Record of the data sheet, or None.
    #[pyo3(get)]
    instrument: Option<Py<PyAny>>,
    #[pyo3(get)]
    warnings: Vec<String>,
}

#[pymethods]
impl Study {
    /// Loads the study in `folder` (text or path) with every file it names. Raises `RecordingError`, which names file, line and
    /// remedy.
    #[staticmethod]
    fn load(py: Python<'_>, folder: &Bound<'_, PyAny>) -> PyResult<Study> {
        let place = path("folder", folder)?;
        let study = run(py, &Hooks::new(None, None)?, move |_| {
            thenar_recordings::Study::load(&place).map_err(Failure::Recording)
        })?;
        let recordings: Vec<_> = study
            .recordings
            .iter()
            .map(|each| recording(py, each))
            .collect::<PyResult<_>>()?;
        Ok(Study {
            folder: study.folder.clone().into_pyobject(py)?.into_any().unbind(),
            title: study.title.clone(),
            skin: skin(py, &study.skin)?,
            indenters: by_name(
                py,
                study
                    .indenters
                    .iter()
                    .map(|each| (&each.name, indenter(py, each))),
            )?,
            sites: by_name(
                py,
                study.sites.iter().map(|each| (&each.name, site(py, each))),
            )?,
            recordings: PyList::new(py, recordings)?.into_any().unbind(),
            instrument: study
                .instrument
                .as_ref()
                .map(|each| instrument(py, each))
                .transpose()?,
            warnings: study.warnings.clone(),
            whole: Arc::new(study),
        })
    }

    /// The recording of a name; raises `KeyError`.
    fn recording(&self, py: Python<'_>, name: &str) -> PyResult<Py<PyAny>> {
        for each in self.recordings.bind(py).try_iter()? {
            let each = each?;
            if each.get_item("name")?.extract::<String>()? == name {
                return Ok(each.unbind());
            }
        }
        Err(pyo3::exceptions::PyKeyError::new_err(name.to_string()))
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let count = self.recordings.bind(py).len()?;
        Ok(format!("<Study {:?} with {count} recordings>", self.title))
    }
}

impl Study {
    /// The study as the library knows it.
    pub fn whole(&self) -> Arc<thenar_recordings::Study> {
        Arc::clone(&self.whole)
    }
}

fn by_name<'a>(
    py: Python<'_>,
    items: impl Iterator<Item = (&'a String, PyResult<Py<PyAny>>)>,
) -> PyResult<Py<PyAny>> {
    let entries = PyDict::new(py);
    for (name, item) in items {
        entries.set_item(name, item?)?;
    }
    record(entries)
}

fn put_mesh(py: Python<'_>, mesh: &MeshFile, entries: &Bound<'_, PyDict>) -> PyResult<()> {
    let corners = mesh
        .triangles
        .iter()
        .flatten()
        .map(|index| *index as i32)
        .collect();
    entries.set_item("vertices_mm", rows(py, &mesh.positions)?)?;
    entries.set_item("triangles", table::<i32>(py, corners, 3)?)
}

fn skin(py: Python<'_>, skin: &StudySkin) -> PyResult<Py<PyAny>> {
    let entries = PyDict::new(py);
    put_mesh(py, &skin.mesh, &entries)?;
    let has_regions = !skin.regions.is_empty();
    entries.set_item(
        "regions",
        has_regions.then(|| column(py, skin.regions.clone())),
    )?;
    entries.set_item("region_names", &skin.region_names)?;
    let materials = PyDict::new(py);
    for material in &skin.materials {
        let numbers = PyDict::new(py);
        numbers.set_item("g0_mpa", material.g0_mpa)?;
        numbers.set_item("g_lim_mpa", material.g_lim_mpa)?;
        numbers.set_item("d_lim_mm", material.d_lim_mm)?;
        numbers.set_item("thickness_mm", material.thickness_mm)?;
        numbers.set_item("fit", &material.fit)?;
        materials.set_item(&material.region, record(numbers)?)?;
    }
    entries.set_item("materials", record(materials)?)?;
    record(entries)
}

fn indenter(py: Python<'_>, indenter: &Indenter) -> PyResult<Py<PyAny>> {
    let entries = PyDict::new(py);
    let (name, radius_mm) = match &indenter.shape {
        Shape::Plane => ("plane", None),
        Shape::Cylinder { radius_mm, axis } => {
            entries.set_item("axis", triple(py, Vec3::from(*axis)))?;
            ("cylinder", Some(*radius_mm))
        }
        Shape::Sphere { radius_mm } => ("sphere", Some(*radius_mm)),
        Shape::Punch { radius_mm } => ("punch", Some(*radius_mm)),
        Shape::Mesh(mesh) => {
            put_mesh(py, mesh, &entries)?;
            ("mesh", None)
        }
    };
    entries.set_item("shape", name)?;
    if let Some(radius_mm) = radius_mm {
        entries.set_item("radius_mm", radius_mm)?;
    }
    record(entries)
}

fn site(py: Python<'_>, site: &Site) -> PyResult<Py<PyAny>> {
    let entries = PyDict::new(py);
    entries.set_item("point_mm", triple(py, Vec3::from(site.point_mm)))?;
    entries.set_item("direction", triple(py, Vec3::from(site.direction)))?;
    entries.set_item("distance_mm", site.distance_mm)?;
    record(entries)
}

fn instrument(py: Python<'_>, sheet: &Instrument) -> PyResult<Py<PyAny>> {
    let entries = PyDict::new(py);
    entries.set_item("gain_percent", sheet.gain_percent)?;
    entries.set_item("noise_n", sheet.noise_n)?;
    entries.set_item("saturation_kpa", sheet.saturation_kpa)?;
    entries.set_item("threshold_kpa", sheet.threshold_kpa)?;
    entries.set_item("pitch_mm", sheet.pitch_mm)?;
    entries.set_item("position_mm", sheet.position_mm)?;
    entries.set_item("first_touch_mm", sheet.first_touch_mm)?;
    record(entries)
}

fn recording(py: Python<'_>, recording: &StudyRecording) -> PyResult<Py<PyAny>> {
    let entries = PyDict::new(py);
    entries.set_item("name", &recording.name)?;
    entries.set_item("file", &recording.file)?;
    let kind = match &recording.data {
        Data::Indentation(curve) => {
            entries.set_item("curve", curve_record(py, curve)?)?;
            "indentation"
        }
        Data::PressureMap {
            map,
            sensels,
            motion,
        } => {
            entries.set_item("map", map_record(py, map)?)?;
            entries.set_item(
                "sensels",
                sensels
                    .as_ref()
                    .map(|places| places_record(py, places))
                    .transpose()?,
            )?;
            entries.set_item(
                "motion",
                motion
                    .as_ref()
                    .map(|curve| curve_record(py, curve))
                    .transpose()?,
            )?;
            "pressure_map"
        }
        Data::Grasp {
            map,
            sensels,
            force,
            force_direction,
        } => {
            entries.set_item("map", map_record(py, map)?)?;
            entries.set_item("sensels", places_record(py, sensels)?)?;
            let force = force.as_ref().map(|curve| curve_record(py, curve));
            entries.set_item("force", force.transpose()?)?;
            let direction = force_direction.map(|way| triple(py, Vec3::from(way)));
            entries.set_item("force_direction", direction)?;
            "grasp"
        }
        Data::Scan {
            mesh,
            at_time_s,
            depth_mm,
            motion,
        } => {
            put_mesh(py, mesh, &entries)?;
            entries.set_item("at_time_s", *at_time_s)?;
            entries.set_item("depth_mm", *depth_mm)?;
            let motion = motion.as_ref().map(|curve| curve_record(py, curve));
            entries.set_item("motion", motion.transpose()?)?;
            "scan"
        }
        Data::Handprint {
            print,
            sensels,
            ink_kpa,
            depth_mm,
            force_n,
            motion,
        } => {
            entries.set_item("print", Py::new(py, Print::new((**print).clone()))?)?;
            let places = sensels.as_ref().map(|places| places_record(py, places));
            entries.set_item("sensels", places.transpose()?)?;
            entries.set_item("ink_kpa", *ink_kpa)?;
            entries.set_item("depth_mm", *depth_mm)?;
            entries.set_item("force_n", *force_n)?;
            let motion = motion.as_ref().map(|curve| curve_record(py, curve));
            entries.set_item("motion", motion.transpose()?)?;
            "handprint"
        }
    };
    entries.set_item("kind", kind)?;
    entries.set_item("indenter", &recording.indenter)?;
    entries.set_item("site", &recording.site)?;
    entries.set_item("protocol", &recording.protocol)?;
    entries.set_item("subject", &recording.subject)?;
    entries.set_item("day", &recording.day)?;
    entries.set_item("temperature_c", recording.temperature_c)?;
    entries.set_item("rest_s", recording.rest_s)?;
    entries.set_item("order", recording.order)?;
    record(entries)
}

/// Centers and areas in the map's order, NaN for a cell without a place.
fn places_record(py: Python<'_>, places: &[Option<PlacedSensel>]) -> PyResult<Py<PyAny>> {
    let entries = PyDict::new(py);
    let centers: Vec<Vec3> = places
        .iter()
        .map(|place| Vec3::from(place.map_or([f64::NAN; 3], |place| place.center_mm)))
        .collect();
    let areas = places
        .iter()
        .map(|place| place.map_or(f64::NAN, |place| place.area_mm2))
        .collect();
    entries.set_item("center_mm", rows(py, &centers)?)?;
    let normal = |place: &Option<PlacedSensel>| place.and_then(|place| place.normal);
    let normals: Option<Vec<Vec3>> = places
        .iter()
        .filter(|place| place.is_some())
        .map(|place| normal(place).map(Vec3::from))
        .collect();
    let normals = normals.map(|_| {
        places
            .iter()
            .map(|place| Vec3::from(normal(place).unwrap_or([f64::NAN; 3])))
            .collect::<Vec<_>>()
    });
    entries.set_item(
        "normal",
        normals.map(|normals| rows(py, &normals)).transpose()?,
    )?;
    entries.set_item("area_mm2", column::<f64>(py, areas))?;
    record(entries)
}
