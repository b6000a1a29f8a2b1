//! Lower bounds on distances along a skin, between patches.

use rayon::prelude::*;

use crate::mesh::adjacency::Adjacency;
use crate::mesh::triangles::{Mesh, Vec3};
use crate::skin_distance::patches::Patches;
use crate::skin_distance::shortest_paths::{Graph, Search, Stretch};

/// A coarse table of distances along a skin: lower bounds from patch to patch.
///
/// The skin is cut into patches of up to 32 vertices. Shortest paths from center to center over edges overestimate the distance along the
/// skin, by a stretch that depends on the triangles (up to 1.155 on the regular lattice, more over patches). The largest stretch is measured on
/// this mesh where the skin is nearly flat and the chord gives the true distance: that of long paths, and what short ones have beyond it. A bound
/// is the path without its stretch, less the reach of both patches; or the chord between balls around them if that is larger.
#[derive(Debug, Clone)]
pub struct SkinDistance {
    patches: Patches,
    starts: Vec<u32>,
    others: Vec<u32>,
    bounds: Vec<f32>,
}

impl SkinDistance {
    /// Cuts a skin into patches and measures up to `range_mm` along it. `adjacency` is that of `mesh`.
    pub fn new(mesh: &Mesh, adjacency: &Adjacency, range_mm: f64) -> SkinDistance {
        let patches = Patches::new(mesh, adjacency);
        let graph = Graph::new(mesh, adjacency, &patches);
        let balls = balls(mesh, &patches, &graph.centers);
        let stretch = Stretch::measure(&graph);
        let reach = 2.0 * patches.radii.iter().fold(0.0f64, |a, b| a.max(*b));
        let longest = stretch.most(range_mm + reach);
        let row = |search: &mut Search, a: u32| {
            search.run(&graph, a, longest);
            let bound = |b: u32| {
                let path = stretch.least(f64::from(search.along[b as usize]));
                let [i, j] = [a as usize, b as usize];
                let chord = (graph.centers[i] - graph.centers[j]).norm() - balls[i] - balls[j];
                let bound = (path - patches.radii[i] - patches.radii[j]).max(chord);
                let is_near = bound <= 0.0 || a == b || graph.touches(i, b);
                // Rounded down, as paths were rounded a few times.
                if is_near {
                    0.0
                } else {
                    (bound * (1.0 - 1e-5)) as f32
                }
            };
            // In order of patches, rather than sorting those found.
            let reached =
                (0..patches.len() as u32).filter(|&b| search.along[b as usize].is_finite());
            let row = reached.map(|b| (b, bound(b)));
            row.filter(|r| f64::from(r.1) <= range_mm).collect()
        };
        let all = (0..patches.len() as u32).into_par_iter();
        let rows: Vec<Vec<(u32, f32)>> = all.map_init(|| Search::new(patches.len()), row).collect();
        let mut starts = vec![0];
        starts.extend(rows.iter().scan(0, |end, row| {
            *end += row.len() as u32;
            Some(*end)
        }));
        let others = rows.iter().flatten().map(|r| r.0).collect();
        let bounds = rows.iter().flatten().map(|r| r.1).collect();
        SkinDistance {
            patches,
            starts,
            others,
            bounds,
        }
    }

    /// The patch of vertex `i`.
    pub fn patch_of(&self, i: usize) -> u32 {
        self.patches.patch_of[i]
    }

    /// How many patches there are.
    pub fn len(&self) -> usize {
        self.patches.len()
    }

    /// Whether there are no patches.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The vertices of each patch, ascending.
    pub fn patches(&self) -> impl Iterator<Item = &[u32]> {
        (0..self.patches.len()).map(|p| self.patches.members(p))
    }

    /// The vertex in the middle of a patch.
    pub fn center(&self, patch: u32) -> u32 {
        self.patches.centers[patch as usize]
    }

    /// How far a patch reaches from its center along the skin, at most, mm.
    pub fn radius(&self, patch: u32) -> f64 {
        self.patches.radii[patch as usize]
    }

    /// Lower bound, mm, on the distance along the skin between any vertex of patch `a` and any of patch `b`: 0 for the same and for touching
    /// patches, infinity beyond the range and between parts that are not connected.
    pub fn lower_bound(&self, a: u32, b: u32) -> f64 {
        let row = self.starts[a as usize] as usize..self.starts[a as usize + 1] as usize;
        match self.others[row.clone()].binary_search(&b) {
            Ok(at) => f64::from(self.bounds[row.start + at]),
            Err(_) => f64::INFINITY,
        }
    }

    /// The patches within range of patch `a`, ascending, each with its [`SkinDistance::lower_bound`].
    pub fn near(&self, a: u32) -> impl Iterator<Item = (u32, f64)> {
        let row = self.starts[a as usize] as usize..self.starts[a as usize + 1] as usize;
        row.map(|at| (self.others[at], f64::from(self.bounds[at])))
    }
}

/// Radius of a ball about each center that holds the patch, mm.
fn balls(mesh: &Mesh, patches: &Patches, centers: &[Vec3]) -> Vec<f64> {
    let p = mesh.positions();
    let ball = |a: usize| {
        patches
            .members(a)
            .iter()
            .map(|&i| (p[i as usize] - centers[a]).norm())
            .fold(0.0, f64::max)
    };
    (0..patches.len()).map(ball).collect()
}
