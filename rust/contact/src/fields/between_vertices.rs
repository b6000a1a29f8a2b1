//! A product that passes between the vertices of the skin: a wire, the edge of a sheet, a corner. Contact is solved at vertices, so that
//! skin does not feel what none of them meets.
//!
//! First the readings are looked through for places where that may be: neighbors that see the product in opposite directions, and
//! vertices that have it behind them. Ordinary contacts have none. Only there is the product sampled, and its depth under the written
//! skin measured.

use std::collections::HashSet;

use thenar_surface::{Gap, GapLimits, Mesh, Product, Vec3, vertex_normals};

use super::warnings::Warning;
use crate::press::pressed::Pressed;
use crate::skin::prepare::Skin;
use crate::solve::Accuracy;

/// How near the product is to a vertex that may have missed it, in spacings of the skin.
const NEAR_SPACINGS: f64 = 1.5;
/// The same beyond the deepest skin, mm: next to a wire that some vertices have met, others have it as far behind them.
const BEYOND_DEPTH: f64 = 0.5;
/// How many vertices that have the product behind them are asked whether it lies under skin.
const MOST_ASKED: usize = 24;
/// Cosine between the ways to the product below which two neighbors see it from opposite sides.
const OPPOSITE: f64 = -0.1;
/// Cosine of the angle between a vertex's normal and its way back from the product above which it has the product behind it.
const BEHIND: f64 = 0.5;
/// Distance from which a vertex has a way back at all, mm.
const LEAST_DISTANCE: f64 = 0.05;
/// How far from such a vertex the product is sampled, mm.
const REACH: f64 = 6.0;
/// Skin beyond this from the samples is not looked at, mm: the far side of a finger.
const MARGIN: f64 = 10.0;
/// Distance between samples of the product, mm, and the most intervals along a side or across a triangle.
const SAMPLE_STEP: f64 = 0.7;
const MOST_STEPS: usize = 300;
/// Least cosine between the skin's normal and the way from a sample to it: past a rim of the skin nothing is beneath.
const BENEATH: f64 = 0.5;
/// Depth below the nearest vertices' tangent planes from which a sample is measured, as a share of what is worth a word; and for how many
/// pairs of samples and vertices that is faster.
const ROUGH_SHARE: f64 = 0.5;
const MOST_PAIRS: usize = 2_000_000;
/// Depth of the product under skin in contact that is worth a word, mm: flat triangles span less of a sharp edge.
const MOST_SPANNED: f64 = 1.0;
/// The same where nothing touches, mm.
const MOST_MISSED: f64 = 0.1;

/// The warning that the product lies under the skin between its vertices, and at which of them.
///
/// `displacement` by welded vertex, mm. Frames of Live are not searched: they show no grade, and `Solve` follows.
pub(super) fn product_between(
    skin: &Skin,
    product: &Product,
    pressed: &Pressed,
    displacement: &[Vec3],
) -> Option<Warning> {
    if pressed.accuracy == Accuracy::Rough {
        return None;
    }
    let detection = &pressed.detection;
    let within = (NEAR_SPACINGS * skin.spacing).max(detection.deepest() + BEYOND_DEPTH);
    let is_near = |v: &u32| detection.distances[*v as usize] < within && is_skin(skin, *v);
    let near: Vec<u32> = (0..detection.positions.len() as u32)
        .filter(is_near)
        .collect();
    let touches = pressed.solved.force.iter().any(|f| *f > 0.0);
    let place = Place {
        skin,
        normals: &detection.normals,
        before: &detection.positions,
        displacement,
        most: if touches { MOST_SPANNED } else { MOST_MISSED },
    };
    let suspects = place.suspects(&near, &detection.gaps, within);
    if suspects.is_empty() {
        return None;
    }
    let (depth, vertex) = place.deepest(product.mesh(), &suspects)?;
    (depth > place.most).then(|| Warning::ProductBetweenVertices {
        vertex: skin.merged.source[vertex as usize] as usize,
        depth,
        spacing: skin.spacing,
        touches,
    })
}

fn is_skin(skin: &Skin, v: u32) -> bool {
    skin.regions[skin.merged.source[v as usize] as usize] >= 0
}

/// The written skin, by welded vertex.
struct Place<'a> {
    skin: &'a Skin,
    /// Normals before the press.
    normals: &'a [Vec3],
    /// Positions before the press, mm.
    before: &'a [Vec3],
    displacement: &'a [Vec3],
    /// Depth that is worth a word, mm.
    most: f64,
}

impl Place<'_> {
    fn at(&self, v: u32) -> Vec3 {
        self.before[v as usize] + self.displacement[v as usize]
    }

    /// Vertices between which, or behind which, the product may lie, of those `near` it.
    fn suspects(&self, near: &[u32], gaps: &[Option<Gap>], within: f64) -> Vec<u32> {
        let skin = self.skin;
        let seen = |v: u32| {
            let gap = gaps[v as usize].as_ref();
            gap.filter(|gap| gap.distance < within && is_skin(skin, v))
        };
        let mut found = Vec::new();
        for &v in near {
            let Some(gap) = seen(v) else { continue };
            // A pair is looked at once.
            let later = skin.adjacency.neighbors(v as usize).iter();
            for &w in later.filter(|w| **w > v) {
                if seen(w).is_some_and(|other| gap.normal.dot(&other.normal) < OPPOSITE) {
                    found.extend([v, w]);
                }
            }
        }
        found.sort_unstable();
        found.dedup();
        let behind = |&v: &u32| {
            let gap = seen(v)?;
            let turned = gap.normal.dot(&self.normals[v as usize]);
            (gap.distance > LEAST_DISTANCE && turned > BEHIND).then_some((v, gap.closest))
        };
        let behind: Vec<(u32, Vec3)> = near.iter().filter_map(behind).collect();
        // Skin in creases and on the back of a finger has the product behind it as well, beyond other skin.
        let mut some = behind.iter().step_by(behind.len() / MOST_ASKED + 1);
        let near = if behind.is_empty() {
            Vec::new()
        } else {
            self.placed(near)
        };
        let is_under =
            |(_, place): &(u32, Vec3)| self.roughly(&near, *place) > ROUGH_SHARE * self.most;
        if some.any(is_under) {
            found.extend(behind.iter().map(|(v, _)| *v));
        }
        found
    }

    /// Vertices with their written places, mm.
    fn placed(&self, vertices: &[u32]) -> Vec<(u32, Vec3)> {
        vertices.iter().map(|&v| (v, self.at(v))).collect()
    }

    /// Least depth of a point below the tangent planes of the nearest three of some vertices, mm.
    fn roughly(&self, vertices: &[(u32, Vec3)], point: Vec3) -> f64 {
        let mut nearest = [(f64::INFINITY, 0usize); 3];
        for (index, (_, place)) in vertices.iter().enumerate() {
            let away = (place - point).norm_squared();
            if away < nearest[2].0 {
                nearest[2] = (away, index);
                nearest.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
            }
        }
        let found = nearest.iter().filter(|(away, _)| away.is_finite());
        let depths = found.map(|(_, index)| {
            let (v, place) = vertices[*index];
            (place - point).dot(&self.normals[v as usize])
        });
        depths.fold(f64::INFINITY, f64::min)
    }

    /// How deep the product lies under the written skin near `suspects`, mm, and the vertex there.
    fn deepest(&self, product: &Mesh, suspects: &[u32]) -> Option<(f64, u32)> {
        let (low, high) = bounds(suspects.iter().map(|v| self.at(*v)));
        let is_near = |p: &Vec3| {
            let mut away = suspects.iter().map(|v| (self.at(*v) - p).norm_squared());
            away.any(|squared| squared < REACH * REACH)
        };
        let within = |(low, high): (Vec3, Vec3), reach: f64| {
            (low.add_scalar(-reach), high.add_scalar(reach))
        };
        let mut samples = samples(product, within((low, high), REACH));
        samples.retain(is_near);
        let here = within((low, high), REACH + MARGIN);
        let count = self.before.len() as u32;
        let local: Vec<u32> = (0..count).filter(|v| contains(here, self.at(*v))).collect();
        if samples.len() * local.len() < MOST_PAIRS {
            let local = self.placed(&local);
            samples.retain(|p| self.roughly(&local, *p) > ROUGH_SHARE * self.most);
        }
        if samples.is_empty() {
            return None;
        }
        let here = within(bounds(samples.iter().copied()), MARGIN);
        let (surface, normals) = self.surface(here)?;
        let limits = GapLimits {
            cut_off_mm: MARGIN,
            max_depth_mm: MARGIN,
        };
        let depth_of = |(p, gap): (&Vec3, Option<Gap>)| {
            let gap = gap?;
            let corners = surface.mesh().triangles()[gap.triangle as usize];
            if !corners.iter().all(|v| is_skin(self.skin, *v)) {
                return None;
            }
            let weighted = corners.iter().zip(gap.barycentric);
            let normal: Vec3 = weighted.map(|(v, w)| normals[*v as usize] * w).sum();
            let depth = gap.distance.abs();
            let is_beneath = (gap.closest - p).dot(&normal) > BENEATH * depth * normal.norm();
            let weight = |k: &usize| gap.barycentric[*k];
            let nearest = (0..3).max_by(|a, b| weight(a).total_cmp(&weight(b)))?;
            is_beneath.then_some((depth, corners[nearest]))
        };
        // On which side of the skin a sample is says nothing here; deep in it the search goes on in full.
        let nearest = surface.nearest(&samples, MARGIN).into_iter();
        let gaps = samples.iter().zip(nearest);
        let gaps = gaps.map(|(p, gap)| (p, gap.or_else(|| surface.gap(*p, None, limits))));
        let depths = gaps.filter_map(depth_of);
        depths.max_by(|a, b| a.0.total_cmp(&b.0))
    }

    /// The written skin within a box, and its vertex normals.
    fn surface(&self, here: (Vec3, Vec3)) -> Option<(Product, Vec<Vec3>)> {
        let written: Vec<Vec3> = (0..self.before.len() as u32).map(|v| self.at(v)).collect();
        let is_here = |t: &&[u32; 3]| t.iter().any(|v| contains(here, written[*v as usize]));
        let triangles = self.skin.merged.mesh.triangles().iter();
        let triangles = triangles.filter(is_here).copied().collect();
        let surface = Mesh::new(written, triangles).ok()?;
        let normals = vertex_normals(&surface);
        Some((Product::new(surface).ok()?, normals))
    }
}

/// Points of the mesh within a box, about `SAMPLE_STEP` apart: rows along the longest side of each triangle, one point a cell.
fn samples(mesh: &Mesh, here: (Vec3, Vec3)) -> Vec<Vec3> {
    let (mut found, mut taken) = (Vec::new(), HashSet::new());
    let mut take = |point: Vec3| {
        let cell = (point / SAMPLE_STEP).map(|x| x.floor() as i64);
        if contains(here, point) && taken.insert([cell.x, cell.y, cell.z]) {
            found.push(point);
        }
    };
    for triangle in 0..mesh.triangles().len() {
        let corners = mesh.corners(triangle);
        let (least, most) = bounds(corners.into_iter());
        if (0..3).any(|k| least[k] > here.1[k] || most[k] < here.0[k]) {
            continue;
        }
        let length = |k: &usize| (corners[(k + 1) % 3] - corners[*k]).norm();
        let longest = (0..3).max_by(|i, j| length(i).total_cmp(&length(j)));
        let first = longest.unwrap_or(0);
        let [a, b, c] = [0, 1, 2].map(|k| corners[(first + k) % 3]);
        let side = (b - a).norm();
        let height = (b - a).cross(&(c - a)).norm() / side.max(f64::MIN_POSITIVE);
        let rows = steps(height);
        for row in 0..=rows {
            let up = row as f64 / rows as f64;
            let (from, to) = (a + (c - a) * up, b + (c - b) * up);
            let along = steps((to - from).norm());
            for step in 0..=along {
                take(from + (to - from) * (step as f64 / along as f64));
            }
        }
    }
    found
}

/// Intervals of at most `SAMPLE_STEP` along a length, mm.
fn steps(length: f64) -> usize {
    ((length / SAMPLE_STEP).ceil() as usize).clamp(1, MOST_STEPS)
}

fn contains((low, high): (Vec3, Vec3), point: Vec3) -> bool {
    (0..3).all(|k| (low[k]..=high[k]).contains(&point[k]))
}

fn bounds(points: impl Iterator<Item = Vec3>) -> (Vec3, Vec3) {
    let none = (Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY));
    points.fold(none, |(low, high), p| (low.inf(&p), high.sup(&p)))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;

    /// The cap of a rod, a fan of long thin triangles, and the same disc in even triangles: its area decides, not how it is cut.
    #[test]
    fn samples_are_as_many_as_the_area_has_room_for_and_leave_no_hole() {
        let (radius, sectors) = (30.0, 720u32);
        let rim = |k: u32| {
            let angle = std::f64::consts::TAU * f64::from(k) / f64::from(sectors);
            Vec3::new(radius * angle.cos(), radius * angle.sin(), 0.0)
        };
        let mut positions = vec![Vec3::zeros()];
        positions.extend((0..sectors).map(rim));
        let slice = |k: u32| [0, 1 + k, 1 + (k + 1) % sectors];
        let fan = Mesh::new(positions, (0..sectors).map(slice).collect()).unwrap();
        let everywhere = (Vec3::repeat(-100.0), Vec3::repeat(100.0));
        let found = samples(&fan, everywhere);
        let cells = std::f64::consts::PI * radius * radius / (SAMPLE_STEP * SAMPLE_STEP);
        assert!(
            (found.len() as f64) < 1.2 * cells,
            "{} for {cells}",
            found.len()
        );
        for k in 0..400 {
            let (away, turn) = (radius * f64::from(k) / 400.0, f64::from(k) * 2.4);
            let place = Vec3::new(away * turn.cos(), away * turn.sin(), 0.0);
            let nearest = found.iter().map(|p| (p - place).norm());
            assert!(nearest.fold(f64::INFINITY, f64::min) < 1.5 * SAMPLE_STEP);
        }
    }
}
