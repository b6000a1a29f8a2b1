//! Whether flesh lies behind a point of the skin, as far as a wall of the product that it may have come through.
//!
//! A wall that skin has come through lies within the flesh: from the point to the wall nothing of the skin is crossed, and behind the wall
//! there is at least as much flesh as before it, or the wall came in from the other side. In a crease, where normals of a coarse skin point
//! anywhere, the way to a far wall leads through air or through other skin.

use crate::mesh::triangles::{Vec3, is_flat};
use crate::tree::bvh::{Source, Tree};
use crate::tree::nearest::Pending;

/// How far behind a point flesh is sought to tell it from air, mm: more than half a hand's thickness.
const THICKEST: f64 = 40.0;

/// The skin's triangles, for rays through the flesh.
pub(crate) struct Flesh<'a> {
    points: &'a [Vec3],
    triangles: &'a [[u32; 3]],
    tree: Option<Tree>,
}

/// Where a ray leaves the flesh, or that it was not in it.
enum Way {
    /// Through the skin from behind, after so many mm.
    Out(f64),
    /// The ray met the outside of the skin.
    In,
    /// It met no skin: the skin is open there.
    Open,
}

impl<'a> Flesh<'a> {
    /// Prepares the triangles that rays along some `ways` (from, to) may meet.
    pub(crate) fn new(
        points: &'a [Vec3],
        triangles: &'a [[u32; 3]],
        ways: &[(Vec3, Vec3)],
    ) -> Flesh<'a> {
        let boxes: Vec<(Vec3, Vec3)> = ways
            .iter()
            .map(|(from, to)| {
                let way = to - from;
                let back = way.try_normalize(0.0).unwrap_or_else(Vec3::zeros);
                let (ahead, back) = (to + way, from - back * THICKEST);
                (ahead.inf(&back), ahead.sup(&back))
            })
            .collect();
        let none = (Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY));
        let whole = boxes
            .iter()
            .fold(none, |all, b| (all.0.inf(&b.0), all.1.sup(&b.1)));
        let meets = |(low, high): &(Vec3, Vec3), b: &(Vec3, Vec3)| {
            (0..3).all(|k| low[k] <= b.1[k] && high[k] >= b.0[k])
        };
        let near = (0u32..).zip(triangles).filter_map(|(id, triangle)| {
            let corners = triangle.map(|v| points[v as usize]);
            let own = (
                corners[0].inf(&corners[1]).inf(&corners[2]),
                corners[0].sup(&corners[1]).sup(&corners[2]),
            );
            let is_near = meets(&own, &whole) && boxes.iter().any(|b| meets(&own, b));
            (is_near && !is_flat(corners)).then_some(Source {
                id,
                corners,
                is_sheet: false,
                piece_of: None,
            })
        });
        let near: Vec<Source> = near.collect();
        Flesh {
            points,
            triangles,
            tree: (!near.is_empty()).then(|| Tree::new(&near, triangles.len())),
        }
    }

    /// Whether the skin at vertex `at` may have come through a wall at `wall`: flesh lies between, and as much of it beyond.
    pub(crate) fn reaches(&self, at: u32, wall: Vec3) -> bool {
        let from = self.points[at as usize];
        let way = wall - from;
        let depth = way.norm();
        let Some(along) = way.try_normalize(0.0) else {
            return false;
        };
        match self.way(at, along, 2.0 * depth) {
            Way::Out(after) => after >= 2.0 * depth,
            Way::In => false,
            // No skin is met before twice the depth: flesh, or air. Air has flesh at the other side of the skin.
            Way::Open => !matches!(self.way(at, -along, THICKEST), Way::Out(_)),
        }
    }

    /// The first skin that a ray from a vertex meets within `reach`, triangles at that vertex left out.
    fn way(&self, at: u32, along: Vec3, reach: f64) -> Way {
        let Some(tree) = &self.tree else {
            return Way::Open;
        };
        let from = tree.query(self.points[at as usize]).point;
        let crossings = tree.crossings(from, along, reach, &mut Pending::default());
        let face = |slot: u32| &tree.faces[slot as usize];
        let is_other = |(_, slot): &&(f64, u32)| {
            let triangle = self.triangles[face(*slot).id as usize];
            !triangle.contains(&at)
        };
        match crossings.iter().find(is_other) {
            None => Way::Open,
            Some((after, slot)) if face(*slot).normal.dot(&along) > 0.0 => Way::Out(*after),
            Some(_) => Way::In,
        }
    }
}
