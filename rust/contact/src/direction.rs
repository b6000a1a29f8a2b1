//! The direction in which each site yields.
//!
//! Linear theory moves the skin of a contact in one direction, that of the load. The product's normal at each closest
//! point would fan out under a small sphere and cost several percent of the force; so normals are averaged over the
//! contact around each site, which is one direction under a small contact and follows a product that the skin wraps.

use thenar_surface::{Adjacency, Vec3};

use crate::sites::Sites;

/// Length over which normals are averaged along the skin, mm: about a fingertip (tests pass from 12 to 40).
const AVERAGE_LENGTH: f64 = 16.0;
/// Accuracy of the average: a fixed number of steps reaches it for any field, so the result turns with its input.
const AVERAGE_ACCURACY: f64 = 1e-3;
/// Least cosine between a site's normal and its direction.
pub const LEAST_COSINE: f64 = 0.35;

/// Sums of weighted normals and of weights around a site; their ratio is the average.
pub type Sums = [f64; 4];

/// Averaged directions for the sites of `zone`, whose product normals and gaps (mm) are given, and the sums they come from.
///
/// `known`: sums of sites that keep theirs; empty where none does.
pub fn yielding_directions(
    zone: &[u32],
    (normal, gap): (&[Vec3], &[f64]),
    known: &[Option<Sums>],
    around: (&Sites, &Adjacency, f64),
) -> (Vec<Vec3>, Vec<Sums>) {
    let (sites, adjacency, spacing) = around;
    let mut place = vec![u32::MAX; sites.len()];
    for (k, &site) in zone.iter().enumerate() {
        place[site as usize] = k as u32;
    }
    let neighbors = |&site: &u32| -> Vec<u32> {
        let neighbors = adjacency.neighbors(sites.vertex[site as usize] as usize);
        let there = neighbors.iter().map(|&v| sites.of_vertex[v as usize]);
        let there = there.filter_map(|site| place.get(site as usize).copied());
        there.filter(|k| *k != u32::MAX).collect()
    };
    let local: Vec<Vec<u32>> = zone.iter().map(neighbors).collect();
    let deepest = gap.iter().fold(0.0, |most, g| f64::max(most, -g));
    let weight: Vec<f64> = zone
        .iter()
        .zip(gap)
        .map(|(&site, g)| sites.area[site as usize] * ((-g).max(0.0) + 1e-6 * deepest))
        .collect();
    // Sums of weight and of weighted normals spread alike; their ratio is a weighted average.
    let sums: Vec<[f64; 4]> = normal
        .iter()
        .zip(&weight)
        .map(|(n, w)| [w * n.x, w * n.y, w * n.z, *w])
        .collect();
    let averages = spread_beside(&sums, (&local, known), spacing);
    let directions = averages
        .iter()
        .zip(normal)
        .map(|(s, n)| tame(Vec3::new(s[0], s[1], s[2]), *n))
        .collect();
    (directions, averages)
}

/// [`spread`] where some values are `known`: what lies beside them takes from them, and they stay.
fn spread_beside(
    b: &[Sums],
    (neighbors, known): (&[Vec<u32>], &[Option<Sums>]),
    spacing: f64,
) -> Vec<Sums> {
    let degrees: Vec<usize> = neighbors.iter().map(Vec::len).collect();
    if known.iter().all(Option::is_none) {
        return spread(b, (neighbors, &degrees), spacing);
    }
    let c = strength(spacing);
    let open: Vec<usize> = (0..b.len()).filter(|&k| known[k].is_none()).collect();
    let mut place = vec![u32::MAX; b.len()];
    for (i, &k) in open.iter().enumerate() {
        place[k] = i as u32;
    }
    let (mut near, mut right) = (Vec::new(), Vec::new());
    for &k in &open {
        let mut sum = b[k];
        let beside = neighbors[k].iter().filter_map(|&j| known[j as usize]);
        beside.for_each(|x| (0..4).for_each(|axis| sum[axis] += c * x[axis]));
        right.push(sum);
        let unknown = neighbors[k].iter().map(|&j| place[j as usize]);
        near.push(unknown.filter(|i| *i != u32::MAX).collect::<Vec<u32>>());
    }
    let degrees: Vec<usize> = open.iter().map(|&k| degrees[k]).collect();
    let found = spread(&right, (&near, &degrees), spacing);
    let mut all: Vec<Sums> = known.iter().map(|x| x.unwrap_or_default()).collect();
    for (k, x) in open.into_iter().zip(found) {
        all[k] = x;
    }
    all
}

/// How strongly neighbors pull at each other: on a triangular lattice the Laplacian of the graph is 3/2 h^2 times that of the
/// plane.
fn strength(spacing: f64) -> f64 {
    AVERAGE_LENGTH * AVERAGE_LENGTH / (1.5 * spacing * spacing)
}

/// Solves `(1 + c L) x = b` with the graph's Laplacian L: every value spreads over about [`AVERAGE_LENGTH`].
///
/// Chebyshev's iteration, whose steps do not depend on `b`. Neighbors that are not listed but counted in `degrees` have theirs
/// in `b`.
fn spread(b: &[Sums], (neighbors, degrees): (&[Vec<u32>], &[usize]), spacing: f64) -> Vec<Sums> {
    let c = strength(spacing);
    let degree = degrees.iter().copied().max().unwrap_or(0) as f64;
    let (low, high) = (1.0, 1.0 + 2.0 * c * degree);
    let (middle, half) = (0.5 * (high + low), 0.5 * (high - low).max(1e-12));
    let steps = (0.5 * (high / low).sqrt() * (2.0 / AVERAGE_ACCURACY).ln()).ceil() as usize;
    let graph = Graph::new(neighbors, degrees, c);
    let mut x = vec![Sums::default(); b.len()];
    let mut step = vec![Sums::default(); b.len()];
    let mut rho = half / middle;
    for k in 0..=steps {
        let next = if k == 0 {
            rho
        } else {
            1.0 / (2.0 * middle / half - rho)
        };
        let (keep, gain) = if k == 0 {
            (0.0, 1.0 / middle)
        } else {
            (next * rho, 2.0 * next / half)
        };
        advance(&graph, b, (keep, gain), (&mut x, &mut step));
        rho = next;
    }
    x
}

/// Neighbors one after the other, with the diagonal of `1 + c L`.
struct Graph {
    strength: f64,
    diagonal: Vec<f64>,
    /// One past the last neighbor of each.
    ends: Vec<u32>,
    neighbors: Vec<u32>,
}

impl Graph {
    fn new(neighbors: &[Vec<u32>], degrees: &[usize], strength: f64) -> Self {
        let mut end = 0;
        let ends = neighbors.iter().map(|list| {
            end += list.len() as u32;
            end
        });
        let own = |degree: &usize| 1.0 + strength * *degree as f64;
        Graph {
            strength,
            diagonal: degrees.iter().map(own).collect(),
            ends: ends.collect(),
            neighbors: neighbors.concat(),
        }
    }
}

/// One of Chebyshev's steps: `step` becomes `keep` of itself and `gain` of the residual, and is added to `x`.
#[multiversion::multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2"))]
fn advance(
    graph: &Graph,
    b: &[Sums],
    (keep, gain): (f64, f64),
    (x, step): (&mut [Sums], &mut [Sums]),
) {
    let mut from = 0;
    let all = graph.ends.iter().zip(&graph.diagonal).zip(b).zip(&*x);
    for ((((&to, own), b), here), step) in all.zip(&mut *step) {
        let mut around = [0.0; 4];
        for &j in &graph.neighbors[from as usize..to as usize] {
            let there = &x[j as usize];
            (0..4).for_each(|axis| around[axis] += there[axis]);
        }
        for axis in 0..4 {
            let residual = b[axis] - own * here[axis] + graph.strength * around[axis];
            step[axis] = keep * step[axis] + gain * residual;
        }
        from = to;
    }
    for (x, step) in x.iter_mut().zip(step) {
        (0..4).for_each(|axis| x[axis] += step[axis]);
    }
}

/// Unit direction nearest to `average` within the cone around `normal` that keeps the contact pressing.
fn tame(average: Vec3, normal: Vec3) -> Vec3 {
    let direction = average.try_normalize(1e-300).unwrap_or(normal);
    let cosine = direction.dot(&normal);
    if cosine >= LEAST_COSINE {
        return direction;
    }
    let sideways = direction - normal * cosine;
    match sideways.try_normalize(1e-12) {
        Some(side) => normal * LEAST_COSINE + side * (1.0 - LEAST_COSINE * LEAST_COSINE).sqrt(),
        None => normal,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn beside_values_that_stay_the_others_are_those_of_the_whole() {
        let n = 80_u32;
        let beside = |i: u32| [i.checked_sub(1), Some(i + 1).filter(|j| *j < n)];
        let neighbors: Vec<Vec<u32>> = (0..n)
            .map(|i| beside(i).into_iter().flatten().collect())
            .collect();
        let b: Vec<Sums> = (0..n)
            .map(|i| [0.3, 0.7, 1.1, 1.9].map(|pace| 1.0 + (pace * f64::from(i)).sin()))
            .collect();
        let whole = spread_beside(&b, (&neighbors, &[]), 1.5);
        let known = |i: u32| (20..50).contains(&i).then_some(whole[i as usize]);
        let known: Vec<Option<Sums>> = (0..n).map(known).collect();
        let again = spread_beside(&b, (&neighbors, &known), 1.5);
        let all = || whole.iter().zip(&again).zip(&known);
        assert!(all().all(|((a, b), known)| known.is_none() || a == b));
        let off = all().flat_map(|((a, b), _)| (0..4).map(move |axis| (a[axis] - b[axis]).abs()));
        let off = off.fold(0.0, f64::max);
        let most = whole.iter().flatten().fold(0.0, |m, x| f64::max(m, *x));
        assert!(off < 2.0 * AVERAGE_ACCURACY * most, "{off} of {most}");
        // The whole is no constant, so that this says something.
        let least = whole.iter().flatten().fold(most, |m, x| f64::min(m, *x));
        assert!(most - least > 20.0 * AVERAGE_ACCURACY * most);
    }
}
