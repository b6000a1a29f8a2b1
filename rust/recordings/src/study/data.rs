//! What was measured, with the parts that several kinds of recordings share: where sensels lie, and the indentation that goes with them.

use super::indentation;
use super::place::Folder;
use super::places::charts::{self, OffChart};
use super::places::seat;
use super::places::sensels::{self, PlacedSensel};
use super::toml_tree::Section;
use crate::RecordingError;
use crate::curve::Curve;
use crate::fault::Fault;
use crate::handprint::Handprint;
use crate::meshes::MeshFile;
use crate::pressure_map::PressureMap;
use crate::recording_file::ReadOptions;
use std::path::PathBuf;

/// What was measured.
#[derive(Debug, Clone, PartialEq)]
pub enum Data {
    /// Force over depth and time: channels `time_s`, `force_n`, and `depth_mm` or `travel_mm`.
    Indentation(Curve),
    /// Frames of a mat.
    PressureMap {
        /// The frames.
        map: Box<PressureMap>,
        /// Where the sensels lie on the product, in the map's order, if the study says.
        sensels: Option<Vec<Option<PlacedSensel>>>,
        /// The indentation that goes with it.
        motion: Option<Box<Curve>>,
    },
    /// Frames of a mat on a product that a whole hand holds: the skin is the posed hand, in touch with the product.
    Grasp {
        /// The frames.
        map: Box<PressureMap>,
        /// Where the sensels lie on the product, in the map's order.
        sensels: Vec<Option<PlacedSensel>>,
        /// Force trace: channels `time_s` on the mat's clock, and `force_n`.
        force: Option<Box<Curve>>,
        /// What the trace measures: the force across this direction (a unit vector) in a product that is cut in two; `None` is the sum
        /// of all normal forces.
        force_direction: Option<[f64; 3]>,
    },
    /// A surface under load, or before it.
    Scan {
        /// The deformed surface, mm; a point cloud has no triangles.
        mesh: MeshFile,
        /// Time of the scan, s.
        at_time_s: Option<f64>,
        /// How deep the tool stood, mm; 0 before touch and after it.
        depth_mm: Option<f64>,
        /// The indentation during which it was taken.
        motion: Option<Box<Curve>>,
    },
    /// A print in ink: where skin touched, never how hard.
    Handprint {
        /// Shares of ink by cell.
        print: Box<Handprint>,
        /// Where the cells lie on the product, in the print's order, if the study says.
        sensels: Option<Vec<Option<PlacedSensel>>>,
        /// Pressure above which skin leaves ink, kPa.
        ink_kpa: f64,
        /// How deep the tool stood at most, mm.
        depth_mm: Option<f64>,
        /// How hard it was pressed at most, N.
        force_n: Option<f64>,
        /// The indentation during which it was taken.
        motion: Option<Box<Curve>>,
    },
}

/// The indentation that goes with a map or a scan.
pub(super) fn read_motion(
    section: &mut Section,
    folder: &Folder,
) -> Result<Option<Box<Curve>>, RecordingError> {
    let entry = section.get("motion");
    let file = entry.map(|entry| folder.file(&entry)).transpose()?;
    let read = |file: PathBuf| indentation::read(&file, &ReadOptions::default()).map(Box::new);
    file.map(read).transpose()
}

/// Where the sensels lie: as a file lists them, or as the mat is laid on a plane or a cylinder.
pub(super) fn read_places(
    section: &mut Section,
    (map, off): (&PressureMap, OffChart),
    folder: &Folder,
) -> Result<Option<Vec<Option<PlacedSensel>>>, RecordingError> {
    let here = |fault: Fault| folder.fault(fault);
    let file = section
        .get("sensels")
        .map(|entry| folder.file(&entry))
        .transpose()?;
    let Some(mut placing) = section.section("placing").map_err(here)? else {
        return file.map(|file| sensels::read(&file, map)).transpose();
    };
    if file.is_some() {
        let problem = format!("{} has both sensels and placing", section.name);
        return Err(here(section.fault(problem, "leave one of them out")));
    }
    let is_on_mesh =
        matches!(placing.get("on"), Some(entry) if entry.text().is_ok_and(|on| on == "mesh"));
    let placed = match is_on_mesh {
        true => charts::place(&mut placing, (map, off), folder)?,
        false => {
            let seat = seat::read(&mut placing).map_err(here)?;
            let placed = seat.place(map);
            placed.map_err(|(problem, remedy)| here(placing.fault(problem, remedy)))?
        }
    };
    placing.finish().map_err(here)?;
    Ok(Some(placed))
}
