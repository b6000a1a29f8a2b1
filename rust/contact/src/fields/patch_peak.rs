//! The largest mean pressure over a small patch of skin: what a pressure mat's sensel would read.

use std::collections::BinaryHeap;

use thenar_surface::{Adjacency, Vec3};

/// A sensel of the paper's mat (4.2 sensors per cm2), mm2.
pub const SENSEL_AREA: f64 = 24.0;

/// Mean pressure over the `SENSEL_AREA` around each of `centers`; the largest, MPa. 0 without centers.
///
/// The patch grows from its center over the mesh in order of distance until it has the area; the last vertex counts in part.
pub fn patch_peak(centers: &[u32], field: Field<'_>) -> f64 {
    centers
        .iter()
        .map(|&c| patch_mean(c, field))
        .fold(0.0, f64::max)
}

/// A pressure field on a mesh.
#[derive(Clone, Copy)]
pub struct Field<'a> {
    /// Neighbors of every vertex.
    pub adjacency: &'a Adjacency,
    /// Positions, mm.
    pub positions: &'a [Vec3],
    /// Vertex areas, mm2.
    pub area: &'a [f64],
    /// Nodal forces, N.
    pub force: &'a [f64],
}

#[derive(PartialEq)]
struct Reached {
    distance: f64,
    vertex: u32,
}

impl Eq for Reached {}

impl Ord for Reached {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        other
            .distance
            .total_cmp(&self.distance)
            .then(other.vertex.cmp(&self.vertex))
    }
}

impl PartialOrd for Reached {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

fn patch_mean(center: u32, field: Field<'_>) -> f64 {
    let origin = field.positions[center as usize];
    let mut queue = BinaryHeap::from([Reached {
        distance: 0.0,
        vertex: center,
    }]);
    let mut seen = vec![center];
    let (mut area, mut force) = (0.0, 0.0);
    while let Some(Reached { vertex, .. }) = queue.pop() {
        let v = vertex as usize;
        let share = ((SENSEL_AREA - area) / field.area[v].max(f64::MIN_POSITIVE)).min(1.0);
        area += share * field.area[v];
        force += share * field.force[v];
        if share < 1.0 {
            break;
        }
        for &next in field.adjacency.neighbors(v) {
            if let Err(slot) = seen.binary_search(&next) {
                seen.insert(slot, next);
                let distance = (field.positions[next as usize] - origin).norm();
                queue.push(Reached {
                    distance,
                    vertex: next,
                });
            }
        }
    }
    // A skin smaller than a sensel loads it in part.
    force / SENSEL_AREA.max(area)
}
