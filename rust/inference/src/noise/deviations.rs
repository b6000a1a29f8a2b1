//! Deviations of repeats from their mean, and their scatter.

use nalgebra::Vector3;

use crate::noise::correlation::Correlation;
use crate::observe::robust_scale::trimmed_deviation;

/// Deviations beyond this many standard deviations are outliers, and not noise.
pub(crate) const OUTLIER: f64 = 3.5;

/// Variance that values within `OUTLIER` standard deviations of a normal law keep.
const KEPT_VARIANCE: f64 = 0.9935;

/// Noise below this part of a channel's largest value is not believed: tables are joined to 1e-4 of their peak.
pub(crate) const FLOOR: f64 = 2e-4;

/// Fewest samples of a channel from which noise is told.
pub(crate) const LEAST_SAMPLES: usize = 8;

/// Recordings of one protocol with one tool at one place, by number; two or more.
pub type Group = Vec<usize>;

/// How the size of a noise differs from sample to sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NoiseShape {
    /// Standard deviation of the part in proportion to the load, at full load, over that of the rest.
    pub ratio: f64,
    /// Whether readings are independent, so that a mean of n of them has the n-th part of their variance.
    pub is_averaged: bool,
}

impl NoiseShape {
    /// Of the same size everywhere.
    pub const EVEN: NoiseShape = NoiseShape {
        ratio: 0.0,
        is_averaged: false,
    };

    /// Standard deviation at a load (part of the largest) of a mean of `readings`, over that of one reading without load.
    pub fn at(self, load: f64, readings: f64) -> f64 {
        let one = 1f64.hypot(self.ratio * load);
        match self.is_averaged {
            true => one / readings.max(1.0).sqrt(),
            false => one,
        }
    }
}

/// Deviations within one group.
pub struct Deviations {
    pub(crate) group: Group,
    /// s.
    pub(crate) time: Vec<f64>,
    /// Largest mean value.
    pub(crate) most: f64,
    /// Size of the mean value over that, by sample.
    pub(crate) load: Vec<f64>,
    /// Readings of which each sample is the mean.
    pub(crate) readings: Vec<f64>,
    /// Standard deviation of the noise at each sample over that of one reading without load; 1 unless weighted.
    pub(crate) profile: Vec<f64>,
    /// Deviation by repeat and sample, with what differs as a whole taken out.
    pub(crate) rest: Vec<Vec<f64>>,
    /// What differs as a whole, by repeat: logarithm of gain, first touch in mm, and zero of the force in N; and what each sample adds to them.
    pub(crate) whole: Vec<Vector3<f64>>,
    pub(crate) along: Vec<Vector3<f64>>,
    /// Whether each repeat has a zero of the force of its own; else the third of each is 0.
    pub(crate) has_own_zero: bool,
}

impl Deviations {
    /// In units of the noise's own size at each sample.
    pub(crate) fn weighted(&self, shape: NoiseShape) -> Deviations {
        let each = self.load.iter().zip(&self.readings);
        let profile: Vec<f64> = each.map(|(load, n)| shape.at(*load, *n)).collect();
        let over = |series: &Vec<f64>| series.iter().zip(&profile).map(|(r, p)| r / p).collect();
        Deviations {
            group: self.group.clone(),
            time: self.time.clone(),
            most: self.most,
            load: self.load.clone(),
            readings: self.readings.clone(),
            rest: self.rest.iter().map(over).collect(),
            whole: self.whole.clone(),
            along: self
                .along
                .iter()
                .zip(&profile)
                .map(|(a, p)| a / *p)
                .collect(),
            has_own_zero: self.has_own_zero,
            profile,
        }
    }

    /// Time (s) and profile of a sample.
    pub(crate) fn sample(&self, k: usize) -> (f64, f64) {
        (self.time[k], self.profile[k])
    }

    /// What makes a weighted deviation one over its own standard deviation in noise of that correlation.
    pub(crate) fn rescaled(&self, k: usize, correlation: Correlation) -> f64 {
        self.profile[k] / correlation.deviation(self.profile[k])
    }

    /// Deviations made independent, over the standard deviation of the noise, by repeat.
    pub(crate) fn whitened(&self, (sigma, correlation): (f64, Correlation)) -> Vec<Vec<f64>> {
        let m = self.rest.len() as f64;
        // The repeats' own mean takes part of each.
        let sigma = sigma * ((m - 1.0) / m).sqrt();
        let filter = correlation.filter((0..self.time.len()).map(|k| self.sample(k)));
        let series = |rest: &Vec<f64>| -> Vec<f64> {
            let all = filter.whitened(|k| rest[k] * self.rescaled(k, correlation));
            all.into_iter().skip(1).map(|white| white / sigma).collect()
        };
        match sigma > 0.0 {
            true => self.rest.iter().map(series).collect(),
            false => Vec::new(),
        }
    }

    /// How many numbers each repeat has of its own.
    pub(crate) fn own(&self) -> f64 {
        if self.has_own_zero { 3.0 } else { 2.0 }
    }

    /// How a rhythm of the gain shows in a sample, up to a factor, in units of the noise's own size there: by what the sample adds to the gain or,
    /// where a zero is taken out and such a weight is negative without load, by the load.
    pub(crate) fn grows(&self, k: usize) -> f64 {
        match self.has_own_zero {
            true => self.load[k] / self.profile[k],
            false => self.along[k].x,
        }
    }

    /// Variance of what differs as a whole, for noise of variance 1 with that correlation.
    pub(crate) fn unit_variance(&self, correlation: Correlation) -> Vector3<f64> {
        let mut sum = Vector3::zeros();
        let square = |(a, p): (&Vector3<f64>, &f64)| a * (p * correlation.deviation(*p));
        let along: Vec<Vector3<f64>> = self.along.iter().zip(&self.profile).map(square).collect();
        for (k, a) in along.iter().enumerate() {
            sum += a.component_mul(a);
            // Noise remembers little of what lies many memories back.
            for j in (0..k).rev() {
                let shared = correlation.between(self.sample(k), self.sample(j));
                // A hum is the same again after each turn.
                if shared < 1e-3 && correlation.hum.variance == 0.0 {
                    break;
                }
                sum += a.component_mul(&along[j]) * (2.0 * shared);
            }
        }
        sum
    }
}

/// Standard deviation without outliers.
pub(crate) fn robust_deviation(values: &[f64]) -> f64 {
    trimmed_deviation(values, OUTLIER) / KEPT_VARIANCE.sqrt()
}
