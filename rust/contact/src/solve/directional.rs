//! The compliance along press directions, `A_ij = w_i w_j K_ij t_i.t_j`, computed on demand; weights stay outside.
//!
//! A change of weights alone rebuilds nothing, and only the submatrices of contact sets are stored.

use std::cell::RefCell;
use std::rc::Rc;

use thenar_surface::Vec3;

use super::lcp::Compliance;
use super::packed::PackedSymmetric;
use super::row_runs::RowRuns;
use super::submatrix::Submatrix;
use super::symmetric::Symmetric;

/// Unit directions by axis.
#[derive(Debug, Clone, Default)]
pub struct Axes([Vec<f64>; 3]);

impl Axes {
    /// The axes of unit `directions`.
    pub fn new(directions: &[Vec3]) -> Self {
        Axes([0, 1, 2].map(|axis| directions.iter().map(|t| t[axis]).collect()))
    }

    /// The direction of one unknown.
    pub fn at(&self, i: usize) -> [f64; 3] {
        [0, 1, 2].map(|axis| self.0[axis][i])
    }

    /// The directions of `len` unknowns from the `first` on, by axis.
    pub fn columns(&self, first: usize, len: usize) -> [&[f64]; 3] {
        [0, 1, 2].map(|axis| &self.0[axis][first..first + len])
    }

    /// All of them in single precision, by axis.
    pub fn narrow(&self) -> [Vec<f32>; 3] {
        let narrow = |axis: &Vec<f64>| axis.iter().map(|t| *t as f32).collect();
        self.0.each_ref().map(narrow)
    }

    /// Those of some `rows`.
    pub fn of(&self, rows: &[u32]) -> Axes {
        let pick = |axis: &Vec<f64>| rows.iter().map(|&i| axis[i as usize]).collect();
        Axes([pick(&self.0[0]), pick(&self.0[1]), pick(&self.0[2])])
    }
}

/// The part of `K t.t` that was stored last, for as long as coupling and directions stay.
pub type Part = RefCell<Option<(Vec<u32>, Rc<PackedSymmetric<f32>>)>>;

/// A compliance along directions, mm/N.
pub struct DirectionalCompliance<'a> {
    coupling: &'a RowRuns<f32>,
    axes: &'a Axes,
    weight: &'a [f64],
    /// Which unknowns are likely to be in contact: they are stored with the first set.
    likely: &'a [bool],
    part: &'a Part,
    diagonal: Vec<f64>,
}

impl<'a> DirectionalCompliance<'a> {
    /// Of the `coupling` (1/mm) along `axes` with `weight` by unknown; `part` must have been made with the same two, or be empty.
    pub fn new(
        (coupling, axes): (&'a RowRuns<f32>, &'a Axes),
        (weight, likely): (&'a [f64], &'a [bool]),
        part: &'a Part,
    ) -> Self {
        let own = |(i, w): (usize, &f64)| {
            let t = axes.at(i);
            let entry = (coupling.diagonal()[i] * dot(t, t)) as f32;
            f64::from(entry) * w * w
        };
        DirectionalCompliance {
            coupling,
            axes,
            weight,
            likely,
            part,
            diagonal: weight.iter().enumerate().map(own).collect(),
        }
    }
}

impl Symmetric for DirectionalCompliance<'_> {
    fn diagonal(&self) -> &[f64] {
        &self.diagonal
    }

    fn times(&self, x: &[f64], out: &mut [f64]) {
        let all: Vec<u32> = (0..self.weight.len() as u32).collect();
        self.times_rows(&all, x, out);
    }
}

impl Compliance for DirectionalCompliance<'_> {
    fn times_rows(&self, rows: &[u32], x: &[f64], out: &mut [f64]) {
        let weighted: Vec<f64> = x.iter().zip(self.weight).map(|(x, w)| x * w).collect();
        multiply((self.coupling, self.axes), rows, &weighted, out);
        for (&i, out) in rows.iter().zip(out) {
            *out *= self.weight[i as usize];
        }
    }

    /// Gershgorin's, of entries without their directions' cosines.
    fn norm_bound(&self) -> f64 {
        let row = |i: usize| {
            let (runs, values) = self.coupling.row(i);
            let columns = runs
                .iter()
                .flat_map(|run| run.start as usize..(run.start + run.len) as usize);
            let terms = columns
                .zip(values)
                .map(|(j, value)| f64::from(value.abs()) * self.weight[j]);
            terms.sum::<f64>() * self.weight[i]
        };
        (0..self.weight.len())
            .map(row)
            .fold(f64::MIN_POSITIVE, f64::max)
    }

    fn submatrix(&self, set: &[u32], _is_rough: bool) -> Submatrix<'_> {
        let mut part = self.part.borrow_mut();
        let (rows, half) = match part.take() {
            Some((rows, half)) if super::submatrix::holds(&rows, set) => (rows, half),
            before => {
                let mut wanted = self.likely.to_vec();
                let old = before.map_or_else(Vec::new, |before| before.0);
                old.iter()
                    .chain(set)
                    .for_each(|&i| wanted[i as usize] = true);
                let rows: Vec<u32> = (0..wanted.len() as u32)
                    .filter(|&i| wanted[i as usize])
                    .collect();
                let axes = self.axes.of(&rows);
                let half =
                    PackedSymmetric::stretched(self.coupling, &rows, |i, first, values, out| {
                        turn_entries(axes.at(i), axes.columns(first, values.len()), (values, out));
                    });
                (rows, Rc::new(half))
            }
        };
        let weight: Vec<f64> = rows.iter().map(|&i| self.weight[i as usize]).collect();
        let diagonal = rows.iter().map(|&i| self.diagonal[i as usize]).collect();
        let matrix = Weighted {
            half: Rc::clone(&half),
            weight,
            diagonal,
        };
        let kept = Submatrix::of(rows.clone(), Box::new(matrix));
        *part = Some((rows, half));
        kept
    }

    fn is_narrow(&self, _is_rough: bool) -> bool {
        false
    }
}

/// A stored part with its weights.
struct Weighted {
    half: Rc<PackedSymmetric<f32>>,
    weight: Vec<f64>,
    diagonal: Vec<f64>,
}

impl Symmetric for Weighted {
    fn diagonal(&self) -> &[f64] {
        &self.diagonal
    }

    fn times(&self, x: &[f64], out: &mut [f64]) {
        let weighted: Vec<f64> = x.iter().zip(&self.weight).map(|(x, w)| x * w).collect();
        self.half.times(&weighted, out);
        for (out, w) in out.iter_mut().zip(&self.weight) {
            *out *= w;
        }
    }
}

#[inline(always)]
fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// `K_ij t_i.t_j` of one row: the same bits wherever it is made, and for both of a pair.
#[multiversion::multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2"))]
fn turn_entries(row: [f64; 3], columns: [&[f64]; 3], (values, out): (&[f32], &mut [f32])) {
    let [x, y, z] = columns;
    for ((((value, x), y), z), out) in values.iter().zip(x).zip(y).zip(z).zip(out) {
        *out = (f64::from(*value) * dot(row, [*x, *y, *z])) as f32;
    }
}

/// Rows of `K t.t` times `x`.
#[multiversion::multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2"))]
fn multiply((coupling, axes): (&RowRuns<f32>, &Axes), rows: &[u32], x: &[f64], out: &mut [f64]) {
    for (&i, out) in rows.iter().zip(out) {
        let (runs, values) = coupling.row(i as usize);
        let own = axes.at(i as usize);
        let mut sums = [0.0; 32];
        let mut tail = 0.0;
        let mut offset = 0;
        for run in runs {
            let (start, len) = (run.start as usize, run.len as usize);
            let [tx, ty, tz] = axes.columns(start, len);
            let (a, a_rest) = values[offset..offset + len].as_chunks::<32>();
            let (b, b_rest) = x[start..start + len].as_chunks::<32>();
            let (cx, x_rest) = tx.as_chunks::<32>();
            let (cy, y_rest) = ty.as_chunks::<32>();
            let (cz, z_rest) = tz.as_chunks::<32>();
            for k in 0..a.len() {
                for lane in 0..32 {
                    let cosine = dot(own, [cx[k][lane], cy[k][lane], cz[k][lane]]);
                    let entry = (f64::from(a[k][lane]) * cosine) as f32;
                    sums[lane] += f64::from(entry) * b[k][lane];
                }
            }
            for k in 0..a_rest.len() {
                let cosine = dot(own, [x_rest[k], y_rest[k], z_rest[k]]);
                let entry = (f64::from(a_rest[k]) * cosine) as f32;
                tail += f64::from(entry) * b_rest[k];
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
    use crate::Control;
    use crate::solve::row_runs::Run;
    use crate::solve::{Accuracy, solve_contact};

    /// A coupling like the half space's on a strip, in two runs a row, and directions that turn along it.
    fn strip(n: usize) -> (RowRuns<f32>, Vec<Vec3>, Vec<f64>) {
        let mut rows = RowRuns::new();
        for i in 0..n {
            let entry = |j: usize| {
                if i == j {
                    3.0
                } else {
                    1.0 / (i as f32 - j as f32).abs()
                }
            };
            let middle = (n / 3) as u32;
            let runs = [(0, middle), (middle, n as u32 - middle)];
            let runs = runs.map(|(start, len)| Run { start, len });
            rows.push(runs, (0..n).map(entry), 3.0);
        }
        let angle = |i: usize| 0.02 * i as f64;
        let directions = (0..n).map(|i| Vec3::new(angle(i).cos(), 0.0, angle(i).sin()));
        let weights = (0..n).map(|i| 1.0 + 0.3 * (i as f64).sin());
        (rows, directions.collect(), weights.collect())
    }

    /// The same matrix, entry by entry.
    fn dense(rows: &RowRuns<f32>, directions: &[Vec3], weights: &[f64]) -> RowRuns<f64> {
        let n = weights.len();
        let entry = |k: usize| {
            let (i, j) = (k / n, k % n);
            f64::from(rows.row(i).1[j])
                * directions[i].dot(&directions[j])
                * weights[i]
                * weights[j]
        };
        RowRuns::dense((0..n * n).map(entry).collect(), n)
    }

    #[test]
    fn products_are_those_of_the_matrix_written_out() {
        let (rows, directions, weights) = strip(101);
        let (axes, part) = (Axes::new(&directions), Part::default());
        let likely = vec![false; 101];
        let along = DirectionalCompliance::new((&rows, &axes), (&weights, &likely), &part);
        let written = dense(&rows, &directions, &weights);
        let x: Vec<f64> = (0..101).map(|i| f64::from(i).cos()).collect();
        let (mut ours, mut theirs) = (vec![0.0; 101], vec![0.0; 101]);
        along.times(&x, &mut ours);
        written.times(&x, &mut theirs);
        for (a, b) in ours.iter().zip(&theirs) {
            assert!((a - b).abs() < 1e-5, "{a} {b}");
        }
        for (a, b) in along.diagonal().iter().zip(written.diagonal()) {
            assert!((a / b - 1.0).abs() < 1e-6, "{a} {b}");
        }
        assert!(along.norm_bound() >= x.iter().zip(&ours).map(|(x, y)| x * y).sum::<f64>() / 101.0);
    }

    #[test]
    fn stored_parts_serve_other_weights_and_the_contact_is_the_same() {
        let (rows, directions, weights) = strip(90);
        let gap: Vec<f64> = (0..90)
            .map(|i| (f64::from(i) / 90.0 - 0.4).powi(2) * 20.0 - 1.0)
            .collect();
        let likely: Vec<bool> = gap.iter().map(|d| *d < 0.0).collect();
        let (axes, part) = (Axes::new(&directions), Part::default());
        for factor in [1.0, 0.7] {
            let weights: Vec<f64> = weights.iter().map(|w| w * factor).collect();
            let along = DirectionalCompliance::new((&rows, &axes), (&weights, &likely), &part);
            let control = Control::none();
            let ours = solve_contact(&along, &gap, None, (Accuracy::Full, &control));
            let written = dense(&rows, &directions, &weights);
            let theirs = solve_contact(&written, &gap, None, (Accuracy::Full, &control));
            assert!(ours.complementarity < 1e-11, "{}", ours.complementarity);
            let most = theirs.force.iter().fold(0.0, |m, f| f64::max(m, *f));
            for (a, b) in ours.force.iter().zip(&theirs.force) {
                assert!((a - b).abs() < 1e-5 * most, "{a} {b}");
            }
        }
    }
}
