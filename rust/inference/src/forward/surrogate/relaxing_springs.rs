//! Viscoelastic springs by the method of dimensionality reduction on a tool's force curve.
//!
//! An elastic force curve `f(d)`, joined by straight lines between rungs `d_j`, is that of springs of stiffness `k_j` that touch
//! one after the other at the depths `d_j`: `f(d) = sum_j k_j max(d - d_j, 0)`. Memory acts on each spring by itself, which is exact
//! for an axisymmetric tool that goes in (Lee & Radok 1960) and near to Ting's solution when it comes out (Popov & Hess 2015,
//! Method of Dimensionality Reduction).
//! What is computed is each spring's length times its share that is borne, over what an elastic spring would bear.

/// Steps shorter than this share of a period are taken by the series of the closed form.
const SHORT: f64 = 1e-6;

/// What the springs of one recording go through.
#[derive(Debug, Clone)]
pub struct SpringHistory<'a> {
    /// True depth by row, mm.
    pub depths: &'a [f64],
    /// Depth at which each spring touches, mm.
    pub touches: &'a [f64],
    /// By branch, decay and mean over each row's step.
    pub relaxation_branches: &'a [Vec<(f64, f64)>],
    /// Share of each branch.
    pub shares: &'a [f64],
}

/// Decay and mean of a branch over steps of its clock in periods.
pub(crate) fn branch_decay(steps: &[f64]) -> Vec<(f64, f64)> {
    let one = |x: &f64| match *x < SHORT {
        true => (1.0 - x, 1.0 - 0.5 * x),
        false => {
            let decay = libm::exp(-x);
            (decay, (1.0 - decay) / x)
        }
    };
    steps.iter().map(one).collect()
}

/// By row, force over what elastic springs bear: `sum_j k_j (s_j - max(d - d_j, 0))`, with stiffness `springs` (N/mm).
pub(crate) fn relaxation_loss(way: &SpringHistory<'_>, springs: &[f64]) -> Vec<f64> {
    let rows = way.depths.len();
    let mut all = vec![0.0; rows];
    let mut left = vec![0.0; way.relaxation_branches.len()];
    for (touch, k) in way.touches.iter().zip(springs) {
        left.fill(0.0);
        let mut last = 0.0;
        for n in 0..rows {
            let length = (way.depths[n] - touch).max(0.0);
            let mut borne = length;
            for (b, relaxation_branches) in way.relaxation_branches.iter().enumerate() {
                let (decay, mean) = match n {
                    0 => (0.0, 1.0),
                    _ => relaxation_branches[n],
                };
                left[b] = left[b] * decay + (length - last) * mean;
                borne -= way.shares[b] * (length - left[b]);
            }
            last = length;
            // Skin that does not cling does not pull.
            all[n] += k * (borne.max(0.0) - length);
        }
    }
    all
}
