//! Depth of skin that has come out on the far side of a thin wall.
//!
//! Such a vertex is outside, and faces away from the wall; so does the back of a finger whose pad presses the other side. What tells them
//! apart is their neighborhood: walking over the skin from where it plainly touches or enters the wall, the depth grows steadily up to the
//! vertex that has come out, while it would have to jump to reach the back. So a reading through the wall is accepted only if
//! 1. the ray from the vertex into the finger meets the wall's far side, then its near side, within the deepest depth asked for, and
//! 2. at least two neighbors, whose reading is settled, are pushed the same way and to a depth that differs by no more than the way between
//!    (a signed distance grows by at most 1 mm a mm). Settled are readings found without this rule, and those it has accepted.
//!
//! A piece of skin that lies wholly behind a sheet, as all of a patch in a box without its lid, has no such neighbors: it is through where
//! the sheet winds around all of it.
//!
//! What is accepted does not depend on the order of the vertices.

use rayon::prelude::*;

use crate::mesh::Vec3;
use crate::nearest::Pending;
use crate::product::{Gap, GapLimits, Product, Side};
use crate::tree::Face;
use crate::triangle::ClosestPoint;
use crate::vicinity::Vicinity;

/// Cosine between skin normal and the product's outward direction from which a point outside may have come through. Tests pass from 0.1 to 0.5.
const FACING_AWAY: f64 = 0.3;

/// Cosine from which two readings push the same way.
const SAME_WAY: f64 = 0.5;

/// Growth of depth, mm a mm, that neighbors may show; 1 in a smooth field, and some for the corners of a product.
const STEEPEST: f64 = 1.1;

/// Settled neighbors needed, so that no vertex is judged by one other alone.
const WITNESSES: usize = 2;

/// Up to so many items are answered one after the other: to wake other threads takes as long.
const FEW: usize = 256;

/// Points of one query, with the skin's normals.
pub(crate) struct Skin<'a> {
    pub points: &'a [Vec3],
    pub normals: &'a [Vec3],
}

/// A point outside that may have come through, with what it would read: through a wall, and through a sheet without thickness.
struct Candidate {
    at: u32,
    plain: Option<Gap>,
    readings: [Option<Gap>; 2],
    neighbors: Vec<u32>,
}

/// Replaces the readings of points that have come through a wall; returns the points that may have, with what was read before.
///
/// `sights`: how each faces what it was measured to.
pub(crate) fn settle(
    product: &Product,
    skin: &Skin,
    limits: GapLimits,
    (sights, gaps): (&[Sight], &mut [Option<Gap>]),
) -> Vec<(u32, Option<Gap>)> {
    let (seen, away) = seen_and_away(sights);
    if away.is_empty() {
        return Vec::new();
    }
    let vicinity = Vicinity::new(skin.points, &seen, &away);
    let mut is_settled = vec![false; gaps.len()];
    seen.iter().for_each(|&i| is_settled[i as usize] = true);
    away.iter().for_each(|&i| is_settled[i as usize] = false);
    let mut is_unread = vec![true; away.len()];
    let mut candidates = Vec::new();
    let mut has_grown = true;
    // Points that were read deeper make others agree.
    while has_grown {
        let needed = needed(skin, (&vicinity, &away, &is_unread), (product, gaps));
        let read = |&k: &usize| {
            let at = away[k];
            let reading = |gap| product.readings_through(skin, at as usize, gap, limits);
            Candidate {
                at,
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
    }
    candidates.sort_by_key(|c| c.at);
    enclose(product, skin, &candidates, (&is_settled, gaps));
    candidates.iter().map(|c| (c.at, c.plain)).collect()
}

/// How skin faces what it was measured to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Sight {
    /// Nothing was within reach.
    Nothing,
    /// As skin does that is pressed.
    Toward,
    /// It is outside and faces away: it may have come through.
    Away,
}

impl Sight {
    /// Of a point with a skin normal and its gap.
    pub(crate) fn new(gap: Option<&Gap>, normal: &Vec3, limits: GapLimits) -> Sight {
        let Some(gap) = gap else {
            return Sight::Nothing;
        };
        let is_outside = gap.distance > 0.0 && gap.distance <= limits.max_depth_mm;
        if is_outside && gap.normal.dot(normal) > FACING_AWAY {
            Sight::Away
        } else {
            Sight::Toward
        }
    }
}

/// Points that have a reading, and those of them that face away from what they were measured to.
fn seen_and_away(sights: &[Sight]) -> (Vec<u32>, Vec<u32>) {
    let those = |wanted: fn(&Sight) -> bool| {
        let all = (0..).zip(sights).filter(|(_, sight)| wanted(sight));
        all.map(|(i, _)| i).collect()
    };
    (
        those(|sight| *sight != Sight::Nothing),
        those(|sight| *sight == Sight::Away),
    )
}

/// What `f` gives for each item, in order.
fn each<T: Sync, R: Send>(items: &[T], f: impl Fn(&T) -> R + Sync + Send) -> Vec<R> {
    if items.len() <= FEW {
        items.iter().map(f).collect()
    } else {
        items.par_iter().map(f).collect()
    }
}

/// Which of the points that face away to read next: those that some neighbors could agree with, as far as these are known.
///
/// Through a wall a point is at least as deep as it is now away, so that most are never read.
fn needed(
    skin: &Skin,
    (vicinity, away, is_unread): (&Vicinity, &[u32], &[bool]),
    (product, gaps): (&Product, &[Option<Gap>]),
) -> Vec<usize> {
    let gap = |i: u32| gaps[i as usize].as_ref();
    let distance = |i: u32| gap(i).map_or(f64::INFINITY, |g| g.distance);
    let (distances, deepest) = (vicinity.values(distance), STEEPEST * vicinity.reach());
    let least = vicinity.least_near(away, &distances);
    let may_be = |&k: &usize| {
        let is_deep = distance(away[k]) + least[k] <= deepest;
        is_unread[k] && (is_deep || product.is_sheet_at(gap(away[k])))
    };
    let may_be: Vec<usize> = (0..away.len()).filter(may_be).collect();
    let agreeing = |&k: &usize| {
        let (i, own) = (away[k], distance(away[k]));
        let agrees = |&j: &u32| {
            let apart = (skin.points[i as usize] - skin.points[j as usize]).norm();
            own + distance(j) <= STEEPEST * apart && faces_alike(skin, i, j)
        };
        let mut near = vicinity.around_where(i, &distances, |other| own + other <= deepest);
        near.retain(agrees);
        near
    };
    let found = each(&may_be, agreeing);
    let mut is_needed = vec![false; away.len()];
    for (k, agreeing) in may_be.into_iter().zip(found) {
        if agreeing.len() >= WITNESSES || product.is_sheet_at(gap(away[k])) {
            is_needed[k] = true;
            for other in agreeing {
                if let Ok(other) = away.binary_search(&other) {
                    is_needed[other] = is_unread[other];
                }
            }
        }
    }
    (0..away.len()).filter(|&k| is_needed[k]).collect()
}

/// The points near a point whose skin faces the same way.
fn neighbors(skin: &Skin, vicinity: &Vicinity, at: u32) -> Vec<u32> {
    let mut near = vicinity.around(at);
    near.retain(|&j| faces_alike(skin, at, j));
    near
}

/// Whether skin at two different points faces the same way, by and large.
fn faces_alike(skin: &Skin, i: u32, j: u32) -> bool {
    i != j && skin.normals[j as usize].dot(&skin.normals[i as usize]) > 0.0
}

/// Accepts candidates next to settled points, until no more can be; returns whether there were any.
fn grow(
    skin: &Skin,
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
                let apart = (skin.points[at] - skin.points[j as usize]).norm();
                other.is_some_and(|g| {
                    let grown = (g.distance - reading.distance).abs();
                    g.normal.dot(&reading.normal) > SAME_WAY && grown <= STEEPEST * apart
                })
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

/// Accepts pieces of skin that lie wholly behind a sheet which winds around all of them.
fn enclose(
    product: &Product,
    skin: &Skin,
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
    /// Whether a gap was measured to a sheet.
    fn is_sheet_at(&self, gap: Option<&Gap>) -> bool {
        let face = |g: &Gap| &self.tree.faces[self.tree.slots[g.triangle as usize] as usize];
        gap.is_some_and(|g| face(g).is_sheet)
    }

    /// What a point outside, whose plain gap is `gap`, would read if it had come through a wall, and if it had come through a sheet.
    fn readings_through(
        &self,
        skin: &Skin,
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
            let choice = (is_near_side, |_: &Face, _: &ClosestPoint| 1.0);
            let hit = self.tree.nearest_of(&query, limit, &mut pending, choice);
            hit.map(|hit| self.reading(&query, &hit, Side::Inside))
        });
        let is_sheet = self.is_sheet_at(Some(gap));
        let flipped = Gap {
            distance: -gap.distance,
            normal: -gap.normal,
            ..*gap
        };
        [wall, (is_sheet && !crossings.is_empty()).then_some(flipped)]
    }
}
