//! Repeats of one protocol resampled to the same moments.

use crate::noise::channel::Channel;
use crate::observe::measured::{Censoring, Measured, Phase};
use crate::random::Random;

/// Parts of the time that a recording takes: by how much the moments of repeats may differ that count as the same, and by how much
/// they may have begun apart.
const APART: f64 = 0.01;
const LAG: f64 = 0.05;

/// One channel of one repeat at the moments of the first of them.
#[derive(Debug, Clone, PartialEq)]
pub struct Aligned {
    /// Measured.
    pub value: Vec<f64>,
    /// Depth, mm.
    pub depth: Vec<f64>,
    /// Simulated.
    pub simulated: Vec<f64>,
    /// Derivative of the simulated value by depth, per mm.
    pub slope: Vec<f64>,
    /// Readings of which each is the mean.
    pub readings: Vec<f64>,
}

/// A recording with what the model says of it.
#[derive(Clone, Copy)]
pub struct RepeatSeries<'a> {
    /// The recording.
    pub measured: &'a Measured,
    /// Predictions by sample.
    pub simulated: &'a [f64],
    /// Their derivatives by depth.
    pub slopes: &'a [f64],
    /// Number of the recording.
    pub number: usize,
}

/// The channel of each repeat at the times (s) of the first one's samples that all of them cover.
///
/// Repeats whose samples fall on the same moments are taken as they are; others are joined by straight lines over the time since
/// the first loading began. Only sensors without a number of their own: a mat's sensels are compared frame by frame elsewhere.
pub fn aligned(channel: Channel, repeats: &[RepeatSeries<'_>]) -> (Vec<f64>, Vec<Aligned>) {
    let series: Vec<Series> = repeats
        .iter()
        .map(|repeat| Series::new(channel, repeat))
        .collect();
    let first = &series[0];
    let range = match (first.time.first(), first.time.last()) {
        (Some(start), Some(end)) => end - start,
        _ => 0.0,
    };
    // When the first loading began is judged from rows that lie some way apart: by itself it does not make two repeats different.
    let is_same = |other: &Series| {
        let pairs = || other.time.iter().zip(&first.time);
        let lag = pairs().next().map_or(0.0, |(a, b)| a - b);
        other.time.len() == first.time.len()
            && lag.abs() <= LAG * range
            && pairs().all(|(a, b)| (a - b - lag).abs() <= APART * range)
    };
    if series.iter().all(is_same) {
        let time = first.time.clone();
        return (time, series.into_iter().map(|s| s.aligned).collect());
    }
    let start = series
        .iter()
        .map(|s| s.time.first().copied().unwrap_or(f64::NAN));
    let end = series
        .iter()
        .map(|s| s.time.last().copied().unwrap_or(f64::NAN));
    let (start, end) = (
        start.fold(f64::NEG_INFINITY, f64::max),
        end.fold(f64::INFINITY, f64::min),
    );
    let times: Vec<f64> = first
        .time
        .iter()
        .copied()
        .filter(|t| start <= *t && *t <= end)
        .collect();
    let aligned = series.iter().map(|s| s.at(&times)).collect();
    (times, aligned)
}

struct Series {
    /// Since the first loading began, s.
    time: Vec<f64>,
    aligned: Aligned,
}

impl Series {
    fn new(channel: Channel, repeat: &RepeatSeries<'_>) -> Series {
        let moments = &repeat.measured.moments;
        let began = moments
            .iter()
            .find(|m| m.phase == Phase::Load)
            .map_or(0.0, |m| m.time_s);
        let mut series = Series {
            time: Vec::new(),
            aligned: Aligned {
                value: Vec::new(),
                depth: Vec::new(),
                simulated: Vec::new(),
                slope: Vec::new(),
                readings: Vec::new(),
            },
        };
        // Forces that are rounded alike seem to have no noise: where in its step each was, nobody knows.
        let mut random = Random::new(repeat.number as u64);
        for (k, sample) in repeat.measured.samples.iter().enumerate() {
            let within = random.uniform() - 0.5;
            if Channel::of(sample.quantity) == channel && sample.censoring == Censoring::Seen {
                let moment = &moments[sample.moment as usize];
                let step_n = match channel {
                    Channel::Force => moment.force_step_n,
                    _ => 0.0,
                };
                series.time.push(moment.time_s - began);
                series.aligned.value.push(sample.value + step_n * within);
                series.aligned.depth.push(moment.depth_mm);
                series.aligned.simulated.push(repeat.simulated[k]);
                series.aligned.slope.push(repeat.slopes[k]);
                series.aligned.readings.push(f64::from(moment.readings));
            }
        }
        series
    }

    fn at(&self, times: &[f64]) -> Aligned {
        let joined = |values: &[f64]| match values.is_empty() {
            true => Vec::new(),
            false => crate::interpolation::linear(&self.time, values, times),
        };
        Aligned {
            value: joined(&self.aligned.value),
            depth: joined(&self.aligned.depth),
            simulated: joined(&self.aligned.simulated),
            slope: joined(&self.aligned.slope),
            readings: joined(&self.aligned.readings),
        }
    }
}
