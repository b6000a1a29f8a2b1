//! Faces of a tree, and how many share a node.

use crate::mesh::triangles::Vec3;

/// Boxes in one node.
pub(crate) const WIDTH: usize = 8;

/// A triangle with area, about the tree's center, mm.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Face {
    pub a: Vec3,
    pub ab: Vec3,
    pub ac: Vec3,
    /// Unit normal, outward.
    pub normal: Vec3,
    /// Index in the mesh.
    pub id: u32,
    /// Whether it is of a sheet, which has two sides and no inside.
    pub is_sheet: bool,
    /// Whether it is only a piece of that triangle.
    pub is_piece: bool,
}
