//! Triangle meshes: checks, edges, normals, the nearest point of a triangle.

pub(crate) mod bucket_sort;
pub(crate) mod triangles;
pub(crate) mod edges;
pub(crate) mod adjacency;
pub(crate) mod normals;
pub(crate) mod closest_point;
pub(crate) mod audit;
pub(crate) mod welded_vertices;
