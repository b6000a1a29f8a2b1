//! Packed symmetric matrix: the lower triangle alone, since products are limited by memory reads.

use super::row_runs::{Entry, RowRuns, Run};
use super::symmetric::Symmetric;

/// Rows of runs of columns left of the diagonal, and the diagonal.
#[derive(Debug, Clone)]
pub struct PackedSymmetric<T> {
    run_ends: Vec<u32>,
    runs: Vec<Run>,
    values: Vec<T>,
    diagonal: Vec<f64>,
}

impl<T: Entry> PackedSymmetric<T> {
    /// The half of the principal submatrix of the rows `keep` (ascending) of `matrix`.
    pub fn of<S: Entry>(matrix: &RowRuns<S>, keep: &[u32], convert: impl Fn(S) -> T) -> Self {
        // rank[c]: how many kept columns lie before column c.
        let mut rank = vec![0u32; matrix.len() + 1];
        for &k in keep {
            rank[k as usize + 1] = 1;
        }
        for c in 0..matrix.len() {
            rank[c + 1] += rank[c];
        }
        let mut half = PackedSymmetric {
            run_ends: Vec::with_capacity(keep.len()),
            runs: Vec::new(),
            values: Vec::with_capacity(keep.len() * keep.len() / 2),
            diagonal: Vec::with_capacity(keep.len()),
        };
        for (row, &i) in keep.iter().enumerate() {
            let (runs, values) = matrix.row(i as usize);
            let mut offset = 0usize;
            for run in runs {
                let (start, len) = (run.start as usize, run.len as usize);
                let first = rank[start] as usize;
                let last = (rank[start + len] as usize).min(row);
                if first < last {
                    half.runs.push(Run {
                        start: first as u32,
                        len: (last - first) as u32,
                    });
                    let run = &values[offset..offset + len];
                    let wanted = keep[first..last].iter();
                    half.values
                        .extend(wanted.map(|&c| convert(run[c as usize - start])));
                }
                offset += len;
            }
            half.run_ends.push(half.runs.len() as u32);
            half.diagonal.push(matrix.diagonal()[i as usize]);
        }
        half
    }
}

impl PackedSymmetric<f32> {
    /// The half of the principal submatrix of the rows `keep` (ascending) of `matrix`, its entries replaced by
    /// `run(row, first column, values, out)`, both counted in `keep`.
    pub fn stretched(
        matrix: &RowRuns<f32>,
        keep: &[u32],
        run: impl Fn(usize, usize, &[f32], &mut [f32]),
    ) -> Self {
        let stretches = stretches(keep);
        let most = keep.len() * (keep.len() + 1) / 2;
        let mut half = PackedSymmetric {
            run_ends: Vec::with_capacity(keep.len()),
            runs: Vec::new(),
            values: Vec::with_capacity(most.min(matrix.entries())),
            diagonal: Vec::with_capacity(keep.len()),
        };
        let mut own = [0.0];
        for (row, &i) in keep.iter().enumerate() {
            run(row, row, &[matrix.diagonal()[i as usize] as f32], &mut own);
            half.diagonal.push(own[0].wide());
            half.push_row(matrix, (row, i), (&stretches, &run));
        }
        half
    }

    /// Appends what of row `i` lies left of the diagonal within the stretches of kept columns.
    fn push_row(
        &mut self,
        matrix: &RowRuns<f32>,
        (row, i): (usize, u32),
        (stretches, run): (&[Stretch], &impl Fn(usize, usize, &[f32], &mut [f32])),
    ) {
        let (runs, mut values) = matrix.row(i as usize);
        let (begun, mut at) = (self.runs.len(), 0);
        for part in runs {
            let (own, rest) = values.split_at(part.len as usize);
            values = rest;
            if part.start >= i {
                break;
            }
            let end = (part.start + part.len).min(i);
            while at < stretches.len() && stretches[at].end() <= part.start {
                at += 1;
            }
            for stretch in stretches[at..].iter().take_while(|s| s.first < end) {
                let (from, to) = (stretch.first.max(part.start), stretch.end().min(end));
                let there = stretch.place + from - stretch.first;
                let taken = &own[(from - part.start) as usize..(to - part.start) as usize];
                let begin = self.values.len();
                self.values.resize(begin + taken.len(), 0.0);
                run(row, there as usize, taken, &mut self.values[begin..]);
                match self.runs[begun..].last_mut() {
                    Some(last) if last.start + last.len == there => last.len += to - from,
                    _ => self.runs.push(Run {
                        start: there,
                        len: to - from,
                    }),
                }
            }
        }
        self.run_ends.push(self.runs.len() as u32);
    }
}

/// Kept columns that follow one another.
struct Stretch {
    /// The first of them.
    first: u32,
    len: u32,
    /// Its place among all kept columns.
    place: u32,
}

impl Stretch {
    fn end(&self) -> u32 {
        self.first + self.len
    }
}

fn stretches(keep: &[u32]) -> Vec<Stretch> {
    let mut stretches: Vec<Stretch> = Vec::new();
    for (place, &column) in keep.iter().enumerate() {
        match stretches.last_mut() {
            Some(last) if last.end() == column => last.len += 1,
            _ => stretches.push(Stretch {
                first: column,
                len: 1,
                place: place as u32,
            }),
        }
    }
    stretches
}

impl<T: Entry> Symmetric for PackedSymmetric<T> {
    fn diagonal(&self) -> &[f64] {
        &self.diagonal
    }

    fn times(&self, x: &[f64], out: &mut [f64]) {
        multiply(self, x, out);
    }
}

#[multiversion::multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2"))]
fn multiply<T: Entry>(matrix: &PackedSymmetric<T>, x: &[f64], out: &mut [f64]) {
    let (mut from, mut offset) = (0, 0);
    for (i, &to) in matrix.run_ends.iter().enumerate() {
        let mut sums = [0.0; 32];
        let mut tail = 0.0;
        let own = x[i];
        for run in &matrix.runs[from..to as usize] {
            let (start, len) = (run.start as usize, run.len as usize);
            let (a32, a_rest) = matrix.values[offset..offset + len].as_chunks::<32>();
            let (b32, b_rest) = x[start..start + len].as_chunks::<32>();
            let (c32, c_rest) = out[start..start + len].as_chunks_mut::<32>();
            for ((a, b), c) in a32.iter().zip(b32).zip(c32) {
                for lane in 0..32 {
                    let value = a[lane].wide();
                    sums[lane] += value * b[lane];
                    c[lane] += value * own;
                }
            }
            for ((a, b), c) in a_rest.iter().zip(b_rest).zip(c_rest) {
                tail += a.wide() * b;
                *c += a.wide() * own;
            }
            offset += len;
        }
        for half in [16, 8, 4, 2, 1] {
            for lane in 0..half {
                sums[lane] += sums[lane + half];
            }
        }
        // Rows below add to this entry later: all above it have been.
        out[i] = sums[0] + tail + matrix.diagonal[i] * own;
        from = to as usize;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_multiplies_like_the_rows_it_was_taken_from() {
        let n = 90;
        let entry = |i: usize, j: usize| 1.0 / (1.0 + (i as f64 - j as f64).abs());
        let rows = RowRuns::dense((0..n * n).map(|k| entry(k / n, k % n)).collect(), n);
        let keep: Vec<u32> = (0..n as u32).filter(|i| i % 7 != 3).collect();
        let half = PackedSymmetric::of(&rows, &keep, |value| value);
        let x: Vec<f64> = keep.iter().map(|&i| f64::from(i).sin()).collect();
        let mut out = vec![f64::NAN; keep.len()];
        half.times(&x, &mut out);
        for (out, &i) in out.iter().zip(&keep) {
            let terms = keep.iter().zip(&x);
            let wanted: f64 = terms.map(|(&j, x)| entry(i as usize, j as usize) * x).sum();
            assert!((out - wanted).abs() < 1e-13, "{out} {wanted}");
        }
    }
}
