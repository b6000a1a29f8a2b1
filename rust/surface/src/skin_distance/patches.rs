//! Patches of up to 32 vertices grown over a skin.

use std::cmp::Reverse;
use std::collections::{BinaryHeap, VecDeque};

use crate::mesh::adjacency::Adjacency;
use crate::mesh::triangles::{Mesh, Vec3};

/// Vertices in a patch, at most, up to 24,000 vertices; larger meshes get larger patches, so that there are about 1,024:
/// what is measured between all of them then takes a second at most, and they are still smaller than a fine hand's at its usual size.
const SIZE: usize = 32;

/// Vertices in a patch as it is first grown, in parts of the most it may have.
const FIRST: f64 = 0.75;
const MOST_PATCHES: usize = 1024;

/// From this many vertices in a patch on, centers are found between small patches, and vertices shared out once: each time, paths over
/// all vertices of so large a mesh wait for memory at every step.
const LARGE: usize = 512;

/// Vertices in a small patch, at most. 8 to 32 serve.
const SMALL: usize = 16;

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
    /// Cuts a mesh into patches, and measures how far their members are from their centers.
    pub(crate) fn new(mesh: &Mesh, adjacency: &Adjacency) -> Patches {
        let skin = Skin {
            positions: mesh.positions(),
            adjacency,
        };
        let count = mesh.positions().len();
        let size = SIZE.max((count as f64 / (FIRST * MOST_PATCHES as f64)).ceil() as usize);
        let mut patches = if size < LARGE {
            skin.grow(size)
        } else {
            skin.grow_large(size)
        };
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
        self.centers = skin.middles(self);
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

/// A skin's vertices and edges, or its small patches' middles and which of them touch.
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
    /// Grows patches by distance along edges, each from where the last ones stopped, makes them round, and halves those too large.
    fn grow(&self, size: usize) -> Patches {
        let (centers, _) = self.seeds((FIRST * size as f64) as usize);
        let mut patches = Patches::collect(self.share(&centers));
        for _ in 0..ROUNDS {
            patches = Patches::collect(self.share(&self.middles(&patches)));
        }
        self.halve(&mut patches, size);
        patches
    }

    /// The same, where centers are those of patches of small patches.
    fn grow_large(&self, size: usize) -> Patches {
        let small = Patches::collect(self.seeds(SMALL).1);
        let means: Vec<Vec3> = (0..small.len())
            .map(|p| self.mean(small.members(p)))
            .collect();
        let adjacency = Adjacency::of((0..small.len()).map(|p| {
            let members = small.members(p).iter();
            let beside = members.flat_map(|&i| self.adjacency.neighbors(i as usize));
            let others = beside.map(|&j| small.patch_of[j as usize]);
            others.filter(|&other| other as usize != p).collect()
        }));
        let coarse = Skin {
            positions: &means,
            adjacency: &adjacency,
        };
        let of_small = (size * small.len()).div_ceil(self.positions.len());
        let rough = coarse.grow(of_small).patch_of;
        let rough = small.patch_of.iter().map(|&p| rough[p as usize]).collect();
        let centers = self.middles(&Patches::collect(rough));
        let mut patches = Patches::collect(self.share(&centers));
        self.halve(&mut patches, size);
        patches
    }

    /// The member nearest to the middle of each patch.
    fn middles(&self, patches: &Patches) -> Vec<u32> {
        (0..patches.len())
            .map(|p| self.middle(patches.members(p)))
            .collect()
    }

    /// Vertices to grow patches of `size` from, about one in `size`, and the number of the one that each vertex was reached from first.
    fn seeds(&self, size: usize) -> (Vec<u32>, Vec<u32>) {
        const FREE: u32 = u32::MAX;
        let mut seed_of = vec![FREE; self.positions.len()];
        let (mut seeds, mut edge, mut next) =
            (Vec::new(), VecDeque::new(), 0..self.positions.len() as u32);
        while let Some(seed) = edge.pop_front().or_else(|| next.next()) {
            if seed_of[seed as usize] != FREE {
                continue;
            }
            let number = seeds.len() as u32;
            seeds.push(seed);
            let mut heap = BinaryHeap::from([Reverse((Length(0.0), seed))]);
            let mut taken = 0;
            while let Some(Reverse((at, i))) = heap.pop() {
                if seed_of[i as usize] != FREE {
                    continue;
                }
                if taken == size {
                    edge.push_back(i);
                    continue;
                }
                seed_of[i as usize] = number;
                taken += 1;
                for &j in self
                    .adjacency
                    .neighbors(i as usize)
                    .iter()
                    .filter(|&&j| seed_of[j as usize] == FREE)
                {
                    let step = (self.positions[i as usize] - self.positions[j as usize]).norm();
                    heap.push(Reverse((Length(at.0 + step), j)));
                }
            }
        }
        (seeds, seed_of)
    }

    /// Gives every vertex the number of the center nearest along edges. Every connected part must hold a center.
    fn share(&self, centers: &[u32]) -> Vec<u32> {
        let mut spread = Spread::new(self.positions.len());
        let from: Vec<(u32, u32)> = centers.iter().copied().zip(0..).collect();
        spread.run(self, &from, |_| true);
        spread.label
    }

    /// Where members lie on average, mm.
    fn mean(&self, members: &[u32]) -> Vec3 {
        let places = members.iter().map(|&i| self.positions[i as usize]);
        places.sum::<Vec3>() / members.len() as f64
    }

    /// The member nearest to the middle.
    fn middle(&self, members: &[u32]) -> u32 {
        let middle = self.mean(members);
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

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;

    /// A lattice of triangles bent over a ridge, `side` by `side`, numbered in no order, spacing 1 mm.
    fn ridge(side: u32) -> Mesh {
        let count = side * side;
        // 48,271 shares no divisor with a power of two: a step along the lattice leads far away in memory.
        let number = |i: u32, j: u32| ((i * side + j) as u64 * 48_271 % u64::from(count)) as u32;
        let mut positions = vec![Vec3::zeros(); count as usize];
        let mut triangles = Vec::new();
        for i in 0..side {
            for j in 0..side {
                let (x, y) = (f64::from(i) + 0.5 * f64::from(j % 2), 0.866 * f64::from(j));
                let height = 20.0 * (x / 40.0).sin();
                positions[number(i, j) as usize] = Vec3::new(x, y, height);
                if i + 1 < side && j + 1 < side {
                    let [a, b, c, d] = [(i, j), (i + 1, j), (i, j + 1), (i + 1, j + 1)];
                    let cut = if j % 2 == 0 {
                        [a, b, c, b, d, c]
                    } else {
                        [a, b, d, a, d, c]
                    };
                    let cut = cut.map(|(i, j)| number(i, j));
                    triangles.extend(cut.as_chunks::<3>().0);
                }
            }
        }
        Mesh::new(positions, triangles).unwrap()
    }

    #[test]
    fn large_patches_are_as_many_and_as_round_as_those_grown_vertex_by_vertex() {
        let (mesh, size) = (ridge(256), LARGE);
        let adjacency = Adjacency::new(&mesh);
        let skin = Skin {
            positions: mesh.positions(),
            adjacency: &adjacency,
        };
        let measured = |mut patches: Patches| {
            patches.measure(&skin);
            patches
        };
        let (plain, large) = (measured(skin.grow(size)), measured(skin.grow_large(size)));
        let counts = [plain.len() as f64, large.len() as f64];
        assert!((counts[1] / counts[0] - 1.0).abs() < 0.15, "{counts:?}");
        let mean = |patches: &Patches| patches.radii.iter().sum::<f64>() / patches.len() as f64;
        assert!(
            mean(&large) < 1.05 * mean(&plain),
            "{} over {}",
            mean(&large),
            mean(&plain)
        );
        for p in 0..large.len() {
            assert!((1..=size).contains(&large.members(p).len()));
            assert!(
                large
                    .members(p)
                    .iter()
                    .all(|&i| large.patch_of[i as usize] as usize == p)
            );
        }
        // Every vertex is in one, and joined with its center by members alone.
        assert_eq!(large.members.len(), mesh.positions().len());
        assert!(large.from_center.iter().all(|d| d.is_finite()));
    }
}
