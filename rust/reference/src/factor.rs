//! Sparse Cholesky factorization, its order found once (faer).

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::LltRegularization;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymbolicCholesky, SymmetricOrdering,
    factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, MatMut, Par, Side};

use crate::pattern::Pattern;

/// Largest factor, numbers: 3 GB.
const MOST_VALUES: usize = 400_000_000;

/// A matrix pattern with its elimination order, and room for the factor.
pub struct Factor {
    symbolic: SymbolicCholesky<usize>,
    values: Vec<f64>,
    size: usize,
    /// Room for the computation.
    room: MemBuffer,
}

impl Factor {
    /// `None` where the factor would take more than 3 GB, or there is not enough memory.
    pub fn new(pattern: &Pattern) -> Option<Factor> {
        let size = pattern.columns.len() - 1;
        let matrix =
            SymbolicSparseColMatRef::new_checked(size, size, &pattern.columns, None, &pattern.rows);
        let symbolic = factorize_symbolic_cholesky(
            matrix,
            Side::Lower,
            SymmetricOrdering::Amd,
            CholeskySymbolicParams::default(),
        )
        .ok()?;
        let length = symbolic.len_val();
        if length > MOST_VALUES {
            return None;
        }
        let mut values = Vec::new();
        values.try_reserve_exact(length).ok()?;
        values.resize(length, 0.0);
        let par = Par::Seq;
        let need = symbolic
            .factorize_numeric_llt_scratch::<f64>(par, Default::default())
            .or(symbolic.solve_in_place_scratch::<f64>(1, par));
        let room = MemBuffer::try_new(need).ok()?;
        Some(Factor {
            symbolic,
            values,
            size,
            room,
        })
    }

    /// Solves the system in place. False where the matrix is not positive definite.
    pub fn solve(&mut self, pattern: &Pattern, values: &[f64], right: &mut [f64]) -> bool {
        let matrix = SymbolicSparseColMatRef::new_checked(
            self.size,
            self.size,
            &pattern.columns,
            None,
            &pattern.rows,
        );
        let matrix = SparseColMatRef::new(matrix, values);
        // One thread: the same bits for any number of threads of the caller.
        let par = Par::Seq;
        let factored = self.symbolic.factorize_numeric_llt(
            &mut self.values,
            matrix,
            Side::Lower,
            LltRegularization::default(),
            par,
            MemStack::new(&mut self.room),
            Default::default(),
        );
        if factored.is_err() {
            return false;
        }
        let right = MatMut::from_column_major_slice_mut(right, self.size, 1);
        LltRef::<usize, f64>::new(&self.symbolic, &self.values).solve_in_place_with_conj(
            Conj::No,
            right,
            par,
            MemStack::new(&mut self.room),
        );
        true
    }
}
