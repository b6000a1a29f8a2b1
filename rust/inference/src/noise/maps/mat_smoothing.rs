//! Smoothed mat readings, by which noise proportional to the reading is judged (the noisy reading itself would bias the weights).
//!
//! Judged by the reading, a value that noise made low would count as the surer one, and a fit would follow it.

use std::collections::BTreeMap;

use crate::observe::measured::{Censoring, Measured, Quantity};

/// Frames on either side of one over which a sensel's readings are averaged.
const AROUND: usize = 2;

/// By sample: of a pressure that was seen the mean over the frames around it, of all others the value.
pub(crate) fn smoothed(measured: &Measured) -> Vec<f64> {
    let mut values: Vec<f64> = measured.samples.iter().map(|s| s.value).collect();
    let mut by_sensel: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
    for (k, sample) in measured.samples.iter().enumerate() {
        if let (Quantity::Pressure(sensel), Censoring::Seen) = (sample.quantity, sample.censoring) {
            by_sensel.entry(sensel).or_default().push(k);
        }
    }
    for samples in by_sensel.values() {
        for (at, k) in samples.iter().enumerate() {
            let around = &samples[at.saturating_sub(AROUND)..(at + AROUND + 1).min(samples.len())];
            let sum: f64 = around.iter().map(|k| measured.samples[*k].value).sum();
            values[*k] = sum / around.len() as f64;
        }
    }
    values
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::observe::measured::{Moment, Phase, Sample};
    use nalgebra::Vector3;

    /// Readings of 10 kPa with noise of a tenth of them: judged by what is smoothed, low readings are hardly surer than high ones.
    #[test]
    fn smoothed_reading_weights_low_readings_no_more_than_high() {
        let mut state = 3u64;
        let mut roll = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            (state >> 11) as f64 / (1u64 << 53) as f64 - 0.5
        };
        let sample = |k: u32, value: f64| Sample {
            moment: k / 4,
            quantity: Quantity::Pressure(k % 4),
            value,
            censoring: Censoring::Seen,
        };
        let samples: Vec<Sample> = (0..400).map(|k| sample(k, 10.0 + 3.5 * roll())).collect();
        let moment = |k: u32| Moment {
            time_s: f64::from(k),
            depth_mm: 1.0,
            demand_n: f64::NAN,
            slide_mm: Vector3::zeros(),
            rate_mm_s: 0.0,
            phase: Phase::Hold,
            cycle: 0,
            readings: 1,
            depth_spread_mm: 0.0,
            force_step_n: 0.0,
        };
        let measured = Measured {
            name: String::new(),
            protocol: String::new(),
            indenter: String::new(),
            site: String::new(),
            moments: (0..100).map(moment).collect(),
            samples,
            mat: None,
            scan: None,
            is_calibrated: true,
            depth_error_mm: 0.0,
            is_coarse: false,
            unknown: Vec::new(),
        };
        // What a fit of one number to readings weighted by 1 / sigma^2 finds, sigma in proportion to what it is judged by.
        let fitted = |judged: &[f64]| {
            let pairs = measured.samples.iter().zip(judged);
            let (sum, all) = pairs.fold((0.0, 0.0), |(sum, all), (s, by)| {
                (sum + s.value / (by * by), all + 1.0 / (by * by))
            });
            sum / all
        };
        let raw: Vec<f64> = measured.samples.iter().map(|s| s.value).collect();
        let plain = raw.iter().sum::<f64>() / 400.0;
        let (by_value, by_smoothed) = (plain - fitted(&raw), plain - fitted(&smoothed(&measured)));
        // Weights of 1 / v^2 pull the mean of v down by twice its variance over its mean, 2 x 1.02 / 10; of five readings' mean, by a fifth of it.
        assert!((by_value - 0.2).abs() < 0.05, "{by_value}");
        assert!((by_smoothed - 0.04).abs() < 0.03, "{by_smoothed}");
    }
}
