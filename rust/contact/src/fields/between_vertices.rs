//! A product that passes between the vertices of the skin: a wire, the edge of a sheet, a corner. Contact is solved at vertices, so that
//! skin does not feel what none of them meets.
//!
//! First the readings are looked through for places where that may be: neighbors that see the product in opposite directions, and
//! vertices that have it behind them. Ordinary contacts have none. Only there is the product sampled, and its depth under the written
//! skin measured.

use thenar_surface::{Gap, GapLimits, Mesh, Product, Vec3};

use super::warnings::Warning;
use crate::press::pressed::Pressed;
use crate::skin::prepare::Skin;

/// How near the product is to a vertex that may have missed it, in spacings of the skin.
const NEAR_SPACINGS: f64 = 1.5;
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
/// Distance between samples of the product, mm, and the most intervals along one side of a triangle.
const SAMPLE_STEP: f64 = 0.7;
const MOST_STEPS: usize = 300;
/// Least cosine between the skin's normal and the way from a sample to it: beside a rim of the skin nothing is beneath.
const BENEATH: f64 = 0.5;
/// Depth of the product under skin in contact that is worth a word, mm: flat triangles span less of a sharp edge.
const MOST_SPANNED: f64 = 1.0;
/// The same where nothing touches, mm.
const MOST_MISSED: f64 = 0.1;

/// The warning that the product lies under the skin between its vertices, and at which of them.
///
/// `displacement` by welded vertex, mm.
pub(super) fn product_between(
    skin: &Skin,
    product: &Product,
    pressed: &Pressed,
    displacement: &[Vec3],
) -> Option<Warning> {
    let suspects = suspects(skin, pressed);
    if suspects.is_empty() {
        return None;
    }
    let written = pressed.detection.positions.iter().zip(displacement);
    let written: Vec<Vec3> = written.map(|(p, u)| p + u).collect();
    let touches = pressed.solved.force.iter().any(|f| *f > 0.0);
    let (depth, vertex) = deepest(skin, &written, product, &suspects)?;
    let most = if touches { MOST_SPANNED } else { MOST_MISSED };
    (depth > most).then(|| Warning::ProductBetweenVertices {
        vertex: skin.merged.source[vertex as usize] as usize,
        depth,
        spacing: skin.spacing,
        touches,
    })
}

/// Skin vertices between which, or behind which, the product may lie.
fn suspects(skin: &Skin, pressed: &Pressed) -> Vec<u32> {
    let detection = &pressed.detection;
    let near = NEAR_SPACINGS * skin.spacing;
    let seen = |v: u32| {
        let is_near = detection.distances[v as usize] < near;
        let gap = is_near
            .then(|| detection.gaps[v as usize].as_ref())
            .flatten()?;
        is_skin(skin, v).then_some(gap)
    };
    let is_behind = |v: u32, gap: &Gap| {
        gap.distance > LEAST_DISTANCE && gap.normal.dot(&detection.normals[v as usize]) > BEHIND
    };
    let is_opposite = |v: u32, gap: &Gap| {
        let around = skin.adjacency.neighbors(v as usize).iter();
        let mut others = around.filter_map(|&w| seen(w));
        others.any(|other| gap.normal.dot(&other.normal) < OPPOSITE)
    };
    let is_suspect =
        |v: &u32| seen(*v).is_some_and(|gap| is_behind(*v, gap) || is_opposite(*v, gap));
    (0..detection.positions.len() as u32)
        .filter(is_suspect)
        .collect()
}

fn is_skin(skin: &Skin, v: u32) -> bool {
    skin.regions[skin.merged.source[v as usize] as usize] >= 0
}

/// How deep the product lies under the written skin near `suspects`, mm, and the vertex there.
fn deepest(
    skin: &Skin,
    written: &[Vec3],
    product: &Product,
    suspects: &[u32],
) -> Option<(f64, u32)> {
    let at = |v: &u32| written[*v as usize];
    let (low, high) = bounds(suspects.iter().map(at));
    let samples = samples(
        product.mesh(),
        (low.add_scalar(-REACH), high.add_scalar(REACH)),
    );
    let is_near = |p: &&Vec3| {
        suspects
            .iter()
            .any(|v| (at(v) - **p).norm_squared() < REACH * REACH)
    };
    let samples: Vec<Vec3> = samples.iter().filter(is_near).copied().collect();
    let (low, high) = (
        low.add_scalar(-REACH - MARGIN),
        high.add_scalar(REACH + MARGIN),
    );
    let is_here = |v: &u32| (0..3).all(|k| (low[k]..=high[k]).contains(&written[*v as usize][k]));
    let triangles = skin.merged.mesh.triangles().iter();
    let triangles: Vec<[u32; 3]> = triangles
        .filter(|t| t.iter().any(is_here))
        .copied()
        .collect();
    let surface = Mesh::new(written.to_vec(), triangles).ok()?;
    let normals = thenar_surface::vertex_normals(&surface);
    let surface = Product::new(surface).ok()?;
    let limits = GapLimits {
        cut_off_mm: MARGIN,
        max_depth_mm: MARGIN,
    };
    let depth_of = |(p, gap): (&Vec3, Option<Gap>)| {
        let gap = gap?;
        let corners = surface.mesh().triangles()[gap.triangle as usize];
        if !corners.iter().all(|v| is_skin(skin, *v)) {
            return None;
        }
        let weighted = corners.iter().zip(gap.barycentric);
        let normal: Vec3 = weighted.map(|(v, w)| normals[*v as usize] * w).sum();
        let depth = gap.distance.abs();
        let is_beneath = (gap.closest - p).dot(&normal) > BENEATH * depth * normal.norm();
        let nearest = (0..3).max_by(|a, b| gap.barycentric[*a].total_cmp(&gap.barycentric[*b]))?;
        is_beneath.then_some((depth, corners[nearest]))
    };
    let gaps = surface.gaps(&samples, None, limits);
    let depths = samples.iter().zip(gaps).filter_map(depth_of);
    depths.max_by(|a, b| a.0.total_cmp(&b.0))
}

/// Points of the mesh within a box, `SAMPLE_STEP` apart.
fn samples(mesh: &Mesh, (low, high): (Vec3, Vec3)) -> Vec<Vec3> {
    let mut found = Vec::new();
    for triangle in 0..mesh.triangles().len() {
        let [a, b, c] = mesh.corners(triangle);
        let (least, most) = bounds([a, b, c].into_iter());
        if (0..3).any(|k| least[k] > high[k] || most[k] < low[k]) {
            continue;
        }
        let longest = (b - a).norm().max((c - b).norm()).max((a - c).norm());
        let steps = ((longest / SAMPLE_STEP).ceil() as usize).clamp(1, MOST_STEPS);
        for i in 0..=steps {
            for j in 0..=steps - i {
                let (u, v) = (i as f64 / steps as f64, j as f64 / steps as f64);
                let point = a + (b - a) * u + (c - a) * v;
                if (0..3).all(|k| (low[k]..=high[k]).contains(&point[k])) {
                    found.push(point);
                }
            }
        }
    }
    found
}

fn bounds(points: impl Iterator<Item = Vec3>) -> (Vec3, Vec3) {
    let none = (Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY));
    points.fold(none, |(low, high), p| (low.inf(&p), high.sup(&p)))
}
