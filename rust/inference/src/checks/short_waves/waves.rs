//! The waves of one recording: its force less its running mean, along its time or along the way in and out.

use std::f64::consts::TAU;

use nalgebra::{DMatrix, DVector};

use crate::forward::surrogate::force_recording::{ForceRecording, Row};
use crate::observe::measured::Phase;
use crate::observe::protocol_phases::range;
use crate::observe::robust_scale::{median, median_deviation, noise_of};

/// Part of a recording's depth above which it counts as loaded: where the skin is first touched is not known to a sample.
const LOADED: f64 = 0.1;
/// Fewest samples of a running mean.
const FEWEST_IN_MEAN: usize = 5;
/// Deviations beyond which a sample counts no more: single ones that are astray do not decide.
const MOST: f64 = 3.0;

/// What is taken of a row and its sample, N.
pub(super) type Value<'a> = &'a dyn Fn(&Row, usize) -> f64;

/// Along what the waves of two recordings are compared.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Along {
    /// The time since the first row: repeats of a protocol.
    Time,
    /// The depth on the way in and on the way out, cycle by cycle, at any speed. A wave counts in proportion to the force, as what the tissue
    /// does grows with it.
    Depth,
}

/// Which waves are taken.
#[derive(Debug, Clone, Copy)]
pub(super) struct Filter {
    pub(super) along: Along,
    /// Samples of a recording over those of a running mean, and the part of a running mean over which a sample is smoothed.
    pub(super) band: (usize, f64),
    /// Number of running means that are taken off.
    pub(super) means: usize,
}

/// One recording's waves.
pub(super) struct Waves {
    /// Number of the way (0 in time) and the place on it, s or mm; in order.
    pub(super) at: Vec<(u32, f64)>,
    /// Force less its running mean, in deviations of it, times its weight.
    pub(super) force: Vec<f64>,
    /// Weight of each.
    pub(super) weight: Vec<f64>,
    /// Samples of a running mean.
    pub(super) in_mean: usize,
    /// One deviation, N.
    pub(super) deviation_n: f64,
    /// Range of the recording's forces, N.
    pub(super) range_n: f64,
}

impl Waves {
    /// None where a recording has too few samples under load. `simulated` holds predictions by sample, N, and `hum_hz` is the frequency of a hum
    /// of the instrument, which is taken off with its overtone.
    pub(super) fn of(
        course: &ForceRecording,
        filter: Filter,
        (of, simulated, hum_hz): (Value<'_>, &[f64], Option<f64>),
    ) -> Option<Waves> {
        let start = course.rows.first()?.time_s;
        let rows = course.rows.iter();
        let read: Vec<(&Row, usize)> = rows.filter_map(|row| Some((row, row.sample?))).collect();
        let half = FEWEST_IN_MEAN.max(read.len() / filter.band.0) / 2;
        let near = (half as f64 * filter.band.1).round() as usize;
        let most_n = read.iter().map(|(_, k)| simulated[*k]).fold(0.0, f64::max);
        let filtered = |mut values: Vec<f64>| {
            values = less_running_mean(&values, (half, near));
            for _ in 1..filter.means {
                values = less_running_mean(&values, (half, 0));
            }
            values
        };
        let (mut at, mut weight, mut waves) = (Vec::new(), Vec::new(), Vec::new());
        let mut columns = vec![Vec::new(); if hum_hz.is_some() { 5 } else { 0 }];
        for (way, stage) in stages(course, &read, filter.along) {
            let mut values: Vec<f64> = stage.iter().map(|(row, k)| of(row, *k)).collect();
            limit_spikes(&mut values, half);
            waves.extend(filtered(values));
            for (column, found) in columns.iter_mut().enumerate() {
                let of = |(row, k): &(&Row, usize)| {
                    let turned = TAU * hum_hz.unwrap_or(0.0) * row.time_s;
                    let (sine, cosine) = libm::sincos(turned);
                    let (second, other) = libm::sincos(2.0 * turned);
                    [simulated[*k], sine, cosine, second, other][column]
                };
                found.extend(filtered(stage.iter().map(of).collect()));
            }
            let inner = filter.means * half..stage.len().saturating_sub(filter.means * half);
            for (row, k) in &stage[inner.start.min(inner.end)..inner.end] {
                match filter.along {
                    Along::Time => at.push((0, row.time_s - start)),
                    Along::Depth => at.push((way, row.depth_mm)),
                }
                weight.push(match filter.along {
                    Along::Time => 1.0,
                    Along::Depth => simulated[*k].max(0.0) / most_n,
                });
            }
        }
        take_off_hum(&columns, &mut waves);
        let mut order: Vec<usize> = (0..at.len()).collect();
        order.sort_by(|i, j| at[*i].0.cmp(&at[*j].0).then(at[*i].1.total_cmp(&at[*j].1)));
        let mut sizes: Vec<f64> = waves.iter().map(|wave: &f64| wave.abs()).collect();
        let deviation_n = median_deviation(&mut sizes);
        let in_deviations = |wave: f64| (wave / deviation_n).clamp(-MOST, MOST);
        (at.len() > 1 && deviation_n > 0.0 && most_n > 0.0).then(|| Waves {
            at: order.iter().map(|k| at[*k]).collect(),
            force: order
                .iter()
                .map(|k| weight[*k] * in_deviations(waves[*k]))
                .collect(),
            weight: order.iter().map(|k| weight[*k]).collect(),
            in_mean: 2 * half + 1,
            deviation_n,
            range_n: range_n(course),
        })
    }

    /// Mean distance of neighbors on one way, s or mm.
    fn step(&self) -> f64 {
        let neighbors = self.at.windows(2).filter(|pair| pair[0].0 == pair[1].0);
        let along: f64 = neighbors.map(|pair| pair[1].1 - pair[0].1).sum();
        along / self.at.len() as f64
    }

    /// Pairs of numbers of a wave of this and of the one of `other` that is nearest to it, half a step off at most.
    pub(super) fn same_places(&self, other: &Waves) -> Vec<(usize, usize)> {
        const SAME: f64 = 0.5;
        let most = SAME * self.step().max(other.step());
        let nearest = |(way, at): (u32, f64)| {
            let after = other.at.partition_point(|b| *b < (way, at));
            let near = after.saturating_sub(1)..(after + 1).min(other.at.len());
            let off = |k: usize| (other.at[k].1 - at).abs();
            let of_way = near.filter(|k| other.at[*k].0 == way);
            of_way
                .min_by(|i, j| off(*i).total_cmp(&off(*j)))
                .filter(|k| off(*k) <= most)
        };
        let all = self.at.iter().enumerate();
        all.filter_map(|(k, at)| Some((k, nearest(*at)?))).collect()
    }
}

/// Stages of a recording under load, with the number of their way; along the depth those in which it goes in or out.
fn stages<'a>(
    course: &ForceRecording,
    read: &'a [(&'a Row, usize)],
    along: Along,
) -> impl Iterator<Item = (u32, &'a [(&'a Row, usize)])> {
    let deep = LOADED * course.deepest();
    let is_loaded = move |row: &Row| row.phase != Phase::Apart && row.depth_mm > deep;
    let is_one_stage = move |a: &(&Row, usize), b: &(&Row, usize)| {
        is_loaded(a.0) == is_loaded(b.0) && (a.0.phase, a.0.cycle) == (b.0.phase, b.0.cycle)
    };
    let loaded = read
        .chunk_by(is_one_stage)
        .filter(move |s| is_loaded(s[0].0));
    loaded.filter_map(move |stage| {
        let row = stage[0].0;
        match (along, row.phase) {
            (Along::Time, _) => Some((0, stage)),
            (Along::Depth, Phase::Load) => Some((2 * row.cycle, stage)),
            (Along::Depth, Phase::Unload) => Some((2 * row.cycle + 1, stage)),
            (Along::Depth, _) => None,
        }
    })
}

/// From the smallest to the largest force that was read, N.
fn range_n(course: &ForceRecording) -> f64 {
    let read = course.rows.iter().filter(|row| row.sample.is_some());
    let forces: Vec<f64> = read.map(|row| row.force_n).collect();
    let (least, most) = range(&forces);
    most - least
}

/// Takes off what a hum of its own phase and size makes of the waves, by least squares next to what grows with the prediction: all columns are filtered
/// as the waves are, so that what bends slowly in the force is not taken for a hum.
fn take_off_hum(columns: &[Vec<f64>], waves: &mut [f64]) {
    if columns.is_empty() || waves.is_empty() {
        return;
    }
    let matrix = DMatrix::from_fn(waves.len(), columns.len(), |n, column| columns[column][n]);
    let pull = matrix.tr_mul(&DVector::from_column_slice(waves));
    let Some(found) = matrix
        .tr_mul(&matrix)
        .cholesky()
        .map(|root| root.solve(&pull))
    else {
        return;
    };
    for (n, wave) in waves.iter_mut().enumerate() {
        // The first column is the prediction, which stays.
        *wave -= (1..columns.len())
            .map(|c| found[c] * columns[c][n])
            .sum::<f64>();
    }
}

/// Limits single values that are far from the running median about them: a running mean would spread them over their neighbors.
fn limit_spikes(values: &mut [f64], half: usize) {
    let about = |window: &[f64]| median(&mut window.to_vec());
    let medians: Vec<f64> = values.windows(2 * half + 1).map(about).collect();
    if medians.is_empty() {
        return;
    }
    let noise = noise_of(values);
    let inner = &mut values[half..];
    let mut sizes: Vec<f64> = inner
        .iter()
        .zip(&medians)
        .map(|(v, m)| (v - m).abs())
        .collect();
    let most = MOST * median_deviation(&mut sizes).max(noise);
    if !most.is_finite() {
        return;
    }
    for (value, median) in inner.iter_mut().zip(&medians) {
        *value = value.clamp(median - most, median + most);
    }
}

/// Values less their running mean of `half` samples each way, smoothed over `near` each way; `half` fewer at each end.
fn less_running_mean(values: &[f64], (half, near): (usize, usize)) -> Vec<f64> {
    let of = |window: &[f64]| mean(&window[half - near..=half + near]) - mean(window);
    values.windows(2 * half + 1).map(of).collect()
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

#[cfg(test)]
mod tests {
    use super::limit_spikes;

    /// A stage that is half longer than a running mean: a spike is limited where it is.
    #[test]
    fn spike_is_limited_and_the_curve_is_kept() {
        for n in [23, 60] {
            let curve: Vec<f64> = (0..n)
                .map(|k| 0.1 * f64::from(k) + 0.01 * f64::from(k % 3))
                .collect();
            let mut values = curve.clone();
            values[9] += 5.0;
            limit_spikes(&mut values, 8);
            for (k, (found, was)) in values.iter().zip(&curve).enumerate() {
                let most = if k == 9 { 1.5 } else { 0.1 };
                assert!((found - was).abs() <= most, "{n}, {k}: {found} {was}");
            }
        }
        let mut short = vec![1.0, 9.0, 1.0];
        limit_spikes(&mut short, 8);
        assert_eq!(short, [1.0, 9.0, 1.0]);
    }
}
