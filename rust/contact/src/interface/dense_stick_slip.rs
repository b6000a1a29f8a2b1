//! The friction problem of a dense matrix given by the caller.

use super::disc_solver::solve_discs;
use super::shear_matrix::ShearMatrix;
use crate::{ContactError, Control};

const TILE: usize = 32;

/// Forces and slip of a friction problem in the plane.
#[derive(Debug, Clone, PartialEq)]
pub struct StickSlip {
    /// Shear force by site, both components next to each other, N.
    pub force: Vec<f64>,
    /// Slip of the skin over the product, laid out the same way, mm.
    pub slip: Vec<f64>,
    /// Largest natural residual `d_i |q_i - P(q_i - slip_i / d_i)|` relative to the longest travel.
    pub residual: f64,
    /// Products with the matrix that it took.
    pub products: usize,
}

/// Solves `|q_i| <= limit_i`, slip `A q - travel` zero inside and against `q_i` on the rim (Coulomb's law for given pressure).
///
/// `matrix` (2n 2n, row by row, mm/N) is symmetric and definite, both components of a site next to each other, as in `travel`
/// (2n, mm) of the product; `limit` (n, N) is mu times the normal force.
///
/// # Errors
/// [`ContactError::DenseShape`], `DenseEntry` or `SlipLimit` if the arrays do not fit or are no friction problem.
pub fn solve_stick_slip(
    matrix: &[f64],
    travel: &[f64],
    limit: &[f64],
) -> Result<StickSlip, ContactError> {
    let n = limit.len();
    if travel.len() != 2 * n || matrix.len() != 4 * n * n {
        return Err(ContactError::DenseShape {
            found: matrix.len(),
            gaps: travel.len(),
        });
    }
    check(matrix, travel, limit)?;
    let matrix = ShearMatrix::from_dense(matrix, n);
    let planar = |c: usize| (0..n).map(move |i| -travel[2 * i + c]);
    let offset: Vec<f64> = planar(0).chain(planar(1)).collect();
    let solution = solve_discs(&matrix, &offset, limit, None, &Control::none());
    let paired = |field: &[f64]| (0..n).flat_map(|i| [field[i], field[n + i]]).collect();
    Ok(StickSlip {
        force: paired(&solution.force),
        slip: paired(&solution.slip),
        residual: solution.residual,
        products: solution.products,
    })
}

fn check(matrix: &[f64], travel: &[f64], limit: &[f64]) -> Result<(), ContactError> {
    let size = travel.len();
    // In tiles: a column of a large matrix read alone costs a cache line an entry.
    for first_row in (0..size).step_by(TILE) {
        for first in (0..=first_row).step_by(TILE) {
            for row in first_row..(first_row + TILE).min(size) {
                for column in first..(first + TILE).min(row + 1) {
                    let (found, other) = (matrix[row * size + column], matrix[column * size + row]);
                    let off = (found - other).abs();
                    let is_symmetric = off <= 1e-12 * found.abs().max(other.abs());
                    if !found.is_finite() || !is_symmetric || (row == column && found <= 0.0) {
                        return Err(ContactError::DenseEntry { row, column, found });
                    }
                }
            }
        }
    }
    if let Some(row) = travel.iter().position(|t| !t.is_finite()) {
        return Err(ContactError::DenseEntry {
            row,
            column: size,
            found: travel[row],
        });
    }
    let is_admissible = |r: &f64| *r >= 0.0 && r.is_finite();
    match limit.iter().position(|r| !is_admissible(r)) {
        None => Ok(()),
        Some(site) => Err(ContactError::SlipLimit {
            site,
            found: limit[site],
        }),
    }
}
