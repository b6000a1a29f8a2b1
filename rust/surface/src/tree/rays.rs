//! Where rays cross the faces of a tree.

use crate::mesh::triangles::Vec3;
use crate::tree::bvh::{Child, Node, Tree};
use crate::tree::face::Face;
use crate::tree::nearest::Pending;

/// Part of a face's size by which a ray may miss it: a ray through an edge must not slip between its two faces. Callers must accept that
/// such a ray crosses both.
const ON_EDGE: f64 = 1e-9;

impl Tree {
    /// Where the ray `from + t * along` (about the tree's center) crosses faces for t in 0..=`reach`: (t, slot), sorted.
    pub(crate) fn crossings(
        &self,
        from: Vec3,
        along: Vec3,
        reach: f64,
        pending: &mut Pending,
    ) -> Vec<(f64, u32)> {
        let mut found = Vec::new();
        let (start, inverse) = (from * self.shrink, along.map(|d| 1.0 / d));
        pending.0.clear();
        pending.0.push((0.0, 0));
        while let Some((_, at)) = pending.0.pop() {
            let node = &self.nodes[at as usize];
            for lane in 0..node.used as usize {
                if !meets_box(node, lane, &start, &inverse, reach * self.shrink) {
                    continue;
                }
                match Child::of(node.child[lane]) {
                    Child::Node(below) => pending.0.push((0.0, below as u32)),
                    Child::Leaf(leaf) => {
                        let (first, faces) = self.leaf_faces(leaf);
                        found.extend((first as u32..).zip(faces).filter_map(|(slot, face)| {
                            Some((face.crossing(from, along, reach)?, slot))
                        }));
                    }
                }
            }
        }
        found.sort_by(|a, b| {
            a.0.total_cmp(&b.0).then(
                self.faces[a.1 as usize]
                    .id
                    .cmp(&self.faces[b.1 as usize].id),
            )
        });
        found
    }
}

impl Face {
    /// Where a ray crosses the face (Moeller & Trumbore 1997), if it does within `reach`.
    fn crossing(&self, from: Vec3, along: Vec3, reach: f64) -> Option<f64> {
        let across = along.cross(&self.ac);
        let det = self.ab.dot(&across);
        if det == 0.0 {
            return None;
        }
        let to = from - self.a;
        let u = to.dot(&across) / det;
        let turned = to.cross(&self.ab);
        let v = along.dot(&turned) / det;
        let t = self.ac.dot(&turned) / det;
        let is_on = u >= -ON_EDGE && v >= -ON_EDGE && u + v <= 1.0 + ON_EDGE;
        (is_on && (0.0..=reach).contains(&t)).then_some(t)
    }
}

/// Whether a ray meets one box of a node within `reach`, by its slabs; `inverse` is one over its direction.
fn meets_box(node: &Node, lane: usize, start: &Vec3, inverse: &Vec3, reach: f64) -> bool {
    let (mut enter, mut leave) = (0.0, reach);
    for axis in 0..3 {
        let (low, high) = (
            f64::from(node.low[axis][lane]),
            f64::from(node.high[axis][lane]),
        );
        let (t0, t1) = (
            (low - start[axis]) * inverse[axis],
            (high - start[axis]) * inverse[axis],
        );
        // `min` and `max` drop the NaN of 0 * infinity, which is a ray within the face of a box.
        enter = t0.min(t1).max(enter);
        leave = t0.max(t1).min(leave);
    }
    enter <= leave
}
