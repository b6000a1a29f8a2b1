//! The recordings that a study lists, with what they were taken from.

use super::charts::{self, OffChart};
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
use crate::pressure_map::{PressureMap, PressureUnit};
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
            Data::PressureMap { map, .. } => &map.warnings,
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
    let (name, file, data) = read;
    let indenters: Vec<&str> = known
        .0
        .iter()
        .map(|indenter| indenter.name.as_str())
        .collect();
    let sites: Vec<&str> = known.1.iter().map(|site| site.name.as_str()).collect();
    Ok(StudyRecording {
        name,
        file,
        data,
        indenter: defined(section, "indenter", &indenters)?,
        site: defined(section, "site", &sites)?,
        protocol: section.text("protocol")?.unwrap_or_default(),
        subject: section.text("subject")?,
        day: section.text("day")?,
        temperature_c: section.number("temperature_c")?,
        rest_s: section.number("rest_s")?,
        order: section.number("order")?,
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
            "give indentation, pressure_map, scan or handprint",
        )));
    };
    let kind = entry.text().map_err(here)?;
    let key = if kind == "scan" { "mesh" } else { "file" };
    let known = ["indentation", "pressure_map", "scan", "handprint"];
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
        "scan" => read_scan(section, &file, folder)?,
        "handprint" => prints::read(section, (&file, skin), folder)?,
        _ => read_map(section, &file, folder)?,
    };
    Ok((file, data))
}

fn read_map(section: &mut Section, file: &Path, folder: &Folder) -> Result<Data, RecordingError> {
    let here = |fault: Fault| folder.fault(fault);
    let maps = crate::read(file)?.maps;
    let wanted = section.text("mat").map_err(here)?;
    let mut map = choose(section, maps, wanted).map_err(here)?;
    if let Some(entry) = section.get("calibrated") {
        let is_calibrated = entry.boolean().map_err(here)?;
        match (is_calibrated, map.unit) {
            (false, _) => map.unit = PressureUnit::RawCounts,
            (true, PressureUnit::Kilopascal) => {}
            (true, _) => {
                let problem =
                    "is true, but the file holds raw counts or states no unit".to_string();
                return Err(here(entry.fault(
                    problem,
                    "export calibrated pressures, or write calibrated = false",
                )));
            }
        }
    } else if map.unit != PressureUnit::Kilopascal {
        let problem = format!("{} holds raw counts, or states no unit", section.name);
        return Err(here(section.fault(
            problem,
            "declare it with calibrated = false, or export calibrated pressures",
        )));
    }
    if map.unit == PressureUnit::RawCounts {
        map.warnings
            .push("not calibrated: only shape and relative size are used".into());
    }
    let sensels = read_places(section, (&map, OffChart::Refused), folder)?;
    Ok(Data::PressureMap {
        map: Box::new(map),
        sensels,
        motion: read_motion(section, folder)?,
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

/// The mat of a name; the only one needs none.
fn choose(
    section: &Section,
    mut maps: Vec<PressureMap>,
    wanted: Option<String>,
) -> Result<PressureMap, Fault> {
    let names: Vec<String> = maps.iter().map(|map| map.name.clone()).collect();
    let at = match &wanted {
        None if maps.len() == 1 => Some(0),
        None => None,
        Some(wanted) => names.iter().position(|name| name == wanted),
    };
    match at {
        Some(at) => Ok(maps.swap_remove(at)),
        None => {
            let problem = format!(
                "{} must say which of {} mats of its file it is",
                section.name,
                maps.len()
            );
            let remedy = match names.is_empty() {
                true => "name a file of pressures".to_string(),
                false => format!("add mat = \"...\" with one of {}", names.join(", ")),
            };
            Err(Fault::line(section.line, problem, remedy))
        }
    }
}
