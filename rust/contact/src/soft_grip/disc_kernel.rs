//! How far a layer yields about a force that is spread evenly over a disc.
//!
//! The force of a skin vertex stands for a pressure over the vertex's area. Taken at a point it would make the layer yield
//! without bound there. The kernel of the layer, `1/r - Psi(r)`, is averaged over a disc of that area.

use std::collections::HashMap;

use libm::{j0, j1};
use rayon::prelude::*;

use crate::response::bonded_layer::Layer;
use crate::response::kernel_grid::{RANGE_IN_THICKNESSES, wave_numbers};

/// Ratio of neighboring radii for which tables are made; a disc takes the nearest.
const RADIUS_RATIO: f64 = 1.05;
/// Knots of a table for every disc radius or quarter thickness, whichever is less.
const KNOTS_PER_LENGTH: f64 = 8.0;
/// Distance beyond which a half space sees a disc as a point, in radii: off by 1e-4.
const FAR_IN_RADII: f64 = 8.0;

/// Kernels of one layer averaged over discs: `2 J1(k a) / (k a)` of each wave is left.
#[derive(Debug)]
pub struct DiscKernels {
    layer: Layer,
    /// No distance is longer, mm.
    size: f64,
    /// By number of the radius.
    discs: HashMap<i32, DiscTable>,
}

#[derive(Debug)]
struct DiscTable {
    step: f64,
    values: Vec<f64>,
}

impl DiscKernels {
    /// No table yet; `size` is a distance beyond which none is asked for, mm.
    pub fn new(layer: Layer, size: f64) -> Self {
        DiscKernels {
            layer,
            size,
            discs: HashMap::new(),
        }
    }

    /// Makes the tables for discs of these radii (mm) that are missing.
    pub fn make(&mut self, radii: impl Iterator<Item = f64>) {
        for number in radii.map(number_of) {
            if !self.discs.contains_key(&number) {
                let table = self.table(RADIUS_RATIO.powi(number));
                self.discs.insert(number, table);
            }
        }
    }

    /// The kernel at distance `r` from the middle of a disc of radius `a` (mm), 1/mm; 0 for a radius without a table.
    pub fn at(&self, r: f64, a: f64) -> f64 {
        let Some(table) = self.discs.get(&number_of(a)) else {
            return 0.0;
        };
        let x = r / table.step;
        let i = x as usize;
        if i + 1 >= table.values.len() {
            return match self.layer.thickness.is_finite() {
                true => 0.0,
                false => 1.0 / r,
            };
        }
        let t = x - i as f64;
        table.values[i] * (1.0 - t) + table.values[i + 1] * t
    }

    /// Distance beyond which a disc of radius `a` (mm) moves nothing, mm.
    pub fn reach(&self, a: f64) -> f64 {
        RANGE_IN_THICKNESSES * self.layer.thickness + a
    }

    fn table(&self, a: f64) -> DiscTable {
        let length = a.min(0.25 * self.layer.thickness);
        let step = length / KNOTS_PER_LENGTH;
        let end = match self.layer.thickness.is_finite() {
            true => self.reach(a).min(self.size),
            false => FAR_IN_RADII * a,
        };
        let knots = (end / step).ceil() as usize + 2;
        let waves = self.waves(a, end);
        let value = |knot: usize| {
            let r = knot as f64 * step;
            let taken: f64 = waves.iter().map(|(k, w)| w * j0(k * r)).sum();
            half_space(r, a) - taken
        };
        DiscTable {
            step,
            values: (0..knots).into_par_iter().map(value).collect(),
        }
    }

    /// Wave numbers (1/mm), and what the rigid core takes of each from the half space.
    fn waves(&self, a: f64, end: f64) -> Vec<(f64, f64)> {
        if self.layer.thickness.is_infinite() {
            return Vec::new();
        }
        let spread = |k: f64| match k * a {
            x if x < 1e-6 => 1.0,
            x => 2.0 * j1(x) / x,
        };
        // Waves of r and of a beat: no panel is longer than one oscillation of the faster.
        let nodes = wave_numbers(self.layer.thickness, end + a).into_iter();
        nodes
            .map(|(k, w)| (k, w * (1.0 - self.layer.transfer(k)) * spread(k)))
            .collect()
    }
}

fn number_of(a: f64) -> i32 {
    (a.ln() / RADIUS_RATIO.ln()).round() as i32
}

/// Mean of 1/distance over a disc of radius `a`, seen from its plane at `r` from its middle (Johnson, Contact Mechanics 3.4).
fn half_space(r: f64, a: f64) -> f64 {
    let ratio = r / a;
    if ratio <= 1.0 {
        let (_, e) = elliptic(ratio * ratio);
        return 4.0 / (std::f64::consts::PI * a) * e;
    }
    let m = 1.0 / (ratio * ratio);
    let (k, e) = elliptic(m);
    let lowered = if m < 1.0 { (1.0 - m) * k } else { 0.0 };
    4.0 * ratio / (std::f64::consts::PI * a) * (e - lowered)
}

/// Complete elliptic integrals K and E of parameter m = k^2, by the arithmetic-geometric mean (Abramowitz and Stegun 17.6).
fn elliptic(m: f64) -> (f64, f64) {
    if m >= 1.0 {
        return (f64::INFINITY, 1.0);
    }
    let (mut a, mut b, mut c) = (1.0, (1.0 - m).sqrt(), m.sqrt());
    let (mut sum, mut weight) = (0.5 * c * c, 0.5);
    while c > 1e-16 {
        (a, b, c) = (0.5 * (a + b), (a * b).sqrt(), 0.5 * (a - b));
        weight *= 2.0;
        sum += weight * c * c;
    }
    let k = std::f64::consts::FRAC_PI_2 / a;
    (k, k * (1.0 - sum))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::response::kernel_tables::KernelTables;

    #[test]
    fn a_disc_is_two_over_its_radius_at_its_middle_and_a_point_far_away() {
        assert!((half_space(0.0, 1.5) - 2.0 / 1.5).abs() < 1e-12);
        // At the rim: 4 / (pi a).
        assert!((half_space(1.5, 1.5) - 4.0 / (std::f64::consts::PI * 1.5)).abs() < 1e-12);
        assert!((half_space(30.0, 1.5) * 30.0 - 1.0).abs() < 5e-4);
    }

    #[test]
    fn the_average_over_a_disc_meets_a_sum_over_many_points() {
        let layer = Layer {
            thickness: 2.0,
            poisson_ratio: 0.3,
        };
        let a = 1.3;
        let mut kernels = DiscKernels::new(layer, 100.0);
        kernels.make([a].into_iter());
        let tables = KernelTables::new(&[layer], 40.0);
        for r in [2.0, 3.1, 5.0] {
            let (mut sum, mut count) = (0.0, 0);
            for i in -200..=200 {
                for j in -200..=200 {
                    let (x, y) = (f64::from(i) * a / 200.0, f64::from(j) * a / 200.0);
                    if x * x + y * y <= a * a {
                        let d = ((x - r).powi(2) + y * y).sqrt();
                        sum += 1.0 / d - tables.psi(0, 0, d);
                        count += 1;
                    }
                }
            }
            let (found, wanted) = (kernels.at(r, a), sum / f64::from(count));
            assert!((found - wanted).abs() < 0.01 / a, "{r}: {found} {wanted}");
        }
    }

    #[test]
    fn a_layer_far_thinner_than_the_disc_yields_as_a_confined_column() {
        // Under the middle of the disc: pi a^2 times the kernel is what a pressure of pi a^2 over the disc moves, 2 pi K(k)/k at k = 0.
        for (a, thickness) in [(2.0, 0.2), (2.0, 0.05), (1.0, 0.1)] {
            let layer = Layer {
                thickness,
                poisson_ratio: 0.3,
            };
            let mut kernels = DiscKernels::new(layer, 100.0);
            kernels.make([a].into_iter());
            let number = RADIUS_RATIO.powi(number_of(a));
            let found = number * number * kernels.at(0.0, a) / 2.0;
            let column = layer.transfer(1e-6 / thickness) / (1e-6 / thickness);
            assert!(
                (found / column - 1.0).abs() < 0.02,
                "{a} {thickness}: {found} {column}"
            );
        }
    }

    #[test]
    fn an_incompressible_film_under_a_wide_disc_moves_at_its_rim_only() {
        let layer = Layer {
            thickness: 0.2,
            poisson_ratio: 0.5,
        };
        let mut kernels = DiscKernels::new(layer, 100.0);
        kernels.make([2.0].into_iter());
        let middle = kernels.at(0.0, 2.0) * 2.0;
        assert!(
            middle.abs() < 1e-3,
            "{middle} of the half space's 2 at the middle"
        );
    }
}
