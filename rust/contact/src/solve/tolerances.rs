//! Tolerances of the contact solvers: residuals relative to the largest gap.

/// Residual of the first level of a rough solution.
pub(super) const FIRST: f64 = 1e-2;
/// Residual from which a level is loose.
pub(super) const ROUGH: f64 = 1e-4;
/// Residual at which the set of a large problem is looked at once more: a set that proves wrong later is solved twice.
pub(super) const FINE: f64 = 1e-7;
/// Residual of the certificate.
pub(super) const EXACT: f64 = 1e-12;
