//! PLY: the elements `vertex` (x, y, z) and `face` (a list of vertex numbers); all else is passed over.

use super::mesh_file::MeshFile;
use super::ply_header::{self, Element};
use super::ply_values::Values;
use super::polygons::Faces;
use crate::fault::{Fault, shown};
use nalgebra::Vector3;

const AGAIN: &str = "export the mesh again";

/// ASCII or binary, any number types, any further elements and properties.
pub(super) fn parse(bytes: &[u8]) -> Result<MeshFile, Fault> {
    let header = ply_header::parse(bytes)?;
    let mut values = Values::new(bytes, &header);
    let mut mesh = MeshFile::default();
    let (mut faces, mut face_line) = (Faces::default(), 0);
    for element in &header.elements {
        let smallest = element.properties.len();
        if element
            .count
            .checked_mul(smallest)
            .is_none_or(|size| size > values.remaining())
        {
            let problem = format!(
                "{} elements {} do not fit into the rest of the file",
                element.count,
                shown(&element.name)
            );
            return Err(Fault::line(
                element.line,
                problem,
                "the file is cut short; export it again",
            ));
        }
        match element.name.as_slice() {
            b"vertex" => read_vertices(element, &mut values, &mut mesh)?,
            b"face" => {
                face_line = element.line;
                read_faces(element, &mut values, &mut faces)?;
            }
            b"tristrips" => {
                let problem = "triangle strips are not read".into();
                return Err(Fault::line(element.line, problem, "export faces instead"));
            }
            _ => pass_over(element, &mut values)?,
        }
    }
    let vertices = mesh.positions.len();
    mesh.triangles = faces.triangles(&mesh.positions);
    if let Some(number) = mesh
        .triangles
        .iter()
        .position(|triangle| triangle.iter().any(|&index| index as usize >= vertices))
    {
        let problem = format!(
            "triangle {number} is {:?}, the file has {vertices} vertices",
            mesh.triangles[number]
        );
        return Err(Fault::line(face_line, problem, AGAIN));
    }
    Ok(mesh)
}

fn read_vertices(element: &Element, values: &mut Values, mesh: &mut MeshFile) -> Result<(), Fault> {
    let axes: Vec<Option<usize>> = element
        .properties
        .iter()
        .map(|property| {
            [b"x", b"y", b"z"]
                .iter()
                .position(|name| property.count.is_none() && property.name == *name)
        })
        .collect();
    if (0..3).any(|axis| axes.iter().filter(|found| **found == Some(axis)).count() != 1) {
        return Err(Fault::line(
            element.line,
            "a vertex needs x, y and z, each once".into(),
            AGAIN,
        ));
    }
    mesh.positions.reserve(element.count);
    for _ in 0..element.count {
        let mut position = Vector3::zeros();
        for (property, axis) in element.properties.iter().zip(&axes) {
            let times = property
                .count
                .map_or(Ok(1), |count| values.next_whole(count))?;
            for _ in 0..times {
                let value = values.next(property.item)?;
                let Some(axis) = *axis else { continue };
                if !value.is_finite() {
                    let problem = format!("vertex {} is not finite", mesh.positions.len());
                    return Err(values.fault(problem, "give every vertex finite coordinates"));
                }
                position[axis] = value;
            }
        }
        mesh.positions.push(position);
    }
    Ok(())
}

fn read_faces(element: &Element, values: &mut Values, faces: &mut Faces) -> Result<(), Fault> {
    if !element
        .properties
        .iter()
        .any(|property| is_corners(&property.name) && property.count.is_some())
        && element.count > 0
    {
        return Err(Fault::line(
            element.line,
            "a face needs the list vertex_indices".into(),
            AGAIN,
        ));
    }
    let mut corners = Vec::new();
    let mut longer = None;
    for _ in 0..element.count {
        if let Err(fault) = read_face(element, values, &mut corners, faces) {
            // What went wrong first is the row that holds more than the header says.
            let Some(line) = longer else {
                return Err(fault);
            };
            let problem = format!(
                "the row of a face holds more values than the header names from line {} on",
                element.line
            );
            return Err(Fault::line(
                line,
                problem,
                "export the mesh again, as binary or from another program",
            ));
        }
        longer = longer.or_else(|| values.unread_line());
    }
    Ok(())
}

fn is_corners(name: &[u8]) -> bool {
    name == b"vertex_indices" || name == b"vertex_index"
}

fn read_face(
    element: &Element,
    values: &mut Values,
    corners: &mut Vec<u32>,
    faces: &mut Faces,
) -> Result<(), Fault> {
    for property in &element.properties {
        let times = property
            .count
            .map_or(Ok(1), |count| values.next_whole(count))?;
        if !is_corners(&property.name) {
            (0..times).try_for_each(|_| values.next(property.item).map(drop))?;
            continue;
        }
        corners.clear();
        for _ in 0..times {
            corners.push(values.next_whole(property.item)?);
        }
        if corners.len() < 3 {
            let problem = format!("a face with {} corners, expected 3 or more", corners.len());
            return Err(values.fault(problem, "delete loose edges and export again"));
        }
        faces.push(corners);
    }
    Ok(())
}

fn pass_over(element: &Element, values: &mut Values) -> Result<(), Fault> {
    if element.properties.is_empty() {
        return Ok(());
    }
    for _ in 0..element.count {
        for property in &element.properties {
            let times = property
                .count
                .map_or(Ok(1), |count| values.next_whole(count))?;
            (0..times).try_for_each(|_| values.next(property.item).map(drop))?;
        }
    }
    Ok(())
}
