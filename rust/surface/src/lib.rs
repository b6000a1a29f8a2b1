//! Meshes, regions, distances and the nearest triangle; knows nothing of forces.
#![doc = include_str!("../README.md")]
// Boxes are arrays over axes and lanes; an index over both reads better than zipped iterators, and becomes vector code.
#![allow(clippy::needless_range_loop)]

mod adjacency;
mod audit;
mod cells;
mod crossings;
mod edges;
mod facing;
mod flesh;
mod vicinity;
mod poke;
mod sight;
mod interior;
mod mesh;
mod nearest;
mod rays;
mod normals;
mod orient;
mod patches;
mod product;
mod readings;
mod sign;
mod paths;
mod skin_distance;
mod tree;
mod leaf;
mod triangle;
mod union;
mod weld;
mod winding;

pub use adjacency::Adjacency;
pub use audit::{Audit, connected_parts};
pub use crossings::self_intersections;
pub use mesh::{Mesh, MeshError, Vec3};
pub use normals::{median_edge_length, renew_shape, vertex_areas, vertex_normals};
pub use product::{Gap, GapLimits, Product};
pub use readings::Readings;
pub use sight::{PosedSkin, SkinSurface};
pub use skin_distance::SkinDistance;
pub use triangle::{ClosestPoint, Feature, closest_point};
