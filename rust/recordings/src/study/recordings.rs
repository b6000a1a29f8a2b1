//! The recordings that a study lists, with what they were taken from.

use super::data::{Data, read_motion, read_places};
use super::frames::read_map;
use super::grasps;
use super::indentation;
use super::indenters::Indenter;
use super::place::Folder;
use super::places::charts::OffChart;
use super::prints;
use super::sites::Site;
use super::toml_tree::{Section, nearest};
use crate::RecordingError;
use crate::fault::{Fault, shown};
use crate::meshes::{self, MeshFile};
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
        let read = Read { name, file, data };
        let recording = read_setting(&mut section, (indenters, sites), read).map_err(here)?;
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

/// A recording without its setting.
struct Read {
    name: String,
    file: PathBuf,
    data: Data,
}

fn read_setting(
    section: &mut Section,
    known: (&[Indenter], &[Site]),
    read: Read,
) -> Result<StudyRecording, Fault> {
    let indenters: Vec<&str> = known
        .0
        .iter()
        .map(|indenter| indenter.name.as_str())
        .collect();
    let sites: Vec<&str> = known.1.iter().map(|site| site.name.as_str()).collect();
    let indenter = defined(section, "indenter", &indenters)?;
    if matches!(read.data, Data::Grasp { .. }) {
        grasps::check_product(section, (&indenter, known.0))?;
    }
    Ok(StudyRecording {
        indenter,
        site: match read.data {
            Data::Grasp { .. } => String::new(),
            _ => defined(section, "site", &sites)?,
        },
        protocol: section.text("protocol")?.unwrap_or_default(),
        subject: section.text("subject")?,
        day: section.text("day")?,
        temperature_c: section.number("temperature_c")?,
        rest_s: section.number("rest_s")?,
        order: section.number("order")?,
        name: read.name,
        file: read.file,
        data: read.data,
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
