//! The nearest face of a tree: front to back over boxes, exact over faces.

use crate::mesh::closest_point::{ClosestPoint, closest_on};
use crate::mesh::triangles::Vec3;
use crate::tree::bvh::{Child, Query, Tree};
use crate::tree::face::{Face, WIDTH};

/// The face found, and the point on it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Hit {
    /// Index into the tree's faces.
    pub slot: u32,
    /// Closest point on it, about the tree's center.
    pub on: ClosestPoint,
    /// Squared distance times the face's weight, mm2.
    pub weighted: f64,
}

/// Nodes still to visit, with the squared distance of their boxes; kept between queries so that none allocates.
#[derive(Debug, Default)]
pub(crate) struct Pending(pub(crate) Vec<(f32, u32)>);

/// Which faces count, and how far away each seems.
pub(crate) struct Choice<W, F> {
    /// Whether a face counts.
    pub wanted: W,
    /// Its weight for its closest point, at least 1, or infinity to leave it out.
    pub weigh: F,
}

impl Tree {
    /// The face with the least `weight * distance^2`, at most `limit` (mm2); of several, that of lowest index in the mesh.
    ///
    /// `weigh` gives a face's weight from its closest point, at least 1, or infinity to leave it out.
    pub(crate) fn nearest(
        &self,
        query: &Query,
        limit: f64,
        pending: &mut Pending,
        weigh: impl Fn(&Face, &ClosestPoint) -> f64,
    ) -> Option<Hit> {
        let choice = Choice {
            wanted: |_: &Face| true,
            weigh,
        };
        self.nearest_of(query, limit, pending, choice)
    }

    /// [`Tree::nearest`] of the faces that are wanted.
    pub(crate) fn nearest_of(
        &self,
        query: &Query,
        limit: f64,
        pending: &mut Pending,
        choice: Choice<impl Fn(&Face) -> bool, impl Fn(&Face, &ClosestPoint) -> f64>,
    ) -> Option<Hit> {
        #[cfg(target_arch = "x86_64")]
        if std::arch::is_x86_feature_detected!("avx2") {
            // SAFETY: the processor was just asked whether it has the feature.
            return unsafe { self.nearest_avx2(query, limit, pending, choice) };
        }
        self.walk(query, limit, pending, choice)
    }

    /// The same instructions twice as wide; rounding, and so every bit of the answer, is the same.
    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2")]
    fn nearest_avx2(
        &self,
        query: &Query,
        limit: f64,
        pending: &mut Pending,
        choice: Choice<impl Fn(&Face) -> bool, impl Fn(&Face, &ClosestPoint) -> f64>,
    ) -> Option<Hit> {
        self.walk(query, limit, pending, choice)
    }

    #[inline(always)]
    fn walk(
        &self,
        query: &Query,
        limit: f64,
        pending: &mut Pending,
        choice: Choice<impl Fn(&Face) -> bool, impl Fn(&Face, &ClosestPoint) -> f64>,
    ) -> Option<Hit> {
        let mut best = Best {
            hit: None,
            bound: limit,
            boxed: self.box_bound(limit),
        };
        if let Some(slot) = query.start {
            self.try_face(slot, query, &mut best, &choice);
        }
        let stack = &mut pending.0;
        stack.clear();
        stack.push((0.0, 0));
        while let Some((distance, at)) = stack.pop() {
            if distance > best.boxed {
                continue;
            }
            let node = match Child::of(at) {
                Child::Node(node) => &self.nodes[node],
                Child::Leaf(leaf) => {
                    let leaf = &self.leaves[leaf];
                    let mut near = leaf.near(&query.boxed, best.boxed);
                    while near != 0 {
                        self.try_face(
                            leaf.first + near.trailing_zeros(),
                            query,
                            &mut best,
                            &choice,
                        );
                        near &= near - 1;
                    }
                    continue;
                }
            };
            let distances = node.box_distances(&query.boxed);
            let below = stack.len();
            for lane in 0..WIDTH.min(node.used as usize) {
                if distances[lane] <= best.boxed {
                    stack.push((distances[lane], node.child[lane]));
                }
            }
            stack[below..].sort_unstable_by(|a, b| b.0.total_cmp(&a.0));
        }
        best.hit
    }

    #[inline(always)]
    fn try_face(
        &self,
        slot: u32,
        query: &Query,
        best: &mut Best,
        choice: &Choice<impl Fn(&Face) -> bool, impl Fn(&Face, &ClosestPoint) -> f64>,
    ) {
        let face = &self.faces[slot as usize];
        if !(choice.wanted)(face) {
            return;
        }
        let on = closest_on(face.a, face.ab, face.ac, query.point);
        // Weights are at least 1, so most faces need none.
        if on.distance_squared > best.bound {
            return;
        }
        let weighted = on.distance_squared * (choice.weigh)(face, &on);
        let is_nearer = match &best.hit {
            Some(hit) => {
                weighted < hit.weighted
                    || (weighted == hit.weighted && face.id < self.faces[hit.slot as usize].id)
            }
            None => weighted <= best.bound && weighted < f64::INFINITY,
        };
        if is_nearer {
            *best = Best {
                hit: Some(Hit { slot, on, weighted }),
                bound: weighted,
                boxed: self.box_bound(weighted),
            };
        }
    }
}

struct Best {
    hit: Option<Hit>,
    bound: f64,
    boxed: f32,
}

impl Tree {
    /// Triangles of the mesh whose leaf boxes meet the box of `corners`.
    pub(crate) fn overlapping(&self, corners: &[Vec3; 3], found: &mut Vec<u32>) {
        found.clear();
        let local = corners.map(|p| p - self.center);
        let low = local[0].inf(&local[1]).inf(&local[2]);
        let high = local[0].sup(&local[1]).sup(&local[2]);
        self.visit_overlapping([low, high], |_, faces| {
            found.extend(faces.iter().map(|f| f.id));
        });
    }

    /// Faces whose leaf boxes meet a box, its lowest and highest corner about the tree's center.
    pub(crate) fn slots_overlapping(&self, bounds: [Vec3; 2]) -> Vec<u32> {
        let mut found = Vec::new();
        self.visit_overlapping(bounds, |first, faces| {
            found.extend((first as u32..).take(faces.len()));
        });
        found
    }

    /// Calls `visit` with the first index and the faces of every leaf whose box meets another, about the tree's center.
    fn visit_overlapping(&self, bounds: [Vec3; 2], mut visit: impl FnMut(usize, &[Face])) {
        let [low, high] = bounds.map(|p| p * self.shrink);
        let mut pending = vec![0usize];
        while let Some(at) = pending.pop() {
            let node = &self.nodes[at];
            for lane in 0..node.used as usize {
                let meets = (0..3).all(|k| {
                    f64::from(node.low[k][lane]) <= high[k]
                        && low[k] <= f64::from(node.high[k][lane])
                });
                match Child::of(node.child[lane]) {
                    _ if !meets => {}
                    Child::Node(below) => pending.push(below),
                    Child::Leaf(leaf) => {
                        let (first, faces) = self.leaf_faces(leaf);
                        visit(first, faces);
                    }
                }
            }
        }
    }
}
