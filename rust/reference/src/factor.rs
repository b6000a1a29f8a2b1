//! Sparse Cholesky factorization in single precision, its order found once (faer), and conjugate gradients in double precision with it.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::LltRegularization;
use faer::sparse::linalg::SymbolicSupernodalParams;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymbolicCholesky, SymmetricOrdering,
    factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, MatMut, Par, Side};

use crate::pattern::Pattern;

/// Largest factor, numbers: 1.6 GB.
const MOST_VALUES: usize = 400_000_000;
/// Residual over that of zero, both in the norm of the factor, that is enough; on the samples one or two iterations give 1e-5.
const ACCURACY: f64 = 1e-4;
/// Most iterations: a factor that needs more is of no use.
const MOST_ITERATIONS: usize = 30;
/// Supernodes are merged up to so many columns, where zeros are less than this share. A skin vertex has nine columns, three layers of three axes.
const MERGED: &[(usize, f64)] = &[(9, 1.0), (36, 0.5), (96, 0.2), (usize::MAX, 0.05)];

/// A matrix pattern with its elimination order, and room for the factor.
pub struct Factor {
    symbolic: SymbolicCholesky<usize>,
    values: Vec<f32>,
    /// The matrix in single precision.
    single: Vec<f32>,
    size: usize,
    /// Room for the computation.
    room: MemBuffer,
}

impl Factor {
    /// `None` where the factor would take more than 1.6 GB, or there is not enough memory.
    pub fn new(pattern: &Pattern) -> Option<Factor> {
        let size = pattern.columns.len() - 1;
        let matrix =
            SymbolicSparseColMatRef::new_checked(size, size, &pattern.columns, None, &pattern.rows);
        let symbolic = factorize_symbolic_cholesky(
            matrix,
            Side::Lower,
            SymmetricOrdering::Amd,
            CholeskySymbolicParams {
                supernodal_params: SymbolicSupernodalParams {
                    relax: Some(MERGED),
                },
                ..Default::default()
            },
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
            .factorize_numeric_llt_scratch::<f32>(par, Default::default())
            .or(symbolic.solve_in_place_scratch::<f32>(1, par));
        let room = MemBuffer::try_new(need).ok()?;
        Some(Factor {
            symbolic,
            values,
            single: Vec::new(),
            size,
            room,
        })
    }

    /// Solves the system in place: a factor in single precision, then conjugate gradients in double precision with it as preconditioner.
    /// False where the matrix is not positive definite.
    pub fn solve(&mut self, pattern: &Pattern, values: &[f64], right: &mut [f64]) -> bool {
        if !self.factorize(pattern, values) {
            return false;
        }
        let mut x = vec![0.0; right.len()];
        let mut direction = self.apply(right);
        let mut rest = dot(right, &direction);
        let enough = ACCURACY * ACCURACY * rest;
        for _ in 0..MOST_ITERATIONS {
            let image = pattern.times(values, &direction);
            let curvature = dot(&direction, &image);
            if curvature <= 0.0 || !curvature.is_finite() {
                return false;
            }
            let share = rest / curvature;
            for k in 0..x.len() {
                x[k] += share * direction[k];
                right[k] -= share * image[k];
            }
            let better = self.apply(right);
            let next = dot(right, &better);
            if next <= enough {
                right.copy_from_slice(&x);
                return true;
            }
            for (along, z) in direction.iter_mut().zip(&better) {
                *along = z + next / rest * *along;
            }
            rest = next;
        }
        false
    }

    /// False where the matrix is not positive definite in single precision.
    fn factorize(&mut self, pattern: &Pattern, values: &[f64]) -> bool {
        self.single.clear();
        self.single.extend(values.iter().map(|value| *value as f32));
        let matrix = SymbolicSparseColMatRef::new_checked(
            self.size,
            self.size,
            &pattern.columns,
            None,
            &pattern.rows,
        );
        let matrix = SparseColMatRef::new(matrix, &self.single);
        // One thread: the same bits for any number of threads of the caller.
        let factored = self.symbolic.factorize_numeric_llt(
            &mut self.values,
            matrix,
            Side::Lower,
            LltRegularization::default(),
            Par::Seq,
            MemStack::new(&mut self.room),
            Default::default(),
        );
        factored.is_ok()
    }

    /// The factor's solution, in single precision.
    fn apply(&mut self, right: &[f64]) -> Vec<f64> {
        let size = right.iter().fold(0.0_f64, |most, r| most.max(r.abs()));
        let scale = size.max(f64::MIN_POSITIVE);
        let mut column: Vec<f32> = right.iter().map(|r| (r / scale) as f32).collect();
        LltRef::<usize, f32>::new(&self.symbolic, &self.values).solve_in_place_with_conj(
            Conj::No,
            MatMut::from_column_major_slice_mut(&mut column, self.size, 1),
            Par::Seq,
            MemStack::new(&mut self.room),
        );
        column.iter().map(|x| f64::from(*x) * scale).collect()
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Tissue;
    use crate::prisms::PrismMesh;
    use thenar_surface::Vec3;

    /// A strip of eight triangles over bone.
    fn strip() -> Pattern {
        let at = |k: usize, z: f64| Vec3::new((k / 2) as f64, (k % 2) as f64, z);
        let tissue = Tissue {
            skin: (0..10).map(|k| at(k, 1.0)).collect(),
            bone: (0..10).map(|k| at(k, 0.0)).collect(),
            triangles: (0..4)
                .flat_map(|k| {
                    [
                        [2 * k, 2 * k + 2, 2 * k + 1],
                        [2 * k + 1, 2 * k + 2, 2 * k + 3],
                    ]
                })
                .collect(),
            is_held: vec![false; 10],
            can_touch: vec![true; 10],
            shear_modulus_mpa: vec![0.01; 10],
            stiffening: vec![0.0; 10],
        };
        Pattern::new(&PrismMesh::new(&tissue, 1).expect("the prisms have volume"))
    }

    /// Entries outside the diagonal of -1 and a diagonal of `row sum + margin`, in which the first unknown is `stiff` times stiffer.
    fn values(pattern: &Pattern, margin: f64, stiff: f64) -> Vec<f64> {
        let size = pattern.columns.len() - 1;
        let mut sums = vec![margin; size];
        let mut values = vec![-1.0; pattern.rows.len()];
        for column in 0..size {
            for row in &pattern.rows[pattern.columns[column] + 1..pattern.columns[column + 1]] {
                sums[column] += 1.0;
                sums[*row] += 1.0;
            }
        }
        for (entry, sum) in pattern.diagonal().iter().zip(sums) {
            values[*entry] = sum;
        }
        values[0] *= stiff;
        values
    }

    #[test]
    fn a_solution_is_far_finer_than_single_precision() {
        let pattern = strip();
        let values = values(&pattern, 0.01, 1e6);
        let truth: Vec<f64> = (0..pattern.columns.len() - 1)
            .map(|k| (1.0 + k as f64).sin())
            .collect();
        let mut solution = pattern.times(&values, &truth);
        let mut factor = Factor::new(&pattern).expect("memory");
        assert!(factor.solve(&pattern, &values, &mut solution));
        let error = solution.iter().zip(&truth).map(|(x, t)| (x - t).abs());
        assert!(error.fold(0.0, f64::max) < 1e-6);
    }

    #[test]
    fn a_matrix_that_is_not_definite_is_refused() {
        let pattern = strip();
        let values = values(&pattern, -0.5, 1.0);
        let mut right = vec![1.0; pattern.columns.len() - 1];
        let mut factor = Factor::new(&pattern).expect("memory");
        assert!(!factor.solve(&pattern, &values, &mut right));
    }
}
