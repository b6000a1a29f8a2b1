//! The tools of a study.

use super::place::Folder;
use super::toml_tree::{Section, nearest};
use crate::RecordingError;
use crate::fault::{Fault, shown};
use crate::meshes::{self, MeshFile};

const SHAPES: &[&str] = &["plane", "cylinder", "sphere", "punch", "mesh"];

/// A tool.
#[derive(Debug, Clone, PartialEq)]
pub struct Indenter {
    /// Name that recordings use.
    pub name: String,
    /// Its shape.
    pub shape: Shape,
}

/// What touches the skin. It lies so that it touches at the site's point and travels along the site's direction.
#[derive(Debug, Clone, PartialEq)]
pub enum Shape {
    /// Flat plate across the direction of travel.
    Plane,
    /// Cylinder lying on the skin.
    Cylinder {
        /// Radius, mm.
        radius_mm: f64,
        /// Unit vector along it, skin coordinates.
        axis: [f64; 3],
    },
    /// Sphere.
    Sphere {
        /// Radius, mm.
        radius_mm: f64,
    },
    /// Flat end of a round rod.
    Punch {
        /// Radius, mm.
        radius_mm: f64,
    },
    /// Any surface, in skin coordinates at first touch.
    Mesh(MeshFile),
}

pub(super) fn read(root: &mut Section, folder: &Folder) -> Result<Vec<Indenter>, RecordingError> {
    let here = |fault: Fault| folder.fault(fault);
    let Some(all) = root.section("indenters").map_err(here)? else {
        return Ok(Vec::new());
    };
    let mut indenters = Vec::new();
    for (name, mut section) in all.sections().map_err(here)? {
        let shape = read_shape(&mut section, folder)?;
        section.finish().map_err(here)?;
        indenters.push(Indenter { name, shape });
    }
    Ok(indenters)
}

fn read_shape(section: &mut Section, folder: &Folder) -> Result<Shape, RecordingError> {
    let here = |fault: Fault| folder.fault(fault);
    let Some(entry) = section.get("shape") else {
        return Err(here(
            section.needs("shape", "give plane, cylinder, sphere, punch or mesh"),
        ));
    };
    let name = entry.text().map_err(here)?;
    match name.as_str() {
        "plane" => Ok(Shape::Plane),
        "cylinder" => {
            let radius_mm = radius(section).map_err(here)?;
            let axis = unit_vector(section, "axis").map_err(here)?;
            Ok(Shape::Cylinder { radius_mm, axis })
        }
        "sphere" => Ok(Shape::Sphere {
            radius_mm: radius(section).map_err(here)?,
        }),
        "punch" => Ok(Shape::Punch {
            radius_mm: radius(section).map_err(here)?,
        }),
        "mesh" => {
            let Some(file) = section.get("file") else {
                return Err(here(
                    section.needs("file", "name the mesh of the tool, file = \"tool.stl\""),
                ));
            };
            meshes::read(&folder.file(&file)?).map(Shape::Mesh)
        }
        _ => {
            let problem = format!("shape {} is not known", shown(name.as_bytes()));
            Err(here(Fault::line(
                entry.line,
                problem,
                nearest(&name, SHAPES),
            )))
        }
    }
}

fn radius(section: &mut Section) -> Result<f64, Fault> {
    let radius = section.positive("radius_mm")?;
    radius.ok_or_else(|| section.needs("radius_mm", "give its radius in mm"))
}

/// A direction of any length but zero, as a unit vector.
pub(super) fn unit_vector(section: &mut Section, key: &'static str) -> Result<[f64; 3], Fault> {
    let Some(vector) = section.vector(key)? else {
        return Err(section.needs(key, "give it as [x, y, z]"));
    };
    let length = vector.iter().map(|part| part * part).sum::<f64>().sqrt();
    if !(length > 1e-9 && length.is_finite()) {
        let problem = format!(
            "{} has the {key} {vector:?}, which points nowhere",
            section.name
        );
        return Err(section.fault(problem, "give a vector of length 1"));
    }
    Ok(vector.map(|part| part / length))
}
