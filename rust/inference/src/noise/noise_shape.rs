//! How the size of noise differs from sample to sample: in proportion to the load, and with the readings of which a sample is the mean.

use crate::noise::correlation::Correlation;
use crate::noise::deviations::{Deviations, NoiseShape};
use crate::noise::hum::with_hum;
use crate::noise::restricted_likelihood::{
    correlation_and_inliers, left, likeliest_memory, likeliest_mixture, likelihood,
    sampling_interval, within,
};

/// Noise in proportion to the load over noise without load, at full load, that is tried.
const RATIOS: [f64; 11] = [0.0, 0.5, 1.0, 1.5, 2.0, 3.0, 5.0, 8.0, 16.0, 40.0, 100.0];
/// How much likelier a shape must be than even noise, nats: as a memory must, and the logarithm of how many are tried.
const CLEAR: f64 = 5.0;
/// Part of the samples which even noise has within it that a shape must have so too: one that takes what is read without load for outliers says
/// nothing of them.
const KEPT: f64 = 0.9;
/// Part of the largest load below which noise is that without load, and fewest samples from which its memory is estimated.
const LIGHT: (f64, usize) = (0.15, 24);
/// Part of the largest load from which samples are under load, and standard errors by which neighbors there may be alike.
const LOADED: f64 = 0.3;
const SLOW: f64 = 3.0;
/// Memory of noise in proportion, over that of what is there without load, from which it is no noise of an instrument: the skin itself is
/// unsteady.
const STEADY: f64 = 1.5;

/// What the repeats of all groups show.
pub struct NoiseEstimate {
    /// How it differs from sample to sample.
    pub shape: NoiseShape,
    /// Correlation in time.
    pub correlation: Correlation,
    /// By group: standard deviation, and its degrees of freedom.
    pub sizes: Vec<(f64, f64)>,
}

/// The likeliest part in proportion to the load, the likeliest correlation, and each group's size under it; outliers are left out. The
/// deviations are weighted accordingly.
pub fn estimate(all: &mut Vec<Deviations>) -> NoiseEstimate {
    let shape = likeliest_shape(all);
    if shape != NoiseShape::EVEN {
        *all = all.iter().map(|d| d.weighted(shape)).collect();
    }
    let (mut correlation, mut kept) = correlation_and_inliers(all, likeliest_mixture);
    if let Some(found) = with_hum(all, correlation) {
        correlation = found;
        kept = all.iter().map(|d| within(d, Some(found))).collect();
    }
    let pairs = all.iter().zip(&kept);
    NoiseEstimate {
        shape,
        correlation,
        sizes: pairs
            .map(|(d, kept)| {
                let (sum, degrees, _) = left(d, kept, correlation);
                ((sum / degrees).sqrt(), degrees)
            })
            .collect(),
    }
}

/// The shape under which the deviations are likeliest; even where no other is clearly likelier.
pub(crate) fn likeliest_shape(all: &[Deviations]) -> NoiseShape {
    let (mut best, mut shape) = (CLEAR, NoiseShape::EVEN);
    let has_means = all
        .iter()
        .flat_map(|d| &d.readings)
        .any(|n| *n != all[0].readings[0]);
    let averaged = [false, true].into_iter().filter(|a| !a || has_means);
    let count = |kept: &[Vec<usize>]| kept.iter().map(Vec::len).sum::<usize>() as f64;
    let in_even = count(&correlation_and_inliers(all, likeliest_memory).1);
    let shapes =
        averaged.flat_map(|is_averaged| RATIOS.map(|ratio| NoiseShape { ratio, is_averaged }));
    for tried in shapes.filter(|shape| *shape != NoiseShape::EVEN) {
        let weighted: Vec<Deviations> = all.iter().map(|d| d.weighted(tried)).collect();
        let (memory, kept) = correlation_and_inliers(&weighted, likeliest_memory);
        let even = likeliest_memory(all, &kept);
        let gained = likelihood(&weighted, &kept, memory)
            - weights(&weighted, &kept)
            - likelihood(all, &kept, even);
        let is_steady = tried.ratio == 0.0
            || (memory.memory_s <= STEADY * light_memory(all)
                && !is_slow(&weighted, &kept, memory));
        if gained > best && is_steady && count(&kept) >= KEPT * in_even {
            (best, shape) = (gained, tried);
        }
    }
    match shape == NoiseShape::EVEN || is_mixed_instead(all, shape) {
        true => NoiseShape::EVEN,
        false => shape,
    }
}

/// Logarithm of what weighting takes from a likelihood.
fn weights(weighted: &[Deviations], kept: &[Vec<usize>]) -> f64 {
    let size = |(d, kept): (&Deviations, &Vec<usize>)| {
        let logs = kept.iter().map(|k| libm::log(d.profile[*k]));
        logs.sum::<f64>() * (d.rest.len() as f64 - 1.0)
    };
    weighted.iter().zip(kept).map(size).sum()
}

/// Whether even noise with a white part and a memory explains what a shape seemed to.
fn is_mixed_instead(all: &[Deviations], shape: NoiseShape) -> bool {
    let (even, kept) = correlation_and_inliers(all, likeliest_mixture);
    if even.white == 0.0 {
        return false;
    }
    let weighted: Vec<Deviations> = all.iter().map(|d| d.weighted(shape)).collect();
    let shaped = likeliest_mixture(&weighted, &kept);
    let gained = likelihood(&weighted, &kept, shaped)
        - weights(&weighted, &kept)
        - likelihood(all, &kept, even);
    gained <= CLEAR
}

/// Whether deviations under load go on from sample to sample beyond their memory: something slow is among them, which is no noise in
/// proportion.
fn is_slow(weighted: &[Deviations], kept: &[Vec<usize>], memory: Correlation) -> bool {
    let (mut product, mut square, mut count) = (0.0, 0.0, 0.0);
    for (of, kept) in weighted.iter().zip(kept) {
        let loaded: Vec<usize> = kept
            .iter()
            .copied()
            .filter(|&k| of.load[k] > LOADED)
            .collect();
        for series in &of.rest {
            let filter = memory.filter(loaded.iter().map(|&k| of.sample(k)));
            let white = filter.whitened(|k| series[loaded[k]]);
            let fresh = white.get(1..).unwrap_or_default();
            product += fresh.windows(2).map(|w| w[0] * w[1]).sum::<f64>();
            square += fresh.iter().map(|e| e * e).sum::<f64>();
            count += fresh.len() as f64;
        }
    }
    product > SLOW * square / f64::max(count, 1.0).sqrt()
}

/// Memory of what deviates without load, s, at least the time between samples; where there is too little of it, of all.
fn light_memory(all: &[Deviations]) -> f64 {
    let light = |d: &Deviations| -> Vec<usize> {
        let kept = within(d, None).into_iter();
        kept.filter(|&k| d.load[k] < LIGHT.0).collect()
    };
    let kept: Vec<Vec<usize>> = all.iter().map(light).collect();
    let step = sampling_interval(all);
    match kept.iter().map(Vec::len).sum::<usize>() >= LIGHT.1 {
        true => likeliest_memory(all, &kept).memory_s.max(step),
        false => step,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::noise::restricted_likelihood::tests::{deviations, deviations_of, of_memory};
    use crate::random::Random;

    /// Of studies of five protocols: what taking out gain and touch, or a zero too, hides of the noise is not missed, neither in its memory nor in what
    /// it does to a slow signal, which goes as the variance times the memory.
    #[test]
    fn correlation_time_and_sigma_are_unbiased() {
        for (memory_s, own) in [(0.15, 2), (0.6, 2), (0.15, 3), (0.6, 3)] {
            let mut random = Random::new(5);
            let studies = 60.0;
            let mut logs = [0.0; 2];
            for _ in 0..60 {
                let mut all: Vec<Deviations> = (0..5)
                    .map(|_| of_memory(own, memory_s, &mut random))
                    .collect();
                let found = estimate(&mut all);
                let variance = found.sizes.iter().map(|s| s.0 * s.0).sum::<f64>() / 5.0;
                let ratio = found.correlation.memory_s / memory_s;
                logs[0] += libm::log(ratio) / studies;
                logs[1] += libm::log(ratio * variance) / studies;
            }
            assert!(
                logs[0].abs() < 0.1 && logs[1].abs() < 0.1,
                "{memory_s} {own}: {logs:?}"
            );
        }
    }

    #[test]
    fn white_noise_has_zero_correlation_time() {
        let mut random = Random::new(2);
        let with = (0..100).filter(|_| {
            let mut all: Vec<Deviations> = (0..5).map(|_| deviations(0.0, &mut random)).collect();
            estimate(&mut all).correlation.memory_s > 0.0
        });
        // Twice two nats is beyond the 95 % point of a chi-square of one number, and a memory can only be longer than none.
        let often = with.count();
        assert!(often <= 7, "{often} of 100");
    }

    /// White noise of 1 without load and of 4 or 60 at full load is found, and even noise is not taken for it; a skin that is unsteady for
    /// seconds is no noise of an instrument.
    #[test]
    fn proportional_noise_is_detected_and_even_noise_is_not() {
        let mut random = Random::new(8);
        let study = |grown: f64, slow: f64, random: &mut Random| -> Vec<Deviations> {
            let one = |_| {
                let (mut of, wander) = (deviations(0.0, random), deviations(3.0, random));
                for r in 0..2 {
                    for k in 0..of.time.len() {
                        of.rest[r][k] *= 1f64.hypot(grown * of.load[k]);
                        of.rest[r][k] += slow * of.load[k] * wander.rest[r][k];
                    }
                }
                of
            };
            (0..5).map(one).collect()
        };
        // The second lies between two that are tried.
        for (grown, off, studies) in [(4.0, 0.2, 20), (60.0, 0.55, 5)] {
            let mut logs = Vec::new();
            for _ in 0..studies {
                let found = estimate(&mut study(grown, 0.0, &mut random));
                logs.push(libm::log(found.shape.ratio / grown));
            }
            let mean = logs.iter().sum::<f64>() / f64::from(studies);
            assert!(
                mean.abs() < off && logs.iter().all(|l| l.abs() < 0.8),
                "{grown}: {mean} {logs:?}"
            );
        }
        let mut often = |grown: f64, slow: f64| -> usize {
            (0..20)
                .filter(|_| estimate(&mut study(grown, slow, &mut random)).shape.ratio > 0.0)
                .count()
        };
        assert!(often(0.0, 0.0) <= 2);
        for slow in [2.0, 6.0, 20.0] {
            let often = often(0.0, slow);
            assert!(often <= 4, "{slow}: {often}");
        }
    }

    /// Means of 1 and of 9 independent readings; with memory, means of either are alike.
    #[test]
    fn means_of_more_readings_are_surer_where_noise_is_white() {
        let mut random = Random::new(9);
        let mut often = |memory_s: f64, is_white: bool| {
            let study = |random: &mut Random| -> Vec<Deviations> {
                let one = |_| {
                    let mut of = deviations(memory_s, random);
                    for k in 22..48 {
                        of.readings[k] = 9.0;
                        if is_white {
                            of.rest.iter_mut().for_each(|r| r[k] /= 3.0);
                        }
                    }
                    of
                };
                (0..5).map(one).collect()
            };
            (0..20)
                .filter(|_| estimate(&mut study(&mut random)).shape.is_averaged)
                .count()
        };
        assert_eq!(often(0.0, true), 20);
        assert!(often(0.6, false) <= 1);
    }

    /// A zero that walks from nothing under white noise, of which many readings leave a third: the walk's variance in a second, the
    /// white part and what readings do to it are found; noise of one memory, or without any, is not taken for it.
    #[test]
    fn wandering_zero_is_a_memory_and_a_white_part() {
        let (per_s, white) = (0.3, 0.6);
        let mut random = Random::new(10);
        let mut readings = vec![1.0; 78];
        readings[22..48].fill(9.0);
        let mut study = |is_wandering: bool, memory_s: f64| -> Vec<Deviations> {
            let one = |_| {
                if !is_wandering {
                    return deviations(memory_s, &mut random);
                }
                let mut of = deviations_of(2, &mut |time| {
                    let mut zero = 0.0;
                    let each = (0..time.len()).map(|k| {
                        let step = if k > 0 { time[k] - time[k - 1] } else { 0.0 };
                        zero += per_s * step.sqrt() * random.normal();
                        zero + white / f64::sqrt(readings[k]) * random.normal()
                    });
                    each.collect()
                });
                of.readings.clone_from(&readings);
                of
            };
            (0..5).map(one).collect()
        };
        let (mut logs, mut tared) = ([0.0; 2], 0);
        for _ in 0..20 {
            let found = estimate(&mut study(true, 0.0));
            let correlation = found.correlation;
            assert!(correlation.white > 0.0 && found.shape.ratio == 0.0);
            tared += usize::from(correlation.is_tared);
            // Half of the difference of two repeats is in each, and `sizes` allow for it.
            let variance = found.sizes.iter().map(|s| s.0 * s.0).sum::<f64>() / 5.0;
            let slow = 2.0 * variance * (1.0 - correlation.white) / correlation.memory_s;
            logs[0] += 0.5 * libm::log(slow / (per_s * per_s)) / 20.0;
            logs[1] += 0.5 * libm::log(variance * correlation.white / (white * white)) / 20.0;
        }
        assert!(
            logs[0].abs() < 0.12 && logs[1].abs() < 0.05 && tared >= 14,
            "{logs:?} {tared}"
        );
        for memory_s in [0.0, 0.15, 0.6] {
            let often =
                (0..20).filter(|_| estimate(&mut study(false, memory_s)).correlation.white > 0.0);
            let often = often.count();
            assert!(often <= 1, "{memory_s}: {often}");
        }
    }
}
