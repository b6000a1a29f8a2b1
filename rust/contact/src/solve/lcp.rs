//! The linear complementarity problem of a contact: find `p >= 0` with `s = A p + d >= 0` and `p s = 0` (Xie Eq. 13-14).
//!
//! What a solver needs of the matrix `A`, how accurately it solves, and what it returns.

use super::row_runs::{Entry, RowRuns};
use super::submatrix::Submatrix;
use super::symmetric::Symmetric;
use super::tolerances::{EXACT, FINE, FIRST, ROUGH};

/// A compliance that contact is solved with, mm/N.
pub trait Compliance: Symmetric {
    /// Some rows of the matrix times `x`.
    fn times_rows(&self, rows: &[u32], x: &[f64], out: &mut [f64]);

    /// A bound on the largest eigenvalue.
    fn norm_bound(&self) -> f64;

    /// The part that a contact set (ascending) is solved on; a rough solution may be had with less precision.
    fn submatrix(&self, set: &[u32], is_rough: bool) -> Submatrix<'_>;

    /// Whether that part has less precision than the matrix.
    fn is_narrow(&self, is_rough: bool) -> bool;

    /// Whether products are what a solution's time goes to, whatever else is done.
    fn is_costly(&self) -> bool {
        false
    }
}

impl<T: Entry> Compliance for RowRuns<T> {
    fn times_rows(&self, rows: &[u32], x: &[f64], out: &mut [f64]) {
        RowRuns::times_rows(self, rows, x, out);
    }

    /// Gershgorin's.
    fn norm_bound(&self) -> f64 {
        (0..self.len())
            .map(|i| self.row(i).1.iter().map(|v| v.wide().abs()).sum())
            .fold(f64::MIN_POSITIVE, f64::max)
    }

    fn submatrix(&self, set: &[u32], is_rough: bool) -> Submatrix<'_> {
        Submatrix::new(self, set, Compliance::is_narrow(self, is_rough))
    }

    fn is_narrow(&self, is_rough: bool) -> bool {
        is_rough && size_of::<T>() > 4
    }
}

/// How far a contact problem is solved.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Accuracy {
    /// To 1e-4 of the largest gap: enough to see where the surface goes.
    Rough,
    /// To 1e-12 of it: the certificate; from forces that are already rough, this costs least.
    #[default]
    Full,
}

impl Accuracy {
    /// Residuals to go through, relative to the largest gap; the set must hold still before the next is taken.
    ///
    /// Where products are dear, the set is looked at on the way to the certificate, not only at its end, and not before a rough
    /// solution: steps are few, and each look costs two products.
    pub(super) fn levels(self, is_costly: bool) -> &'static [f64] {
        match self {
            Accuracy::Rough if is_costly => &[ROUGH],
            Accuracy::Rough => &[FIRST, ROUGH],
            Accuracy::Full if is_costly => &[FINE, EXACT],
            Accuracy::Full => &[EXACT],
        }
    }

    /// Largest complementarity of a contact that counts as solved.
    pub fn certificate(self) -> f64 {
        match self {
            Accuracy::Rough => 5e-3,
            Accuracy::Full => 1e-10,
        }
    }
}

/// Forces and what is left of the equations.
#[derive(Debug, Clone, PartialEq)]
pub struct Solution {
    /// Nodal force, N, >= 0.
    pub force: Vec<f64>,
    /// Slack `A p + d`, mm, >= 0.
    pub slack: Vec<f64>,
    /// Largest |min(A_ii p_i, s_i)|, relative to the largest |d|.
    pub complementarity: f64,
    /// Changes of the contact set.
    pub pivots: usize,
    /// Conjugate-gradient steps, or products of the fallback.
    pub steps: usize,
    /// True if the fallback was needed.
    pub fell_back: bool,
}
