//! Protocols from Python, and `thenar.Course`: what comes out of them.

use crate::conversion::arrays::{Argument, column, rows, table, triple};
use crate::conversion::errors::SolveError;
use crate::conversion::record::record;
use crate::press::contact::Contact;
use crate::press::instrument::loads_table;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use std::sync::Arc;
use thenar_contact::{Demand, Keep, Protocol, Row};
use thenar_surface::Vec3;

const COLUMNS: [&str; 3] = ["offset_mm", "depth_mm", "force_n"];

/// The result of a protocol: arrays with one entry per row.
#[pyclass(frozen, get_all, module = "thenar")]
pub struct Course {
    /// (s,), s.
    time_s: Py<PyAny>,
    /// (s,), mm, travel of the product along `direction` from where it was given.
    offset_mm: Py<PyAny>,
    /// (s,), mm, beyond first touch; NaN where the protocol asked for neither depth nor release.
    depth_mm: Py<PyAny>,
    /// (s,), N, normal force on the skin along `direction`.
    force_n: Py<PyAny>,
    /// (s, 3), N, on the product.
    total_force_n: Py<PyAny>,
    /// (s, 3), N, shear force on the skin; zero without friction.
    tangential_force_n: Py<PyAny>,
    /// (s,), mJ, energy lost to slip since the first row.
    slip_loss_mj: Py<PyAny>,
    /// (s,), mm2.
    contact_area_mm2: Py<PyAny>,
    /// (s,), MPa.
    peak_pressure_mpa: Py<PyAny>,
    /// (s, regions), N.
    region_force_n: Py<PyAny>,
    /// (s,), mJ, work done on the skin since the first row.
    work_mj: Py<PyAny>,
    /// (s, n), MPa, or None if only totals were to be kept.
    pressure_mpa: Option<Py<PyAny>>,
    /// List of (k, 5) x, y, z (mm, in the product's frame), N, mm2 by row, or None unless loads were to be kept.
    loads: Py<PyAny>,
    /// Records of the closed cycles: start_s, end_s, loss_mj, work_mj, loss_share; see `thenar_contact::Cycle`.
    cycles: Py<PyAny>,
    /// (s,), bool.
    has_converged: Py<PyAny>,
    /// (3,), unit direction of travel.
    direction: Py<PyAny>,
    /// The contact at the last row, in full.
    last: Py<Contact>,
}

impl Course {
    /// Moves the result into Python; `kept` is what was kept of the skin's so many vertices.
    pub fn new(
        py: Python<'_>,
        course: thenar_contact::Course,
        (names, (keep, vertices)): (Arc<Vec<String>>, (Keep, usize)),
    ) -> PyResult<Course> {
        let steps = &course.steps;
        let of = |value: &dyn Fn(&thenar_contact::Step) -> f64| {
            column(py, steps.iter().map(value).collect())
        };
        let touch = course.touch_offset.unwrap_or(f64::NAN);
        let forces: Vec<Vec3> = steps.iter().map(|step| step.total_force).collect();
        let shears: Vec<Vec3> = steps.iter().map(|step| step.shear).collect();
        let regions = steps.first().map_or(0, |step| step.region_force.len());
        let by_region = steps
            .iter()
            .flat_map(|step| step.region_force.iter().copied())
            .collect();
        let loads = (keep == Keep::Loads).then(|| {
            let each = steps.iter().map(|step| loads_table(py, &step.loads));
            PyList::new(py, each.collect::<PyResult<Vec<_>>>()?)
        });
        let loads = match loads.transpose()? {
            Some(loads) => loads.into_any().unbind(),
            None => py.None(),
        };
        let cycles = course.cycles();
        let cycles = cycles.iter().map(|cycle| cycle_record(py, cycle));
        let cycles = PyList::new(py, cycles.collect::<PyResult<Vec<_>>>()?)?;
        let pressure = (keep == Keep::Pressure).then(|| {
            let mut values = vec![0.0; steps.len() * vertices];
            for (step, row) in steps.iter().zip(values.chunks_mut(vertices.max(1))) {
                step.pressure
                    .iter()
                    .for_each(|&(vertex, p)| row[vertex as usize] = p);
            }
            table(py, values, vertices)
        });
        Ok(Course {
            time_s: of(&|step| step.time_s),
            offset_mm: of(&|step| step.offset),
            depth_mm: of(&|step| step.offset - touch),
            force_n: of(&|step| step.force),
            total_force_n: rows(py, &forces)?,
            tangential_force_n: rows(py, &shears)?,
            slip_loss_mj: of(&|step| step.slip_loss),
            contact_area_mm2: of(&|step| step.area),
            peak_pressure_mpa: of(&|step| step.peak_pressure),
            region_force_n: table(py, by_region, regions)?,
            work_mj: of(&|step| step.work),
            pressure_mpa: pressure.transpose()?,
            loads,
            cycles: cycles.into_any().unbind(),
            has_converged: column(py, steps.iter().map(|step| step.has_converged).collect()),
            direction: triple(py, course.direction),
            last: Py::new(py, Contact::new(course.last, names))?,
        })
    }
}

fn cycle_record(py: Python<'_>, cycle: &thenar_contact::Cycle) -> PyResult<Py<PyAny>> {
    let entries = PyDict::new(py);
    entries.set_item("start_s", cycle.start_s)?;
    entries.set_item("end_s", cycle.end_s)?;
    entries.set_item("work_mj", cycle.work)?;
    entries.set_item("loss_mj", cycle.loss)?;
    entries.set_item("loss_share", cycle.share())?;
    record(entries)
}

/// A protocol from a dict of columns: `time_s` and one or more of `offset_mm`, `depth_mm`, `force_n`, one of them given
/// (not NaN) in each row; `slide_mm` (s, 3) if the product moves besides.
pub fn protocol_of(given: &Bound<'_, PyDict>, direction: Option<Vec3>) -> PyResult<Protocol> {
    for name in given.keys() {
        let name: String = name.extract()?;
        if name != "time_s" && name != "slide_mm" && !COLUMNS.contains(&name.as_str()) {
            return Err(SolveError::new_err(format!(
                "protocol: there is no column {name:?}; there are time_s, offset_mm, depth_mm, force_n and slide_mm"
            )));
        }
    }
    let Some(times) = given.get_item("time_s")? else {
        return Err(SolveError::new_err(
            "protocol: time_s is missing; give one time per row, s",
        ));
    };
    let count = times.len()?;
    let times = Argument::solve("time_s", &times).numbers_of(count)?;
    let mut demands: Vec<Option<Demand>> = vec![None; count];
    for name in COLUMNS {
        let Some(values) = given.get_item(name)? else {
            continue;
        };
        let values = Argument::solve(name, &values).numbers_of(count)?;
        for (row, (demand, value)) in demands
            .iter_mut()
            .zip(values)
            .enumerate()
            .filter(|(_, (_, v))| !v.is_nan())
        {
            if demand.is_some() {
                return Err(SolveError::new_err(format!(
                    "protocol, row {row}: more than one of offset_mm, depth_mm and force_n is given; leave one"
                )));
            }
            *demand = Some(match name {
                "offset_mm" => Demand::Offset(value),
                "depth_mm" => Demand::Depth(value),
                _ => Demand::Force(value),
            });
        }
    }
    let slides = match given.get_item("slide_mm")? {
        Some(slides) => Argument::solve("slide_mm", &slides).points()?,
        None => vec![Vec3::zeros(); count],
    };
    if slides.len() != count {
        let found = slides.len();
        return Err(SolveError::new_err(format!(
            "slide_mm: {found} rows for {count} times; give one per time"
        )));
    }
    let row = |(row, ((time_s, demand), slide)): (usize, ((f64, Option<Demand>), Vec3))| {
        let demand = demand.ok_or_else(|| {
            SolveError::new_err(format!(
                "protocol, row {row}: give one of offset_mm, depth_mm and force_n"
            ))
        })?;
        Ok(Row {
            time_s,
            demand,
            slide,
        })
    };
    let rows = times.into_iter().zip(demands).zip(slides).enumerate();
    Ok(Protocol {
        rows: rows.map(row).collect::<PyResult<_>>()?,
        direction,
    })
}
