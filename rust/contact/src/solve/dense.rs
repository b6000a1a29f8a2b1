//! The contact problem of a dense matrix that somebody else made.

use super::block_pivoting::{Accuracy, Solution, solve_contact};
use super::operator::Rows;
use crate::{ContactError, Control};

const TILE: usize = 32;

fn tiles(n: usize) -> impl Iterator<Item = usize> + Clone {
    (0..n).step_by(TILE)
}

/// Solves `p >= 0, s = A p + d >= 0, p s = 0` for a dense symmetric definite `matrix` (n n, row by row, mm/N) and a `gap` (n, mm).
///
/// # Errors
/// [`ContactError::DenseShape`] or [`ContactError::DenseEntry`] if the arrays do not fit or are not a compliance.
pub fn solve_dense(matrix: Vec<f64>, gap: &[f64]) -> Result<Solution, ContactError> {
    let n = gap.len();
    if matrix.len() != n * n {
        return Err(ContactError::DenseShape {
            found: matrix.len(),
            gaps: n,
        });
    }
    // In tiles: a column of a large matrix read alone costs a cache line an entry.
    for (first, row) in
        tiles(n).flat_map(|a| tiles(n).filter(move |b| *b <= a).map(move |b| (b, a)))
    {
        for row in row..(row + TILE).min(n) {
            for column in first..(first + TILE).min(row + 1) {
                let (found, other) = (matrix[row * n + column], matrix[column * n + row]);
                let is_symmetric = (found - other).abs() <= 1e-12 * found.abs().max(other.abs());
                if !found.is_finite() || !is_symmetric || (row == column && found <= 0.0) {
                    return Err(ContactError::DenseEntry { row, column, found });
                }
            }
        }
    }
    if let Some(row) = gap.iter().position(|d| !d.is_finite()) {
        return Err(ContactError::DenseEntry {
            row,
            column: n,
            found: gap[row],
        });
    }
    // Single precision finds the set at half the memory traffic; double precision gives the certificate.
    let (matrix, control) = (Rows::dense(matrix, n), Control::none());
    let rough = solve_contact(&matrix.narrow(), gap, None, (Accuracy::Rough, &control));
    Ok(solve_contact(
        &matrix,
        gap,
        Some(&rough.force),
        (Accuracy::Polish, &control),
    ))
}
