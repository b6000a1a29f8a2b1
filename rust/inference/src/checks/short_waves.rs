//! Short waves of the force that repeats of a protocol share: what sums over whole parts of a phase cancel out.
//!
//! Each recording's force is taken less its running mean, stage by stage, and multiplied moment by moment with the same of its repeats.
//! Noise of two recordings knows nothing of each other, so that the products' sum is 0 within its own standard error (the test of a
//! covariance; its error under memory after Bartlett 1935, Journal of the Royal Statistical Society 98:536).

use crate::forward::surrogate::force_recording::{ForceRecording, Row};
use crate::observe::measured::Phase;
use crate::observe::protocol_phases::range;
use crate::observe::robust_scale::median_deviation;

/// Part of a recording's depth above which it counts as loaded: where the skin is first touched is not known to a sample.
const LOADED: f64 = 0.1;
/// Samples of a recording over those of a running mean.
const WINDOWS: [usize; 2] = [24, 12];
/// Fewest samples of a running mean.
const FEWEST_IN_MEAN: usize = 5;
/// Parts of a running mean over which a sample is smoothed: waves between the two are passed.
const SMOOTHED: [f64; 2] = [0.0, 0.25];
/// Deviations beyond which a sample counts no more: single ones that are astray do not decide.
const MOST: f64 = 3.0;
/// Part of the range of forces by which a table is off between its rungs, at most (`interpolation::Table` on a Hertz curve).
const JOINED: f64 = 1e-4;
/// Standard errors of all pairs of repeats over those that are left without the one that shares most, at most.
const OF_ONE: f64 = 2.0;
/// Fewest products of two repeats' samples.
const FEWEST: usize = 30;
/// Part of a sample's time by which moments of two repeats differ at most.
const SAME: f64 = 0.5;

/// Short waves that repeats share.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShortWaves {
    /// Sum of products of repeats' waves over the standard error that independent noise gives it.
    pub standard_errors: f64,
    /// Root mean square of what is shared, N; 0 where products are negative on the whole.
    pub rms_n: f64,
}

/// Waves, and their root mean square over the ranges of forces.
type WithPart = (ShortWaves, f64);

/// What is taken of a row and its sample, N.
type Value<'a> = &'a dyn Fn(&Row, usize) -> f64;

/// One recording's waves: seconds since its first row, and force less its running mean, in deviations of it.
struct Waves {
    time_s: Vec<f64>,
    force: Vec<f64>,
    /// One deviation, N.
    deviation_n: f64,
    /// Range of the recording's forces, N.
    range_n: f64,
}

/// The waves that repeats of all protocols share, in the force and in what the model leaves of it, whichever is less: a motion that goes in
/// steps shows in the force, and a depth that is read in steps in the rest. None where too few moments were recorded twice. `simulated`
/// holds predictions by sample, N.
///
/// Forces that are read in steps share waves of that size, which are none; nor are waves as small as those by which the model's own tables
/// are off between their rungs. Repeats are held against each other by the time since their first
/// rows: what repeats by the way alone, at another speed, is not seen. Recordings are thinned before, to a hundred moments or so, so that the
/// shortest wave is of two of these.
pub fn short_waves(courses: &[ForceRecording], simulated: &[f64]) -> Option<ShortWaves> {
    let clearer = |a: WithPart, b: WithPart| match b.0.standard_errors > a.0.standard_errors {
        true => b,
        false => a,
    };
    let bands = WINDOWS
        .iter()
        .flat_map(|window| SMOOTHED.map(|smoothed| (*window, smoothed)));
    let each = bands.filter_map(|band| least_shared(courses, simulated, band));
    let (found, part) = each.reduce(clearer)?;
    let rows = courses.iter().flat_map(|course| &course.rows);
    let step_n = rows.map(|row| row.force_step_n).fold(0.0, f64::max);
    // Half a step each way is the most that rounding leaves.
    let is_feigned = found.rms_n < 0.5 * step_n || part < JOINED;
    Some(match is_feigned {
        true => ShortWaves {
            standard_errors: found.standard_errors.min(0.0),
            rms_n: 0.0,
        },
        false => found,
    })
}

/// From the smallest to the largest force that was read, N.
fn range_n(course: &ForceRecording) -> f64 {
    let read = course.rows.iter().filter(|row| row.sample.is_some());
    let forces: Vec<f64> = read.map(|row| row.force_n).collect();
    let (least, most) = range(&forces);
    most - least
}

/// What is shared in the force or in what the model leaves of it, whichever is less, in a band: a window and how much of it is smoothed. Its
/// size is what a second running mean leaves, if that is less: a single one leaves a part of a curve that bends.
fn least_shared(
    courses: &[ForceRecording],
    simulated: &[f64],
    band: (usize, f64),
) -> Option<WithPart> {
    let of_force = |row: &Row, _: usize| row.force_n;
    let of_rest = |row: &Row, k: usize| row.force_n - simulated[k];
    let of: [Value<'_>; 2] = [&of_force, &of_rest];
    let once = of.map(|of| shared(courses, (band, 1), of));
    let twice = of.map(|of| shared(courses, (band, 2), of));
    let of_less = |a: WithPart, b: WithPart| match b.0.standard_errors < a.0.standard_errors {
        true => b,
        false => a,
    };
    let [force, rest] = once;
    let (found, part) = of_less(force?, rest?);
    let bent = || twice.iter().flatten();
    let waves = ShortWaves {
        rms_n: bent()
            .map(|(waves, _)| waves.rms_n)
            .fold(found.rms_n, f64::min),
        ..found
    };
    Some((waves, bent().map(|(_, part)| *part).fold(part, f64::min)))
}

/// Sums of one pair of repeats.
struct Pair {
    products: f64,
    /// Variance of that sum where noise knows nothing of each other.
    variance: f64,
    /// The same if what waves do of themselves is noise that remembers.
    variance_alone: f64,
    newtons: f64,
    /// The same over the ranges of both repeats' forces.
    parts: f64,
    count: usize,
}

/// `filter`: a band, and the number of running means.
fn shared(
    courses: &[ForceRecording],
    filter: ((usize, f64), usize),
    of: Value<'_>,
) -> Option<WithPart> {
    let all: Vec<Option<Waves>> = courses.iter().map(|c| waves(c, filter, of)).collect();
    let mut pairs = Vec::new();
    for (i, one) in courses.iter().enumerate() {
        for (j, other) in courses.iter().enumerate().skip(i + 1) {
            if one.protocol != other.protocol || one.place != other.place {
                continue;
            }
            if let (Some(a), Some(b)) = (&all[i], &all[j]) {
                pairs.push(Pair::of(a, b));
            }
        }
    }
    let count: usize = pairs.iter().map(|pair| pair.count).sum();
    let mean = |of: fn(&Pair) -> f64| pairs.iter().map(of).sum::<f64>() / count as f64;
    (count >= FEWEST).then(|| {
        let waves = ShortWaves {
            standard_errors: standard_errors(&pairs),
            rms_n: mean(|pair| pair.newtons).max(0.0).sqrt(),
        };
        (waves, mean(|pair| pair.parts).max(0.0).sqrt())
    })
}

/// Of the sum over all pairs. What hums by itself may be in step in one pair by chance: one alone is held against its own memory, and of
/// several no single one decides.
fn standard_errors(pairs: &[Pair]) -> f64 {
    let over = |products: f64, variance: f64| products / variance.max(f64::MIN_POSITIVE).sqrt();
    if let [one] = pairs {
        return over(one.products, one.variance.max(one.variance_alone));
    }
    let of = |pair: &Pair| over(pair.products, pair.variance);
    let Some(most) = pairs.iter().max_by(|a, b| of(a).total_cmp(&of(b))) else {
        return 0.0;
    };
    let products: f64 = pairs.iter().map(|pair| pair.products).sum();
    let variance: f64 = pairs.iter().map(|pair| pair.variance).sum();
    let left = over(products - most.products, variance - most.variance);
    over(products, variance).min(OF_ONE * left.max(0.0))
}

impl Pair {
    fn of(a: &Waves, b: &Waves) -> Pair {
        let pairs = same_moments(a, b);
        let products: Vec<f64> = pairs.iter().map(|(x, y)| x * y).collect();
        // What two repeats do not share is noise, and tells how far noise remembers.
        let off: Vec<f64> = pairs.iter().map(|(x, y)| x - y).collect();
        let (x, y): (Vec<f64>, Vec<f64>) = pairs.into_iter().unzip();
        let squares: f64 = products.iter().map(|p| p * p).sum();
        let sum: f64 = products.iter().sum();
        Pair {
            products: sum,
            variance: squares * memory(&off, &off),
            variance_alone: squares * memory(&x, &y),
            newtons: sum * a.deviation_n * b.deviation_n,
            parts: sum * (a.deviation_n / a.range_n) * (b.deviation_n / b.range_n),
            count: products.len(),
        }
    }
}

/// How many neighbors count as one in a sum of products of two series: 1 and twice the products of their correlations at all lags of a running
/// mean.
fn memory(one: &[f64], other: &[f64]) -> f64 {
    let lags = FEWEST_IN_MEAN.max(one.len() / WINDOWS[1]).min(one.len());
    let at = |series: &[f64], lag: usize| -> f64 {
        let pairs = series[lag..].iter().zip(series);
        pairs.map(|(a, b)| a * b).sum()
    };
    let of = |series: &[f64], lag| at(series, lag) / at(series, 0).max(f64::MIN_POSITIVE);
    let shared = (1..lags).map(|lag| of(one, lag) * of(other, lag));
    1.0 + 2.0 * shared.sum::<f64>().max(0.0)
}

/// Both repeats' waves at moments of the first at which the second was read too.
fn same_moments(a: &Waves, b: &Waves) -> Vec<(f64, f64)> {
    let step = |w: &Waves| {
        let range = w.time_s.last().zip(w.time_s.first());
        range.map_or(0.0, |(end, start)| end - start) / w.time_s.len().max(2) as f64
    };
    let most = SAME * step(a).max(step(b));
    let nearest = |t: f64| {
        let after = b.time_s.partition_point(|s| *s < t);
        let near = after.saturating_sub(1)..(after + 1).min(b.time_s.len());
        near.min_by(|i, j| {
            (b.time_s[*i] - t)
                .abs()
                .total_cmp(&(b.time_s[*j] - t).abs())
        })
    };
    let both = a.time_s.iter().zip(&a.force).filter_map(|(t, x)| {
        let k = nearest(*t)?;
        ((b.time_s[k] - t).abs() <= most).then_some((*x, b.force[k]))
    });
    both.collect()
}

/// The waves of one recording, of a band and a number of running means; None where it has too few samples under load.
fn waves(
    course: &ForceRecording,
    ((part, smoothed), means): ((usize, f64), usize),
    of: Value<'_>,
) -> Option<Waves> {
    let start = course.rows.first()?.time_s;
    let deep = LOADED * course.deepest();
    let is_loaded = |row: &Row| row.phase != Phase::Apart && row.depth_mm > deep;
    let read: Vec<(&Row, usize)> = course
        .rows
        .iter()
        .filter_map(|row| Some((row, row.sample?)))
        .collect();
    let half = FEWEST_IN_MEAN.max(read.len() / part) / 2;
    let near = (half as f64 * smoothed).round() as usize;
    let (mut time_s, mut force) = (Vec::new(), Vec::new());
    let is_one_stage = |a: &(&Row, usize), b: &(&Row, usize)| {
        is_loaded(a.0) == is_loaded(b.0) && (a.0.phase, a.0.cycle) == (b.0.phase, b.0.cycle)
    };
    for stage in read.chunk_by(is_one_stage).filter(|s| is_loaded(s[0].0)) {
        let values: Vec<f64> = stage.iter().map(|(row, k)| of(row, *k)).collect();
        let mut left = less_running_mean(&values, (half, near));
        for _ in 1..means {
            left = less_running_mean(&left, (half, 0));
        }
        for (n, wave) in left.into_iter().enumerate() {
            time_s.push(stage[n + means * half].0.time_s - start);
            force.push(wave);
        }
    }
    let mut sizes: Vec<f64> = force.iter().map(|f| f.abs()).collect();
    let deviation_n = median_deviation(&mut sizes);
    (force.len() > 1 && deviation_n > 0.0).then(|| Waves {
        time_s,
        force: force
            .iter()
            .map(|f| (f / deviation_n).clamp(-MOST, MOST))
            .collect(),
        deviation_n,
        range_n: range_n(course),
    })
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
mod tests;
