//! Response of the surface to a tangential point force: Cerruti's solution and the layer bonded to bone.
//!
//! A traction of wave vector k along the surface moves it by `(1 - nu) / (G k) L(k h)` where it points along k and by
//! `T(k h) / (G k)` where it points across: L = T = 1 is Cerruti's half space (Johnson, Contact Mechanics 3.75). In space
//! `u = 1 / (2 pi G) [M(r) + D(r) (2 c c' - 1)] q` with c the unit chord, `M = integral of (T + (1 - nu) L) / 2 J0(k r) dk` and
//! `D = integral of (T - (1 - nu) L) / 2 J2(k r) dk`. Left out: what shear lifts and what pressure moves sideways. For a half
//! space with nu = 1/2 neither exists; for a layer, or nu < 1/2, it is Goodman's approximation (1962).

use libm::{j0, j1};

use crate::response::bonded_layer::Layer;
use crate::response::kernel_grid::{Grid, RANGE_IN_THICKNESSES, pair};

/// Share of the range over which the kernel fades to zero.
const FADE_SHARE: f64 = 0.25;
/// Most knots of one table.
const MOST_KNOTS: usize = 2048;
/// Lattice self term of 1/r over sqrt(area), as for the normal response: -4 zeta(1/2) beta(1/2).
///
/// By the symmetry of the lattice the sum of x^2/r^3 is half that of 1/r, so a point's own term is `(1 - nu / 2)` of it, 1.5
/// of the chord-free 1/r at nu = 1/2, in every direction.
pub const LATTICE: f64 = 3.900_264_920_001_956;

impl Layer {
    /// Transfer functions (L, T) of shear along and across the wave vector, at wave number `k` (1/mm); between 0 and 1.
    ///
    /// The base is bonded. Both are k h / ... = h / G in displacement for long waves: a sheared slab.
    pub fn shear_transfer(&self, k: f64) -> (f64, f64) {
        if self.thickness.is_infinite() {
            return (1.0, 1.0);
        }
        let s = k * self.thickness;
        let kappa = 3.0 - 4.0 * self.poisson_ratio;
        let (e2, e4) = ((-2.0 * s).exp(), (-4.0 * s).exp());
        let top = -kappa * (-4.0 * s).exp_m1() + 4.0 * s * e2;
        let bottom = kappa * (1.0 + e4) + (4.0 * s * s + 1.0 + kappa * kappa) * e2;
        (top / bottom, s.tanh())
    }
}

/// The kernel of one pair of places, 1/mm: `M` and `D` without their half-space part.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct ShearKernel {
    /// Taken off M.
    pub mean: f64,
    /// Taken off D.
    pub deviator: f64,
}

/// What bone takes off Cerruti's kernel, tabulated over distance for every pair of layers.
#[derive(Debug, Clone)]
pub struct ShearTables {
    layers: Vec<Layer>,
    /// (M, D) knots of the pair (a, b), a <= b; None for two half spaces.
    tables: Vec<Option<Vec<[f64; 2]>>>,
    step: f64,
}

impl ShearTables {
    /// Tabulates all pairs of `layers` for distances up to `size` (mm).
    pub fn new(layers: &[Layer], size: f64) -> Self {
        let grid = Grid::new(layers, size, MOST_KNOTS);
        let mut tables = vec![None; layers.len() * (layers.len() + 1) / 2];
        if !grid.is_half_space() {
            let nodes = grid.wave_numbers();
            for b in 0..layers.len() {
                for a in 0..=b {
                    let both = [layers[a], layers[b]];
                    if both.iter().any(|l| l.thickness.is_finite()) {
                        tables[pair(a, b)] = Some(tabulate(both, &nodes, &grid));
                    }
                }
            }
        }
        ShearTables {
            layers: layers.to_vec(),
            tables,
            step: grid.step,
        }
    }

    /// Geometric mean of 1 - nu of two layers: what their response along the wave vector goes with.
    pub fn softness(&self, a: usize, b: usize) -> f64 {
        softness([self.layers[a], self.layers[b]])
    }

    /// What bone takes off the kernel of the layers `a` and `b` at distance `r` (mm), 1/mm.
    pub fn held(&self, a: usize, b: usize, r: f64) -> ShearKernel {
        let Some(table) = &self.tables[pair(a, b)] else {
            return ShearKernel::default();
        };
        let x = r / self.step;
        let i = x as usize;
        if i + 3 >= table.len() {
            // Beyond the table nothing is left of the whole.
            let soft = self.softness(a, b);
            return ShearKernel {
                mean: 0.5 * (1.0 + soft) / r,
                deviator: 0.5 * (1.0 - soft) / r,
            };
        }
        let t = x - i as f64;
        let cubic = |c: usize| {
            let [p0, p1, p2, p3] = [
                table[i][c],
                table[i + 1][c],
                table[i + 2][c],
                table[i + 3][c],
            ];
            p1 + 0.5
                * t
                * (p2 - p0
                    + t * (2.0 * p0 - 5.0 * p1 + 4.0 * p2 - p3 + t * (3.0 * (p1 - p2) + p3 - p0)))
        };
        ShearKernel {
            mean: cubic(0),
            deviator: cubic(1),
        }
    }
}

fn softness(layers: [Layer; 2]) -> f64 {
    ((1.0 - layers[0].poisson_ratio) * (1.0 - layers[1].poisson_ratio)).sqrt()
}

/// The knots of one pair: one before zero (both parts are even), two behind the end.
fn tabulate(layers: [Layer; 2], nodes: &[(f64, f64)], grid: &Grid) -> Vec<[f64; 2]> {
    let soft = softness(layers);
    let weight = |&(k, w): &(f64, f64)| {
        let [(l0, t0), (l1, t1)] = layers.map(|layer| layer.shear_transfer(k));
        let (along, across) = (1.0 - (l0 * l1).sqrt(), 1.0 - (t0 * t1).sqrt());
        [
            0.5 * w * (across + soft * along),
            0.5 * w * (across - soft * along),
        ]
    };
    let weights: Vec<[f64; 2]> = nodes.iter().map(weight).collect();
    let range = RANGE_IN_THICKNESSES * 0.5 * (layers[0].thickness + layers[1].thickness);
    let at = |knot: usize| {
        let r = (knot as f64 - 1.0).abs() * grid.step;
        let mut sum = [0.0; 2];
        for (&(k, _), weight) in nodes.iter().zip(&weights) {
            let x = k * r;
            let zeroth = j0(x);
            let second = if x < 1e-3 {
                x * x / 8.0
            } else {
                2.0 * j1(x) / x - zeroth
            };
            sum[0] += weight[0] * zeroth;
            sum[1] += weight[1] * second;
        }
        let whole = [0.5 * (1.0 + soft) / r, 0.5 * (1.0 - soft) / r];
        let kept = fade(r, range);
        [0, 1].map(|c| {
            if kept < 1.0 {
                whole[c] - (whole[c] - sum[c]) * kept
            } else {
                sum[c]
            }
        })
    };
    (0..=grid.knots()).map(at).collect()
}

/// 1 near, 0 at the range and beyond, smooth between.
fn fade(r: f64, range: f64) -> f64 {
    if range.is_infinite() {
        return 1.0;
    }
    let from = range * (1.0 - FADE_SHARE);
    let share = ((r - from) / (range - from)).clamp(0.0, 1.0);
    1.0 - share.powi(3) * (10.0 - 15.0 * share + 6.0 * share * share)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn layer(thickness: f64, poisson_ratio: f64) -> Layer {
        Layer {
            thickness,
            poisson_ratio,
        }
    }

    #[test]
    fn long_waves_shear_a_slab_and_short_ones_a_half_space() {
        for nu in [0.3, 0.45, 0.5] {
            let (k, soft) = (1e-5, layer(7.0, nu));
            let (along, across) = soft.shear_transfer(k);
            assert!(
                ((1.0 - nu) * along / (k * 7.0) - 1.0).abs() < 1e-4,
                "{nu}: {along}"
            );
            assert!((across / (k * 7.0) - 1.0).abs() < 1e-4);
            let (along, across) = soft.shear_transfer(4.0);
            assert!((along - 1.0).abs() < 1e-12 && (across - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn the_lattice_sum_of_the_chord_part_is_half_that_of_the_whole() {
        // Sum minus integral over a disc, the edge smoothed: 1/r gives minus the lattice constant, x^2/r^3 half of it.
        let (cut, reach) = (120.0f64, 200i32);
        let (mut whole, mut chord) = (0.0, 0.0);
        let smooth = |r: f64| (-(r / cut).powi(6) * 8.0).exp();
        for i in -reach..=reach {
            for j in -reach..=reach {
                if (i, j) != (0, 0) {
                    let r = f64::from(i).hypot(f64::from(j));
                    whole += smooth(r) / r;
                    chord += smooth(r) * f64::from(i * i) / r.powi(3);
                }
            }
        }
        let steps = 200_000;
        let width = f64::from(reach) / f64::from(steps);
        let integral: f64 = (0..steps)
            .map(|s| smooth((f64::from(s) + 0.5) * width) * width)
            .sum();
        let tau = std::f64::consts::TAU;
        assert!(
            (tau * integral - whole - LATTICE).abs() < 1e-6,
            "{}",
            tau * integral - whole
        );
        assert!((0.5 * tau * integral - chord - 0.5 * LATTICE).abs() < 1e-6);
    }

    #[test]
    fn a_layer_far_away_and_a_half_space_hold_nothing() {
        let open = layer(f64::INFINITY, 0.5);
        let tables = ShearTables::new(&[open, layer(5.0, 0.5)], 100.0);
        assert_eq!(tables.held(0, 0, 3.0), ShearKernel::default());
        let beyond = tables.held(1, 1, 40.0);
        assert!(
            (beyond.mean - 0.75 / 40.0).abs() < 1e-15
                && (beyond.deviator - 0.25 / 40.0).abs() < 1e-15
        );
    }

    #[test]
    fn interpolation_meets_the_integral() {
        let (a, b) = (layer(5.0, 0.5), layer(11.0, 0.4));
        let tables = ShearTables::new(&[a, b], 100.0);
        let soft = tables.softness(0, 1);
        for r in [0.03, 2.7, 9.1] {
            let (mut mean, mut deviator) = (0.0, 0.0);
            for i in 0..200_000 {
                let k = (f64::from(i) + 0.5) * 2e-5;
                let [(l0, t0), (l1, t1)] = [a, b].map(|l| l.shear_transfer(k));
                let (along, across) = (1.0 - (l0 * l1).sqrt(), 1.0 - (t0 * t1).sqrt());
                let j2 = libm::jn(2, k * r);
                mean += 0.5 * (across + soft * along) * j0(k * r) * 2e-5;
                deviator += 0.5 * (across - soft * along) * j2 * 2e-5;
            }
            let held = tables.held(0, 1, r);
            assert!((held.mean - mean).abs() < 5e-6, "{r}: {} {mean}", held.mean);
            assert!(
                (held.deviator - deviator).abs() < 5e-6,
                "{r}: {} {deviator}",
                held.deviator
            );
        }
    }
}
