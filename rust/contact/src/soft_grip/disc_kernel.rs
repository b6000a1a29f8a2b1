//! How far a layer yields about a force that is spread evenly over a disc.
//!
//! The force of a skin vertex stands for a pressure over the vertex's area. Taken at a point it would make the layer yield
//! without bound there. The kernel of the layer, `1/r - Psi(r)`, is averaged over a disc of that area.

use crate::response::bonded_layer::Layer;
use crate::response::kernel_grid::RANGE_IN_THICKNESSES;
use crate::response::layer_kernel::KernelTables;

/// Ratio of neighboring radii for which tables are made; a disc takes the nearest.
const RADIUS_RATIO: f64 = 1.05;
/// Knots of a table for every disc radius or quarter thickness, whichever is less.
const KNOTS_PER_LENGTH: f64 = 8.0;
/// Distance beyond which a half space sees a disc as a point, in radii: off by 1e-4.
const FAR_IN_RADII: f64 = 8.0;
/// Rings and points of each by which Psi is averaged over a disc.
const RINGS: usize = 4;
const SPOKES: usize = 12;

/// Kernels of one layer averaged over discs.
#[derive(Debug)]
pub struct DiscKernels {
    layer: Layer,
    tables: KernelTables,
    /// Number of the least radius, and a table for each from there on that was asked for.
    first: i32,
    discs: Vec<Option<DiscTable>>,
}

#[derive(Debug)]
struct DiscTable {
    step: f64,
    values: Vec<f64>,
}

impl DiscKernels {
    /// Tables for discs of these radii, mm.
    pub fn new(layer: Layer, radii: &[f64]) -> Self {
        let numbers: Vec<i32> = radii.iter().map(|a| number_of(*a)).collect();
        let first = numbers.iter().copied().min().unwrap_or(0);
        let last = numbers.iter().copied().max().unwrap_or(0);
        let most = radii.iter().copied().fold(0.0, f64::max);
        let reach = match layer.thickness.is_finite() {
            true => RANGE_IN_THICKNESSES * layer.thickness + 2.0 * most,
            false => FAR_IN_RADII * most,
        };
        let tables = KernelTables::new(&[layer], reach);
        let mut kernels = DiscKernels {
            layer,
            tables,
            first,
            discs: (first..=last).map(|_| None).collect(),
        };
        for number in numbers {
            let place = (number - first) as usize;
            if kernels.discs[place].is_none() {
                kernels.discs[place] = Some(kernels.table(RADIUS_RATIO.powi(number)));
            }
        }
        kernels
    }

    /// The kernel at distance `r` from the middle of a disc of radius `a` (mm), 1/mm. The radius was asked for before.
    pub fn at(&self, r: f64, a: f64) -> f64 {
        let place = (number_of(a) - self.first) as usize;
        let Some(table) = self.discs.get(place).and_then(Option::as_ref) else {
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
            true => self.reach(a),
            false => FAR_IN_RADII * a,
        };
        let knots = (end / step).ceil() as usize + 2;
        let values = (0..knots).map(|k| self.averaged(k as f64 * step, a));
        DiscTable {
            step,
            values: values.collect(),
        }
    }

    fn averaged(&self, r: f64, a: f64) -> f64 {
        if self.layer.thickness.is_infinite() {
            return half_space(r, a);
        }
        // Rings of equal area, points turned from ring to ring.
        let mut psi = 0.0;
        for ring in 0..RINGS {
            let rho = a * ((ring as f64 + 0.5) / RINGS as f64).sqrt();
            for spoke in 0..SPOKES {
                let angle = std::f64::consts::TAU * (spoke as f64 + 0.5 * (ring % 2) as f64)
                    / SPOKES as f64;
                let d = (r * r + rho * rho - 2.0 * r * rho * angle.cos())
                    .max(0.0)
                    .sqrt();
                psi += match d < RANGE_IN_THICKNESSES * self.layer.thickness {
                    true => self.tables.psi(0, 0, d),
                    false => 1.0 / d,
                };
            }
        }
        half_space(r, a) - psi / (RINGS * SPOKES) as f64
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
        let (a, kernels) = (1.3, DiscKernels::new(layer, &[1.3]));
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
}
