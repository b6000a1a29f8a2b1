//! The recordings that a study lists, with what they were taken from.

use super::charts::{self, OffChart};
use super::frames::read_map;
use super::grasps;
use super::indentation;
use super::indenters::Indenter;
use super::place::Folder;
use super::prints;
use super::seat;
use super::sensels::{self, PlacedSensel};
use super::sites::Site;
use super::toml_tree::{Section, nearest};
use crate::RecordingError;
use crate::curve::Curve;
use crate::fault::{Fault, shown};
use crate::handprint::Handprint;
use crate::meshes::{self, MeshFile};
use crate::pressure_map::PressureMap;
use crate::recording_file::ReadOptions;
use std::collections::HashSet;
use std::path::{Path, PathBuf};

/// A recording and its setting.
#[derive(Debug, Clone, PartialEq)]
pub struct StudyRecording {
    /// Name, one of its kind in the study.
    pub name: String,
    /// The file that holds it, under the study's folder.
    pub file: PathBuf,
    /// What was measured.
    pub data: Data,
    /// Name of the tool.
    pub indenter: String,
    /// Name of the place.
    pub site: String,
    /// Repeats of one protocol share this name; empty if it is not given.
    pub protocol: String,
    /// Code of the person, as the study gives it.
    pub subject: Option<String>,
    /// Day, as the study gives it.
    pub day: Option<String>,
    /// Temperature, degrees Celsius.
    pub temperature_c: Option<f64>,
    /// Rest since the previous recording, s.
    pub rest_s: Option<f64>,
    /// Order in which it was taken.
    pub order: Option<f64>,
}

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

impl StudyRecording {
    /// What the files say that a reader should be told, a sentence each.
    pub(super) fn warnings(&self) -> Vec<String> {
        let of_file = match &self.data {
            Data::Indentation(curve) => &curve.warnings,
            Data::PressureMap { map, .. } | Data::Grasp { map, .. } => &map.warnings,
            Data::Scan { .. } => return Vec::new(),
            Data::Handprint { print, .. } => &print.warnings,
        };
        of_file
            .iter()
            .map(|text| format!("{}: {text}", self.name))
            .collect()
    }
}

pub(super) fn read(
    root: &mut Section,
    (indenters, sites, skin): (&[Indenter], &[Site], &MeshFile),
    folder: &Folder,
) -> Result<Vec<StudyRecording>, RecordingError> {
    let here = |fault: Fault| folder.fault(fault);
    let (mut recordings, mut names) = (Vec::new(), HashSet::new());
    for mut section in root.list("recordings").map_err(here)? {
        let name = needed(&mut section, "name").map_err(here)?;
        section.name = format!("recording {}", shown(name.as_bytes()));
        if !names.insert(name.clone()) {
            let problem = format!("{} stands twice", section.name);
            return Err(here(
                section.fault(problem, "give each recording a name of its own"),
            ));
        }
        let (file, data) = read_data(&mut section, skin, folder)?;
        let recording =
            read_setting(&mut section, (indenters, sites), (name, file, data)).map_err(here)?;
        section.finish().map_err(here)?;
        recordings.push(recording);
    }
    if recordings.is_empty() {
        return Err(here(Fault::line(
            1,
            "the study lists no recording".into(),
            "add [[recordings]]",
        )));
    }
    Ok(recordings)
}

fn needed(section: &mut Section, key: &'static str) -> Result<String, Fault> {
    let text = section.text(key)?.filter(|text| !text.is_empty());
    text.ok_or_else(|| section.needs(key, "add it, in quotes"))
}

fn read_setting(
    section: &mut Section,
    known: (&[Indenter], &[Site]),
    read: (String, PathBuf, Data),
) -> Result<StudyRecording, Fault> {
    let indenters: Vec<&str> = known
        .0
        .iter()
        .map(|indenter| indenter.name.as_str())
        .collect();
    let sites: Vec<&str> = known.1.iter().map(|site| site.name.as_str()).collect();
    let indenter = defined(section, "indenter", &indenters)?;
    if matches!(read.2, Data::Grasp { .. }) {
        grasps::check_product(section, (&indenter, known.0))?;
    }
    Ok(StudyRecording {
        indenter,
        site: match read.2 {
            Data::Grasp { .. } => String::new(),
            _ => defined(section, "site", &sites)?,
        },
        protocol: section.text("protocol")?.unwrap_or_default(),
        subject: section.text("subject")?,
        day: section.text("day")?,
        temperature_c: section.number("temperature_c")?,
        rest_s: section.number("rest_s")?,
        order: section.number("order")?,
        name: read.0,
        file: read.1,
        data: read.2,
    })
}

/// A name that must be defined in the study.
fn defined(section: &mut Section, key: &'static str, known: &[&str]) -> Result<String, Fault> {
    let Some(entry) = section.get(key) else {
        return Err(section.needs(key, "name one that the study defines"));
    };
    let name = entry.text()?;
    if known.contains(&name.as_str()) {
        return Ok(name);
    }
    let problem = format!("{key} {} is not defined", shown(name.as_bytes()));
    let remedy = match known {
        [] => format!("add [{key}s.{name}]"),
        _ => nearest(&name, known),
    };
    Err(Fault::line(entry.line, problem, remedy))
}

fn read_data(
    section: &mut Section,
    skin: &MeshFile,
    folder: &Folder,
) -> Result<(PathBuf, Data), RecordingError> {
    let here = |fault: Fault| folder.fault(fault);
    let Some(entry) = section.get("kind") else {
        return Err(here(section.needs(
            "kind",
            "give indentation, pressure_map, grasp, scan or handprint",
        )));
    };
    let kind = entry.text().map_err(here)?;
    let key = if kind == "scan" { "mesh" } else { "file" };
    let known = ["indentation", "pressure_map", "grasp", "scan", "handprint"];
    if !known.contains(&kind.as_str()) {
        let problem = format!("kind {} is not known", shown(kind.as_bytes()));
        return Err(here(Fault::line(
            entry.line,
            problem,
            nearest(&kind, &known),
        )));
    }
    let Some(file) = section.get(key) else {
        return Err(here(
            section.needs(key, "name the file, relative to the study's folder"),
        ));
    };
    let file = folder.file(&file)?;
    let data = match kind.as_str() {
        "indentation" => Data::Indentation(indentation::of_section(section, &file, folder)?),
        "grasp" => read_grasp(section, &file, folder)?,
        "scan" => read_scan(section, &file, folder)?,
        "handprint" => prints::read(section, (&file, skin), folder)?,
        _ => read_pressures(section, &file, folder)?,
    };
    Ok((file, data))
}

fn read_pressures(
    section: &mut Section,
    file: &Path,
    folder: &Folder,
) -> Result<Data, RecordingError> {
    let map = read_map(section, file, folder)?;
    Ok(Data::PressureMap {
        sensels: read_places(section, (&map, OffChart::Refused), folder)?,
        map: Box::new(map),
        motion: read_motion(section, folder)?,
    })
}

fn read_grasp(section: &mut Section, file: &Path, folder: &Folder) -> Result<Data, RecordingError> {
    let map = read_map(section, file, folder)?;
    grasps::check(section, &map).map_err(|fault| folder.fault(fault))?;
    let places = read_places(section, (&map, OffChart::Refused), folder)?;
    let sensels = places.ok_or_else(|| folder.fault(grasps::unplaced(section)))?;
    let trace = grasps::read_trace(section, folder)?;
    Ok(Data::Grasp {
        map: Box::new(map),
        sensels,
        force: trace.force.map(Box::new),
        force_direction: trace.direction,
    })
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

fn read_scan(section: &mut Section, file: &Path, folder: &Folder) -> Result<Data, RecordingError> {
    let here = |fault: Fault| folder.fault(fault);
    let mesh = meshes::read_points(file)?;
    let at_time_s = section.number("at_time_s").map_err(here)?;
    let depth_mm = section.number("depth_mm").map_err(here)?;
    let motion = read_motion(section, folder)?;
    let known = motion.as_ref().and_then(|curve| curve.channel("time_s"));
    match (known, at_time_s) {
        (Some(_), None) => Err(here(section.needs(
            "at_time_s",
            "give the time of the scan in the indentation that motion names",
        ))),
        (Some([first, .., last]), Some(at)) if !(*first..=*last).contains(&at) => {
            let problem = format!(
                "{} was taken at {at} s, and its motion lasts from {first} to {last} s",
                section.name
            );
            let remedy = "count at_time_s as the indentation does";
            Err(here(section.fault(problem, remedy)))
        }
        _ => Ok(Data::Scan {
            mesh,
            at_time_s,
            depth_mm,
            motion,
        }),
    }
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
