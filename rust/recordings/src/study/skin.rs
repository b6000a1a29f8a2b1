//! The skin of a study: mesh, regions by vertex, and the materials where fitting starts.

use super::place::Folder;
use super::toml_tree::{Section, nearest};
use crate::fault::{Fault, shown};
use crate::meshes::{self, MeshFile};
use crate::text::fields::Separator;
use crate::text::lines::Lines;
use crate::{RecordingError, plain_file};
use std::io::BufReader;
use std::path::Path;

/// Most regions of a hand.
const MOST_REGIONS: usize = 4096;
/// Parameters that a fit may change.
const FITTED: &[&str] = &["g0_mpa", "g_lim_mpa", "d_lim_mm", "thickness_mm"];
/// What else a length may be.
const OR_HALF_SPACE: &str = "give a number above zero, or \"inf\" for a half space";
const OR_ENDLESS: &str = "give a number above zero, or \"inf\" for bone without end";

/// The undeformed skin.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct StudySkin {
    /// Vertices, mm, and triangles.
    pub mesh: MeshFile,
    /// Region of each vertex, -1 for no skin; empty if the study has one region.
    pub regions: Vec<i32>,
    /// Name of each region, in order of first appearance.
    pub region_names: Vec<String>,
    /// Materials by region name, `default` for all others.
    pub materials: Vec<StudyMaterial>,
}

impl StudySkin {
    /// Whether a vertex is in no region, which counts as no skin.
    pub(super) fn is_bare(&self, vertex: u32) -> bool {
        self.regions
            .get(vertex as usize)
            .is_some_and(|region| *region < 0)
    }
}

/// Where the fit of a region starts; what is not given is `None`.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct StudyMaterial {
    /// Region name, or `default`.
    pub region: String,
    /// Shear modulus at rest, MPa.
    pub g0_mpa: Option<f64>,
    /// Shear modulus it grows to, MPa.
    pub g_lim_mpa: Option<f64>,
    /// Depth of that growth, mm.
    pub d_lim_mm: Option<f64>,
    /// Soft tissue over bone, mm; infinite for a half space.
    pub thickness_mm: Option<f64>,
    /// Half the width of the bone under the tissue, mm; infinite for bone without end.
    pub bone_half_width_mm: Option<f64>,
    /// Half the length of that bone, mm; infinite for a long one.
    pub bone_half_length_mm: Option<f64>,
    /// Parameters that a fit may change.
    pub fit: Vec<String>,
}

pub(super) fn read(root: &mut Section, folder: &Folder) -> Result<StudySkin, RecordingError> {
    let here = |fault: Fault| folder.fault(fault);
    let Some(mut section) = root.section("skin").map_err(here)? else {
        return Err(here(Fault::line(
            1,
            "the study has no [skin]".into(),
            "add [skin] with mesh = \"skin.ply\"",
        )));
    };
    let Some(entry) = section.get("mesh") else {
        return Err(here(
            section.needs("mesh", "name the surface, mesh = \"skin.ply\""),
        ));
    };
    let mut skin = StudySkin {
        mesh: meshes::read(&folder.file(&entry)?)?,
        ..StudySkin::default()
    };
    if let Some(entry) = section.get("regions") {
        let file = folder.file(&entry)?;
        let count = skin.mesh.positions.len();
        (skin.regions, skin.region_names) = read_regions(&file, count)?;
    }
    if let Some(materials) = section.section("materials").map_err(here)? {
        for (region, section) in materials.sections().map_err(here)? {
            let line = section.line;
            let material = read_material(region, section).map_err(here)?;
            check_region(&material.region, &skin.region_names, line).map_err(here)?;
            skin.materials.push(material);
        }
    }
    let line = section.line;
    section.finish().map_err(here)?;
    check_covered(&skin, line).map_err(here)?;
    Ok(skin)
}

fn read_material(region: String, mut section: Section) -> Result<StudyMaterial, Fault> {
    let length_line = section.get("bone_half_length_mm").map(|entry| entry.line);
    let mut material = StudyMaterial {
        region,
        g0_mpa: section.positive("g0_mpa")?,
        g_lim_mpa: section.positive("g_lim_mpa")?,
        d_lim_mm: section.positive("d_lim_mm")?,
        thickness_mm: length(&mut section, "thickness_mm", OR_HALF_SPACE)?,
        bone_half_width_mm: length(&mut section, "bone_half_width_mm", OR_ENDLESS)?,
        bone_half_length_mm: length(&mut section, "bone_half_length_mm", OR_ENDLESS)?,
        fit: vec!["g0_mpa".into(), "g_lim_mpa".into()],
    };
    let has_width = material.bone_half_width_mm.is_some();
    if let Some(line) = length_line.filter(|_| !has_width) {
        return Err(Fault::line(
            line,
            "bone_half_length_mm stands without bone_half_width_mm".into(),
            "state half the width of the bone too, or leave both out",
        ));
    }
    if let Some(entry) = section.get("fit") {
        material.fit = entry.texts()?;
        if let Some(unknown) = material
            .fit
            .iter()
            .find(|name| !FITTED.contains(&name.as_str()))
        {
            let problem = format!(
                "fit: {} is no parameter that can be fitted",
                shown(unknown.as_bytes())
            );
            return Err(Fault::line(entry.line, problem, nearest(unknown, FITTED)));
        }
    }
    section.finish()?;
    Ok(material)
}

/// A length above zero, mm, or "inf".
fn length(
    section: &mut Section,
    key: &'static str,
    remedy: &'static str,
) -> Result<Option<f64>, Fault> {
    let Some(entry) = section.get(key) else {
        return Ok(None);
    };
    let is_endless = entry.is_text() && entry.text()? == "inf";
    let found = if is_endless {
        f64::INFINITY
    } else {
        entry.number()?
    };
    if found <= 0.0 {
        return Err(entry.fault(format!("is {found}"), remedy));
    }
    Ok(Some(found))
}

fn check_region(region: &str, names: &[String], line: usize) -> Result<(), Fault> {
    if region == "default" || names.iter().any(|name| name == region) {
        return Ok(());
    }
    let known: Vec<&str> = std::iter::once("default")
        .chain(names.iter().map(String::as_str))
        .collect();
    let problem = format!("there is no region {}", shown(region.as_bytes()));
    Err(Fault::line(line, problem, nearest(region, &known)))
}

/// Every region needs a material once there are materials.
fn check_covered(skin: &StudySkin, line: usize) -> Result<(), Fault> {
    let has = |name: &str| {
        skin.materials
            .iter()
            .any(|material| material.region == name)
    };
    let bare = skin.region_names.iter().find(|name| !has(name));
    match bare {
        Some(name) if !skin.materials.is_empty() && !has("default") => {
            let problem = format!("region {} has no material", shown(name.as_bytes()));
            Err(Fault::line(
                line,
                problem,
                "add [skin.materials.default] or a table for the region",
            ))
        }
        _ => Ok(()),
    }
}

/// Region of each vertex and the names of the regions, from a CSV of vertex,region.
fn read_regions(file: &Path, vertices: usize) -> Result<(Vec<i32>, Vec<String>), RecordingError> {
    let mut lines = Lines::new(BufReader::new(plain_file::open(file)?.0));
    parse_regions(&mut lines, vertices).map_err(|fault| fault.in_file(file))
}

fn parse_regions(lines: &mut Lines, vertices: usize) -> Result<(Vec<i32>, Vec<String>), Fault> {
    const UNSET: i32 = i32::MIN;
    let (mut regions, mut names) = (vec![UNSET; vertices], Vec::<String>::new());
    match lines.next_filled(&[','])? {
        Some(line) if line.text.trim() == "vertex,region" => {}
        _ => {
            return Err(Fault::line(
                1,
                "the first line does not name the columns".into(),
                "begin with vertex,region",
            ));
        }
    }
    while let Some(line) = lines.next_filled(&[','])? {
        let mut fields = Separator::Comma.split(line.text);
        let (vertex, region) = (fields.next().unwrap_or(""), fields.next().unwrap_or(""));
        let Some(slot) = vertex
            .parse::<usize>()
            .ok()
            .and_then(|vertex| regions.get_mut(vertex))
        else {
            let problem = format!(
                "{} is no vertex, the mesh has {vertices}",
                shown(vertex.as_bytes())
            );
            return Err(line.fault(
                problem,
                "number vertices from 0 in the order of the mesh file",
            ));
        };
        if *slot != UNSET {
            return Err(line.fault(
                format!("vertex {vertex} stands twice"),
                "name each vertex once",
            ));
        }
        *slot = match (region, names.iter().position(|name| name == region)) {
            ("" | "-1" | "none", _) => -1,
            (_, Some(number)) => number as i32,
            (_, None) if names.len() == MOST_REGIONS => {
                return Err(line.fault(
                    format!("there are more than {MOST_REGIONS} regions"),
                    "merge some of them",
                ));
            }
            (_, None) => {
                names.push(region.to_string());
                names.len() as i32 - 1
            }
        };
    }
    match regions.iter().position(|region| *region == UNSET) {
        Some(vertex) => Err(Fault::file(
            format!("vertex {vertex} has no region"),
            "add it, with -1 for no skin",
        )),
        None => Ok((regions, names)),
    }
}
