//! What a mesh file holds, and the coordinates of one of its vertices.

use crate::fault::{Fault, number};
use nalgebra::Vector3;

/// What a mesh file holds, in its own unit and its own vertex order.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct MeshFile {
    /// Vertex positions, finite. Equal corners of an STL are one vertex, in order of first appearance.
    pub positions: Vec<Vector3<f64>>,
    /// Triangles as vertex numbers from 0, all in range; larger faces are cut, concave ones too.
    pub triangles: Vec<[u32; 3]>,
    /// What was odd about the file and how it was read, one sentence each.
    pub notes: Vec<String>,
}

/// A mesh whose triangles lie in a map.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Charted {
    /// The mesh.
    pub mesh: MeshFile,
    /// By triangle, texture coordinates of its corners.
    pub charts: Vec<[[f64; 2]; 3]>,
}

/// A mesh that has vertices.
pub(super) fn filled(mesh: MeshFile) -> Result<MeshFile, Fault> {
    match mesh.positions.is_empty() {
        true => Err(Fault::file(
            "it holds no vertices".into(),
            "export the mesh again",
        )),
        false => Ok(mesh),
    }
}

/// The three finite coordinates that follow the word of a `what` (vertex, corner) on a line.
pub(super) fn position<'a>(
    mut words: impl Iterator<Item = &'a [u8]>,
    line: usize,
    what: &str,
) -> Result<Vector3<f64>, Fault> {
    let mut position = Vector3::zeros();
    for axis in 0..3 {
        let Some(word) = words.next() else {
            let problem = format!("a {what} with {axis} coordinates, expected 3");
            return Err(Fault::line(line, problem, "export the mesh again"));
        };
        position[axis] = number(word).map_err(|problem| {
            let remedy = format!("give every {what} finite coordinates");
            Fault::line(line, problem, remedy)
        })?;
    }
    Ok(position)
}
