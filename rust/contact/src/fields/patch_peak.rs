//! The largest mean pressure over a small patch of skin: what a pressure mat's sensel would read.

use std::collections::BinaryHeap;

use thenar_surface::{Adjacency, Vec3};

/// A sensel of the paper's mat (4.2 sensors per cm2), mm2.
pub const SENSEL_AREA: f64 = 24.0;

/// Centers nearer than this to another one are left out, mm: a sensel's mean changes by less than a thousandth over it.
const CENTER_SPACING: f64 = 0.25;

/// Mean pressure over the `SENSEL_AREA` around each of `centers`; the largest, MPa. 0 without centers.
///
/// The patch grows from its center over the mesh in order of distance until it has the area; the last vertex counts in part.
pub fn patch_peak(centers: &[u32], field: Field<'_>) -> f64 {
    let mut seen = vec![u32::MAX; field.area.len()];
    let thinned = thinned(centers, field);
    let means = thinned.iter().map(|&c| patch_mean(c, field, &mut seen));
    means.fold(0.0, f64::max)
}

/// Centers of which none lies within [`CENTER_SPACING`] of an earlier one along the mesh.
fn thinned(centers: &[u32], field: Field<'_>) -> Vec<u32> {
    let mut is_covered = vec![false; field.area.len()];
    let (mut kept, mut open) = (Vec::new(), Vec::new());
    for &center in centers {
        if is_covered[center as usize] {
            continue;
        }
        kept.push(center);
        open.push(center);
        while let Some(v) = open.pop() {
            for &next in field.adjacency.neighbors(v as usize) {
                let off = field.positions[next as usize] - field.positions[center as usize];
                if !is_covered[next as usize] && off.norm() < CENTER_SPACING {
                    is_covered[next as usize] = true;
                    open.push(next);
                }
            }
        }
    }
    kept
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

/// `seen` holds the center from which each vertex was last reached.
fn patch_mean(center: u32, field: Field<'_>, seen: &mut [u32]) -> f64 {
    let origin = field.positions[center as usize];
    let mut queue = BinaryHeap::from([Reached {
        distance: 0.0,
        vertex: center,
    }]);
    seen[center as usize] = center;
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
            if seen[next as usize] != center {
                seen[next as usize] = center;
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
