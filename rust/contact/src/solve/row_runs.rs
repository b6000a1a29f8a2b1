//! Symmetric matrix stored by rows of contiguous column runs: dense where sites are near, empty beyond the range.

use rayon::prelude::*;

/// Rows shorter than this in all are multiplied on one thread: waking others costs more.
const PARALLEL_ENTRIES: usize = 3_000_000;

/// Storage of a matrix entry; arithmetic is in double precision.
pub trait Entry: Copy + Send + Sync {
    /// The entry in double precision.
    fn wide(self) -> f64;
    /// The entry in single precision.
    fn narrow(self) -> f32;
}

impl Entry for f32 {
    #[inline(always)]
    fn wide(self) -> f64 {
        f64::from(self)
    }
    #[inline(always)]
    fn narrow(self) -> f32 {
        self
    }
}

impl Entry for f64 {
    #[inline(always)]
    fn wide(self) -> f64 {
        self
    }
    #[inline(always)]
    fn narrow(self) -> f32 {
        self as f32
    }
}

/// Columns `start .. start + len` of one row, stored next to each other.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Run {
    /// First column.
    pub start: u32,
    /// Number of columns.
    pub len: u32,
}

/// A symmetric positive definite matrix (mm/N): runs of columns by row. Entries outside the runs are zero.
#[derive(Debug, Clone, Default)]
pub struct RowRuns<T> {
    run_ends: Vec<u32>,
    runs: Vec<Run>,
    value_ends: Vec<usize>,
    values: Vec<T>,
    diagonal: Vec<f64>,
}

impl<T: Entry> RowRuns<T> {
    /// An empty matrix to be filled by [`RowRuns::push`].
    pub fn new() -> Self {
        RowRuns {
            run_ends: Vec::new(),
            runs: Vec::new(),
            value_ends: Vec::new(),
            values: Vec::new(),
            diagonal: Vec::new(),
        }
    }

    /// Takes all rows out; their storage stays.
    pub fn clear(&mut self) {
        self.run_ends.clear();
        self.runs.clear();
        self.value_ends.clear();
        self.values.clear();
        self.diagonal.clear();
    }

    /// Appends a row: its runs in ascending order, their values, and its diagonal entry.
    pub fn push(
        &mut self,
        runs: impl IntoIterator<Item = Run>,
        values: impl IntoIterator<Item = T>,
        diagonal: f64,
    ) {
        self.runs.extend(runs);
        self.values.extend(values);
        self.run_ends.push(self.runs.len() as u32);
        self.value_ends.push(self.values.len());
        self.diagonal.push(diagonal);
    }

    /// Number of unknowns.
    pub fn len(&self) -> usize {
        self.diagonal.len()
    }

    /// Number of stored entries.
    pub fn entries(&self) -> usize {
        self.values.len()
    }

    /// Whether products are worth several threads.
    pub fn is_large(&self) -> bool {
        self.values.len() >= PARALLEL_ENTRIES
    }

    /// Diagonal entries, positive.
    pub fn diagonal(&self) -> &[f64] {
        &self.diagonal
    }

    /// Runs and values of row `i`.
    pub fn row(&self, i: usize) -> (&[Run], &[T]) {
        let (first_run, first_value) = if i == 0 {
            (0, 0)
        } else {
            (self.run_ends[i - 1] as usize, self.value_ends[i - 1])
        };
        (
            &self.runs[first_run..self.run_ends[i] as usize],
            &self.values[first_value..self.value_ends[i]],
        )
    }

    /// The matrix times `x`; the same bits for any number of threads.
    pub fn times(&self, x: &[f64], out: &mut [f64]) {
        let all: Vec<u32> = (0..self.len() as u32).collect();
        self.times_rows(&all, x, out);
    }

    /// Some rows of the matrix times `x`; the same bits for any number of threads.
    pub fn times_rows(&self, rows: &[u32], x: &[f64], out: &mut [f64]) {
        if !self.is_large() {
            multiply(self, rows, x, out);
        } else {
            let parts = rows.par_chunks(256).zip(out.par_chunks_mut(256));
            parts.for_each(|(rows, out)| multiply(self, rows, x, out));
        }
    }

    /// Writes the matrix with every run replaced by `run(row, first column, values, out)`, which must keep it symmetric, to `mapped`.
    pub fn map_runs(&self, mapped: &mut Self, run: impl Fn(usize, usize, &[T], &mut [T])) {
        mapped.run_ends.clone_from(&self.run_ends);
        mapped.runs.clone_from(&self.runs);
        mapped.value_ends.clone_from(&self.value_ends);
        mapped.diagonal.clone_from(&self.diagonal);
        if mapped.values.len() != self.values.len() {
            mapped.values.clone_from(&self.values);
        }
        let mut first = 0;
        for (i, diagonal) in mapped.diagonal.iter_mut().enumerate() {
            for Run { start, len } in self.row(i).0 {
                let (start, len) = (*start as usize, *len as usize);
                run(
                    i,
                    start,
                    &self.values[first..first + len],
                    &mut mapped.values[first..first + len],
                );
                if (start..start + len).contains(&i) {
                    *diagonal = mapped.values[first + i - start].wide();
                }
                first += len;
            }
        }
    }

    /// The matrix in single precision.
    pub fn narrow(&self) -> RowRuns<f32> {
        RowRuns {
            run_ends: self.run_ends.clone(),
            runs: self.runs.clone(),
            value_ends: self.value_ends.clone(),
            values: self.values.iter().map(|v| v.narrow()).collect(),
            diagonal: self.diagonal.clone(),
        }
    }

    /// The principal submatrix of the rows in `keep` (ascending), in single precision.
    pub fn principal_narrow(&self, keep: &[u32]) -> RowRuns<f32> {
        self.principal_of(keep, Entry::narrow)
    }

    /// The principal submatrix of the rows in `keep` (ascending).
    pub fn principal(&self, keep: &[u32]) -> RowRuns<T> {
        self.principal_of(keep, |value| value)
    }

    fn principal_of<S: Entry>(&self, keep: &[u32], convert: impl Fn(T) -> S) -> RowRuns<S> {
        // rank[c]: how many kept columns lie before column c.
        let mut rank = vec![0u32; self.len() + 1];
        for &k in keep {
            rank[k as usize + 1] = 1;
        }
        for c in 0..self.len() {
            rank[c + 1] += rank[c];
        }
        let mut kept = RowRuns::new();
        for &i in keep {
            let (runs, values) = self.row(i as usize);
            let mut offset = 0usize;
            for run in runs {
                let (start, len) = (run.start as usize, run.len as usize);
                let (first, last) = (rank[start] as usize, rank[start + len] as usize);
                if first < last {
                    kept.runs.push(Run {
                        start: first as u32,
                        len: (last - first) as u32,
                    });
                    let wanted = &keep[first..last];
                    kept.values.extend(
                        wanted
                            .iter()
                            .map(|&c| convert(values[offset + c as usize - start])),
                    );
                }
                offset += len;
            }
            kept.run_ends.push(kept.runs.len() as u32);
            kept.value_ends.push(kept.values.len());
            kept.diagonal.push(self.diagonal[i as usize]);
        }
        kept
    }
}

impl RowRuns<f64> {
    /// A dense matrix, row by row.
    pub fn dense(matrix: Vec<f64>, n: usize) -> Self {
        debug_assert_eq!(matrix.len(), n * n);
        RowRuns {
            run_ends: (1..=n as u32).collect(),
            runs: vec![
                Run {
                    start: 0,
                    len: n as u32
                };
                n
            ],
            value_ends: (1..=n).map(|i| i * n).collect(),
            diagonal: (0..n).map(|i| matrix[i * n + i]).collect(),
            values: matrix,
        }
    }
}

#[multiversion::multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2"))]
fn multiply<T: Entry>(matrix: &RowRuns<T>, rows: &[u32], x: &[f64], out: &mut [f64]) {
    for (&i, out) in rows.iter().zip(out) {
        let (runs, values) = matrix.row(i as usize);
        // Four chains of eight: one chain would wait for each of its own additions.
        let mut sums = [0.0; 32];
        let mut tail = 0.0;
        let mut offset = 0;
        for run in runs {
            let (start, len) = (run.start as usize, run.len as usize);
            let (a32, a_rest) = values[offset..offset + len].as_chunks::<32>();
            let (b32, b_rest) = x[start..start + len].as_chunks::<32>();
            for (a, b) in a32.iter().zip(b32) {
                for lane in 0..32 {
                    sums[lane] += a[lane].wide() * b[lane];
                }
            }
            let (a8, a_rest) = a_rest.as_chunks::<8>();
            let (b8, b_rest) = b_rest.as_chunks::<8>();
            for (a, b) in a8.iter().zip(b8) {
                for lane in 0..8 {
                    sums[lane] += a[lane].wide() * b[lane];
                }
            }
            for (a, b) in a_rest.iter().zip(b_rest) {
                tail += a.wide() * b;
            }
            offset += len;
        }
        for half in [16, 8, 4, 2, 1] {
            for lane in 0..half {
                sums[lane] += sums[lane + half];
            }
        }
        *out = sums[0] + tail;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn banded(n: usize) -> (Vec<f64>, RowRuns<f64>) {
        let mut dense = vec![0.0; n * n];
        let mut rows = RowRuns::new();
        for i in 0..n {
            let (start, end) = (i.saturating_sub(11), (i + 12).min(n));
            let values: Vec<f64> = (start..end)
                .map(|j| 1.0 / (1.0 + (i as f64 - j as f64).abs()))
                .collect();
            dense[i * n + start..i * n + end].copy_from_slice(&values);
            rows.push(
                [Run {
                    start: start as u32,
                    len: (end - start) as u32,
                }],
                values,
                1.0,
            );
        }
        (dense, rows)
    }

    #[test]
    fn runs_multiply_like_the_dense_matrix() {
        let (dense, rows) = banded(40);
        let x: Vec<f64> = (0..40).map(|i| (i as f64 * 0.7).sin()).collect();
        let mut out = vec![0.0; 40];
        rows.times(&x, &mut out);
        for i in 0..40 {
            let expected: f64 = (0..40).map(|j| dense[i * 40 + j] * x[j]).sum();
            assert!((out[i] - expected).abs() < 1e-14);
        }
    }

    #[test]
    fn a_principal_submatrix_keeps_its_entries() {
        let (dense, rows) = banded(30);
        let keep = [1u32, 2, 7, 20, 29];
        let kept = rows.principal(&keep);
        let mut column = vec![0.0; keep.len()];
        for (b, &j) in keep.iter().enumerate() {
            let unit: Vec<f64> = (0..keep.len())
                .map(|c| f64::from(u8::from(c == b)))
                .collect();
            kept.times(&unit, &mut column);
            for (a, &i) in keep.iter().enumerate() {
                assert_eq!(column[a], dense[i as usize * 30 + j as usize]);
            }
        }
    }
}
