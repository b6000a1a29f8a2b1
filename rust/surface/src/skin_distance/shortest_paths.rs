//! Shortest paths from patch to patch of a skin, and how much longer they are than the skin between their ends.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use rayon::prelude::*;

use crate::mesh::adjacency::Adjacency;
use crate::mesh::normals::normals_at;
use crate::mesh::triangles::{Mesh, Vec3};
use crate::skin_distance::patches::Patches;

/// What is measured on a mesh is raised by this factor, for the pairs that were not measured.
const MARGIN: f64 = 1.05;

/// Pairs of patches at least this many steps apart show the stretch of long paths. Tests pass from 1.5 to 3.
const LONG: f64 = 2.0;

/// Stretch is measured up to this many steps.
const MEASURED: f64 = 5.0;

/// Two patches whose normals differ by less than 30 degrees, all the way between them, lie on skin flat enough to compare with the chord.
const FLAT_COSINE: f64 = 0.866;

/// How much longer paths over patches are than the skin between their ends.
pub(crate) struct Stretch {
    /// Largest ratio of all.
    any: f64,
    /// Largest ratio of long paths.
    long: f64,
    /// What short paths have beyond that, mm.
    excess: f64,
}

impl Stretch {
    /// Compares paths with chords wherever the skin between two patches is nearly flat.
    pub(crate) fn measure(graph: &Graph) -> Stretch {
        let (step, patches) = (graph.step(), graph.centers.len());
        let pairs = |search: &mut Search, a: u32| {
            search.run(graph, a, MEASURED * step);
            let ends = |&b: &u32| {
                let chord = (graph.centers[a as usize] - graph.centers[b as usize]).norm();
                let path = f64::from(search.along[b as usize]);
                (search.is_flat[b as usize] && chord > 0.0).then_some((path, chord))
            };
            search.found.iter().filter_map(ends).collect()
        };
        let all = (0..patches as u32).into_par_iter();
        let rows: Vec<Vec<(f64, f64)>> = all.map_init(|| Search::new(patches), pairs).collect();
        Stretch::new(&rows.concat(), step)
    }

    /// From (path, chord) of pairs on nearly flat skin, mm, and the usual step between patches.
    fn new(flat: &[(f64, f64)], step: f64) -> Stretch {
        let ratio = |of: &mut dyn Iterator<Item = &(f64, f64)>| {
            of.map(|(path, chord)| path / chord).fold(1.0, f64::max)
        };
        let any = MARGIN * ratio(&mut flat.iter());
        let mut long = flat
            .iter()
            .filter(|(_, chord)| *chord >= LONG * step)
            .peekable();
        let long = if long.peek().is_some() {
            MARGIN * ratio(&mut long)
        } else {
            any
        };
        let excess = MARGIN
            * flat
                .iter()
                .map(|(path, chord)| path - long * chord)
                .fold(0.0, f64::max);
        Stretch { any, long, excess }
    }

    /// Longest path whose ends may be as near as `distance` along the skin.
    pub(crate) fn most(&self, distance: f64) -> f64 {
        (distance * self.any).min(distance * self.long + self.excess)
    }

    /// Least distance along the skin between the ends of a path.
    pub(crate) fn least(&self, path: f64) -> f64 {
        (path / self.any).max((path - self.excess) / self.long)
    }
}

/// Patches that touch, with the path from center to center.
pub(crate) struct Graph {
    starts: Vec<u32>,
    links: Vec<(u32, f64)>,
    normals: Vec<Vec3>,
    /// Where the centers are, mm.
    pub centers: Vec<Vec3>,
}

impl Graph {
    pub(crate) fn new(mesh: &Mesh, adjacency: &Adjacency, patches: &Patches) -> Graph {
        let p = mesh.positions();
        let (mut starts, mut links) = (vec![0u32], Vec::new());
        for a in 0..patches.len() {
            let mut around: Vec<(u32, f64)> = Vec::new();
            for &i in patches.members(a) {
                for &j in adjacency
                    .neighbors(i as usize)
                    .iter()
                    .filter(|&&j| patches.patch_of[j as usize] as usize != a)
                {
                    let along = patches.from_center[i as usize]
                        + (p[i as usize] - p[j as usize]).norm()
                        + patches.from_center[j as usize];
                    around.push((patches.patch_of[j as usize], along));
                }
            }
            around.sort_unstable_by(|x, y| x.0.cmp(&y.0).then(x.1.total_cmp(&y.1)));
            around.dedup_by_key(|x| x.0);
            links.extend(around);
            starts.push(links.len() as u32);
        }
        Graph {
            starts,
            links,
            normals: normals_at(mesh, &patches.centers),
            centers: patches.centers.iter().map(|&i| p[i as usize]).collect(),
        }
    }

    fn around(&self, a: usize) -> &[(u32, f64)] {
        &self.links[self.starts[a] as usize..self.starts[a + 1] as usize]
    }

    /// Median path between patches that touch, mm; 0 without any.
    fn step(&self) -> f64 {
        let mut lengths: Vec<f64> = self.links.iter().map(|l| l.1).collect();
        lengths.sort_unstable_by(f64::total_cmp);
        lengths.get(lengths.len() / 2).copied().unwrap_or_default()
    }

    pub(crate) fn touches(&self, a: usize, b: u32) -> bool {
        self.around(a).binary_search_by_key(&b, |l| l.0).is_ok()
    }
}

/// Shortest paths from one patch after the other.
pub(crate) struct Search {
    pub along: Vec<f32>,
    /// Whether the skin on the shortest path to each patch is nearly flat.
    pub is_flat: Vec<bool>,
    /// Patches reached, nearest first.
    pub found: Vec<u32>,
    /// Length's bits above the patch: as lengths are not negative, these order like them.
    heap: BinaryHeap<Reverse<u64>>,
}

impl Search {
    pub(crate) fn new(patches: usize) -> Search {
        Search {
            along: vec![f32::INFINITY; patches],
            is_flat: vec![false; patches],
            found: Vec::new(),
            heap: BinaryHeap::new(),
        }
    }

    pub(crate) fn run(&mut self, graph: &Graph, from: u32, range: f64) {
        let normal = graph.normals[from as usize];
        self.along.fill(f32::INFINITY);
        self.found.clear();
        self.along[from as usize] = 0.0;
        self.is_flat[from as usize] = true;
        self.heap.push(Reverse(u64::from(from)));
        while let Some(Reverse(packed)) = self.heap.pop() {
            let (at, i) = (f32::from_bits((packed >> 32) as u32), packed as u32);
            if at > self.along[i as usize] {
                continue;
            }
            self.found.push(i);
            for &(j, step) in graph.around(i as usize) {
                let along = at + step as f32;
                if along < self.along[j as usize] && f64::from(along) <= range {
                    self.along[j as usize] = along;
                    let agrees = normal.dot(&graph.normals[j as usize]) > FLAT_COSINE;
                    self.is_flat[j as usize] = self.is_flat[i as usize] && agrees;
                    self.heap
                        .push(Reverse(u64::from(along.to_bits()) << 32 | u64::from(j)));
                }
            }
        }
    }
}
