//! Depth of skin that lies beyond the middle of a wall, or has come out on its far side.
//!
//! The nearest wall of such a vertex faces the way of the skin. So it does in a crease, where a coarse skin's normals point anywhere, and at
//! the back of a finger whose pad presses the other side. What tells them apart is their neighborhood: walking over the skin from where it
//! plainly touches or enters the wall, the depth grows steadily up to the vertex that has come out, while it would have to jump to reach the
//! back. So a reading through a wall is accepted only if
//! 1. outside, the ray from the vertex into the finger meets the wall's far side, then its near side, within the deepest depth asked for;
//!    inside, a wall that opposes the skin lies within that depth, and
//! 2. at least two neighbors, whose reading is settled, are pushed the same way and to a depth that differs by no more than the way between
//!    (a signed distance grows by at most 1 mm a mm). Settled are readings found without this rule, and those it has accepted; or
//! 3. it is inside, or no deeper than skin yields, as many neighbors at least agree as speak against it, and flesh lies behind it as far as the wall, and as much beyond
//!    it (`flesh`): a flat skin pressed beyond the middle of a plate. From there on 2 goes on.
//!
//! A piece of skin that lies wholly behind a sheet, as all of a patch in a box without its lid, has no such neighbors: it is through where
//! the sheet winds around all of it. All else reads the nearest wall.
//!
//! What is accepted does not depend on the order of the vertices.

use crate::mesh::closest_point::ClosestPoint;
use crate::mesh::triangles::Vec3;
use crate::reading::facing::{PosedSkin, Sight, seen_and_away};
use crate::reading::flesh::Flesh;
use crate::reading::neighborhood::{Vicinity, spacing};
use crate::reading::opposing_wall::{Facing, Turned};
use crate::reading::sheet_side::read_by_side;
use crate::reading::unread_points::{Away, STEEPEST, WITNESSES, each, faces_alike};
use crate::solid::gap::flipped;
use crate::solid::gap::{Gap, GapLimits, Side};
use crate::solid::product::Product;
use crate::tree::face::Face;
use crate::tree::nearest::{Choice, Pending};

/// Cosine from which two readings push the same way.
const SAME_WAY: f64 = 0.5;

/// Depth to which a point outside, all of whose neighbors are outside as well, may have come through, mm: what skin yields before bone.
const THROUGH: f64 = 6.0;

/// A point that may have come through, with what it would read: through a wall, and through a sheet without thickness.
struct Candidate {
    at: u32,
    /// Whether it is still inside the wall.
    is_within: bool,
    plain: Option<Gap>,
    readings: [Option<Gap>; 2],
    neighbors: Vec<u32>,
}

/// Replaces the readings of points that have come through a wall; returns the points that may have, with what was read before.
///
/// `sights`: how each faces what it was measured to.
pub(crate) fn settle(
    product: &Product,
    skin: &PosedSkin<'_>,
    limits: GapLimits,
    (sights, gaps): (&[Sight], &mut [Option<Gap>]),
) -> Vec<(u32, Option<Gap>)> {
    let (seen, away) = seen_and_away(sights);
    if away.is_empty() {
        return Vec::new();
    }
    let places = (&away[..], spacing(skin, &away));
    let vicinity = Vicinity::new(skin.points, &seen, places);
    let mut is_settled = vec![false; gaps.len()];
    seen.iter().for_each(|&i| is_settled[i as usize] = true);
    away.iter().for_each(|&i| is_settled[i as usize] = false);
    let mut is_unread = vec![true; away.len()];
    let mut candidates = Vec::new();
    let (mut tested, mut has_grown) = (0, true);
    // Points that were read deeper make others agree.
    while has_grown {
        let is_within = |k: usize| sights[away[k] as usize] == Sight::Within;
        let unread = Away {
            vicinity: &vicinity,
            points: &away,
            is_unread: &is_unread,
        };
        let mut needed = unread.needed(skin, product, gaps);
        needed.extend((0..away.len()).filter(|&k| is_unread[k] && is_within(k)));
        needed.sort_unstable();
        needed.dedup();
        let read = |&k: &usize| {
            let at = away[k];
            let is_within = is_within(k);
            let reading = |gap| match is_within {
                true => [product.reading_within(skin, at as usize, limits), None],
                false => product.readings_through(skin, at as usize, gap, limits),
            };
            Candidate {
                at,
                is_within,
                plain: gaps[at as usize],
                readings: gaps[at as usize].as_ref().map_or([None; 2], reading),
                neighbors: neighbors(skin, &vicinity, at),
            }
        };
        let read = each(&needed, read);
        needed.iter().for_each(|&k| is_unread[k] = false);
        for candidate in read {
            if candidate.readings.iter().any(Option::is_some) {
                candidates.push(candidate);
            } else {
                is_settled[candidate.at as usize] = true;
            }
        }
        has_grown = grow(skin, &candidates, &mut is_settled, gaps);
        if !has_grown {
            has_grown = sink(skin, &candidates[tested..], (&mut is_settled, gaps));
            tested = candidates.len();
        }
    }
    candidates.sort_by_key(|c| c.at);
    enclose(product, skin, &candidates, (&is_settled, gaps));
    let mut before: Vec<(u32, Option<Gap>)> = candidates.iter().map(|c| (c.at, c.plain)).collect();
    if !product.has_sheets() {
        return before;
    }
    let mut plain = gaps.to_vec();
    candidates
        .iter()
        .for_each(|c| plain[c.at as usize] = c.plain);
    for (i, reading) in read_by_side(product, skin, limits, (&plain, gaps)) {
        if candidates.binary_search_by_key(&i, |c| c.at).is_err() {
            before.push((i, gaps[i as usize]));
        }
        gaps[i as usize] = Some(reading);
    }
    before
}

/// The points near a point whose skin faces the same way.
fn neighbors(skin: &PosedSkin<'_>, vicinity: &Vicinity, at: u32) -> Vec<u32> {
    let mut near = vicinity.around(at);
    near.retain(|&j| faces_alike(skin, at, j));
    near
}

/// Accepts candidates next to settled points, until no more can be; returns whether there were any.
fn grow(
    skin: &PosedSkin<'_>,
    candidates: &[Candidate],
    is_settled: &mut [bool],
    gaps: &mut [Option<Gap>],
) -> bool {
    let mut pending: Vec<usize> = (0..candidates.len())
        .filter(|&k| !is_settled[candidates[k].at as usize])
        .collect();
    let all = pending.len();
    while !pending.is_empty() {
        let before = pending.len();
        pending.retain(|&k| {
            let at = candidates[k].at as usize;
            let continues = |reading: &Gap, j: u32| {
                let other = gaps[j as usize].filter(|_| is_settled[j as usize]);
                other.is_some_and(|g| continues(skin, (at as u32, reading), (j, &g)))
            };
            let agreed = candidates[k].readings.iter().flatten().find(|reading| {
                candidates[k]
                    .neighbors
                    .iter()
                    .filter(|&&j| continues(reading, j))
                    .take(WITNESSES)
                    .count()
                    == WITNESSES
            });
            if let Some(reading) = agreed {
                gaps[at] = Some(*reading);
                is_settled[at] = true;
            }
            agreed.is_none()
        });
        if pending.len() == before {
            break;
        }
    }
    pending.len() < all
}

/// Accepts candidates inside that more neighbors agree with than speak against them, and that have flesh behind them as far as the wall and
/// as much beyond it; returns whether there were any.
///
/// Of points without triangles nothing is known of the flesh: those inside are taken to have come through.
fn sink(
    skin: &PosedSkin<'_>,
    candidates: &[Candidate],
    (is_settled, gaps): (&mut [bool], &mut [Option<Gap>]),
) -> bool {
    let mut open: Vec<(&Candidate, Gap)> = candidates
        .iter()
        .filter(|c| !is_settled[c.at as usize])
        .filter_map(|c| {
            let through = c.readings[0]?;
            let is_near = -through.distance <= THROUGH && skin.surface.is_some();
            (c.is_within || is_near).then_some((c, through))
        })
        .collect();
    open.sort_unstable_by_key(|(c, _)| c.at);
    if let Some(surface) = skin.surface {
        let agrees = |(c, reading): &(&Candidate, Gap)| {
            let (mut with, mut against) = (0, 0);
            for &j in &c.neighbors {
                let is_alike = |other: &Gap| continues(skin, (c.at, reading), (j, other));
                if is_settled[j as usize] {
                    let alike = gaps[j as usize].as_ref().is_some_and(is_alike);
                    (with, against) = (with + usize::from(alike), against + usize::from(!alike));
                } else if let Ok(k) = open.binary_search_by_key(&j, |(c, _)| c.at) {
                    with += usize::from(is_alike(&open[k].1));
                }
            }
            with >= WITNESSES && with >= against
        };
        let agreed: Vec<bool> = open.iter().map(agrees).collect();
        let mut agreed = agreed.into_iter();
        open.retain(|_| agreed.next() == Some(true));
        if open.is_empty() {
            return false;
        }
        let ways = open.iter().map(|(c, reading)| {
            let from = skin.points[c.at as usize];
            (from, reading.closest)
        });
        let ways: Vec<(Vec3, Vec3)> = ways.collect();
        let flesh = Flesh::new(skin.points, surface.triangles, &ways);
        let reaches = each(&open, |(c, reading)| flesh.reaches(c.at, reading.closest));
        let mut reaches = reaches.into_iter();
        open.retain(|_| reaches.next() == Some(true));
    }
    for (candidate, reading) in &open {
        gaps[candidate.at as usize] = Some(*reading);
        is_settled[candidate.at as usize] = true;
    }
    !open.is_empty()
}

/// Whether the readings of two points push the same way, to depths that differ by no more than the way between.
fn continues(skin: &PosedSkin<'_>, (i, own): (u32, &Gap), (j, other): (u32, &Gap)) -> bool {
    let apart = (skin.points[i as usize] - skin.points[j as usize]).norm();
    let grown = (other.distance - own.distance).abs();
    other.normal.dot(&own.normal) > SAME_WAY && grown <= STEEPEST * apart
}

/// Accepts pieces of skin that lie wholly behind a sheet which winds around all of them.
fn enclose(
    product: &Product,
    skin: &PosedSkin<'_>,
    candidates: &[Candidate],
    (is_settled, gaps): (&[bool], &mut [Option<Gap>]),
) {
    let mut seen = vec![false; candidates.len()];
    for start in 0..candidates.len() {
        if seen[start] || is_settled[candidates[start].at as usize] {
            continue;
        }
        seen[start] = true;
        let (mut piece, mut next, mut is_whole) = (vec![start], 0, true);
        while next < piece.len() {
            for other in &candidates[piece[next]].neighbors {
                match candidates.binary_search_by_key(other, |c| c.at) {
                    Ok(k) if !is_settled[*other as usize] => {
                        if !seen[k] {
                            seen[k] = true;
                            piece.push(k);
                        }
                    }
                    _ => is_whole = false,
                }
            }
            next += 1;
        }
        let is_behind = |k: &usize| {
            let at = candidates[*k].at as usize;
            candidates[*k].readings[1].is_some() && product.winds_around(skin.points[at])
        };
        // Fewer than a vertex and its witnesses are no piece of skin.
        if is_whole && piece.len() > WITNESSES && piece.iter().all(is_behind) {
            for k in piece {
                gaps[candidates[k].at as usize] = candidates[k].readings[1];
            }
        }
    }
}

impl Product {
    /// What a point inside would read if it had come through the wall that opposes its skin.
    fn reading_within(&self, skin: &PosedSkin<'_>, at: usize, limits: GapLimits) -> Option<Gap> {
        let mut pending = Pending::default();
        let how = (limits, Turned::Opposing);
        Facing::new(self, how, &mut pending).through(skin.points[at], &skin.normals[at])
    }

    /// What a point outside, whose plain gap is `gap`, would read if it had come through a wall, and if it had come through a sheet.
    fn readings_through(
        &self,
        skin: &PosedSkin<'_>,
        at: usize,
        gap: &Gap,
        limits: GapLimits,
    ) -> [Option<Gap>; 2] {
        let (query, normal) = (self.tree.query(skin.points[at]), skin.normals[at]);
        let mut pending = Pending::default();
        let crossings =
            self.tree
                .crossings(query.point, -normal, limits.max_depth_mm, &mut pending);
        let away = |slot: u32| self.tree.faces[slot as usize].normal.dot(&normal);
        let entry = crossings.iter().find(|(_, slot)| away(*slot) < 0.0);
        let comes_through = crossings.first().is_some_and(|(_, slot)| away(*slot) > 0.0);
        let wall = entry.filter(|_| comes_through).and_then(|&(reach, _)| {
            // The near side of the wall: faces that oppose the skin and have the point behind them.
            let is_near_side = |face: &Face| {
                face.normal.dot(&normal) < 0.0 && (query.point - face.a).dot(&face.normal) < 0.0
            };
            let limit = reach * reach * (1.0 + 1e-9);
            let choice = Choice {
                wanted: is_near_side,
                weigh: |_: &Face, _: &ClosestPoint| 1.0,
            };
            let hit = self.tree.nearest_of(&query, limit, &mut pending, choice);
            hit.map(|hit| self.reading(&query, &hit, Side::Inside))
        });
        let is_sheet = self.is_sheet_at(Some(gap));
        [
            wall,
            (is_sheet && !crossings.is_empty()).then(|| flipped(gap)),
        ]
    }
}
