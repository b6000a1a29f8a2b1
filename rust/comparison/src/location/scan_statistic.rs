//! Scan statistic of a window, and the null distribution of its maximum.
//!
//! Values of atoms under noise n and a simulation's allowed error z: `T (E^T P n + (1 - G G^T) D z)`, where E sums samples up to
//! atoms, G = E^T Q is what parameters absorb of them, T takes smooth factors out, and D is the rough error.

use nalgebra::{DMatrix, DVector, DVectorView};
use rayon::prelude::*;

use crate::location::model_error::Allowance;
use crate::location::residual_sums::CellSums;
use crate::location::scan_windows::{ScanWindow, ScanWindows};
use thenar_inference::random::Random;

/// Share of a look's length that parameters and smooth factors must leave for it to say anything.
const LEAST_SHARE: f64 = 0.2;
/// Draws that are worked on together.
const LANES: usize = 32;

/// Looks with what they need for their statistic.
pub(crate) struct Scan<'a> {
    cell_sums: &'a CellSums,
    windows: &'a ScanWindows,
    allowance: &'a Allowance,
    /// G with smooth factors taken out: T G.
    absorbed: DMatrix<f64>,
    /// Rough error as the values show it: T (1 - G G^T) D.
    rough: DMatrix<f64>,
    /// By row: sums of the columns of T's factors, T G, G, and the rough error.
    along: Vec<DVector<f64>>,
    /// By look: standard deviation of its sum of values; 0 if it says nothing.
    spreads: Vec<f64>,
    /// By look: its sum for one unit more on all of its samples, 1 / unit.
    responses: Vec<f64>,
    /// By look: share of its length that is left.
    pub shares: Vec<f64>,
    /// By atom: standard deviation of its value.
    deviations: Vec<f64>,
    /// Square root of the part of the absorbed space that the atoms do not see.
    unseen: DMatrix<f64>,
}

impl<'a> Scan<'a> {
    pub(crate) fn new(
        (cell_sums, allowance): (&'a CellSums, &'a Allowance),
        windows: &'a ScanWindows,
    ) -> Scan<'a> {
        let (smooth, known) = (&allowance.smooth, &cell_sums.absorbed);
        let absorbed = known - smooth * (smooth.transpose() * known);
        let seen = &allowance.rough - smooth * (smooth.transpose() * &allowance.rough);
        let rough = seen - &absorbed * (known.transpose() * &allowance.rough);
        let left = DMatrix::identity(known.ncols(), known.ncols()) - known.transpose() * known;
        let mut scan = Scan {
            cell_sums,
            windows,
            allowance,
            absorbed,
            rough,
            along: Vec::new(),
            spreads: Vec::new(),
            responses: Vec::new(),
            shares: Vec::new(),
            deviations: Vec::new(),
            unseen: root(left),
        };
        scan.along = windows.rows.iter().map(|row| scan.along(row)).collect();
        scan.deviations = (0..cell_sums.list.len())
            .map(|cell_sum| scan.deviation(cell_sum))
            .collect();
        for window in &windows.list {
            let (spread, response, share) = scan.measure(window);
            let says = share >= LEAST_SHARE;
            scan.spreads.push(if says { spread } else { 0.0 });
            scan.responses.push(response);
            scan.shares.push(share);
        }
        scan
    }

    /// Sums over a row's atoms of all that is taken out or allowed for.
    fn along(&self, row: &[u32]) -> DVector<f64> {
        let parts = [
            &self.allowance.smooth,
            &self.absorbed,
            &self.cell_sums.absorbed,
            &self.rough,
        ];
        let mut sum = DVector::zeros(parts.iter().map(|part| part.ncols()).sum());
        let mut first = 0;
        for part in parts {
            for column in 0..part.ncols() {
                let values = part.column(column);
                let weighted = row
                    .iter()
                    .map(|a| self.cell_sums.list[*a as usize].weight * values[*a as usize]);
                sum[first + column] = weighted.sum();
            }
            first += part.ncols();
        }
        sum
    }

    fn parts<'v>(&self, along: &'v DVector<f64>) -> [DVectorView<'v, f64>; 4] {
        let (s, q) = (self.allowance.smooth.ncols(), self.absorbed.ncols());
        [
            along.rows(0, s),
            along.rows(s, q),
            along.rows(s + q, q),
            along.rows(s + 2 * q, self.rough.ncols()),
        ]
    }

    fn deviation(&self, cell_sum: usize) -> f64 {
        let square = |matrix: &DMatrix<f64>| matrix.row(cell_sum).norm_squared();
        let kept = 1.0 - square(&self.allowance.smooth) - square(&self.absorbed);
        (kept.max(0.0) + square(&self.rough)).sqrt()
    }

    /// Standard deviation, response to one unit, and share kept.
    fn measure(&self, window: &ScanWindow) -> (f64, f64, f64) {
        let along = self.sum(window);
        let [smooth, absorbed, known, rough] = self.parts(&along);
        let whole: f64 = self.squares(window).sum();
        let kept = (whole - smooth.norm_squared() - absorbed.norm_squared()).max(0.0);
        let response = whole - smooth.norm_squared() - absorbed.dot(&known);
        let spread = (kept + rough.norm_squared()).sqrt();
        (spread, response, (response.max(0.0) / whole).sqrt())
    }

    fn squares<'l>(&'l self, window: &'l ScanWindow) -> impl Iterator<Item = f64> + 'l {
        let rows = window
            .rows
            .iter()
            .flat_map(|row| &self.windows.rows[*row as usize]);
        rows.map(|cell_sum| self.cell_sums.list[*cell_sum as usize].weight.powi(2))
    }

    fn sum(&self, window: &ScanWindow) -> DVector<f64> {
        let mut sum = DVector::zeros(self.along.first().map_or(0, DVector::len));
        for row in &window.rows {
            sum += &self.along[*row as usize];
        }
        sum
    }

    /// Number of looks that say anything.
    pub(crate) fn count(&self) -> usize {
        self.spreads.iter().filter(|spread| **spread > 0.0).count()
    }

    /// Values of the atoms with smooth factors taken out.
    pub(crate) fn observed(&self) -> Vec<f64> {
        let values = self.cell_sums.list.iter().map(|cell_sum| cell_sum.value);
        let values = DVector::from_iterator(self.cell_sums.list.len(), values);
        let smooth = &self.allowance.smooth;
        let left = &values - smooth * (smooth.transpose() * &values);
        left.as_slice().to_vec()
    }

    /// Root mean square of values over what it should be, a standard error more for what few numbers tell; at least 1. Curves count
    /// the scatter within their atoms, too; in maps that would dilute an error that all frames share.
    pub(crate) fn excess(&self, values: &[f64], is_used: &dyn Fn(usize) -> bool) -> f64 {
        let (mut sum, mut count) = (0.0, 0.0);
        for (at, value) in values.iter().enumerate().filter(|(at, _)| is_used(*at)) {
            let cell_sum = &self.cell_sums.list[at];
            if self.deviations[at] > 0.1 {
                sum += (value / self.deviations[at]).powi(2);
                count += 1.0;
            }
            if !cell_sum.channel.is_of_map() {
                sum += cell_sum.scatter.1;
                count += cell_sum.scatter.0 - 1.0;
            }
        }
        if count < 1.0 {
            return 1.0;
        }
        f64::max(
            (sum / count).sqrt() * (1.0 + 1.0 / (2.0 * count).sqrt()),
            1.0,
        )
    }

    /// Signed statistic of every look, standard normal each where nothing is amiss; 0 for looks that say nothing.
    pub(crate) fn scores(&self, values: &[f64]) -> Vec<f64> {
        let term = |cell_sum: &u32| {
            self.cell_sums.list[*cell_sum as usize].weight * values[*cell_sum as usize]
        };
        let rows: Vec<f64> = self
            .windows
            .rows
            .iter()
            .map(|row| row.iter().map(term).sum())
            .collect();
        let score = |(window, spread): (&ScanWindow, &f64)| {
            let sum: f64 = window.rows.iter().map(|row| rows[*row as usize]).sum();
            if *spread > 0.0 { sum / spread } else { 0.0 }
        };
        self.windows
            .list
            .iter()
            .zip(&self.spreads)
            .map(score)
            .collect()
    }

    /// Standard deviation of a look's size, in its unit.
    pub(crate) fn error(&self, window: usize) -> f64 {
        self.spreads[window] / self.responses[window]
    }

    /// What two looks have in common, as a correlation of their statistics.
    pub(crate) fn correlation(&self, one: usize, two: usize) -> f64 {
        let (a, b) = (&self.windows.list[one], &self.windows.list[two]);
        let spreads = self.spreads[one] * self.spreads[two];
        if spreads <= 0.0 {
            return 0.0;
        }
        let theirs = self.atoms_of(b);
        let both = self
            .atoms_of(a)
            .into_iter()
            .filter(|cell_sum| theirs.binary_search(cell_sum).is_ok());
        let shared: f64 = both
            .map(|cell_sum| self.cell_sums.list[cell_sum as usize].weight.powi(2))
            .sum();
        let (mine, other) = (self.sum(a), self.sum(b));
        let ([s, q, _, r], [t, p, _, u]) = (self.parts(&mine), self.parts(&other));
        (shared - s.dot(&t) - q.dot(&p) + r.dot(&u)) / spreads
    }

    /// Atoms of a look, sorted.
    pub(crate) fn atoms_of(&self, window: &ScanWindow) -> Vec<u32> {
        let rows = window
            .rows
            .iter()
            .map(|row| &self.windows.rows[*row as usize]);
        let mut cell_sums: Vec<u32> = rows.flatten().copied().collect();
        cell_sums.sort_unstable();
        cell_sums
    }

    /// Values with what a look explains taken out.
    pub(crate) fn without(&self, values: &[f64], window: usize) -> Vec<f64> {
        let size = self.scores(values)[window] * self.error(window);
        let found = &self.windows.list[window];
        let along = self.sum(found);
        let [smooth, _, known, _] = self.parts(&along);
        let mut shown = -(&self.allowance.smooth * smooth) - &self.absorbed * known;
        for cell_sum in self.atoms_of(found) {
            shown[cell_sum as usize] += self.cell_sums.list[cell_sum as usize].weight;
        }
        values
            .iter()
            .zip(shown.iter())
            .map(|(value, shown)| value - size * shown)
            .collect()
    }

    /// Largest magnitude of any look's statistic in each of `draws` sets of noise with nothing amiss, from large to small.
    pub(crate) fn null_maxima(&self, draws: usize, seed: u64) -> Vec<f64> {
        let blocks = draws.div_ceil(LANES);
        let mut maxima: Vec<f64> = (0..blocks)
            .into_par_iter()
            .flat_map_iter(|block| self.maxima(&self.draw(seed.wrapping_add(block as u64))))
            .collect();
        maxima.truncate(draws);
        maxima.sort_by(|one, two| two.total_cmp(one));
        maxima
    }

    /// Sets of values with nothing amiss: a row per set, a column per atom.
    fn draw(&self, seed: u64) -> DMatrix<f64> {
        let mut random = Random::new(seed.wrapping_mul(0x2545_F491_4F6C_DD1D));
        let mut normal = |columns| DMatrix::from_fn(LANES, columns, |_, _| random.normal());
        let mut values = normal(self.cell_sums.list.len());
        let along = &values * &self.cell_sums.absorbed
            + normal(self.unseen.ncols()) * self.unseen.transpose();
        let smooth = &self.allowance.smooth;
        let factors = &values * smooth;
        values -= factors * smooth.transpose();
        values -= along * self.absorbed.transpose();
        values += normal(self.rough.ncols()) * self.rough.transpose();
        values
    }

    fn maxima(&self, values: &DMatrix<f64>) -> [f64; LANES] {
        let mut rows = vec![[0.0; LANES]; self.windows.rows.len()];
        for (sums, row) in rows.iter_mut().zip(&self.windows.rows) {
            for cell_sum in row {
                let weight = self.cell_sums.list[*cell_sum as usize].weight;
                let drawn = values.column(*cell_sum as usize);
                sums.iter_mut()
                    .zip(drawn.iter())
                    .for_each(|(sum, value)| *sum += weight * value);
            }
        }
        let mut maxima = [0.0_f64; LANES];
        for (window, spread) in self.windows.list.iter().zip(&self.spreads) {
            if *spread <= 0.0 {
                continue;
            }
            let mut sums = [0.0; LANES];
            for row in &window.rows {
                let row = &rows[*row as usize];
                sums.iter_mut()
                    .zip(row)
                    .for_each(|(sum, value)| *sum += value);
            }
            for (most, sum) in maxima.iter_mut().zip(sums) {
                *most = most.max(sum.abs() / spread);
            }
        }
        maxima
    }
}

/// A root of a symmetric matrix whose eigenvalues lie in 0 to 1 but for rounding.
fn root(matrix: DMatrix<f64>) -> DMatrix<f64> {
    if matrix.is_empty() {
        return matrix;
    }
    let eigen = matrix.symmetric_eigen();
    let mut root = eigen.eigenvectors;
    for (mut column, value) in root.column_iter_mut().zip(eigen.eigenvalues.iter()) {
        column *= value.clamp(0.0, 1.0).sqrt();
    }
    root
}
