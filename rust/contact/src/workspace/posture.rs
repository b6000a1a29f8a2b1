//! Posture cache: the last posed positions with normals, areas and gaps; what has not moved is not measured again.

use thenar_surface::{Mesh, Readings, Vec3, renew_shape, vertex_areas, vertex_normals};

/// A posture and what was measured of it: what has not moved need not be measured again.
#[derive(Debug, Clone, Default)]
pub struct PostureCache {
    /// Posed positions of the welded vertices, mm.
    posed: Vec<Vec3>,
    shape: PostureShape,
    /// Their gaps to the product.
    pub readings: Readings,
}

/// What follows from a posture alone, by welded vertex.
#[derive(Debug, Clone, Default)]
pub struct PostureShape {
    pub normals: Vec<Vec3>,
    /// mm2.
    pub areas: Vec<f64>,
}

impl PostureCache {
    /// Normals and areas of the welded mesh in its next posture.
    pub fn shape(&mut self, mesh: &Mesh) -> PostureShape {
        let (before, shape) = (&mut self.posed, &mut self.shape);
        if before.len() == mesh.positions().len() {
            let pairs = before.iter().zip(mesh.positions());
            let has_moved: Vec<bool> = pairs.map(|(a, b)| a != b).collect();
            if has_moved.contains(&true) {
                renew_shape(mesh, &has_moved, (&mut shape.normals, &mut shape.areas));
            }
        } else {
            shape.normals = vertex_normals(mesh);
            shape.areas = vertex_areas(mesh);
        }
        before.clear();
        before.extend_from_slice(mesh.positions());
        shape.clone()
    }
}
