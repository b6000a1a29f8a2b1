//! Handprints of a study: how their image is to be read, how the paper lay, and how hard it was pressed.

use super::data::{Data, read_motion, read_places};
use super::place::Folder;
use super::places::charts::OffChart;
use super::toml_tree::{Section, nearest};
use crate::RecordingError;
use crate::fault::{Fault, shown};
use crate::handprint::{Handprint, Ink, PrintOptions, Scale, THRESHOLD_REMEDY};
use crate::meshes::MeshFile;
use std::path::Path;
use thenar_surface::{Mesh, median_edge_length};

/// Reads a handprint, its place and its press.
pub(super) fn read(
    section: &mut Section,
    (file, skin): (&Path, &MeshFile),
    folder: &Folder,
) -> Result<Data, RecordingError> {
    let here = |fault: Fault| folder.fault(fault);
    let options = options(section, skin).map_err(here)?;
    let ink_kpa = number_from_zero(section, "ink_kpa").map_err(here)?;
    let depth_mm = section.positive("depth_mm").map_err(here)?;
    let force_n = section.positive("force_n").map_err(here)?;
    let motion = read_motion(section, folder)?;
    let given = [depth_mm.is_some(), force_n.is_some(), motion.is_some()];
    if given.into_iter().filter(|is| *is).count() > 1 {
        let problem = format!(
            "{} says more than once how hard it was pressed",
            section.name
        );
        let fault = section.fault(problem, "give one of force_n, depth_mm and motion");
        return Err(here(fault));
    }
    let print = Handprint::read(file, &options)?;
    let sensels = read_places(section, (&print.as_map(), OffChart::Blank), folder)?;
    Ok(Data::Handprint {
        print: Box::new(print),
        sensels,
        ink_kpa: ink_kpa.unwrap_or(0.0),
        depth_mm,
        force_n,
        motion,
    })
}

fn options(section: &mut Section, skin: &MeshFile) -> Result<PrintOptions, Fault> {
    let scale = scale(section)?;
    let threshold = match section.get("threshold") {
        None => None,
        Some(entry) => match entry.finite()? {
            share if (0.0..=1.0).contains(&share) => Some(share),
            other => {
                return Err(entry.fault(format!("is {other}"), THRESHOLD_REMEDY));
            }
        },
    };
    let ink = ink(section)?;
    let paper = section.get("paper_px").map(|entry| entry.numbers::<4>());
    let is_mirrored = section.get("mirrored").map(|entry| entry.boolean());
    let cell_mm = section.positive("cell_mm")?;
    Ok(PrintOptions {
        scale,
        cell_mm: cell_mm.unwrap_or_else(|| cell_of(skin, scale)),
        threshold,
        ink,
        paper_px: paper.transpose()?,
        is_mirrored: is_mirrored.transpose()?.unwrap_or(false),
    })
}

fn ink(section: &mut Section) -> Result<Option<Ink>, Fault> {
    let Some(text) = section.text("ink")? else {
        return Ok(None);
    };
    if let Some(ink) = Ink::named(&text) {
        return Ok(Some(ink));
    }
    let problem = format!("ink {} is not known", shown(text.as_bytes()));
    Err(Fault::line(
        section.line,
        problem,
        nearest(&text, &Ink::NAMES),
    ))
}

fn scale(section: &mut Section) -> Result<Scale, Fault> {
    let dpi = section.positive("dpi")?.map(Scale::Dpi);
    let length = section.positive("mm_per_px")?.map(Scale::MmPerPixel);
    let marks = section.get("marks_px").map(|entry| entry.two_pairs());
    let apart = section.positive("marks_mm")?;
    let marks = match (marks.transpose()?, apart) {
        (Some(marks), Some(apart)) => Some(Scale::Marks(marks, apart)),
        (None, None) => None,
        (Some(_), None) => {
            return Err(section.needs("marks_mm", "give the distance of the two marks_px in mm"));
        }
        (None, Some(_)) => {
            return Err(section.needs(
                "marks_px",
                "give two marks of the image, [[x, y], [x, y]] in pixels",
            ));
        }
    };
    let mut given = [dpi, length, marks].into_iter().flatten();
    match (given.next(), given.next()) {
        (Some(scale), None) => Ok(scale),
        (None, _) => Err(section.needs(
            "scale",
            "give dpi as the scanner has it, mm_per_px, or two marks_px with marks_mm",
        )),
        (Some(_), Some(_)) => {
            let problem = format!("{} has more than one scale", section.name);
            Err(section.fault(
                problem,
                "give one of dpi, mm_per_px, and marks_px with marks_mm",
            ))
        }
    }
}

/// Side of a cell: as long as an edge of the skin, since no contact model tells more than its mesh does, and a few pixels at least.
fn cell_of(skin: &MeshFile, scale: Scale) -> f64 {
    const PIXELS: f64 = 4.0;
    // A mesh that is none is refused where its skin is prepared.
    let mesh = Mesh::new(skin.positions.clone(), skin.triangles.clone());
    let edge = mesh.map_or(0.0, |mesh| median_edge_length(&mesh));
    edge.max(PIXELS * scale.mm_per_px())
}

fn number_from_zero(section: &mut Section, key: &'static str) -> Result<Option<f64>, Fault> {
    let Some(entry) = section.get(key) else {
        return Ok(None);
    };
    match entry.finite()? {
        value if value >= 0.0 => Ok(Some(value)),
        value => Err(entry.fault(format!("is {value}"), "give a pressure from 0 on, kPa")),
    }
}
