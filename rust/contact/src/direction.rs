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

/// Averaged directions for the sites of `zone`, whose product normals and gaps (mm) are given.
pub fn yielding_directions(
    zone: &[u32],
    normal: &[Vec3],
    gap: &[f64],
    around: (&Sites, &Adjacency, f64),
) -> Vec<Vec3> {
    let (sites, adjacency, spacing) = around;
    let local: Vec<Vec<u32>> = zone
        .iter()
        .map(|&site| {
            let neighbors = adjacency.neighbors(sites.vertex[site as usize] as usize);
            neighbors
                .iter()
                .filter_map(|&v| zone.binary_search(&sites.of_vertex[v as usize]).ok())
                .map(|k| k as u32)
                .collect()
        })
        .collect();
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
    let averages = spread(&sums, &local, spacing);
    averages
        .iter()
        .zip(normal)
        .map(|(s, n)| tame(Vec3::new(s[0], s[1], s[2]), *n))
        .collect()
}

/// Solves `(1 + c L) x = b` with the graph's Laplacian L: every value spreads over about [`AVERAGE_LENGTH`].
///
/// Chebyshev's iteration, whose steps do not depend on `b`.
fn spread(b: &[[f64; 4]], neighbors: &[Vec<u32>], spacing: f64) -> Vec<[f64; 4]> {
    // On a triangular lattice the Laplacian of the graph is 3/2 h^2 times that of the plane.
    let c = AVERAGE_LENGTH * AVERAGE_LENGTH / (1.5 * spacing * spacing);
    let degree = neighbors.iter().map(Vec::len).max().unwrap_or(0) as f64;
    let (low, high) = (1.0, 1.0 + 2.0 * c * degree);
    let (middle, half) = (0.5 * (high + low), 0.5 * (high - low).max(1e-12));
    let steps = (0.5 * (high / low).sqrt() * (2.0 / AVERAGE_ACCURACY).ln()).ceil() as usize;
    let mut x = vec![[0.0; 4]; b.len()];
    let mut step = vec![[0.0; 4]; b.len()];
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
        for (i, list) in neighbors.iter().enumerate() {
            let mut around = [0.0; 4];
            for &j in list {
                for (sum, x) in around.iter_mut().zip(&x[j as usize]) {
                    *sum += x;
                }
            }
            let own = 1.0 + c * list.len() as f64;
            for axis in 0..4 {
                let residual = b[i][axis] - own * x[i][axis] + c * around[axis];
                step[i][axis] = keep * step[i][axis] + gain * residual;
            }
        }
        for (x, step) in x.iter_mut().zip(&step) {
            for axis in 0..4 {
                x[axis] += step[axis];
            }
        }
        rho = next;
    }
    x
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
