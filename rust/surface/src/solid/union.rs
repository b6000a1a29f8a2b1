//! The outer boundary of parts that touch, overlap or hold each other: faces, or pieces of faces, with solid on both sides are left out.

use rayon::prelude::*;

use crate::mesh::audit::{find, join};
use crate::mesh::closest_point::closest_point;
use crate::mesh::triangles::{Mesh, Vec3, is_flat};
use crate::solid::orientation::{Oriented, Part};
use crate::tree::bvh::{Source, Tree};
use crate::tree::winding_number::{Counted, Winding};

/// From so many others that meet a face, it is cut in four before it is cut along them. 16 to 256 serve.
const MANY: usize = 48;

/// How often a face is cut in four, at most.
const DEEPEST: usize = 10;

/// Part of what counts as no distance by which a corner may be beyond a cut. 0.1 to 0.5 serve.
const CUT: f64 = 0.25;

/// Cosine from which two faces on one plane are turned alike.
const ALIKE: f64 = 0.99;

/// What there is to know of a product whose parts may meet.
struct Parts<'a> {
    oriented: &'a Oriented,
    tree: &'a Tree,
    winding: Winding,
    part_of: Vec<u32>,
    /// By part, the parts whose boxes meet its own.
    adjacent: Vec<Vec<u32>>,
}

/// The faces that bound the union of all parts, those that lie partly within another part cut; `None` if all do as they are.
///
/// `tree` is over `sources`. A sheet has no inside: of it stays what is outside of all solids.
pub(crate) fn boundary(
    oriented: &Oriented,
    tree: &Tree,
    sources: &[Source],
) -> Option<Vec<Source>> {
    let adjacent = adjacent(&oriented.parts, oriented.thin);
    if adjacent.iter().all(Vec::is_empty) {
        return None;
    }
    let mut part_of = vec![u32::MAX; oriented.welded.len()];
    for (p, part) in oriented.parts.iter().enumerate() {
        part.triangles.iter().for_each(|&t| part_of[t] = p as u32);
    }
    let winding = Winding::of(tree, Counted::Bodies);
    let parts = Parts {
        oriented,
        tree,
        winding,
        part_of,
        adjacent,
    };
    let meets: Vec<Vec<u32>> = sources.par_iter().map(|s| parts.meets(s)).collect();
    let is_bare = parts.bare(sources, &meets);
    let pieces: Vec<Vec<Source>> = sources
        .par_iter()
        .zip(&meets)
        .zip(&is_bare)
        .map(|((source, meets), is_bare)| match is_bare {
            Some(true) => vec![*source],
            Some(false) => Vec::new(),
            None => parts.bare_pieces(source, meets),
        })
        .collect();
    let is_whole = |pieces: &Vec<Source>| pieces.len() == 1 && pieces[0].piece_of.is_none();
    if pieces.iter().all(is_whole) {
        return None;
    }
    Some(pieces.into_iter().flatten().collect())
}

/// By part, the parts whose boxes meet its own, by a sweep along x.
fn adjacent(parts: &[Part], thin: f64) -> Vec<Vec<u32>> {
    let mut order: Vec<usize> = (0..parts.len()).collect();
    order.sort_by(|&a, &b| parts[a].low.x.total_cmp(&parts[b].low.x));
    let mut adjacent = vec![Vec::new(); parts.len()];
    for (i, &a) in order.iter().enumerate() {
        for &b in &order[i + 1..] {
            if parts[b].low.x > parts[a].high.x + thin {
                break;
            }
            if boxes_meet(
                [parts[a].low, parts[a].high],
                [parts[b].low, parts[b].high],
                thin,
            ) {
                adjacent[a].push(b as u32);
                adjacent[b].push(a as u32);
            }
        }
    }
    adjacent
}

fn boxes_meet(a: [Vec3; 2], b: [Vec3; 2], thin: f64) -> bool {
    (0..3).all(|k| a[0][k] <= b[1][k] + thin && b[0][k] <= a[1][k] + thin)
}

fn box_of(corners: &[Vec3]) -> [Vec3; 2] {
    let first = corners[0];
    corners
        .iter()
        .fold([first, first], |[low, high], p| [low.inf(p), high.sup(p)])
}

fn normal_of([a, b, c]: [Vec3; 3]) -> Vec3 {
    (b - a).cross(&(c - a)).normalize()
}

impl Parts<'_> {
    fn mesh(&self) -> &Mesh {
        &self.oriented.mesh
    }

    /// Faces of other parts that may touch a face.
    fn meets(&self, source: &Source) -> Vec<u32> {
        let own = self.part_of[source.id as usize];
        let thin = self.oriented.thin;
        let [low, high] = box_of(&source.corners);
        let is_near = |p: &u32| {
            let part = &self.oriented.parts[*p as usize];
            boxes_meet([low, high], [part.low, part.high], thin)
        };
        if own == u32::MAX || !self.adjacent[own as usize].iter().any(is_near) {
            return Vec::new();
        }
        let wide = [low - Vec3::repeat(thin), high + Vec3::repeat(thin), low];
        let mut found = Vec::new();
        self.tree.overlapping(&wide, &mut found);
        found.retain(|&t| {
            let part = self.part_of[t as usize];
            let other = self.mesh().corners(t as usize);
            part != own && part != u32::MAX && may_touch(&source.corners, &other, thin)
        });
        found.sort_unstable();
        found
    }

    /// For each face that meets no other part, whether it bounds the union; all that are joined over such faces are alike.
    fn bare(&self, sources: &[Source], meets: &[Vec<u32>]) -> Vec<Option<bool>> {
        let mut is_free = vec![false; self.part_of.len()];
        for (source, meets) in sources.iter().zip(meets) {
            is_free[source.id as usize] = meets.is_empty();
        }
        let mut root: Vec<u32> = (0..self.part_of.len() as u32).collect();
        for pair in self.oriented.sides.chunk_by(|a, b| a.edge == b.edge) {
            if let [a, b] = pair
                && [a, b].iter().all(|s| is_free[s.triangle as usize])
                && self.part_of[a.triangle as usize] == self.part_of[b.triangle as usize]
            {
                join(&mut root, a.triangle, b.triangle);
            }
        }
        let mut known: Vec<Option<bool>> = vec![None; root.len()];
        let mut sorted = Vec::with_capacity(sources.len());
        for (source, meets) in sources.iter().zip(meets) {
            let own = self.part_of[source.id as usize];
            let is_alone = own == u32::MAX || self.adjacent[own as usize].is_empty();
            sorted.push(if is_alone {
                Some(true)
            } else if !meets.is_empty() {
                None
            } else {
                let first = find(&mut root, source.id) as usize;
                Some(*known[first].get_or_insert_with(|| self.is_bare(source, meets)))
            });
        }
        sorted
    }

    /// Whether a face, or a piece of one, that nothing crosses is part of the union's boundary.
    fn is_bare(&self, source: &Source, meets: &[u32]) -> bool {
        let middle = source.corners.iter().sum::<Vec3>() / 3.0;
        let normal = source.piece_of.unwrap_or_else(|| normal_of(source.corners));
        let winds = |side: f64| {
            let at = middle + normal * (side * self.oriented.thin) - self.tree.center;
            self.winding.number(self.tree, at)
        };
        let (ahead, behind) = (winds(1.0), winds(-1.0));
        if source.is_sheet {
            return ahead <= 0.5 && behind <= 0.5;
        }
        // Of faces that lie on each other and are turned alike, that of the first part stays.
        let is_first = || {
            meets.iter().all(|&t| {
                let other = self.mesh().corners(t as usize);
                let is_before = self.part_of[t as usize] < self.part_of[source.id as usize];
                let is_body = !self.oriented.is_sheet[t as usize];
                !is_before
                    || !is_body
                    || normal_of(other).dot(&normal) < ALIKE
                    || closest_point(other, middle).distance_squared > square(self.oriented.thin)
            })
        };
        ahead <= 0.5 && behind > 0.5 && is_first()
    }

    /// What of a face bounds the union: all of it as it is, or pieces.
    fn bare_pieces(&self, source: &Source, meets: &[u32]) -> Vec<Source> {
        let normal = normal_of(source.corners);
        let pieces = self.cut(&source.corners, (meets, normal), 0);
        let all = pieces.len();
        let piece = |corners: [Vec3; 3]| Source {
            corners,
            piece_of: Some(normal),
            ..*source
        };
        let mut bare: Vec<Source> = Vec::with_capacity(all);
        for polygon in pieces {
            let fan: Vec<Source> = (1..polygon.len() - 1)
                .map(|k| piece([polygon[0], polygon[k], polygon[k + 1]]))
                .filter(|s| !is_flat(s.corners))
                .collect();
            let area = |s: &Source| {
                let [a, b, c] = s.corners;
                (b - a).cross(&(c - a)).norm()
            };
            let largest = fan.iter().max_by(|a, b| area(a).total_cmp(&area(b)));
            if largest.is_some_and(|largest| self.is_bare(largest, meets)) {
                bare.extend(fan);
            } else if largest.is_some() {
                bare.push(Source {
                    id: u32::MAX,
                    ..*source
                });
            }
        }
        let before = bare.len();
        bare.retain(|s| s.id != u32::MAX);
        if before == bare.len() && before > 0 {
            return vec![*source];
        }
        bare
    }

    /// Cuts a convex polygon along all that crosses it or ends on it.
    fn cut(
        &self,
        polygon: &[Vec3],
        (meets, normal): (&[u32], Vec3),
        depth: usize,
    ) -> Vec<Vec<Vec3>> {
        let thin = self.oriented.thin;
        if let (&[a, b, c], true) = (polygon, meets.len() > MANY && depth < DEEPEST) {
            let [ab, bc, ca] = [(a + b) / 2.0, (b + c) / 2.0, (c + a) / 2.0];
            let mut pieces = Vec::new();
            for quarter in [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]] {
                let touches =
                    |t: &u32| may_touch(&quarter, &self.mesh().corners(*t as usize), thin);
                let near: Vec<u32> = meets.iter().copied().filter(touches).collect();
                pieces.extend(self.cut(&quarter, (&near, normal), depth + 1));
            }
            return pieces;
        }
        let mut cut = vec![polygon.to_vec()];
        for &t in meets {
            let other = self.mesh().corners(t as usize);
            for line in lines(&polygon[0], &normal, &other, thin) {
                let whole = std::mem::take(&mut cut);
                whole
                    .into_iter()
                    .for_each(|piece| split(piece, &line, (&normal, CUT * thin), &mut cut));
            }
        }
        cut
    }
}

/// Whether two triangles may come within `thin` of each other: neither their boxes nor their planes part them.
pub(crate) fn may_touch(a: &[Vec3; 3], b: &[Vec3; 3], thin: f64) -> bool {
    let parts = |a: &[Vec3; 3], b: &[Vec3; 3]| {
        let normal = normal_of(*a);
        let off = b.map(|p| normal.dot(&(p - a[0])));
        off.iter().all(|d| *d > thin) || off.iter().all(|d| *d < -thin)
    };
    boxes_meet(box_of(a), box_of(b), thin) && !parts(a, b) && !parts(b, a)
}

/// Where a triangle meets the plane through `on`: its edges if it lies in it, else the line on which it crosses.
fn lines(on: &Vec3, normal: &Vec3, other: &[Vec3; 3], thin: f64) -> Vec<[Vec3; 2]> {
    let off = other.map(|p| normal.dot(&(p - on)));
    let next = |k: usize| (k + 1) % 3;
    if off.iter().all(|d| d.abs() <= thin) {
        return (0..3).map(|k| [other[k], other[next(k)]]).collect();
    }
    let mut ends: Vec<Vec3> = Vec::with_capacity(4);
    for k in 0..3 {
        let (from, to) = (off[k], off[next(k)]);
        if (from < 0.0) != (to < 0.0) {
            ends.push(other[k] + (other[next(k)] - other[k]) * (from / (from - to)));
        }
    }
    ends.chunks_exact(2).map(|c| [c[0], c[1]]).collect()
}

/// Cuts a convex polygon in two along a line within its plane that passes through it.
fn split(
    polygon: Vec<Vec3>,
    [from, to]: &[Vec3; 2],
    (normal, slack): (&Vec3, f64),
    pieces: &mut Vec<Vec<Vec3>>,
) {
    let Some(across) = normal.cross(&(to - from)).try_normalize(slack) else {
        pieces.push(polygon);
        return;
    };
    let off: Vec<f64> = polygon.iter().map(|p| across.dot(&(p - from))).collect();
    let is_clear = off.iter().all(|d| *d >= -slack) || off.iter().all(|d| *d <= slack);
    if is_clear || !reaches(&polygon, &[*from, *to], normal, slack) {
        pieces.push(polygon);
        return;
    }
    let (mut left, mut right) = (Vec::new(), Vec::new());
    for (k, p) in polygon.iter().enumerate() {
        let next = (k + 1) % polygon.len();
        if off[k] >= -slack {
            left.push(*p);
        }
        if off[k] <= slack {
            right.push(*p);
        }
        let is_crossed =
            (off[k] > slack && off[next] < -slack) || (off[k] < -slack && off[next] > slack);
        if is_crossed {
            let between = p + (polygon[next] - p) * (off[k] / (off[k] - off[next]));
            left.push(between);
            right.push(between);
        }
    }
    pieces.extend([left, right].into_iter().filter(|piece| piece.len() > 2));
}

/// Whether a line runs through the inside of a convex polygon of its plane.
fn reaches(polygon: &[Vec3], [from, to]: &[Vec3; 2], normal: &Vec3, slack: f64) -> bool {
    let (mut first, mut last) = (0.0f64, 1.0f64);
    for (k, a) in polygon.iter().enumerate() {
        let side = polygon[(k + 1) % polygon.len()] - a;
        let Some(inward) = normal.cross(&side).try_normalize(0.0) else {
            continue;
        };
        let (begin, end) = (
            inward.dot(&(from - a)) - slack,
            inward.dot(&(to - a)) - slack,
        );
        match (begin < 0.0, end < 0.0) {
            (true, true) => return false,
            (true, false) => first = first.max(begin / (begin - end)),
            (false, true) => last = last.min(begin / (begin - end)),
            (false, false) => {}
        }
    }
    (last - first) * (to - from).norm() > slack
}

fn square(x: f64) -> f64 {
    x * x
}
