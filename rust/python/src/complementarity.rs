//! The solvers of contact and friction alone, for a compliance that somebody else made.

use crate::conversion::arrays::{Argument, column, table};
use crate::conversion::ending;
use crate::conversion::errors::Failure;
use crate::conversion::record::record;
use pyo3::prelude::*;
use pyo3::types::PyDict;

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
    let solved = ending::call(py, || thenar_contact::solve_dense(matrix, &gap));
    Ok(column(py, solved.map_err(Failure::from)?.force))
}

/// Shear forces of the friction problem |q_i| <= limit_i: slip A q - travel is zero inside the limit and against q_i on it.
///
/// `matrix` (2n, 2n), mm/N, symmetric and positive definite, both components of a site next to each other; `travel_mm` (n, 2)
/// of the product; `limit_n` (n,), friction times normal force. Returns a record: force_n (n, 2), slip_mm (n, 2), residual
/// (relative to the longest travel), products. Raises SolveError for arrays that do not fit together.
#[pyfunction]
pub fn solve_stick_slip(
    py: Python<'_>,
    matrix: &Bound<'_, PyAny>,
    travel_mm: &Bound<'_, PyAny>,
    limit_n: &Bound<'_, PyAny>,
) -> PyResult<Py<PyAny>> {
    let matrix = Argument::solve("matrix", matrix).square()?;
    let sites = (matrix.len() as f64).sqrt().round() as usize / 2;
    let travel = Argument::solve("travel_mm", travel_mm).pairs_of(sites)?;
    let limit = Argument::solve("limit_n", limit_n).numbers_of(sites)?;
    let solved = ending::call(py, || {
        thenar_contact::solve_stick_slip(&matrix, &travel, &limit)
    });
    let solved = solved.map_err(Failure::from)?;
    let entries = PyDict::new(py);
    entries.set_item("force_n", table(py, solved.force, 2)?)?;
    entries.set_item("slip_mm", table(py, solved.slip, 2)?)?;
    entries.set_item("residual", solved.residual)?;
    entries.set_item("products", solved.products)?;
    record(entries)
}
