//! From the field to triangles: extraction near the skin, then an isotropic remesh projected back onto the field.

mod edit;
mod extract;
mod polish;
mod remesh;
mod topology;

pub(crate) use extract::extract;
pub(crate) use remesh::remesh;

use thenar_surface::Vec3;

/// Positions and triangles before they become a mesh.
pub(crate) struct Soup {
    pub positions: Vec<Vec3>,
    pub triangles: Vec<[u32; 3]>,
}
