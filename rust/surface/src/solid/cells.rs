//! Rooms of a surface whose edges join more than two triangles: which triangles bound solid, and which stand within it.

use std::f64::consts::TAU;

use crate::mesh::audit::{cone_volumes, find, join};
use crate::mesh::edges::Side;
use crate::mesh::triangles::{Mesh, Vec3};

/// Angle, rad, below which triangles about an edge lie on each other. Rounding of coordinates tilts triangles by less; 1e-9 to 1e-4 serve.
const SAME_ANGLE: f64 = 1e-6;

/// What a triangle of such a surface is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Verdict {
    /// It is not of such a surface, or its rooms could not be identified.
    Unknown,
    /// Solid of this body is on one side.
    Bounds { body: u32, is_inward: bool },
    /// Solid on both sides.
    Within,
    /// Solid on neither side.
    Fin,
}

/// One side of the triangles around an edge of a room: half of a node of the union-find.
fn front(triangle: u32) -> u32 {
    2 * triangle
}

fn back(triangle: u32) -> u32 {
    2 * triangle + 1
}

/// What is known of one room.
#[derive(Debug, Clone, Copy)]
struct Room {
    /// mm3; that of the outside is negative.
    volume: f64,
    area: f64,
    shows_backs: bool,
    borders_outside: bool,
}

/// Verdicts on all triangles. `all` are the sides of those that join, and `before` holds them with their vertices welded.
///
/// Around every edge the triangles are sorted by angle; sides that face each other bound the same room (as Zhou et al. 2016 build cells). Every
/// room that is not the outside is solid, however its triangles are turned; but a room that sees fronts only, apart from the outside, is
/// a cavity. `thin` (mm): a room that is not thicker is solid, as between two walls that lie on each other.
pub(crate) fn verdicts(before: &Mesh, all: &[Side], thin: f64) -> Vec<Verdict> {
    let triangles = before.triangles();
    let mut verdicts = vec![Verdict::Unknown; triangles.len()];
    if all.chunk_by(same_edge).all(|g| g.len() <= 2) {
        return verdicts;
    }
    let mut patch: Vec<u32> = (0..triangles.len() as u32).collect();
    let mut piece = patch.clone();
    let mut rooms: Vec<u32> = (0..2 * triangles.len() as u32).collect();
    for group in all.chunk_by(same_edge) {
        group
            .iter()
            .for_each(|s| join(&mut piece, group[0].triangle, s.triangle));
        if let [a, b] = group {
            join(&mut patch, a.triangle, b.triangle);
        }
    }
    let mut is_branched = vec![false; triangles.len()];
    for group in all.chunk_by(same_edge) {
        if let [alone] = group {
            join(&mut rooms, front(alone.triangle), back(alone.triangle));
        }
        let order = around(before, group, &mut patch);
        for (k, ahead) in order.iter().enumerate().filter(|_| group.len() > 1) {
            let behind = order[(k + 1) % order.len()];
            let from = if ahead.ascends { front } else { back };
            let to = if behind.ascends { back } else { front };
            join(&mut rooms, from(ahead.triangle), to(behind.triangle));
        }
        if group.len() > 2 {
            is_branched[find(&mut piece, group[0].triangle) as usize] = true;
        }
    }
    let members: Vec<u32> = all
        .iter()
        .filter(|s| s.side == 0)
        .map(|s| s.triangle)
        .filter(|&t| is_branched[find(&mut piece, t) as usize])
        .collect();
    let plan = Plan {
        before,
        members,
        piece,
        rooms,
    };
    plan.judge(thin, &mut verdicts);
    verdicts
}

struct Plan<'a> {
    before: &'a Mesh,
    /// Triangles of branched pieces.
    members: Vec<u32>,
    piece: Vec<u32>,
    rooms: Vec<u32>,
}

impl Plan<'_> {
    fn judge(mut self, thin: f64, verdicts: &mut [Verdict]) {
        let members = std::mem::take(&mut self.members);
        let mut rooms = vec![None; self.rooms.len()];
        let cones = cone_volumes(self.before);
        for &t in &members {
            let [a, b, c] = self.before.corners(t as usize);
            let area = (b - a).cross(&(c - a)).norm() / 2.0;
            for (side, sign) in [(front(t), -1.0), (back(t), 1.0)] {
                let room = rooms[find(&mut self.rooms, side) as usize].get_or_insert(Room {
                    volume: 0.0,
                    area: 0.0,
                    shows_backs: false,
                    borders_outside: false,
                });
                room.volume += sign * cones(t as usize);
                room.area += area;
                room.shows_backs |= sign > 0.0;
            }
        }
        let outside = self.outsides(&members, &rooms);
        let is_outside = |plan: &mut Self, t: u32, side: u32| {
            outside[find(&mut plan.piece, t) as usize] == find(&mut plan.rooms, side)
        };
        for &t in &members {
            for (side, across) in [(front(t), back(t)), (back(t), front(t))] {
                if is_outside(&mut self, t, across) {
                    let room = find(&mut self.rooms, side) as usize;
                    rooms[room]
                        .iter_mut()
                        .for_each(|r: &mut Room| r.borders_outside = true);
                }
            }
        }
        // Pieces whose rooms do not add up, as where they pass through themselves, are left as they are.
        let mut is_certain = vec![true; self.piece.len()];
        for &t in &members {
            let piece = find(&mut self.piece, t) as usize;
            for side in [front(t), back(t)] {
                let room = find(&mut self.rooms, side);
                let volume = rooms[room as usize].map_or(0.0, |r| r.volume + thin * r.area);
                is_certain[piece] &= room == outside[piece] || volume >= 0.0;
            }
            let around = rooms[outside[piece] as usize];
            is_certain[piece] &= around.is_some_and(|r| r.volume < -thin * r.area);
        }
        let is_solid = |plan: &mut Self, t: u32, side: u32| {
            let room = rooms[find(&mut plan.rooms, side) as usize];
            let is_cavity = room
                .is_some_and(|r| !r.shows_backs && !r.borders_outside && r.volume > thin * r.area);
            !is_outside(plan, t, side) && !is_cavity
        };
        let mut body: Vec<u32> = (0..self.rooms.len() as u32).collect();
        let mut both = Vec::with_capacity(members.len());
        for &t in members.iter() {
            let solid = [front(t), back(t)].map(|side| is_solid(&mut self, t, side));
            if solid == [true, true] {
                let sides = [front(t), back(t)].map(|side| find(&mut self.rooms, side));
                join(&mut body, sides[0], sides[1]);
            }
            both.push(solid);
        }
        for (&t, [ahead, behind]) in members.iter().zip(both) {
            if !is_certain[find(&mut self.piece, t) as usize] {
                continue;
            }
            let side = if ahead { front(t) } else { back(t) };
            let room = find(&mut self.rooms, side);
            verdicts[t as usize] = match (ahead, behind) {
                (true, true) => Verdict::Within,
                (false, false) => Verdict::Fin,
                _ => Verdict::Bounds {
                    body: find(&mut body, room),
                    is_inward: ahead,
                },
            };
        }
    }

    /// By first triangle of a piece, its outside: the room of least volume.
    fn outsides(&mut self, members: &[u32], rooms: &[Option<Room>]) -> Vec<u32> {
        let mut outside = vec![u32::MAX; self.piece.len()];
        let volume = |room: u32| rooms[room as usize].map_or(0.0, |r| r.volume);
        for &t in members {
            let least = &mut outside[find(&mut self.piece, t) as usize];
            for side in [front(t), back(t)] {
                let room = find(&mut self.rooms, side);
                if *least == u32::MAX || volume(room) < volume(*least) {
                    *least = room;
                }
            }
        }
        outside
    }
}

fn same_edge(a: &Side, b: &Side) -> bool {
    a.edge == b.edge
}

/// The sides of an edge by angle about it, from its lower to its higher vertex.
///
/// Of triangles that lie on each other, those that face one another come so that nothing is between their fronts; those turned alike in the
/// order of their patches, so that all edges of two patches agree.
fn around(before: &Mesh, group: &[Side], patch: &mut [u32]) -> Vec<Side> {
    if group.len() < 3 {
        return group.to_vec();
    }
    let [from, to] = group[0].edge.map(|i| before.positions()[i as usize]);
    let along = (to - from).try_normalize(0.0).unwrap_or_default();
    let arm = |s: &Side| {
        let tip = before.triangles()[s.triangle as usize][(s.side as usize + 2) % 3];
        let arm = before.positions()[tip as usize] - from;
        (arm - along * along.dot(&arm)).try_normalize(0.0)
    };
    let right = group.iter().find_map(arm).unwrap_or_default();
    let up = along.cross(&right);
    let angle = |s: &Side| {
        let arm: Vec3 = arm(s).unwrap_or_default();
        // The first one and all that lie on it come first, whatever rounding says.
        let angle = arm.dot(&up).atan2(arm.dot(&right)).rem_euclid(TAU);
        if angle > TAU - SAME_ANGLE { 0.0 } else { angle }
    };
    let mut order: Vec<(f64, Side)> = group.iter().map(|s| (angle(s), *s)).collect();
    order.sort_by(|a, b| a.0.total_cmp(&b.0));
    for same in order.chunk_by_mut(|a, b| b.0 - a.0 < SAME_ANGLE) {
        same.sort_by_key(|(_, s)| {
            let patch = find(patch, s.triangle);
            let rank = if s.ascends { patch } else { u32::MAX - patch };
            (!s.ascends, rank)
        });
    }
    order.into_iter().map(|(_, s)| s).collect()
}
