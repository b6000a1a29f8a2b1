//! Signed distances of points and of skin to a product.

use rayon::prelude::*;

use crate::mesh::triangles::Vec3;
use crate::reading::facing::{PosedSkin, Sight};
use crate::reading::opposing_wall::{Facing, Turned};
use crate::reading::through_walls::settle;
use crate::solid::gap::{Gap, GapLimits, Side, flipped};
use crate::solid::product::Product;
use crate::tree::nearest::Pending;

/// Points answered by one task.
const CHUNK: usize = 256;
/// Points that one thread measures in less than a millisecond: waking others is not worth it.
pub(crate) const FEW: usize = 2_048;

impl Product {
    /// Signed distance of one point, mm; `None` where it is outside and beyond the cut-off.
    ///
    /// `skin_normal` is the unit outward normal of the skin at the point. With it, the depth of a point inside is measured to the part of
    /// the surface that opposes the skin, so that a thin wall does not cut it short. Points outside read the plain distance: a single point
    /// has no neighbors that could show that it has come out on the far side; [`Product::gaps`] sees that.
    pub fn gap(&self, point: Vec3, skin_normal: Option<Vec3>, limits: GapLimits) -> Option<Gap> {
        let how = (limits, Turned::Opposing);
        Facing::new(self, how, &mut Pending::default()).gap(point, skin_normal, None)
    }

    /// Distances of many points, mm, whichever side they are on, with the nearest place of the surface as read from outside; `None` beyond the
    /// cut-off. Without the side, an open surface needs no winding number.
    pub fn nearest(&self, points: &[Vec3], cut_off_mm: f64) -> Vec<Option<Gap>> {
        let (mut pending, reach) = (Pending::default(), cut_off_mm.max(0.0).powi(2));
        let place = |point: &Vec3| {
            let query = self.tree.query(*point);
            let hit = self.tree.nearest(&query, reach, &mut pending, |_, _| 1.0)?;
            Some(self.reading(&query, &hit, Side::Outside))
        };
        points.iter().map(place).collect()
    }

    /// Signed distances of many points, as [`Product::gap`]; with skin normals also through thin walls, as far as the neighborhood agrees.
    ///
    /// `points` (n), mm; `skin_normals` (n), unit, outward from the skin, zero where there is none. A point that is not finite gives `None`.
    /// The same bits for any number of threads.
    pub fn gaps(
        &self,
        points: &[Vec3],
        skin_normals: Option<&[Vec3]>,
        limits: GapLimits,
    ) -> Vec<Option<Gap>> {
        let Some(normals) = skin_normals else {
            return self.gaps_along(points, None, limits, &[]);
        };
        self.gaps_of_skin(&PosedSkin::of_points(points, normals), limits)
    }

    /// Signed distances of the vertices of a posed skin, through thin walls as well: where skin has come through a wall, depth is measured to
    /// the side it came from (`poke`). A vertex that is not finite gives `None`. The same bits for any number of threads.
    pub fn gaps_of_skin(&self, skin: &PosedSkin<'_>, limits: GapLimits) -> Vec<Option<Gap>> {
        let how = (limits, Turned::Nearest);
        let mut gaps = self.read(skin.points, Some(skin.normals), how, &[]);
        let sights = gaps
            .iter()
            .zip(skin.normals)
            .map(|(gap, normal)| Sight::new(gap.as_ref(), normal, limits));
        let sights: Vec<Sight> = sights.collect();
        if sights.len() == gaps.len() {
            settle(self, skin, limits, (&sights, &mut gaps));
        }
        gaps
    }

    /// Signed distances of points that follow a wall they have met: depth is measured to the side of the product that opposes `facing`, the
    /// normals with which they met it (outward from the skin, unit, zero or missing where none is known).
    ///
    /// `hints` (n), indices into the triangles of [`Product::mesh`] to begin with, which only saves time; others, such as `u32::MAX`, and
    /// missing ones stand for none. Points outside that have come through a thin wall are recognized by their neighbors.
    pub fn gaps_along(
        &self,
        points: &[Vec3],
        facing: Option<&[Vec3]>,
        limits: GapLimits,
        hints: &[u32],
    ) -> Vec<Option<Gap>> {
        let mut gaps = self.read(points, facing, (limits, Turned::Opposing), hints);
        if let Some(normals) = facing.filter(|n| n.len() == points.len()) {
            let sight = |(gap, normal): (&mut Option<Gap>, &Vec3)| {
                match (Sight::new(gap.as_ref(), normal, limits), *gap) {
                    (Sight::Within, _) => Sight::Toward,
                    // The side of a sheet that was met is known: beyond it is through it.
                    (Sight::Away, Some(met)) if self.is_sheet(met.triangle as usize) => {
                        *gap = Some(flipped(&met));
                        Sight::Toward
                    }
                    (sight, _) => sight,
                }
            };
            let sights: Vec<Sight> = gaps.iter_mut().zip(normals).map(sight).collect();
            let skin = PosedSkin::of_points(points, normals);
            settle(self, &skin, limits, (&sights, &mut gaps));
        }
        gaps
    }

    /// What each point reads alone.
    fn read(
        &self,
        points: &[Vec3],
        skin_normals: Option<&[Vec3]>,
        how: (GapLimits, Turned),
        hints: &[u32],
    ) -> Vec<Option<Gap>> {
        let mut gaps = vec![None; points.len()];
        let parts = gaps.chunks_mut(CHUNK).enumerate();
        deal(parts, points.len() < FEW, |(chunk, out)| {
            let mut pending = Pending::default();
            let mut facing = Facing::new(self, how, &mut pending);
            let mut last = None;
            for (k, gap) in out.iter_mut().enumerate() {
                let i = chunk * CHUNK + k;
                let hint = hints.get(i).copied().filter(|t| *t != u32::MAX).or(last);
                *gap = facing.gap(
                    points[i],
                    skin_normals.and_then(|n| n.get(i).copied()),
                    hint,
                );
                // Neighbors in the list tend to be neighbors in space.
                last = gap.map(|g| g.triangle).or(last);
            }
        });
        gaps
    }
}

/// Calls `work` with every part: in turn where there is little to do, else on several threads.
pub(crate) fn deal<T: Send>(
    parts: impl Iterator<Item = T>,
    is_little: bool,
    work: impl Fn(T) + Sync + Send,
) {
    if is_little {
        parts.for_each(work);
    } else {
        parts.collect::<Vec<T>>().into_par_iter().for_each(work);
    }
}
