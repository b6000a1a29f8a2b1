//! A tree of boxes over triangles: nearest faces, rays, winding numbers.

pub(crate) mod face;
pub(crate) mod leaf;
pub(crate) mod bvh;
pub(crate) mod nearest;
pub(crate) mod rays;
pub(crate) mod winding_number;
pub(crate) mod self_intersections;
