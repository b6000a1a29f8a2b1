//! The contact solver alone, for a compliance that somebody else made.

use crate::arrays::{Argument, column};
use crate::errors::Failure;
use pyo3::prelude::*;

/// Forces of the contact problem p >= 0, s = A p + d >= 0, p s = 0 (Xie Eq. 13, 14).
///
/// `matrix` (n, n), mm/N, symmetric and positive definite; `gap` (n,), mm, negative inside. Returns (n,), N. Raises SolveError
/// for arrays that do not fit together or are no compliance.
#[pyfunction]
pub fn solve_complementarity(
    py: Python<'_>,
    matrix: &Bound<'_, PyAny>,
    gap: &Bound<'_, PyAny>,
) -> PyResult<Py<PyAny>> {
    let matrix = Argument::solve("matrix", matrix).square()?;
    let n = (matrix.len() as f64).sqrt().round() as usize;
    let gap = Argument::solve("gap", gap).numbers_of(n)?;
    let solved = py.detach(|| thenar_contact::solve_dense(matrix, &gap));
    Ok(column(py, solved.map_err(Failure::from)?.force))
}
