//! Grasps of a study: frames of a mat on a product that a whole hand holds, with a force trace.

use super::indenters::{Indenter, Shape, unit_vector};
use super::place::Folder;
use super::toml_tree::Section;
use crate::curve::Curve;
use crate::fault::{Fault, shown};
use crate::recording::read_with;
use crate::recording_file::ReadOptions;
use crate::{PressureMap, PressureUnit, RecordingError};
use std::path::Path;

/// What a study says of a grasp besides its frames and their places.
pub(super) struct Trace {
    /// Force over time.
    pub force: Option<Curve>,
    /// Direction across which it is measured.
    pub direction: Option<[f64; 3]>,
}

/// Refuses frames that no grasp can be read from.
pub(super) fn check(section: &Section, map: &PressureMap) -> Result<(), Fault> {
    if map.unit != PressureUnit::Kilopascal {
        let problem = format!("{} holds raw counts", section.name);
        let remedy = "export calibrated pressures: a grasp is compared in kPa and N";
        return Err(section.fault(problem, remedy));
    }
    if map.time_s.is_none() || map.frames() < 2 {
        let problem = format!("{} has no frames over time", section.name);
        let remedy = "export all frames of the hold, with their times";
        return Err(section.fault(problem, remedy));
    }
    Ok(())
}

/// The fault of a grasp whose mat has no place.
pub(super) fn unplaced(section: &Section) -> Fault {
    section.needs(
        "placing",
        "say where the mat lies on the product: sensels = \"sensels.csv\", or a table [recordings.placing]",
    )
}

/// Reads the force trace of a grasp.
pub(super) fn read_trace(section: &mut Section, folder: &Folder) -> Result<Trace, RecordingError> {
    let force = section.get("force").map(|entry| folder.file(&entry));
    let force = force.transpose()?.map(|file| trace(&file)).transpose()?;
    let has_direction = section.get("force_direction").is_some();
    let direction = match has_direction {
        true => Some(unit_vector(section, "force_direction").map_err(|fault| folder.fault(fault))?),
        false => None,
    };
    Ok(Trace { force, direction })
}

/// The product of a grasp is an indenter that is a mesh, since it lies in the hand as it is.
pub(super) fn check_product(
    section: &Section,
    (name, indenters): (&str, &[Indenter]),
) -> Result<(), Fault> {
    let is_it = |each: &Indenter| each.name == name && matches!(each.shape, Shape::Mesh(_));
    if indenters.iter().any(is_it) {
        return Ok(());
    }
    let problem = format!(
        "the indenter {} of {} is not a mesh",
        shown(name.as_bytes()),
        section.name
    );
    let remedy = "give the held product as shape = \"mesh\" with its file, in skin coordinates as it is held";
    Err(section.fault(problem, remedy))
}

/// Force over time.
fn trace(file: &Path) -> Result<Curve, RecordingError> {
    let mut curves = read_with(file, &ReadOptions::default())?.curves;
    let fault = |problem: &str, remedy: &'static str| Fault::file(problem.into(), remedy);
    if curves.len() != 1 {
        let problem = format!("the file holds {} force traces, expected one", curves.len());
        return Err(fault(&problem, "name a table of time_s and force_n").in_file(file));
    }
    let curve = curves.remove(0);
    if curve.channel("time_s").is_none() || curve.channel("force_n").is_none() {
        let remedy = "add columns time_s, on the clock of the mat, and force_n";
        return Err(fault("the force trace lacks time or force", remedy).in_file(file));
    }
    Ok(curve)
}
