//! Patches of up to 32 vertices grown over a skin.

use std::cmp::Reverse;
use std::collections::{BinaryHeap, VecDeque};

use crate::adjacency::Adjacency;
use crate::mesh::{Mesh, Vec3};

/// Vertices in a patch, at most, up to 24,000 vertices; larger meshes get larger patches, so that there are about 1,024:
/// what is measured between all of them then takes a second at most, and they are still smaller than a fine hand's at its usual size.
const SIZE: usize = 32;

/// Vertices in a patch as it is first grown, in parts of the most it may have.
const FIRST: f64 = 0.75;
const MOST_PATCHES: usize = 1024;

/// How often vertices are shared out anew to the nearest center: patches become round. 1 to 5 serve.
const ROUNDS: usize = 2;

/// A skin cut into patches.
#[derive(Debug, Clone)]
pub(crate) struct Patches {
    pub patch_of: Vec<u32>,
    pub starts: Vec<u32>,
    pub members: Vec<u32>,
    /// The vertex each patch was grown from.
    pub centers: Vec<u32>,
    /// Farthest member along edges from the center within the patch, mm.
    pub radii: Vec<f64>,
    /// Distance of each vertex to its center along edges, mm.
    pub from_center: Vec<f64>,
}

/// A length that orders, smallest first in a heap of `Reverse`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Length(pub f64);
impl Eq for Length {}
impl PartialOrd for Length {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}
impl Ord for Length {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.0.total_cmp(&other.0)
    }
}

impl Patches {
    /// Grows patches by distance along edges, each from where the last ones stopped, makes them round, and halves those too large.
    pub(crate) fn new(mesh: &Mesh, adjacency: &Adjacency) -> Patches {
        let count = mesh.positions().len();
        let size = SIZE.max((count as f64 / (FIRST * MOST_PATCHES as f64)).ceil() as usize);
        let skin = Skin {
            positions: mesh.positions(),
            adjacency,
        };
        let mut centers = skin.seeds((FIRST * size as f64) as usize);
        let mut patches = Patches::collect(skin.share(&centers));
        for _ in 0..ROUNDS {
            centers = (0..patches.len())
                .map(|p| skin.middle(patches.members(p)))
                .collect();
            patches = Patches::collect(skin.share(&centers));
        }
        skin.halve(&mut patches, size);
        patches.measure(&skin);
        patches
    }

    pub(crate) fn len(&self) -> usize {
        self.starts.len() - 1
    }

    pub(crate) fn members(&self, patch: usize) -> &[u32] {
        &self.members[self.starts[patch] as usize..self.starts[patch + 1] as usize]
    }
}

impl Patches {
    /// Sorts vertices into patches, numbered anew by their first vertex.
    fn collect(mut patch_of: Vec<u32>) -> Patches {
        let mut number = vec![u32::MAX; patch_of.len()];
        let mut count = 0;
        for p in &mut patch_of {
            let number = &mut number[*p as usize];
            if *number == u32::MAX {
                *number = count;
                count += 1;
            }
            *p = *number;
        }
        let mut starts = vec![0u32; count as usize + 1];
        patch_of.iter().for_each(|&p| starts[p as usize + 1] += 1);
        for i in 1..starts.len() {
            starts[i] += starts[i - 1];
        }
        let mut next = starts.clone();
        let mut members = vec![0u32; patch_of.len()];
        for (i, &p) in patch_of.iter().enumerate() {
            members[next[p as usize] as usize] = i as u32;
            next[p as usize] += 1;
        }
        Patches {
            patch_of,
            starts,
            members,
            centers: Vec::new(),
            radii: Vec::new(),
            from_center: Vec::new(),
        }
    }

    /// Finds the final centers, and how far the members are from them.
    fn measure(&mut self, skin: &Skin) {
        self.centers = (0..self.len())
            .map(|p| skin.middle(self.members(p)))
            .collect();
        let mut spread = Spread::new(self.patch_of.len());
        for &center in &self.centers {
            let own = self.patch_of[center as usize];
            spread.run(skin, &[(center, own)], |j| self.patch_of[j as usize] == own);
        }
        self.from_center = spread.along;
        let farthest = |p: usize| {
            self.members(p)
                .iter()
                .map(|&i| self.from_center[i as usize])
                .fold(0.0, f64::max)
        };
        self.radii = (0..self.len()).map(farthest).collect();
    }
}

/// A skin's vertices and edges.
struct Skin<'a> {
    positions: &'a [Vec3],
    adjacency: &'a Adjacency,
}

/// Shortest paths over edges from given vertices, each of which hands on its label.
struct Spread {
    along: Vec<f64>,
    label: Vec<u32>,
    heap: BinaryHeap<Reverse<(Length, u32)>>,
}

impl Spread {
    fn new(vertices: usize) -> Spread {
        Spread {
            along: vec![f64::INFINITY; vertices],
            label: vec![u32::MAX; vertices],
            heap: BinaryHeap::new(),
        }
    }

    /// Spreads from (vertex, label) over the vertices that `reaches` lets through, where that is shorter than what an earlier run found.
    fn run(&mut self, skin: &Skin, from: &[(u32, u32)], reaches: impl Fn(u32) -> bool) {
        for &(i, label) in from {
            self.along[i as usize] = 0.0;
            self.label[i as usize] = label;
            self.heap.push(Reverse((Length(0.0), i)));
        }
        while let Some(Reverse((at, i))) = self.heap.pop() {
            if at.0 > self.along[i as usize] {
                continue;
            }
            for &j in skin.adjacency.neighbors(i as usize) {
                let along = at.0 + (skin.positions[i as usize] - skin.positions[j as usize]).norm();
                if along < self.along[j as usize] && reaches(j) {
                    self.along[j as usize] = along;
                    self.label[j as usize] = self.label[i as usize];
                    self.heap.push(Reverse((Length(along), j)));
                }
            }
        }
    }
}

impl Skin<'_> {
    /// Vertices to grow patches of `size` from, about one in `size`.
    fn seeds(&self, size: usize) -> Vec<u32> {
        let mut is_taken = vec![false; self.positions.len()];
        let (mut seeds, mut edge, mut next) =
            (Vec::new(), VecDeque::new(), 0..self.positions.len() as u32);
        while let Some(seed) = edge.pop_front().or_else(|| next.next()) {
            if is_taken[seed as usize] {
                continue;
            }
            seeds.push(seed);
            let mut heap = BinaryHeap::from([Reverse((Length(0.0), seed))]);
            let mut taken = 0;
            while let Some(Reverse((at, i))) = heap.pop() {
                if is_taken[i as usize] {
                    continue;
                }
                if taken == size {
                    edge.push_back(i);
                    continue;
                }
                is_taken[i as usize] = true;
                taken += 1;
                for &j in self
                    .adjacency
                    .neighbors(i as usize)
                    .iter()
                    .filter(|&&j| !is_taken[j as usize])
                {
                    let step = (self.positions[i as usize] - self.positions[j as usize]).norm();
                    heap.push(Reverse((Length(at.0 + step), j)));
                }
            }
        }
        seeds
    }

    /// Gives every vertex the number of the center nearest along edges. Every connected part must hold a center.
    fn share(&self, centers: &[u32]) -> Vec<u32> {
        let mut spread = Spread::new(self.positions.len());
        let from: Vec<(u32, u32)> = centers.iter().copied().zip(0..).collect();
        spread.run(self, &from, |_| true);
        spread.label
    }

    /// The member nearest to the middle.
    fn middle(&self, members: &[u32]) -> u32 {
        let middle = members
            .iter()
            .map(|&i| self.positions[i as usize])
            .sum::<Vec3>()
            / members.len() as f64;
        let off = |i: &u32| (self.positions[*i as usize] - middle).norm_squared();
        members
            .iter()
            .copied()
            .min_by(|a, b| off(a).total_cmp(&off(b)))
            .unwrap_or_default()
    }

    /// Cuts patches of more than `size` in two, between members far apart, until there are none.
    fn halve(&self, patches: &mut Patches, size: usize) {
        loop {
            let large: Vec<usize> = (0..patches.len())
                .filter(|&p| patches.members(p).len() > size)
                .collect();
            if large.is_empty() {
                return;
            }
            let mut patch_of = patches.patch_of.clone();
            let mut spread = Spread::new(self.positions.len());
            for (k, &p) in large.iter().enumerate() {
                let members = patches.members(p);
                let far = |from: u32| {
                    let off = |i: &u32| {
                        (self.positions[*i as usize] - self.positions[from as usize]).norm_squared()
                    };
                    members
                        .iter()
                        .copied()
                        .filter(|i| *i != from)
                        .max_by(|a, b| off(a).total_cmp(&off(b)))
                        .unwrap_or(from)
                };
                let one = far(self.middle(members));
                let fresh = (patches.len() + k) as u32;
                spread.run(self, &[(one, p as u32), (far(one), fresh)], |j| {
                    patches.patch_of[j as usize] as usize == p
                });
                members
                    .iter()
                    .for_each(|&i| patch_of[i as usize] = spread.label[i as usize]);
            }
            *patches = Patches::collect(patch_of);
        }
    }
}
