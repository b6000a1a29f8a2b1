//! Positions and triangles without a mesh's promises.

use thenar_surface::Vec3;

/// Positions and triangles before they become a mesh.
pub(crate) struct Soup {
    pub positions: Vec<Vec3>,
    pub triangles: Vec<[u32; 3]>,
}
