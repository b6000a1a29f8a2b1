//! Preconditioned conjugate gradients on a principal submatrix.

use super::symmetric::Symmetric;

/// How a run of conjugate gradients ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CgEnd {
    /// The residual is within the tolerance.
    Converged,
    /// The step limit was reached.
    StepLimit,
    /// A direction of no or negative curvature: the matrix is not definite.
    NotDefinite,
}

/// Steps between two looks at the caller's wish to stop.
const AT_ONCE: usize = 8;

/// When to stop.
#[derive(Clone, Copy)]
pub struct CgLimits<'a> {
    /// Largest residual entry, in the right-hand side's unit.
    pub tolerance: f64,
    /// Most steps.
    pub steps: usize,
    /// Asked now and then; true ends the run as converged, for who asked knows better.
    pub cancelled: &'a dyn Fn() -> bool,
}

/// Solves `matrix x = right` for the unknowns in `set` (ascending), from the `x` given; others are and stay zero.
///
/// Returns how it ended and the steps taken.
pub fn conjugate_gradient(
    matrix: &dyn Symmetric,
    right: &[f64],
    (x, set): (&mut [f64], &[u32]),
    limits: CgLimits<'_>,
) -> (CgEnd, usize) {
    let n = matrix.diagonal().len();
    let mut image = vec![0.0; n];
    matrix.times(x, &mut image);
    let mut residual: Vec<f64> = set
        .iter()
        .map(|&i| right[i as usize] - image[i as usize])
        .collect();
    let preconditioner = matrix.preconditioner(set);
    let mut inverse = vec![0.0; set.len()];
    let mut direction = vec![0.0; n];
    let mut weight = 0.0;
    for step in 0..limits.steps {
        let is_stopped = step > 0 && step % AT_ONCE == 0 && (limits.cancelled)();
        if is_stopped || largest(&residual) <= limits.tolerance {
            return (CgEnd::Converged, step);
        }
        let previous = weight;
        preconditioner.apply(&residual, &mut inverse);
        weight = residual.iter().zip(&inverse).map(|(r, z)| r * z).sum();
        let beta = if step == 0 { 0.0 } else { weight / previous };
        for (&i, z) in set.iter().zip(&inverse) {
            let p = &mut direction[i as usize];
            *p = z + beta * *p;
        }
        matrix.times(&direction, &mut image);
        let curvature: f64 = set
            .iter()
            .map(|&i| direction[i as usize] * image[i as usize])
            .sum();
        if curvature.is_nan() || curvature <= 0.0 {
            return (CgEnd::NotDefinite, step);
        }
        let length = weight / curvature;
        for (&i, r) in set.iter().zip(&mut residual) {
            x[i as usize] += length * direction[i as usize];
            *r -= length * image[i as usize];
        }
    }
    (CgEnd::StepLimit, limits.steps)
}

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |most, v| f64::max(most, v.abs()))
}
