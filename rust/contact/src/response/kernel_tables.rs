//! The layer kernel, tabulated over distance: `u = (1 - nu) / (2 pi G) [1/r - Psi(r)] P`.
//!
//! Where thickness varies over the skin the kernel between two places with transfer functions K_a and K_b is
//! `Psi_ab(r) = integral of (1 - sqrt(K_a K_b)) J0(k r) dk`. For each k this is a congruence of `J0(k r)`, a definite
//! kernel, so the response stays definite for any field of thicknesses, and is the layer's own where it is uniform.

use libm::j0;

use super::bonded_layer::Layer;
use super::kernel_grid::{Grid, RANGE_IN_THICKNESSES, pair};

/// Share of the range over which the kernel fades to zero and gets back the volume that lies beyond it.
const FADE_SHARE: f64 = 0.5;
/// Most knots of one table.
const MOST_KNOTS: usize = 4096;

/// Tables for every pair of layers of a skin.
#[derive(Debug, Clone)]
pub struct KernelTables {
    /// Table of the pair (a, b), a <= b, or None for two half spaces.
    tables: Vec<Option<Vec<f64>>>,
    step: f64,
}

impl KernelTables {
    /// Tabulates all pairs of `layers` for distances up to `size` (the extent of the skin, mm).
    pub fn new(layers: &[Layer], size: f64) -> Self {
        let grid = Grid::new(layers, size, MOST_KNOTS);
        let mut tables = vec![None; layers.len() * (layers.len() + 1) / 2];
        if !grid.is_half_space() {
            fill(layers, &mut tables, &grid);
        }
        KernelTables {
            tables,
            step: grid.step,
        }
    }

    /// Psi of the layers `a` and `b` at distance `r` (mm), 1/mm.
    pub fn psi(&self, a: usize, b: usize, r: f64) -> f64 {
        match &self.tables[pair(a, b)] {
            None => 0.0,
            Some(table) => interpolate(table, r / self.step),
        }
    }

    /// Psi of one pair of layers at many distances (mm), 1/mm.
    pub fn psi_of_pair(&self, a: usize, b: usize, distances: &[f64], out: &mut [f64]) {
        match &self.tables[pair(a, b)] {
            None => out.fill(0.0),
            Some(table) => {
                for (out, r) in out.iter_mut().zip(distances) {
                    *out = interpolate(table, r / self.step);
                }
            }
        }
    }
}

/// Catmull-Rom through the knots; the table holds one knot before zero (Psi is even) and two behind its end.
#[inline]
pub(super) fn interpolate(table: &[f64], x: f64) -> f64 {
    let i = x as usize;
    if i + 3 >= table.len() {
        return 0.0;
    }
    let t = x - i as f64;
    let [p0, p1, p2, p3] = [table[i], table[i + 1], table[i + 2], table[i + 3]];
    p1 + 0.5
        * t
        * (p2 - p0 + t * (2.0 * p0 - 5.0 * p1 + 4.0 * p2 - p3 + t * (3.0 * (p1 - p2) + p3 - p0)))
}

fn fill(layers: &[Layer], tables: &mut [Option<Vec<f64>>], grid: &Grid) {
    let nodes = grid.wave_numbers();
    let knots = grid.knots();
    let roots: Vec<Vec<f64>> = layers
        .iter()
        .map(|layer| {
            nodes
                .iter()
                .map(|&(k, _)| layer.transfer(k).sqrt())
                .collect()
        })
        .collect();
    let mut weights: Vec<(usize, Vec<f64>)> = Vec::new();
    for b in 0..layers.len() {
        for a in 0..=b {
            if layers[a].thickness.is_infinite() && layers[b].thickness.is_infinite() {
                continue;
            }
            let product = nodes
                .iter()
                .enumerate()
                .map(|(i, &(_, w))| w * (1.0 - roots[a][i] * roots[b][i]));
            weights.push((pair(a, b), product.collect()));
            tables[pair(a, b)] = Some(Vec::with_capacity(knots + 1));
        }
    }
    for knot in 0..=knots {
        let r = (knot as f64 - 1.0).abs() * grid.step;
        let bessel: Vec<f64> = nodes.iter().map(|&(k, _)| j0(k * r)).collect();
        for (index, weight) in &weights {
            let value = weight.iter().zip(&bessel).map(|(w, j)| w * j).sum();
            if let Some(table) = &mut tables[*index] {
                table.push(value);
            }
        }
    }
    for b in 0..layers.len() {
        for a in 0..=b {
            if let Some(table) = &mut tables[pair(a, b)] {
                close(table, [layers[a], layers[b]], grid);
            }
        }
    }
}

/// Ends a kernel at its range without losing volume: fades it out and returns the missing volume to where it fades.
///
/// The volume that a unit force displaces is `2 pi` times the integral of `(1/r - Psi) r dr`, whose exact value is the limit of
/// K(k)/k at k = 0: zero for an incompressible layer.
fn close(table: &mut [f64], layers: [Layer; 2], grid: &Grid) {
    let range = RANGE_IN_THICKNESSES * 0.5 * (layers[0].thickness + layers[1].thickness);
    if range > grid.reach {
        return;
    }
    let from = range * (1.0 - FADE_SHARE);
    let share = |r: f64| ((r - from) / (range - from)).clamp(0.0, 1.0);
    let fade = |r: f64| 1.0 - share(r).powi(3) * (10.0 - 15.0 * share(r) + 6.0 * share(r).powi(2));
    let bump = |r: f64| (std::f64::consts::PI * share(r)).sin().powi(4);
    for (knot, psi) in table.iter_mut().enumerate() {
        let r = (knot as f64 - 1.0) * grid.step;
        if r > from {
            *psi = 1.0 / r - (1.0 / r - *psi) * fade(r);
        }
    }
    let wanted = layers
        .map(|layer| layer.transfer(1e-6) / 1e-6)
        .iter()
        .product::<f64>()
        .sqrt();
    let (mut volume, mut room) = (0.0, 0.0);
    let steps = 32 * (range / grid.step).ceil() as usize;
    let width = range / steps as f64;
    for step in 0..steps {
        let r = (step as f64 + 0.5) * width;
        volume += (1.0 - r * interpolate(table, r / grid.step)) * width;
        room += r * bump(r) * width;
    }
    for (knot, psi) in table.iter_mut().enumerate() {
        let r = (knot as f64 - 1.0) * grid.step;
        if r > from && r < range {
            *psi -= (wanted - volume) / room * bump(r);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn layer(thickness: f64) -> Layer {
        Layer {
            thickness,
            poisson_ratio: 0.5,
        }
    }

    #[test]
    fn sign_change_and_deepest_bulge_lie_where_the_literature_of_the_kernel_puts_them() {
        let tables = KernelTables::new(&[layer(10.0)], 100.0);
        let kernel = |r: f64| 1.0 / r - tables.psi(0, 0, r);
        assert!(kernel(7.35) > 0.0 && kernel(7.45) < 0.0);
        let deepest = (500..2000)
            .map(|i| i as f64 * 0.01)
            .min_by(|a, b| kernel(*a).total_cmp(&kernel(*b)));
        assert!((deepest.unwrap() - 11.2).abs() < 0.12, "{deepest:?}");
    }

    #[test]
    fn interpolation_meets_the_integral() {
        let layers = [layer(5.0), layer(11.0)];
        let tables = KernelTables::new(&layers, 100.0);
        let fine: Vec<f64> = (0..200_000).map(|i| (i as f64 + 0.5) * 2e-5).collect();
        for (a, b, r) in [(0, 0, 0.03), (0, 1, 3.777), (1, 1, 20.5), (0, 0, 0.9)] {
            let k = |x: f64| (layers[a].transfer(x) * layers[b].transfer(x)).sqrt();
            let exact: f64 = fine.iter().map(|&x| (1.0 - k(x)) * j0(x * r) * 2e-5).sum();
            assert!(
                (tables.psi(a, b, r) - exact).abs() < 4e-6,
                "{a}{b} {r}: {} {exact}",
                tables.psi(a, b, r)
            );
        }
    }

    #[test]
    fn bulge_volume_equals_dent_volume() {
        // Net volume: integral of (1/r - Psi) 2 pi r dr over the range, which vanishes for nu = 1/2.
        for layers in [
            [layer(1.0), layer(1.0)],
            [layer(5.0), layer(11.0)],
            [layer(13.4), layer(7.1)],
        ] {
            let tables = KernelTables::new(&layers, 200.0);
            let range = RANGE_IN_THICKNESSES * 0.5 * (layers[0].thickness + layers[1].thickness);
            let step = range / 40_000.0;
            let (mut net, mut dent) = (0.0, 0.0);
            for i in 0..40_000 {
                let r = (i as f64 + 0.5) * step;
                let part = (1.0 - r * tables.psi(0, 1, r)) * step;
                net += part;
                dent += part.max(0.0);
            }
            assert!((net / dent).abs() < 1e-6, "{}", net / dent);
        }
    }

    #[test]
    fn a_compressible_layer_loses_the_volume_of_a_confined_column() {
        let soft = Layer {
            thickness: 4.0,
            poisson_ratio: 0.4,
        };
        let tables = KernelTables::new(&[soft], 200.0);
        let step = RANGE_IN_THICKNESSES * 4.0 / 40_000.0;
        let part = |i: i32| {
            (1.0 - (f64::from(i) + 0.5) * step * tables.psi(0, 0, (f64::from(i) + 0.5) * step))
                * step
        };
        let net: f64 = (0..40_000).map(part).sum();
        let column = 4.0 * (1.0 - 2.0 * 0.4) / (2.0 * (1.0 - 0.4) * (1.0 - 0.4));
        assert!((net / column - 1.0).abs() < 1e-5, "{net} {column}");
    }

    #[test]
    fn ending_the_kernel_changes_it_by_little() {
        let tables = KernelTables::new(&[layer(1.0)], 200.0);
        let open = KernelTables::new(
            &[
                layer(1.0),
                Layer {
                    thickness: f64::INFINITY,
                    poisson_ratio: 0.5,
                },
            ],
            60.0,
        );
        for i in 1..80 {
            let r = 0.1 * f64::from(i);
            // An infinite layer beside it keeps the finite pair's table long, and so closed as well: compare below the fade.
            let difference = (tables.psi(0, 0, r) - open.psi(0, 0, r)).abs();
            assert!(r > 3.0 || difference < 1e-5, "{r}: {difference}");
        }
    }
}
