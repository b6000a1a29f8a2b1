//! Meshes, regions, distances and the nearest triangle; knows nothing of forces.
#![doc = include_str!("../README.md")]
// Boxes are arrays over axes and lanes; an index over both reads better than zipped iterators, and becomes vector code.
#![allow(clippy::needless_range_loop)]

mod mesh;
mod tree;
mod solid;
mod reading;
mod skin_distance;

pub use mesh::adjacency::Adjacency;
pub use mesh::audit::{Audit, connected_parts};
pub use mesh::closest_point::{ClosestPoint, Feature, closest_point};
pub use mesh::normals::{median_edge_length, renew_shape, vertex_areas, vertex_normals};
pub use mesh::triangles::{Mesh, MeshError, Vec3};
pub use reading::facing::{PosedSkin, SkinSurface};
pub use reading::kept_readings::Readings;
pub use skin_distance::table::SkinDistance;
pub use solid::gap::{Gap, GapLimits};
pub use solid::product::Product;
pub use tree::self_intersections::self_intersections;
