//! The principal submatrix on which contact sets are solved.

use super::packed::PackedSymmetric;
use super::row_runs::{Entry, RowRuns};
use super::symmetric::Symmetric;

/// Share of the unknowns above which the set of a large problem is solved in place instead of copied out.
const COPY_SHARE: f64 = 0.6;

/// The part of the matrix that sets are solved on, kept while they lie within it.
pub struct Submatrix<'a> {
    /// Its rows, ascending.
    pub rows: Vec<u32>,
    /// The matrix on them.
    pub matrix: Box<dyn Symmetric + 'a>,
    /// Whether it is in single precision only.
    pub is_narrow: bool,
    /// Rows on which the matrix is valid, where not on all.
    answers: Option<Vec<bool>>,
}

impl<'a> Submatrix<'a> {
    /// The part for a set (ascending); all of a large matrix where the set is most of it.
    pub fn new<T: Entry>(matrix: &'a RowRuns<T>, set: &[u32], is_narrow: bool) -> Self {
        let rows = set.to_vec();
        let matrix: Box<dyn Symmetric + 'a> = if matrix.is_large() {
            if set.len() as f64 > COPY_SHARE * matrix.len() as f64 {
                let rows = (0..matrix.len() as u32).collect();
                return Submatrix {
                    rows,
                    matrix: Box::new(matrix),
                    is_narrow,
                    answers: None,
                };
            }
            if is_narrow {
                Box::new(matrix.principal_narrow(set))
            } else {
                Box::new(matrix.principal(set))
            }
        } else if is_narrow {
            Box::new(PackedSymmetric::of(matrix, set, Entry::narrow))
        } else {
            Box::new(PackedSymmetric::of(matrix, set, |value| value))
        };
        Submatrix {
            rows,
            matrix,
            is_narrow,
            answers: None,
        }
    }

    /// These rows (ascending) and the matrix on them.
    pub fn of(rows: Vec<u32>, matrix: Box<dyn Symmetric + 'a>) -> Self {
        Submatrix {
            rows,
            matrix,
            is_narrow: false,
            answers: None,
        }
    }

    /// The same rows with a matrix made of these and the one on them.
    pub fn with(
        self,
        made: impl FnOnce(&[u32], Box<dyn Symmetric + 'a>) -> Box<dyn Symmetric + 'a>,
    ) -> Self {
        let matrix = made(&self.rows, self.matrix);
        Submatrix { matrix, ..self }
    }

    /// All `unknowns`, with a matrix that is valid on `set` (ascending) alone.
    pub fn in_place(unknowns: usize, set: &[u32], matrix: Box<dyn Symmetric + 'a>) -> Self {
        let mut answers = vec![false; unknowns];
        set.iter().for_each(|&i| answers[i as usize] = true);
        Submatrix {
            rows: (0..unknowns as u32).collect(),
            matrix,
            is_narrow: false,
            answers: Some(answers),
        }
    }

    /// Whether a set (ascending) lies within these rows.
    pub fn holds(&self, set: &[u32]) -> bool {
        if let Some(answers) = &self.answers {
            return set.iter().all(|&i| answers[i as usize]);
        }
        holds(&self.rows, set)
    }
}

/// Whether a set lies within rows, both ascending.
pub fn holds(rows: &[u32], set: &[u32]) -> bool {
    let mut rows = rows.iter();
    set.iter().all(|i| rows.any(|j| j == i))
}
