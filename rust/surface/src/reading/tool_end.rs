//! Depth of skin in a thin tool, along the way that the tool was pressed.
//!
//! Skin under the end of an indenter or an edge lies nearer to the tool's sides than to its end as soon as it is deeper than half the tool
//! is wide. It does not come out at a side that lies along the way of the tool: its depth is measured to the end.

use crate::mesh::closest_point::closest_point;
use crate::mesh::triangles::Vec3;
use crate::solid::gap::Gap;
use crate::solid::product::Product;
use crate::tree::nearest::Pending;

/// Cosine between the way of the tool and the way out of its nearest side below which that side lies along the tool: 60 degrees.
const ALONG_THE_TOOL: f64 = 0.5;
/// Cosine between the way of the tool and the skin's inward normal above which the tool comes against the skin.
const AGAINST_THE_SKIN: f64 = 0.5;
/// Widest tool, mm. A wider product has edges, at which skin gives way to the side, as it does at a plate's.
const WIDEST: f64 = 6.0;
/// Farthest end, mm: twice what soft tissue of a hand yields.
const FARTHEST: f64 = 40.0;

impl Product {
    /// The gap to the end of a thin tool that was pressed `along` a unit direction (into the skin), at a point of a skin of outward `normal`.
    ///
    /// `nearest` is the point's gap to the nearest wall. `None` where that holds: where the point is outside, the wall does not lie along the
    /// way, the product is more than 6 mm wide there, the skin does not face the tool, or no end lies within 40 mm.
    pub fn tool_end(
        &self,
        (point, normal): (Vec3, Vec3),
        nearest: &Gap,
        along: Vec3,
    ) -> Option<Gap> {
        let is_beside = nearest.distance < 0.0 && nearest.normal.dot(&along).abs() < ALONG_THE_TOOL;
        if !is_beside || normal.dot(&along) > -AGAINST_THE_SKIN {
            return None;
        }
        let room = WIDEST + nearest.distance;
        self.way_out((point, -nearest.normal), room)?;
        self.way_out((point, along), FARTHEST)
    }

    /// The same of a point that is known to lie in a thin tool.
    pub fn tool_end_again(&self, point: Vec3, nearest: &Gap, along: Vec3) -> Option<Gap> {
        let is_beside = nearest.distance < 0.0 && nearest.normal.dot(&along).abs() < ALONG_THE_TOOL;
        is_beside.then(|| self.way_out((point, along), FARTHEST))?
    }

    /// Depth across the first face through which a way from a point inside leads out within `reach`, mm.
    fn way_out(&self, (point, along): (Vec3, Vec3), reach: f64) -> Option<Gap> {
        let from = self.tree.query(point).point;
        let crossings = self
            .tree
            .crossings(from, along, reach.max(0.0), &mut Pending::default());
        let faces = crossings
            .iter()
            .map(|&(t, slot)| (t, &self.tree.faces[slot as usize]));
        let (t, face) = faces
            .into_iter()
            .find(|(_, face)| !face.is_sheet && face.normal.dot(&along) > 0.0)?;
        let on = closest_point(self.mesh().corners(face.id as usize), point + along * t);
        Some(Gap {
            distance: -t * face.normal.dot(&along),
            closest: on.point,
            normal: face.normal,
            triangle: face.id,
            barycentric: on.barycentric,
        })
    }
}
