//! `thenar.place_mat`: where the sensels of a mat come to lie on a plane or around a cylinder.

use crate::conversion::arrays::{Argument, column, rows};
use crate::conversion::errors::{Failure, RecordingError};
use crate::conversion::record::record;
use crate::conversion::running::{Hooks, run};
use crate::measured::prints::Print;
use crate::measured::recordings::path;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::{Path, PathBuf};
use thenar_recordings::PressureMap;
use thenar_recordings::study::{PlacedSensel, Seat};
use thenar_surface::Vec3;

/// Lays the flat mat of a measurement file, or a `Print`, on a plane or around a cylinder, mm; a mat that bends keeps its lengths.
///
/// `origin_mm` is on a plane the mat's corner before its first row and column, on a cylinder the point of the axis level with the edge
/// before the first row. `rows` is the direction in which rows count (along the axis of a cylinder). `columns` is on a plane the direction in
/// which columns count; on a cylinder of `diameter_mm` it points from the axis to the seam, the edge before the first column, and
/// columns go around by the right-hand rule about `rows`, or against it with `turn="left"`. `mat` names one of several mats of a file.
/// Returns a record in the order of the file's sensels: center_mm (n, 3), normal (n, 3) out of the product, area_mm2 (n,), NaN
/// for cells that are missing in every frame, row and column (n,), -1 where the file does not number them. Raises `RecordingError`.
#[pyfunction]
#[pyo3(signature = (file, on, *, origin_mm, rows, columns, diameter_mm=None, turn="right", mat=None))]
#[expect(
    clippy::too_many_arguments,
    reason = "keywords of the public interface"
)]
pub fn place_mat(
    py: Python<'_>,
    file: &Bound<'_, PyAny>,
    on: &str,
    origin_mm: &Bound<'_, PyAny>,
    rows: &Bound<'_, PyAny>,
    columns: &Bound<'_, PyAny>,
    diameter_mm: Option<f64>,
    turn: &str,
    mat: Option<String>,
) -> PyResult<Py<PyAny>> {
    let flat = match file.cast::<Print>() {
        Ok(print) => Flat::Print(Box::new(print.get().as_map())),
        Err(_) => Flat::File(path("file", file)?),
    };
    let origin = Argument::solve("origin_mm", origin_mm).vector()?;
    let along = direction("rows", Argument::solve("rows", rows).vector()?)?;
    let across = Argument::solve("columns", columns).vector()?;
    let across = direction("columns", across - along * across.dot(&along))?;
    let seat = match (on, diameter_mm) {
        ("plane", _) => Seat::Plane {
            origin,
            columns: across,
            rows: along,
        },
        ("cylinder", Some(diameter)) if diameter > 0.0 && diameter.is_finite() => Seat::Cylinder {
            origin,
            axis: along,
            seam: across,
            radius: 0.5 * diameter,
            turn: sense(turn)?,
        },
        ("cylinder", _) => {
            return Err(refused(
                "diameter_mm: a cylinder needs one above zero; give it in mm",
            ));
        }
        _ => {
            return Err(refused(&format!(
                "on: a mat on {on:?} is not known; give \"plane\" or \"cylinder\""
            )));
        }
    };
    let (map, placed) = run(py, &Hooks::none(), move |_| {
        Ok(lay(flat, mat.as_deref(), &seat))
    })?
    .map_err(|fault| match fault {
        Fault::Reading(error) => PyErr::from(Failure::Recording(error)),
        Fault::Laying(sentence) => refused(&sentence),
    })?;
    placed_record(py, &map, &placed)
}

enum Fault {
    Reading(thenar_recordings::RecordingError),
    Laying(String),
}

type Laid = (PressureMap, Vec<Option<PlacedSensel>>);

/// What is laid.
enum Flat {
    File(PathBuf),
    Print(Box<PressureMap>),
}

fn lay(flat: Flat, mat: Option<&str>, seat: &Seat) -> Result<Laid, Fault> {
    let (map, name) = match flat {
        Flat::Print(map) => (*map, "the print".to_string()),
        Flat::File(file) => {
            let maps = thenar_recordings::read(&file).map_err(Fault::Reading)?.maps;
            let map = chosen(&file, maps, mat).map_err(Fault::Laying)?;
            (map, file.display().to_string())
        }
    };
    let placed = seat.place(&map);
    let placed = placed.map_err(|(problem, remedy)| {
        let remedy = remedy.replace(
            "sensels = \"sensels.csv\"",
            "the places of the sensels in a study",
        );
        Fault::Laying(format!("{name}: {problem}; {remedy}"))
    })?;
    Ok((map, placed))
}

/// The mat of a name, or the only one.
fn chosen(
    file: &Path,
    mut maps: Vec<PressureMap>,
    wanted: Option<&str>,
) -> Result<PressureMap, String> {
    let names: Vec<String> = maps.iter().map(|map| map.name.clone()).collect();
    let at = match wanted {
        Some(wanted) => names.iter().position(|name| name == wanted),
        None => (maps.len() == 1).then_some(0),
    };
    at.map(|at| maps.swap_remove(at)).ok_or_else(|| {
        let file = file.display();
        match names.is_empty() {
            true => format!("{file}: it holds no pressure map; choose a recording of a mat"),
            false => format!(
                "{file}: it holds {} mats; name one with mat: {}",
                names.len(),
                names.join(", ")
            ),
        }
    })
}

fn placed_record(
    py: Python<'_>,
    map: &PressureMap,
    placed: &[Option<PlacedSensel>],
) -> PyResult<Py<PyAny>> {
    let entries = PyDict::new(py);
    let points = |of: &dyn Fn(&PlacedSensel) -> [f64; 3]| -> Vec<Vec3> {
        let point = |place: &Option<PlacedSensel>| place.as_ref().map_or([f64::NAN; 3], of);
        placed
            .iter()
            .map(|place| Vec3::from(point(place)))
            .collect()
    };
    let centers = points(&|place| place.center_mm);
    let normals = points(&|place| place.normal.unwrap_or([f64::NAN; 3]));
    let areas = placed
        .iter()
        .map(|place| place.map_or(f64::NAN, |place| place.area_mm2));
    let number = |axis: usize| {
        let sensels = map.sensels.iter();
        sensels
            .map(|sensel| sensel.place.map_or(-1, |place| i64::from(place[axis])))
            .collect()
    };
    entries.set_item("center_mm", rows(py, &centers)?)?;
    entries.set_item("normal", rows(py, &normals)?)?;
    entries.set_item("area_mm2", column::<f64>(py, areas.collect()))?;
    entries.set_item("row", column::<i64>(py, number(0)))?;
    entries.set_item("column", column::<i64>(py, number(1)))?;
    record(entries)
}

fn sense(turn: &str) -> PyResult<f64> {
    match turn {
        "right" => Ok(1.0),
        "left" => Ok(-1.0),
        _ => Err(refused(&format!(
            "turn: there is no {turn:?}; give \"right\" or \"left\""
        ))),
    }
}

fn direction(name: &str, vector: Vec3) -> PyResult<Vec3> {
    vector.try_normalize(1e-9).ok_or_else(|| {
        refused(&format!(
            "{name}: it points nowhere, or columns along rows; give two directions across one another"
        ))
    })
}

fn refused(sentence: &str) -> PyErr {
    RecordingError::new_err(sentence.to_string())
}
