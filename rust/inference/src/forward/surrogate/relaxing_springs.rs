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

/// By row and spring that touches, the length that memory takes off what an elastic spring bears, mm.
#[derive(Debug, Clone, Default)]
pub(crate) struct Lost {
    lengths: Vec<f64>,
    /// Number of springs that touch.
    count: usize,
}

impl Lost {
    /// By row, the force that memory adds (below 0: takes off) on springs of that stiffness, N/mm.
    pub(crate) fn forces(&self, springs: &[f64]) -> Vec<f64> {
        let row = |lost: &[f64]| springs.iter().zip(lost).map(|(k, lost)| k * lost).sum();
        self.lengths
            .chunks_exact(self.count.max(1))
            .map(row)
            .collect()
    }
}

/// By row, force over what elastic springs bear: `sum_j k_j (s_j - max(d - d_j, 0))`, with stiffness `springs` (N/mm).
pub(crate) fn relaxation_loss(way: &SpringHistory<'_>, springs: &[f64]) -> Vec<f64> {
    let lost = lost_lengths(way);
    match lost.count {
        0 => vec![0.0; way.depths.len()],
        _ => lost.forces(springs),
    }
}

/// What memory takes off every spring.
#[multiversion::multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2"))]
pub(crate) fn lost_lengths(way: &SpringHistory<'_>) -> Lost {
    let deepest = way.depths.iter().fold(0.0, |most: f64, d| most.max(*d));
    // A spring that never touches bears nothing.
    let touches: Vec<f64> = way
        .touches
        .iter()
        .copied()
        .take_while(|t| *t < deepest)
        .collect();
    let count = touches.len();
    let (mut last, mut length, mut borne) = (vec![0.0; count], vec![0.0; count], vec![0.0; count]);
    let mut left = vec![vec![0.0; count]; way.relaxation_branches.len()];
    let mut lengths = Vec::with_capacity(count * way.depths.len());
    for (n, depth) in way.depths.iter().enumerate() {
        for ((length, borne), touch) in length.iter_mut().zip(&mut borne).zip(&touches) {
            *length = (depth - touch).max(0.0);
            *borne = *length;
        }
        for ((branch, share), left) in way
            .relaxation_branches
            .iter()
            .zip(way.shares)
            .zip(&mut left)
        {
            let (decay, mean) = if n == 0 { (0.0, 1.0) } else { branch[n] };
            let each = left
                .iter_mut()
                .zip(&mut borne)
                .zip(length.iter().zip(&last));
            for ((left, borne), (length, last)) in each {
                *left = *left * decay + (length - last) * mean;
                *borne -= share * (length - *left);
            }
        }
        last.copy_from_slice(&length);
        // Skin that does not cling does not pull.
        let each = borne.iter().zip(&length);
        lengths.extend(each.map(|(borne, length)| borne.max(0.0) - length));
    }
    Lost { lengths, count }
}
