//! Lack-of-fit test: the residual that parameters cannot absorb, against what noise alone leaves.

use nalgebra::{DMatrix, DVector};

use crate::noise::estimate::Noise;
use crate::noise::whitening::Whitening;
use crate::observe::measured::{Measured, Quantity};
use crate::random::Random;

/// Part of the largest column below which a direction is no direction.
const LEAST: f64 = 1e-9;
/// Most that one residual adds to the misfit, in standard deviations: outliers do not decide.
const MOST: f64 = 3.0;
/// Parts of a phase.
const PARTS: usize = 5;
/// Fewest deviations of repeats from which noise is drawn; else it is drawn from the normal law.
const LEAST_DEVIATIONS: usize = 100;

/// Orthonormal columns that span those of a whitened Jacobian (modified Gram-Schmidt, twice), columns scaled alike.
pub fn absorbed(whitened: &DMatrix<f64>) -> DMatrix<f64> {
    let mut columns: Vec<DVector<f64>> = Vec::new();
    for column in whitened.column_iter() {
        let size = column.norm();
        if size == 0.0 || !size.is_finite() {
            continue;
        }
        let mut left: DVector<f64> = column / size;
        for _ in 0..2 {
            for other in &columns {
                let along = other.dot(&left);
                left.axpy(-along, other, 1.0);
            }
        }
        let size = left.norm();
        if size > LEAST {
            columns.push(left / size);
        }
    }
    match columns.is_empty() {
        true => DMatrix::zeros(whitened.nrows(), 0),
        false => DMatrix::from_columns(&columns),
    }
}

/// Takes out of a whitened vector all that the columns span.
pub fn project(absorbed: &DMatrix<f64>, vector: &[f64]) -> Vec<f64> {
    let vector = DVector::from_column_slice(vector);
    let along = absorbed.tr_mul(&vector);
    (vector - absorbed * along).as_slice().to_vec()
}

/// What is left, to be judged.
pub struct Left<'a> {
    /// Whitened residuals with all taken out that parameters absorb.
    pub projected: &'a [f64],
    /// True where a sample counts.
    pub counts: &'a [bool],
    /// What parameters absorb.
    pub absorbed: &'a DMatrix<f64>,
    /// Number of the block of each sample: what is alike in protocol, channel and phase, over which misfit is coherent.
    pub blocks: &'a [usize],
    /// The noise.
    pub noise: &'a Noise,
    /// How it was whitened.
    pub whitening: &'a Whitening,
}

/// Probability that noise alone leaves as much; None without repeats.
///
/// Two sizes are looked at: that of all residuals, and that of their means over blocks, in which a misfit adds up that is the same in
/// every repeat. Noise is drawn `draws` times from what the repeats deviated by, outliers among it, and loses what parameters
/// absorb as the data did; its scale is as uncertain as repeats leave it. The larger of both sizes counts, data and draws alike.
pub fn lack_of_fit(left: &Left<'_>, (draws, seed): (usize, u64)) -> Option<f64> {
    let found = left.sizes(left.projected);
    let mut random = Random::new(seed);
    let degrees = (left.noise.degrees?.round() as usize).clamp(1, 2000);
    let mut drawn = Vec::with_capacity(draws);
    for _ in 0..draws {
        // Noise that is larger than repeats happened to show leaves more.
        let scale = (degrees as f64 / random.chi_square(degrees)).sqrt();
        let noise = draw(left, scale, &mut random);
        drawn.push(left.sizes(&project(left.absorbed, &noise)));
    }
    let scales = [0, 1].map(|k| moments(drawn.iter().map(|sizes| sizes[k])));
    let stands_out = |sizes: &[f64; 2]| {
        let over = |k: usize| (sizes[k] - scales[k].0) / scales[k].1;
        over(0).max(over(1))
    };
    let found = stands_out(&found);
    let as_much = drawn
        .iter()
        .filter(|sizes| stands_out(sizes) >= found)
        .count();
    Some((1 + as_much) as f64 / (1 + draws) as f64)
}

/// Mean and standard deviation.
fn moments(values: impl Iterator<Item = f64> + Clone) -> (f64, f64) {
    let n = values.clone().count().max(2) as f64;
    let mean = values.clone().sum::<f64>() / n;
    let variance = values.map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0);
    (mean, variance.sqrt().max(f64::MIN_POSITIVE))
}

impl Left<'_> {
    /// Size of residuals one by one, and of their sums over blocks.
    fn sizes(&self, residuals: &[f64]) -> [f64; 2] {
        let blocks = self.blocks.iter().fold(0, |most, b| most.max(b + 1));
        let mut sums = vec![(0.0, 0.0f64); blocks];
        let mut all = 0.0;
        for (k, r) in residuals
            .iter()
            .enumerate()
            .filter(|(k, _)| self.counts[*k])
        {
            let r = r.clamp(-MOST, MOST);
            all += r * r;
            let sum = &mut sums[self.blocks[k]];
            *sum = (sum.0 + r, sum.1 + 1.0);
        }
        let lack_of_fit = sums
            .iter()
            .filter(|s| s.1 > 0.0)
            .map(|(sum, n)| sum * sum / n);
        [all, lack_of_fit.sum()]
    }
}

/// Blocks of a study's samples, stacked: of one protocol, tool and site, one sensel or one part of a phase.
pub fn blocks(measured: &[Measured]) -> Vec<usize> {
    let mut keys = Vec::new();
    let mut numbers = Vec::new();
    for one in measured {
        let parts = parts(one);
        for sample in &one.samples {
            let part = match sample.quantity {
                Quantity::Pressure(_) | Quantity::Scan(_) => (0, 0),
                _ => parts[sample.moment as usize],
            };
            let key = (
                &one.protocol,
                &one.indenter,
                &one.site,
                sample.quantity,
                part,
            );
            numbers.push(key);
        }
    }
    keys.extend(numbers.iter().copied());
    keys.sort_unstable();
    keys.dedup();
    let number = |key| keys.binary_search(key).unwrap_or(0);
    numbers.iter().map(number).collect()
}

/// By moment: number of its phase in the recording, and which part of that phase it is.
fn parts(measured: &Measured) -> Vec<(usize, usize)> {
    let moments = &measured.moments;
    let mut starts = vec![0];
    starts.extend((1..moments.len()).filter(|&k| moments[k].phase != moments[k - 1].phase));
    let of = |k: usize| {
        let phase = starts.partition_point(|start| *start <= k) - 1;
        let end = starts.get(phase + 1).copied().unwrap_or(moments.len());
        let (start, length) = (starts[phase], end - starts[phase]);
        (phase, PARTS * (k - start) / length)
    };
    (0..moments.len()).map(of).collect()
}

/// Whitened noise.
fn draw(left: &Left<'_>, scale: f64, random: &mut Random) -> Vec<f64> {
    let one = |(k, counts): (usize, &bool)| {
        let from = &left.noise.drawn_from[left.whitening.channel(k) as usize];
        match (*counts, from.len() >= LEAST_DEVIATIONS) {
            (false, _) => 0.0,
            (true, true) => scale * from[(random.uniform() * from.len() as f64) as usize],
            (true, false) => scale * random.normal(),
        }
    };
    left.counts.iter().enumerate().map(one).collect()
}
