//! Knots and quadrature nodes of the kernel tables.

use super::bonded_layer::Layer;

/// Range of the kernels in thicknesses.
///
/// At 6 h the normal response has fallen to 0.8 % of the half space's; the slowest wave of shear falls as
/// exp(-pi r / 2 h), to 1e-4.
pub const RANGE_IN_THICKNESSES: f64 = 6.0;
/// Knots per smallest thickness; cubic interpolation is then within 5e-7 of the integral.
pub const KNOTS_PER_THICKNESS: f64 = 24.0;
/// Where what bone takes off the half space is taken as zero, in k h: 1 - K falls as 4 s^2 exp(-2 s), shear as exp(-2 s).
const CUT_OFF_WAVE_NUMBER: f64 = 18.0;
/// Fewest panels of a sum over wave numbers.
const LEAST_PANELS: usize = 12;

/// Nodes and weights of the 8-point Gauss-Legendre rule on (-1, 1), each for both signs.
pub const RULE: [(f64, f64); 4] = [
    (0.183_434_642_495_649_8, 0.362_683_783_378_362),
    (0.525_532_409_916_329, 0.313_706_645_877_887_3),
    (0.796_666_477_413_626_7, 0.222_381_034_453_374_5),
    (0.960_289_856_497_536_2, 0.101_228_536_290_376_3),
];

/// Knots of the tables of all pairs of some layers.
pub struct Grid {
    /// Distance of the knots, mm.
    pub step: f64,
    /// Where the tables end, mm.
    pub reach: f64,
    thinnest: f64,
}

impl Grid {
    /// For distances up to `size` (the extent of the skin, mm), with `most` knots at most.
    pub fn new(layers: &[Layer], size: f64, most: usize) -> Self {
        let finite = || layers.iter().map(|l| l.thickness).filter(|h| h.is_finite());
        let thinnest = finite().fold(f64::INFINITY, f64::min);
        let thickest = finite().fold(0.0, f64::max);
        let has_half_space = layers.iter().any(|l| l.thickness.is_infinite());
        let range = if has_half_space {
            f64::INFINITY
        } else {
            RANGE_IN_THICKNESSES * thickest
        };
        let reach = range.min(size.max(thickest));
        let step = (thinnest / KNOTS_PER_THICKNESS).max(reach / most as f64);
        Grid {
            step,
            reach,
            thinnest,
        }
    }

    /// True if there is nothing to tabulate: half spaces only.
    pub fn is_half_space(&self) -> bool {
        self.thinnest.is_infinite()
    }

    /// Knots of one table: one before zero (the kernels are even there), two behind the end.
    pub fn knots(&self) -> usize {
        (self.reach / self.step).ceil() as usize + 3
    }

    /// Nodes (1/mm) and weights of panels no longer than one oscillation of J0 at the farthest knot.
    pub fn wave_numbers(&self) -> Vec<(f64, f64)> {
        wave_numbers(self.thinnest, self.reach)
    }
}

/// Nodes (1/mm) and weights for what a rigid base under `thinnest` mm takes off the half space, of panels no longer than one
/// oscillation of J0 at `reach` mm.
pub fn wave_numbers(thinnest: f64, reach: f64) -> Vec<(f64, f64)> {
    let end = CUT_OFF_WAVE_NUMBER / thinnest;
    let panels = ((end * reach / std::f64::consts::TAU).ceil() as usize).max(LEAST_PANELS);
    let half = 0.5 * end / panels as f64;
    let mut nodes = Vec::with_capacity(panels * 8);
    for panel in 0..panels {
        let middle = (2 * panel + 1) as f64 * half;
        for (x, w) in RULE {
            nodes.push((middle - half * x, half * w));
            nodes.push((middle + half * x, half * w));
        }
    }
    nodes
}

/// Number of the table of the layers `a` and `b`, in any order.
pub fn pair(a: usize, b: usize) -> usize {
    let (a, b) = if a <= b { (a, b) } else { (b, a) };
    b * (b + 1) / 2 + a
}
