//! The edges of a mesh, each with the triangles on it.

use crate::mesh::bucket_sort::sort_by_bucket;
use crate::mesh::triangles::{Mesh, Standing};

/// One side of a triangle, filed under its edge.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Side {
    /// Lower and higher vertex.
    pub edge: [u32; 2],
    pub triangle: u32,
    /// Which side: from corner `side` to the next.
    pub side: u8,
    /// Whether the triangle runs from the lower to the higher vertex.
    pub ascends: bool,
}

/// All sides of the triangles that `keeps` lets through, sorted by edge and then triangle. Vertices are below `vertices`.
pub(crate) fn sides(
    vertices: usize,
    triangles: &[[u32; 3]],
    keeps: impl Fn(usize) -> bool,
) -> Vec<Side> {
    let mut all = Vec::with_capacity(3 * triangles.len());
    for (t, corners) in triangles.iter().enumerate().filter(|(t, _)| keeps(*t)) {
        for side in 0..3 {
            let (a, b) = (corners[side], corners[(side + 1) % 3]);
            let edge = [a.min(b), a.max(b)];
            all.push(Side {
                edge,
                triangle: t as u32,
                side: side as u8,
                ascends: a < b,
            });
        }
    }
    sort_by_bucket(vertices, all, |s| s.edge[0], |s| (s.edge[1], s.triangle))
}

impl Mesh {
    /// Unique edges, each as lower and higher vertex, sorted. Triangles that name a vertex twice add none of length zero.
    pub fn edges(&self) -> Vec<[u32; 2]> {
        let mut all: Vec<[u32; 2]> = Vec::with_capacity(3 * self.triangles().len());
        for &[a, b, c] in self.triangles() {
            all.extend([
                [a.min(b), a.max(b)],
                [b.min(c), b.max(c)],
                [c.min(a), c.max(a)],
            ]);
        }
        all.retain(|e| e[0] != e[1]);
        all.sort_unstable();
        all.dedup();
        all
    }
}

/// Whether a triangle joins its neighbors along edges.
pub(crate) fn joins(standing: Standing) -> bool {
    matches!(standing, Standing::Sound | Standing::Flat)
}
