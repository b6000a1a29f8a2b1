//! The contact problem of a dense matrix given by the caller.

use super::block_pivoting::solve_contact;
use super::lcp::{Accuracy, Solution};
use super::row_runs::RowRuns;
use crate::{ContactError, Control};

const TILE: usize = 32;
/// Share of the deepest gap beyond which places start in contact; any share finds the same set. Hertz: the contact's edge is at 0.5.
const FIRST_SHARE: f64 = 0.5;
/// Largest difference of mirrored entries, relative.
const SYMMETRY: f64 = 1e-12;

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
    for (above, left) in
        tiles(n).flat_map(|a| tiles(n).filter(move |b| *b <= a).map(move |b| (a, b)))
    {
        if !is_sound_tile(&matrix, n, (above, left)) {
            check_entries(&matrix, n, (above, left))?;
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
    let (matrix, control) = (RowRuns::dense(matrix, n), Control::none());
    let start = first_forces(&matrix, gap);
    let rough = (Accuracy::Rough, &control);
    let rough = solve_contact(&matrix.narrow(), gap, Some(&start), rough);
    Ok(solve_contact(
        &matrix,
        gap,
        Some(&rough.force),
        (Accuracy::Full, &control),
    ))
}

/// Small forces that mark where contact is likely: of what a smooth indenter overlaps on a half space, the inner half touches.
fn first_forces(matrix: &RowRuns<f64>, gap: &[f64]) -> Vec<f64> {
    let deepest = gap.iter().fold(0.0, |least, d| f64::min(least, *d));
    let alone = |(d, a): (&f64, &f64)| {
        if *d < FIRST_SHARE * deepest {
            -d / a
        } else {
            0.0
        }
    };
    let forces = gap.iter().zip(matrix.diagonal()).map(alone);
    forces.map(|p| p / gap.len() as f64).collect()
}

/// Whether a tile and its mirror image hold finite numbers that agree; says nothing of the diagonal's sign.
fn is_sound_tile(matrix: &[f64], n: usize, (above, left): (usize, usize)) -> bool {
    if above == left || above + TILE > n {
        return false;
    }
    let mut mirror = [[0.0; TILE]; TILE];
    for k in 0..TILE {
        let column = &matrix[(left + k) * n + above..][..TILE];
        for (row, value) in mirror.iter_mut().zip(column) {
            row[k] = *value;
        }
    }
    let mut is_sound = true;
    for (k, mirrored) in mirror.iter().enumerate() {
        let row = &matrix[(above + k) * n + left..][..TILE];
        for (a, b) in row.iter().zip(mirrored) {
            // False for what is not finite, too.
            let most = SYMMETRY * a.abs();
            is_sound &= (a - b).abs() <= most && most < f64::INFINITY;
        }
    }
    is_sound
}

fn check_entries(
    matrix: &[f64],
    n: usize,
    (above, left): (usize, usize),
) -> Result<(), ContactError> {
    for row in above..(above + TILE).min(n) {
        for column in left..(left + TILE).min(row + 1) {
            let (found, other) = (matrix[row * n + column], matrix[column * n + row]);
            let is_symmetric = (found - other).abs() <= SYMMETRY * found.abs().max(other.abs());
            if !found.is_finite() || !is_symmetric || (row == column && found <= 0.0) {
                return Err(ContactError::DenseEntry { row, column, found });
            }
        }
    }
    Ok(())
}
