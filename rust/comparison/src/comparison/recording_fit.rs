//! One recording of a fit: samples, simulation, noise, and whitened residual by moment.

use std::ops::Range;

use nalgebra::DMatrix;

use crate::comparison::quantities::residual;
use thenar_inference::fit::result::Fit;
use thenar_inference::observe::measured::{Censoring, Measured};

/// One recording of a fit.
pub(crate) struct RecordingFit<'a> {
    pub measured: &'a Measured,
    /// In the samples' units; of a map without calibration scaled to the sum of each frame.
    pub simulated: Vec<f64>,
    pub before: Vec<f64>,
    pub sigma: &'a [f64],
    pub projected: &'a [f64],
    /// Measured minus simulated, 0 where the instrument's limits hide the difference.
    pub residual: Vec<f64>,
    /// Samples of each moment.
    pub by_moment: Vec<Range<usize>>,
    absorbed: &'a DMatrix<f64>,
    first_row: usize,
}

impl<'a> RecordingFit<'a> {
    pub fn of(fit: &'a Fit) -> Vec<RecordingFit<'a>> {
        let mut first_row = 0;
        let mut recording_fits = Vec::with_capacity(fit.measured.len());
        for (k, measured) in fit.measured.iter().enumerate() {
            let by_moment = moments(measured);
            let scaled = |simulated: &[f64]| match measured.is_calibrated {
                true => simulated.to_vec(),
                false => scale(measured, simulated, &by_moment),
            };
            let (simulated, before) = (scaled(&fit.simulated[k]), scaled(&fit.before[k]));
            let pairs = measured.samples.iter().zip(&simulated);
            let residual = pairs
                .map(|(sample, simulated)| residual(sample.value, *simulated, sample.censoring))
                .collect();
            recording_fits.push(RecordingFit {
                measured,
                simulated,
                before,
                sigma: &fit.sigma[k],
                projected: &fit.projected[k],
                residual,
                by_moment,
                absorbed: &fit.absorbed,
                first_row,
            });
            first_row += measured.samples.len();
        }
        recording_fits
    }

    /// Residual of a sample in standard deviations of its noise; NaN where that is not known.
    pub fn sigmas(&self, sample: usize) -> f64 {
        let sigma = self.sigma[sample];
        match sigma > 0.0 {
            true => self.residual[sample] / sigma,
            false => f64::NAN,
        }
    }

    pub fn has_noise(&self) -> bool {
        !self.sigma.is_empty() && self.sigma.iter().all(|sigma| *sigma > 0.0)
    }

    /// Whether the sample says anything about the residual; a censored one that agrees does not.
    pub fn tells(&self, sample: usize) -> bool {
        self.measured.samples[sample].censoring == Censoring::Seen || self.residual[sample] != 0.0
    }

    /// The mean of the projected residual over some samples, and its standard deviation under noise alone.
    ///
    /// With `r = P n`, the mean of the samples `S` is `w.r`, and its variance `|P w|^2 = |w|^2 - |Q^T w|^2`, `w` being
    /// `1 / |S|` on `S`.
    pub fn mean_projected(&self, samples: &[usize]) -> (f64, f64) {
        let count = samples.len() as f64;
        let mean = samples.iter().map(|k| self.projected[*k]).sum::<f64>() / count;
        let absorbed: f64 = self
            .absorbed
            .column_iter()
            .map(|column| {
                let sum: f64 = samples.iter().map(|k| column[self.first_row + k]).sum();
                (sum / count).powi(2)
            })
            .sum();
        (mean, (1.0 / count - absorbed).max(0.0).sqrt())
    }
}

/// Where the samples of each moment stand; they are ordered by moment.
fn moments(measured: &Measured) -> Vec<Range<usize>> {
    let mut ranges = Vec::with_capacity(measured.moments.len());
    let mut start = 0;
    for moment in 0..measured.moments.len() as u32 {
        let rest = &measured.samples[start..];
        let count = rest.partition_point(|sample| sample.moment <= moment);
        ranges.push(start..start + count);
        start += count;
    }
    ranges
}

/// The simulation of every frame, scaled to the sum of what was read.
fn scale(measured: &Measured, simulated: &[f64], by_moment: &[Range<usize>]) -> Vec<f64> {
    let mut scaled = simulated.to_vec();
    for range in by_moment {
        let samples = &measured.samples[range.clone()];
        let read = samples
            .iter()
            .filter(|sample| sample.censoring != Censoring::AtMost);
        let (wanted, found): (f64, f64) = (
            read.map(|sample| sample.value).sum(),
            simulated[range.clone()].iter().sum(),
        );
        if found > 0.0 {
            let factor = wanted / found;
            scaled[range.clone()]
                .iter_mut()
                .for_each(|value| *value *= factor);
        }
    }
    scaled
}
