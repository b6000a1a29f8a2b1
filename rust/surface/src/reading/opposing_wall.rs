//! The signed distance as the skin sees it: depth is measured to the side of the product that opposes the skin.

use crate::mesh::closest_point::ClosestPoint;
use crate::mesh::triangles::Vec3;
use crate::reading::facing::FACING_AWAY;
use crate::solid::gap::{Gap, GapLimits, Side};
use crate::solid::product::Product;
use crate::tree::bvh::Query;
use crate::tree::face::Face;
use crate::tree::nearest::{Choice, Hit, Pending};

/// Cosine between skin normal and face normal from which a face is not one the skin can have come through: 46 degrees off its own
/// direction. Between 0 and this, faces count with growing reluctance. Tests pass from 0.5 to 0.85.
const TURNED_AWAY: f64 = 0.7;

/// How far beyond the cut-off faces are sought to tell how much room a point has, in parts of the cut-off.
const ROOM: f64 = 0.5;

/// What rounding may do to such a distance, with room to spare, in parts of it and of the product's extent.
const ROUNDING: f64 = 1e-7;

/// What a point inside reads, whose nearest wall faces the way of the skin.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Turned {
    /// The nearest wall: the neighborhood decides later (`poke`).
    Nearest,
    /// The wall that opposes it: which one is known.
    Opposing,
}

/// Answers one point after the other.
pub(crate) struct Facing<'a> {
    product: &'a Product,
    limits: GapLimits,
    turned: Turned,
    pending: &'a mut Pending,
}

impl<'a> Facing<'a> {
    pub(crate) fn new(
        product: &'a Product,
        (limits, turned): (GapLimits, Turned),
        pending: &'a mut Pending,
    ) -> Facing<'a> {
        // What is not a length is none.
        let [cut_off_mm, max_depth_mm] =
            [limits.cut_off_mm, limits.max_depth_mm].map(|x| x.max(0.0));
        let limits = GapLimits {
            cut_off_mm,
            max_depth_mm,
        };
        Facing {
            product,
            limits,
            turned,
            pending,
        }
    }

    /// The gap of one point. `hint` is a triangle of the mesh to begin with.
    pub(crate) fn gap(
        &mut self,
        point: Vec3,
        skin: Option<Vec3>,
        hint: Option<u32>,
    ) -> Option<Gap> {
        let query = self.query(point, hint);
        let cut_off = square(self.limits.cut_off_mm);
        let tree = &self.product.tree;
        let hit = tree.nearest(&query, cut_off, self.pending, |_, _| 1.0);
        self.gap_to(hit, &query, skin)
    }

    /// [`Facing::gap`], and how far the point may go before a face can be within the cut-off, mm; 0 where one is.
    pub(crate) fn gap_and_room(
        &mut self,
        point: Vec3,
        skin: Option<Vec3>,
        hint: Option<u32>,
    ) -> (Option<Gap>, f64) {
        let (query, tree) = (self.query(point, hint), &self.product.tree);
        let cut_off = self.limits.cut_off_mm;
        let sought = cut_off * (1.0 + ROOM);
        let hit = tree.nearest(&query, square(sought), self.pending, |_, _| 1.0);
        let clear = hit.map_or(sought, |hit| hit.on.distance_squared.sqrt());
        let room = clear - cut_off - ROUNDING * (clear + 1.0 / tree.shrink);
        let hit = hit.filter(|hit| hit.on.distance_squared <= square(cut_off));
        (self.gap_to(hit, &query, skin), room.max(0.0))
    }

    /// The gap of a point that is known to have no face within the cut-off.
    pub(crate) fn gap_beyond(&mut self, point: Vec3, skin: Option<Vec3>) -> Option<Gap> {
        self.far_inside(&self.product.tree.query(point), skin)
    }

    fn query(&self, point: Vec3, hint: Option<u32>) -> Query {
        let tree = &self.product.tree;
        let mut query = tree.query(point);
        query.start = hint
            .and_then(|t| tree.slots.get(t as usize).copied())
            .filter(|slot| *slot != u32::MAX);
        query
    }

    /// The gap of a point with its nearest face, if that is within the cut-off.
    fn gap_to(&mut self, hit: Option<Hit>, query: &Query, skin: Option<Vec3>) -> Option<Gap> {
        let (tree, sign) = (&self.product.tree, &self.product.sign);
        let Some(hit) = hit else {
            return self.far_inside(query, skin);
        };
        // With a skin normal, a sheet is seen from the side the skin is on; `poke` finds the skin that has come through it.
        let is_sheet = skin.is_some() && tree.faces[hit.slot as usize].is_sheet;
        if is_sheet || !sign.is_inside(tree, query.point, &hit) {
            return Some(self.product.reading(query, &hit, Side::Outside));
        }
        self.inside(query, skin, hit)
    }

    /// A point with no face within the cut-off is outside, or so deep inside that the search goes on in full.
    ///
    /// Skin in the hollow of a sheet may have come there through its wall, or through its opening; `sheet_side` tells which.
    fn far_inside(&mut self, query: &Query, skin: Option<Vec3>) -> Option<Gap> {
        if !self.product.holds_far(query, self.pending) {
            return self.far_in_hollow(query, skin);
        }
        let hit = self
            .product
            .tree
            .nearest(query, f64::INFINITY, self.pending, |_, _| 1.0)?;
        let is_sheet = skin.is_some() && self.product.tree.faces[hit.slot as usize].is_sheet;
        if is_sheet {
            None
        } else {
            self.inside(query, skin, hit)
        }
    }

    /// What skin in the hollow of a sheet reads of the sheet's wall, beyond the cut-off, as from outside.
    fn far_in_hollow(&mut self, query: &Query, skin: Option<Vec3>) -> Option<Gap> {
        let product = self.product;
        let is_hollow = |point| product.has_sheets() && product.winds_around(point);
        if skin.is_none() || !is_hollow(query.point + product.tree.center) {
            return None;
        }
        let reach = square(self.limits.max_depth_mm);
        let hit = product
            .tree
            .nearest(query, reach, self.pending, |_, _| 1.0)?;
        let is_sheet = product.tree.faces[hit.slot as usize].is_sheet;
        is_sheet.then(|| product.reading(query, &hit, Side::Outside))
    }

    /// The depth of a point inside, whose nearest face is `hit`.
    fn inside(&mut self, query: &Query, skin: Option<Vec3>, hit: Hit) -> Option<Gap> {
        let product = self.product;
        let tree = &product.tree;
        let plain = product.reading(query, &hit, Side::Inside);
        let skin = skin.filter(|m| *m != Vec3::zeros());
        let face = &tree.faces[hit.slot as usize];
        let outward = if product.is_sliver(face) {
            plain.normal
        } else {
            face.normal
        };
        let away = skin.map_or(0.0, |m| outward.dot(&m));
        if away <= 0.0 || self.turned == Turned::Nearest {
            return Some(plain);
        }
        let through = self.opposing(query, &skin?, TURNED_AWAY);
        let is_shallow = |gap: &Gap| -gap.distance <= self.limits.max_depth_mm;
        through
            .filter(|gap| is_shallow(gap) || away >= TURNED_AWAY)
            .or(Some(plain))
    }

    /// What a point inside reads of the walls that oppose the skin, or face less than `most` (cosine) as it does: the one with the least
    /// distance times reluctance.
    fn opposing(&mut self, query: &Query, skin: &Vec3, most: f64) -> Option<Gap> {
        let product = self.product;
        let tree = &product.tree;
        let may_lead_out = |face: &Face| face.normal.dot(skin) < most;
        let weigh = |face: &Face, _: &ClosestPoint| reluctance(face, skin);
        let choice = Choice {
            wanted: may_lead_out,
            weigh,
        };
        let through = tree.nearest_of(query, f64::INFINITY, self.pending, choice)?;
        Some(product.reading(query, &through, Side::Inside))
    }

    /// What a point inside reads if it has come through the wall that opposes its skin, no deeper than the limit.
    pub(crate) fn through(&mut self, point: Vec3, skin: &Vec3) -> Option<Gap> {
        let query = self.query(point, None);
        self.opposing(&query, skin, FACING_AWAY)
            .filter(|gap| -gap.distance <= self.limits.max_depth_mm)
    }
}

/// Weight of a face on squared distances, for a skin of outward normal `skin`: 1 where they oppose, infinite where they agree.
fn reluctance(face: &Face, skin: &Vec3) -> f64 {
    let away = face.normal.dot(skin);
    if away <= 0.0 {
        1.0
    } else if away >= TURNED_AWAY {
        f64::INFINITY
    } else {
        (1.0 - away / TURNED_AWAY).powi(-4)
    }
}

fn square(x: f64) -> f64 {
    x * x
}
