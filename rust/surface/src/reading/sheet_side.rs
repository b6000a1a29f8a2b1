//! Which side of a sheet skin lies on.
//!
//! Skin that plainly faces a sheet from outside is where it should be, and so is skin far from all sheets. From the nearest of these on the
//! side is followed along the edges of the skin's mesh: it changes where an edge crosses a sheet, and nowhere else. So skin that goes around
//! the rim of a cup into it is outside, and skin that has come through its wall is not, wherever its normals point: at the rim of a contact
//! they are about tangent to the sheet. Where sheets enclose skin that came in both ways, the wall counts.

use std::collections::VecDeque;

use crate::mesh::triangles::Vec3;
use crate::reading::facing::PosedSkin;
use crate::solid::gap::flipped;
use crate::solid::gap::{Gap, GapLimits};
use crate::solid::product::Product;
use crate::tree::nearest::Pending;

/// Cosine between a sheet's outward direction and the skin's normal below which the skin plainly faces it.
const FACING: f64 = -0.7;

/// Cosine between the way out of a sheet and the normal of the deepest skin behind it below which that skin was not pushed through.
const PARALLEL: f64 = 0.7;

/// The same that every vertex of such a patch needs: so much for each mm of depth, and at most.
const TURN_PER_MM: f64 = 0.15;
const MOST_TURNED: f64 = 0.5;

/// Part of a way within which two crossings are one.
const ON_EDGE: f64 = 1e-9;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum SkinSide {
    Unknown,
    Outside,
    Through,
}

/// Reads the skin near sheets by its side; returns the vertices that then read otherwise, with what they read now.
///
/// `plain` (n): what each vertex reads of the nearest wall from outside. A skin whose surface is not known, and pieces of it that lie near
/// sheets with all their vertices, keep what they read.
pub(crate) fn read_by_side(
    product: &Product,
    skin: &PosedSkin<'_>,
    limits: GapLimits,
    (plain, gaps): (&[Option<Gap>], &[Option<Gap>]),
) -> Vec<(u32, Gap)> {
    let Some(surface) = skin.surface else {
        return Vec::new();
    };
    let of_sheet = |gap: &Gap| product.is_sheet(gap.triangle as usize);
    let near: Vec<Option<Gap>> = plain.iter().map(|gap| gap.filter(of_sheet)).collect();
    let mut side = vec![SkinSide::Unknown; near.len()];
    let mut pending = Pending::default();
    let mut crosses = |i: usize, j: usize| {
        let (from, to) = (skin.points[i], skin.points[j]);
        let is_near = near[j].is_some_and(|gap| gap.distance.abs() <= (to - from).norm());
        is_near && product.sheets_between(from, to, &mut pending) % 2 == 1
    };
    let faces_it = |&i: &usize| {
        let gap = near[i].as_ref();
        let is_plain = |gap: &Gap| gap.distance > 0.0 && gap.normal.dot(&skin.normals[i]) < FACING;
        // Skin deep in a hollow may face its other wall.
        gap.is_some_and(is_plain) && !product.winds_around(skin.points[i])
    };
    let is_beyond = |&i: &usize| {
        let around = surface.adjacency.neighbors(i);
        near[i].is_none() && around.iter().any(|&j| near[j as usize].is_some())
    };
    let is_known = |i: &usize| faces_it(i) || is_beyond(i);
    let mut queue: VecDeque<usize> = (0..near.len()).filter(is_known).collect();
    queue.iter().for_each(|&i| side[i] = SkinSide::Outside);
    let mut through = Vec::new();
    while let Some(i) = queue.pop_front() {
        for &j in surface.adjacency.neighbors(i) {
            let j = j as usize;
            if near[j].is_none() || side[j] != SkinSide::Unknown {
                continue;
            }
            side[j] = match (side[i], crosses(i, j)) {
                (SkinSide::Through, false) | (SkinSide::Outside, true) => SkinSide::Through,
                _ => SkinSide::Outside,
            };
            queue.push_back(j);
            if side[j] == SkinSide::Through {
                through.push(j);
            }
        }
    }
    // Skin that came in through a wall and, by another way, through an opening: where the sheets enclose it, the wall counts.
    through.retain(|&i| product.winds_around(skin.points[i]));
    while let Some(i) = through.pop() {
        for &j in surface.adjacency.neighbors(i) {
            let j = j as usize;
            let is_open = near[j].is_some() && side[j] == SkinSide::Outside;
            if is_open && product.winds_around(skin.points[j]) && !crosses(i, j) {
                side[j] = SkinSide::Through;
                through.push(j);
            }
        }
    }
    let is_cut = cut_patches(skin, &near, &side);
    let reads = |j: usize| {
        let gap = near[j].as_ref()?;
        let is_through = side[j] == SkinSide::Through
            && gap.distance <= limits.max_depth_mm
            && (!is_cut[j] || is_behind_its_flesh(gap, &skin.normals[j]));
        let reads = if is_through { flipped(gap) } else { *gap };
        let is_known = side[j] != SkinSide::Unknown;
        (is_known && gaps[j] != Some(reads)).then_some((j as u32, reads))
    };
    (0..near.len()).filter_map(reads).collect()
}

/// Marks the patches of skin that a rim has cut into (n): there, the skin goes on around the rim, and how far the patch reaches is chance.
///
/// Skin that was pushed through a sheet lies deepest where it is parallel to the sheet. Where it does not, the patch ends at the rim.
fn cut_patches(skin: &PosedSkin<'_>, near: &[Option<Gap>], side: &[SkinSide]) -> Vec<bool> {
    let mut is_cut = vec![false; side.len()];
    let mut is_seen = vec![false; side.len()];
    let Some(surface) = skin.surface else {
        return is_cut;
    };
    let depth = |i: usize| near[i].as_ref().map_or(0.0, |gap| gap.distance);
    for start in 0..side.len() {
        if side[start] != SkinSide::Through || is_seen[start] {
            continue;
        }
        is_seen[start] = true;
        let (mut patch, mut next) = (vec![start], 0);
        while let Some(&i) = patch.get(next) {
            next += 1;
            for &j in surface.adjacency.neighbors(i) {
                let j = j as usize;
                if side[j] == SkinSide::Through && !is_seen[j] {
                    is_seen[j] = true;
                    patch.push(j);
                }
            }
        }
        let deepest = patch
            .iter()
            .copied()
            .max_by(|&a, &b| depth(a).total_cmp(&depth(b)));
        let turned = |i: usize| {
            let gap = near[i].as_ref();
            gap.is_some_and(|gap| gap.normal.dot(&skin.normals[i]) < PARALLEL)
        };
        if deepest.is_some_and(turned) {
            patch.iter().for_each(|&i| is_cut[i] = true);
        }
    }
    is_cut
}

/// Whether the way back to the sheet leads into the flesh, the deeper the more squarely: skin far behind a cut would be drawn along itself.
fn is_behind_its_flesh(gap: &Gap, skin_normal: &Vec3) -> bool {
    let least = (TURN_PER_MM * gap.distance).min(MOST_TURNED);
    gap.normal.dot(skin_normal) >= least
}

impl Product {
    /// How often the way from one point to another crosses a sheet.
    fn sheets_between(&self, from: Vec3, to: Vec3, pending: &mut Pending) -> usize {
        let (way, start) = (to - from, self.tree.query(from).point);
        let Some(along) = way.try_normalize(0.0) else {
            return 0;
        };
        let crossings = self.tree.crossings(start, along, way.norm(), pending);
        let is_sheet = |slot: u32| self.tree.faces[slot as usize].is_sheet;
        let mut at: Vec<f64> = crossings
            .into_iter()
            .filter(|(_, slot)| is_sheet(*slot))
            .map(|(t, _)| t)
            .collect();
        at.dedup_by(|next, last| *next - *last <= ON_EDGE * way.norm()); // through an edge it meets both faces
        at.len()
    }
}
