//! Correlation and size of the noise in repeats by restricted likelihood: gain and first touch of every repeat, and its zero of the force where
//! these differ, are unknown, and what finding them hides of the noise is allowed for (Patterson & Thompson 1971; Harville 1977).
//!
//! Noise forgets itself as `exp(-t / memory)`, all of it or all but a white part, at whatever times the samples stand: a series of such
//! noise is independent in its innovations ([`crate::noise::correlation`]), and gain and touch are found there by least squares.

use nalgebra::{Matrix3, Vector3};

use crate::noise::correlation::{Correlation, Hum, LEAST_FRESH};
use crate::noise::deviations::{Deviations, OUTLIER, robust_deviation};
use crate::observe::robust_scale::median;

/// Ratios of memory to sampling interval between which the likeliest is sought, and how finely.
const LEAST: f64 = 0.15;
const MOST: f64 = 30.0;
const TRIED: usize = 24;
const HALVINGS: usize = 4;
/// How much likelier a memory must be than none, nats, to be believed.
const BELIEVED: f64 = 2.0;
/// Memories and white parts that are tried together, and the logarithm of the white part's odds at the ends.
const MIXED: (usize, usize) = (9, 7);
const WIDEST: f64 = 4.0;
/// How much likelier a white part with a memory must be than a memory alone, nats: a number more, and some that are tried.
const CLEARLY_MIXED: f64 = 5.0;

/// The likeliest correlation by `search` of deviations as they are weighted, and by group the samples that are no outliers.
pub(crate) fn correlation_and_inliers(
    all: &[Deviations],
    search: impl Fn(&[Deviations], &[Vec<usize>]) -> Correlation,
) -> (Correlation, Vec<Vec<usize>>) {
    let kept: Vec<Vec<usize>> = all.iter().map(|d| within(d, None)).collect();
    let rough = search(all, &kept);
    let kept: Vec<Vec<usize>> = all.iter().map(|d| within(d, Some(rough))).collect();
    (search(all, &kept), kept)
}

/// Restricted likelihood of all groups, nats.
pub(crate) fn likelihood(all: &[Deviations], kept: &[Vec<usize>], correlation: Correlation) -> f64 {
    let each = all.iter().zip(kept);
    each.map(|(d, kept)| left(d, kept, correlation).2).sum()
}

/// Samples that are no outliers: not far off, and, once a correlation is known, not far from what their neighbors say of them.
pub(crate) fn within(of: &Deviations, correlation: Option<Correlation>) -> Vec<usize> {
    let n = of.time.len();
    let off = |series: &Vec<f64>, k: usize| -> f64 {
        let Some(correlation) = correlation else {
            return series[k];
        };
        let share = |at: Option<usize>| {
            let at = at.filter(|at| *at < n)?;
            let value = series[at] * of.rescaled(at, correlation);
            Some((value, correlation.between(of.sample(k), of.sample(at))))
        };
        let ((a, before), (b, after)) = (
            share(k.checked_sub(1)).unwrap_or((0.0, 0.0)),
            share(Some(k + 1)).unwrap_or((0.0, 0.0)),
        );
        // Mean and deviation given both neighbors.
        let (c, d) = (before * before, after * after);
        if correlation.is_mixed() {
            let ends = k.checked_sub(1).filter(|_| k + 1 < n);
            let both = ends.map_or(0.0, |j| correlation.between(of.sample(j), of.sample(k + 1)));
            let all = 1.0 - both * both;
            let mean = (a * (before - both * after) + b * (after - both * before)) / all;
            let variance = 1.0 - (c + d - 2.0 * both * before * after) / all;
            let own = series[k] * of.rescaled(k, correlation);
            return (own - mean) / variance.max(LEAST_FRESH).sqrt();
        }
        let all = (1.0 - c * d).max(LEAST_FRESH);
        let mean = (a * before * (1.0 - d) + b * after * (1.0 - c)) / all;
        (series[k] - mean) / ((1.0 - c) * (1.0 - d) / all).max(LEAST_FRESH).sqrt()
    };
    let all: Vec<Vec<f64>> = of
        .rest
        .iter()
        .map(|series| (0..n).map(|k| off(series, k)).collect())
        .collect();
    let most = OUTLIER * robust_deviation(&all.concat());
    (0..n)
        .filter(|&k| most == 0.0 || all.iter().all(|series| series[k].abs() <= most))
        .collect()
}

/// The one memory of largest restricted likelihood; none where it is hardly likelier than none.
pub(crate) fn likeliest_memory(all: &[Deviations], kept: &[Vec<usize>]) -> Correlation {
    let step = sampling_interval(all);
    let likelihood = |memory_s: f64| likelihood(all, kept, Correlation::of_memory(memory_s));
    let at = |place: f64| step * LEAST * libm::pow(MOST / LEAST, place / TRIED as f64);
    let tried = (0..=TRIED).map(|k| (likelihood(at(k as f64)), k as f64));
    let mut best = tried.fold(
        (f64::NEG_INFINITY, 0.0),
        |a, b| if b.0 > a.0 { b } else { a },
    );
    for halving in 0..HALVINGS {
        let width = libm::pow(0.5, halving as f64 + 1.0);
        for place in [best.1 - width, best.1 + width] {
            let found = likelihood(at(place));
            if found > best.0 {
                best = (found, place);
            }
        }
    }
    match best.0 > likelihood(0.0) + BELIEVED {
        true => Correlation::of_memory(at(best.1)),
        false => Correlation::NONE,
    }
}

/// As [`likeliest_memory`], or with a white part and a memory of up to twice the longest recording's time, where that is clearly
/// likelier; the part with memory may begin with nothing.
pub(crate) fn likeliest_mixture(all: &[Deviations], kept: &[Vec<usize>]) -> Correlation {
    let plain = likeliest_memory(all, kept);
    let longest = all
        .iter()
        .filter_map(|d| Some(d.time.last()? - d.time.first()?));
    let (low, high) = (sampling_interval(all), 2.0 * longest.fold(0.0, f64::max));
    if low.is_nan() || high <= low {
        return plain;
    }
    // Coordinates between 0 and 1: the memory's logarithm, and the logarithm of the white part's odds.
    let mut best = (likelihood(all, kept, plain) + CLEARLY_MIXED, plain);
    for is_tared in [false, true] {
        let at = |[memory, white]: [f64; 2]| Correlation {
            memory_s: low * libm::pow(high / low, memory),
            white: 1.0 / (1.0 + libm::exp(WIDEST * (1.0 - 2.0 * white))),
            is_tared,
            hum: Hum::NONE,
        };
        let found = highest(&|place| likelihood(all, kept, at(place)));
        if found.0 > best.0 {
            best = (found.0, at(found.1));
        }
    }
    best.1
}

/// The highest value of a function on the unit square, and where: on a grid, refined by halves.
fn highest(of: &dyn Fn([f64; 2]) -> f64) -> (f64, [f64; 2]) {
    let grid = (0..=MIXED.0).flat_map(|i| {
        (0..=MIXED.1).map(move |j| [i as f64 / MIXED.0 as f64, j as f64 / MIXED.1 as f64])
    });
    let better = |a: (f64, [f64; 2]), b: (f64, [f64; 2])| if b.0 > a.0 { b } else { a };
    let tried = grid.map(|place| (of(place), place));
    let mut best = tried.fold((f64::NEG_INFINITY, [0.0; 2]), better);
    for halving in 0..HALVINGS {
        let share = libm::pow(0.5, halving as f64 + 1.0);
        for (axis, count) in [MIXED.0, MIXED.1].into_iter().enumerate() {
            for sign in [-1.0, 1.0] {
                let mut place = best.1;
                place[axis] = (place[axis] + sign * share / count as f64).clamp(0.0, 1.0);
                best = better(best, (of(place), place));
            }
        }
    }
    best
}

/// Median time between samples, s; not a number where there are none.
pub(crate) fn sampling_interval(all: &[Deviations]) -> f64 {
    let steps = all
        .iter()
        .flat_map(|d| d.time.windows(2).map(|w| w[1] - w[0]));
    median(&mut steps.collect::<Vec<f64>>())
}

/// Sum of the squares that gain and touch leave of the whitened deviations, their degrees of freedom, and the restricted likelihood with
/// the size that these have, nats.
pub(crate) fn left(of: &Deviations, kept: &[usize], correlation: Correlation) -> (f64, f64, f64) {
    let repeats = of.rest.len() as f64 - 1.0;
    let degrees = (repeats * (kept.len() as f64 - of.own())).max(1.0);
    let filter = correlation.filter(kept.iter().map(|&k| of.sample(k)));
    let scale: Vec<f64> = kept.iter().map(|&k| of.rescaled(k, correlation)).collect();
    let white = |values: &dyn Fn(usize) -> f64| filter.whitened(|k| values(kept[k]) * scale[k]);
    let [gains, touches, zeros] = [0, 1, 2].map(|j| white(&|k| of.along[k][j]));
    let all: Vec<Vec<f64>> = of.rest.iter().map(|series| white(&|k| series[k])).collect();
    let (mut gram, mut pulls) = (Matrix3::zeros(), vec![Vector3::zeros(); of.rest.len()]);
    let (mut sum, mut log) = (0.0, 0.0);
    for (k, variance) in filter.variances().enumerate() {
        let along = Vector3::new(gains[k], touches[k], zeros[k]);
        gram += along * along.transpose();
        for (series, pull) in all.iter().zip(&mut pulls) {
            sum += series[k] * series[k];
            *pull += along * series[k];
        }
        log += libm::log(variance.max(LEAST_FRESH)) - 2.0 * libm::log(scale[k]);
    }
    if !of.has_own_zero {
        gram[(2, 2)] = 1.0;
    }
    // Scaled, so that what one adds to the others can be seen.
    let scale = Matrix3::from_diagonal(
        &gram
            .diagonal()
            .map(|d| 1.0 / d.max(f64::MIN_POSITIVE).sqrt()),
    );
    let unit = scale * gram * scale;
    let taken = unit.try_inverse().map_or(0.0, |inverse| {
        let part = |pull: &Vector3<f64>| (scale * pull).dot(&(inverse * scale * pull));
        pulls.iter().map(part).sum()
    });
    let sum = (sum - taken).max(f64::MIN_POSITIVE);
    let both = libm::log(gram.determinant().max(f64::MIN_POSITIVE));
    let likelihood = -0.5 * (repeats * (log + both) + degrees * libm::log(sum / degrees));
    (sum, degrees, likelihood)
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::noise::correlation::forgotten;
    use crate::random::Random;
    use nalgebra::{DMatrix, DVector};

    /// Moments of a fast press, a long hold and a fast way up, s.
    fn times() -> Vec<f64> {
        let steps = [(22, 0.02), (26, 0.3), (24, 0.02), (6, 0.5)];
        let each = steps.iter().flat_map(|(n, step)| vec![*step; *n]);
        let passed = each.scan(0.0, |now, step| {
            *now += step;
            Some(*now)
        });
        passed.collect()
    }

    /// Two repeats of noise of standard deviation 1 with that memory, with a gain and a touch of their own found and taken out.
    pub fn deviations(memory_s: f64, random: &mut Random) -> Deviations {
        of_memory(2, memory_s, random)
    }

    /// The same, and with 3 numbers of its own a zero of the force taken out.
    pub fn of_memory(own: usize, memory_s: f64, random: &mut Random) -> Deviations {
        deviations_of(own, &mut |time| {
            let mut noise = vec![random.normal()];
            for k in 1..time.len() {
                let carried = forgotten(time[k] - time[k - 1], memory_s);
                noise.push(
                    carried * noise[k - 1] + (1.0 - carried * carried).sqrt() * random.normal(),
                );
            }
            noise
        })
    }

    /// The same of noise that is drawn at given times.
    pub fn deviations_of(own: usize, draw: &mut dyn FnMut(&[f64]) -> Vec<f64>) -> Deviations {
        let time = times();
        let n = time.len();
        let press = |t: f64| (t / 0.44).min(1.0).min(((time[n - 7] - t) / 0.48).max(0.0));
        let columns = DMatrix::from_fn(n, own, |k, j| match j {
            0 => press(time[k]).powf(1.5),
            1 => press(time[k]).sqrt(),
            _ => 1.0,
        });
        let mut draw = || DVector::from_vec(draw(&time));
        let half = 0.5 * (draw() - draw());
        let gram = (columns.transpose() * &columns).try_inverse().unwrap();
        let rest = &half - &columns * (&gram * (columns.transpose() * &half));
        Deviations {
            group: vec![0, 1],
            time,
            most: 1.0,
            load: columns.column(0).iter().copied().collect(),
            profile: vec![1.0; n],
            readings: vec![1.0; n],
            rest: vec![rest.as_slice().to_vec(), (-rest).as_slice().to_vec()],
            whole: vec![Vector3::zeros(); 2],
            has_own_zero: own == 3,
            along: columns
                .row_iter()
                .map(|r| Vector3::from_fn(|j, _| r.get(j).copied().unwrap_or(0.0)))
                .collect(),
        }
    }

    /// Without memory the size is that of plain least squares.
    #[test]
    fn white_noise_likelihood_is_least_squares() {
        let of = deviations(0.15, &mut Random::new(1));
        let n = of.time.len();
        let all: Vec<usize> = (0..n).collect();
        let (sum, degrees, _) = left(&of, &all, Correlation::NONE);
        let squares: f64 = of.rest.iter().flatten().map(|r| r * r).sum();
        assert!((sum / squares - 1.0).abs() < 1e-9);
        assert_eq!(degrees, n as f64 - 2.0);
    }

    /// Against the restricted likelihood with whole matrices (Harville 1977), of every third sample left out: what it
    /// gains from one memory to another, and the squares.
    #[test]
    fn restricted_likelihood_equals_dense_matrix_form() {
        let mut random = Random::new(3);
        for own_numbers in [2, 3] {
            let of = deviations_of(own_numbers, &mut |time| {
                time.iter().map(|_| random.normal()).collect()
            });
            let kept: Vec<usize> = (0..of.time.len()).filter(|k| k % 3 != 1).collect();
            let columns = DMatrix::from_fn(kept.len(), own_numbers, |k, j| of.along[kept[k]][j]);
            let whole = |memory_s: f64| {
                let apart = |i: usize, j: usize| (of.time[kept[i]] - of.time[kept[j]]).abs();
                let all = DMatrix::from_fn(kept.len(), kept.len(), |i, j| {
                    libm::exp(-apart(i, j) / memory_s)
                });
                let root = all.cholesky().unwrap();
                let gram = columns.transpose() * root.solve(&columns);
                let inverse = gram.clone().try_inverse().unwrap();
                let squares = of.rest.iter().map(|series| {
                    let own = DVector::from_fn(kept.len(), |k, _| series[kept[k]]);
                    let pull = columns.transpose() * root.solve(&own);
                    own.dot(&root.solve(&own)) - pull.dot(&(&inverse * &pull))
                });
                let sum: f64 = squares.sum();
                let degrees = kept.len() as f64 - of.own();
                let logs = libm::log(root.determinant()) + libm::log(gram.determinant());
                (sum, -0.5 * (logs + degrees * libm::log(sum / degrees)))
            };
            let own = |memory_s: f64| {
                let (sum, _, likelihood) = left(&of, &kept, Correlation::of_memory(memory_s));
                (sum, likelihood)
            };
            let gained = |by: &dyn Fn(f64) -> (f64, f64)| by(0.9).1 - by(0.2).1;
            assert!((own(0.4).0 / whole(0.4).0 - 1.0).abs() < 1e-9);
            assert!((gained(&own) - gained(&whole)).abs() < 1e-6);
        }
    }

    /// A reading far from all others is left out, and so is one that is far only from its neighbors.
    #[test]
    fn outliers_are_left_out() {
        let mut of = deviations(0.6, &mut Random::new(7));
        let quiet = within(&of, Some(Correlation::of_memory(0.6))).len();
        for (at, off, memory_s) in [(30, 8.0, None), (10, 2.5, Some(0.6))] {
            of.rest[0][at] += off;
            of.rest[1][at] -= off;
            assert!(
                !within(&of, memory_s.map(Correlation::of_memory)).contains(&at),
                "{at}"
            );
        }
        assert!(quiet > of.time.len() - 4);
    }
}
