//! The direction in which each site is pressed in: product normals averaged over the contact around it.
//!
//! Linear theory moves the skin of a contact in one direction, that of the load. The product's normal at each closest
//! point would fan out under a small sphere and cost several percent of the force; so normals are averaged over the
//! contact around each site, which is one direction under a small contact and follows a product that the skin wraps.

use thenar_surface::{Adjacency, Vec3};

use super::graph_diffusion::{Graph, diffuse};
use crate::skin::sites::Sites;

pub use super::graph_diffusion::Sums;

/// Length over which normals are averaged along the skin, mm: about a fingertip (tests pass from 12 to 40).
const AVERAGE_LENGTH: f64 = 16.0;
/// Least cosine between a site's normal and its direction.
pub const LEAST_COSINE: f64 = 0.35;
/// How much farther than its depth a site may be sent along its direction, mm: the deeper it lies, the nearer that stays to its normal.
pub const MOST_DETOUR: f64 = 3.0;

/// The skin around a zone.
pub struct Neighborhood<'a> {
    pub sites: &'a Sites,
    pub adjacency: &'a Adjacency,
    /// Median edge, mm.
    pub spacing: f64,
}

/// Averaged directions for the sites of `zone`, whose product normals and gaps (mm) are given, and the sums they come from.
///
/// `known`: sums of sites that keep theirs, and with them their directions; empty where none does.
pub fn press_directions(
    zone: &[u32],
    (normal, gap): (&[Vec3], &[f64]),
    known: &[Option<Sums>],
    around: &Neighborhood<'_>,
) -> (Vec<Vec3>, Vec<Sums>) {
    let &Neighborhood {
        sites,
        adjacency,
        spacing,
    } = around;
    let mut place = vec![u32::MAX; sites.len()];
    for (k, &site) in zone.iter().enumerate() {
        place[site as usize] = k as u32;
    }
    let deepest = gap.iter().fold(0.0, |most, g| f64::max(most, -g));
    // Sums of weight and of weighted normals spread alike; their ratio is a weighted average.
    let sums = |k: usize| {
        let weight = sites.area[zone[k] as usize] * ((-gap[k]).max(0.0) + 1e-6 * deepest);
        let n = normal[k];
        [weight * n.x, weight * n.y, weight * n.z, weight]
    };
    let beside = |k: usize| {
        let vertex = sites.vertex[zone[k] as usize] as usize;
        let there = adjacency.neighbors(vertex).iter();
        let there = there.filter_map(|&v| place.get(sites.of_vertex[v as usize] as usize));
        there.copied().filter(|j| *j != u32::MAX)
    };
    let averages = diffuse_beside((zone.len(), sums), (beside, known), spacing);
    let directions = averages.iter().zip(normal).enumerate().map(|(k, (s, n))| {
        let is_known = known.get(k).is_some_and(Option::is_some);
        if is_known {
            *n
        } else {
            let depth = (-gap[k]).max(0.0);
            let least = LEAST_COSINE.max(depth / (depth + MOST_DETOUR));
            limit_tilt(Vec3::new(s[0], s[1], s[2]), (*n, least))
        }
    });
    (directions.collect(), averages)
}

/// [`diffuse`] of `count` values, where some are `known`: what lies beside them takes from them, and they stay.
fn diffuse_beside<I: Iterator<Item = u32>>(
    (count, value): (usize, impl Fn(usize) -> Sums),
    (beside, known): (impl Fn(usize) -> I, &[Option<Sums>]),
    spacing: f64,
) -> Vec<Sums> {
    let known = |k: usize| known.get(k).copied().flatten();
    let c = strength(spacing);
    let open: Vec<usize> = (0..count).filter(|&k| known(k).is_none()).collect();
    let mut place = vec![u32::MAX; count];
    for (i, &k) in open.iter().enumerate() {
        place[k] = i as u32;
    }
    let mut graph = Graph::new(c, open.len());
    let mut right = Vec::with_capacity(open.len());
    for &k in &open {
        let (mut sum, mut degree) = (value(k), 0);
        for j in beside(k) {
            degree += 1;
            match known(j as usize) {
                Some(x) => (0..4).for_each(|axis| sum[axis] += c * x[axis]),
                None => graph.neighbors.push(place[j as usize]),
            }
        }
        graph.end(degree);
        right.push(sum);
    }
    let mut all: Vec<Sums> = (0..count).map(|k| known(k).unwrap_or_default()).collect();
    for (k, x) in open.into_iter().zip(diffuse(&right, &graph)) {
        all[k] = x;
    }
    all
}

/// How strongly neighbors pull at each other: on a triangular lattice the Laplacian of the graph is 3/2 h^2 times that of the
/// plane.
fn strength(spacing: f64) -> f64 {
    AVERAGE_LENGTH * AVERAGE_LENGTH / (1.5 * spacing * spacing)
}

/// Unit direction nearest to `average` within the cone around `normal`, of cosine `least`, that keeps the contact pressing.
fn limit_tilt(average: Vec3, (normal, least): (Vec3, f64)) -> Vec3 {
    let direction = average.try_normalize(1e-300).unwrap_or(normal);
    let cosine = direction.dot(&normal);
    if cosine >= least {
        return direction;
    }
    let sideways = direction - normal * cosine;
    match sideways.try_normalize(1e-12) {
        Some(side) => normal * least + side * (1.0 - least * least).sqrt(),
        None => normal,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::detection::graph_diffusion::ACCURACY;

    #[test]
    fn diffusion_around_fixed_values_equals_the_whole() {
        let n = 80_u32;
        let beside = |i: u32| [i.checked_sub(1), Some(i + 1).filter(|j| *j < n)];
        let neighbors = |k: usize| beside(k as u32).into_iter().flatten();
        let b: Vec<Sums> = (0..n)
            .map(|i| [0.3, 0.7, 1.1, 1.9].map(|pace| 1.0 + (pace * f64::from(i)).sin()))
            .collect();
        let value = |k: usize| b[k];
        let whole = diffuse_beside((b.len(), value), (neighbors, &[]), 1.5);
        let known = |i: u32| (20..50).contains(&i).then_some(whole[i as usize]);
        let known: Vec<Option<Sums>> = (0..n).map(known).collect();
        let again = diffuse_beside((b.len(), value), (neighbors, &known), 1.5);
        let all = || whole.iter().zip(&again).zip(&known);
        assert!(all().all(|((a, b), known)| known.is_none() || a == b));
        let off = all().flat_map(|((a, b), _)| (0..4).map(move |axis| (a[axis] - b[axis]).abs()));
        let off = off.fold(0.0, f64::max);
        let most = whole.iter().flatten().fold(0.0, |m, x| f64::max(m, *x));
        assert!(off < 2.0 * ACCURACY * most, "{off} of {most}");
        // The whole is no constant, so that this says something.
        let least = whole.iter().flatten().fold(most, |m, x| f64::min(m, *x));
        assert!(most - least > 20.0 * ACCURACY * most);
    }
}
