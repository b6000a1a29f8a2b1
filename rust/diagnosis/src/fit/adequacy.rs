//! What parameters can absorb, what is left, and whether noise alone leaves as much.

use nalgebra::{DMatrix, DVector};

use crate::noise::{Noise, Whitening};
use crate::random::Random;

/// Part of the largest column below which a direction is no direction.
const LEAST: f64 = 1e-9;
/// Most that one residual adds to the misfit, in standard deviations: outliers do not decide.
const MOST: f64 = 3.0;
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
    /// The noise.
    pub noise: &'a Noise,
    /// How it was whitened.
    pub whitening: &'a Whitening,
}

/// Probability that noise alone leaves as much; None without repeats.
///
/// Noise is drawn `draws` times from what the repeats deviated by, outliers among it, and loses what parameters absorb as the data
/// did; its size is as uncertain as repeats leave it.
pub fn lack_of_fit(left: &Left<'_>, (draws, seed): (usize, u64)) -> Option<f64> {
    let size = |values: &[f64]| -> f64 {
        let each = values.iter().zip(left.counts);
        each.filter(|(_, counts)| **counts)
            .map(|(r, _)| (r * r).min(MOST * MOST))
            .sum()
    };
    let found = size(left.projected);
    let mut random = Random::new(seed);
    let degrees = (left.noise.degrees?.round() as usize).clamp(1, 2000);
    let mut as_much = 0;
    for _ in 0..draws {
        // Noise that is larger than repeats happened to show leaves more.
        let scale = (degrees as f64 / random.chi_square(degrees)).sqrt();
        let noise = draw(left, scale, &mut random);
        as_much += usize::from(size(&project(left.absorbed, &noise)) >= found);
    }
    Some((1 + as_much) as f64 / (1 + draws) as f64)
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
