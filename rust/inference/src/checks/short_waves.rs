//! Short waves of the force that recordings share: what sums over whole parts of a phase cancel out.
//!
//! Each recording's force is taken less its running mean, stage by stage, and multiplied place by place with that of another. Noise of two
//! recordings knows nothing of each other, so that the products' sum is 0 within its own standard error (the test of a covariance; its error
//! under memory after Bartlett 1935, Journal of the Royal Statistical Society 98:536). Repeats are compared moment by moment, and all
//! recordings of a site by depth, on the way in and on the way out.

mod pair;
mod waves;

use self::pair::{Pair, standard_errors};
use self::waves::{Along, Filter, Value, Waves};
use crate::forward::surrogate::force_recording::{ForceRecording, Row};

/// Samples of a recording over those of a running mean.
const WINDOWS: [usize; 2] = [24, 12];
/// Parts of a running mean over which a sample is smoothed: waves between the two are passed.
const SMOOTHED: [f64; 2] = [0.0, 0.25];
/// Part of the most standard errors from which a filter's waves are as well known.
const AS_CLEAR: f64 = 0.5;
/// Part of the range of forces by which a table is off between its rungs, at most (`interpolation::Table` on a Hertz curve).
const JOINED: f64 = 1e-4;
/// Standard errors over those of what a second running mean leaves, at most: the second takes off more samples.
const TWICE: f64 = 4.0 / 3.0;
/// Recordings that are compared by depth, at most: of more, some evenly among them.
const MOST_BY_DEPTH: usize = 60;
/// Fewest products of two recordings' samples.
const FEWEST: usize = 30;

/// Short waves that recordings share.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShortWaves {
    /// Sum of products of recordings' waves over the standard error that independent noise gives it.
    pub standard_errors: f64,
    /// Root mean square of what is shared, N; 0 where products are negative on the whole.
    pub rms_n: f64,
    /// That over the ranges of the recordings' forces.
    pub part: f64,
    /// Whether they are shared at the same depth, at whatever speed and by whatever tool, more clearly than at the same time of repeats.
    pub is_by_depth: bool,
}

/// What waves are taken from.
#[derive(Clone, Copy)]
struct Recorded<'a> {
    courses: &'a [ForceRecording],
    /// By place of a recording, the first place at the same site.
    site_of: &'a [usize],
    /// Predictions by sample, N.
    simulated: &'a [f64],
    /// Frequency of a hum of the instrument.
    hum_hz: Option<f64>,
}

/// The waves that recordings share, in the force and in what the model leaves of it, whichever is less: a motion that goes in steps shows in
/// the force, and a depth that is read in steps in the rest. None where too few moments were recorded twice. `site_of` holds, by place of a
/// recording, the first place at the same site, `simulated` predictions by sample, N, and `hum_hz` the frequency of a hum of the instrument: what
/// of it is in a recording is taken off before, as it may be in step in few of them.
///
/// Forces that are read in steps share waves of that size, which are none; nor are waves as small as those by which the model's own tables
/// are off between their rungs. Repeats are held against each other by the time since their first rows, and all recordings of a site by depth.
/// Recordings are thinned before, to a hundred moments or so, so that the shortest wave is of two of these.
pub fn short_waves(
    courses: &[ForceRecording],
    site_of: &[usize],
    (simulated, hum_hz): (&[f64], Option<f64>),
) -> Option<ShortWaves> {
    let recorded = Recorded {
        courses,
        site_of,
        simulated,
        hum_hz,
    };
    let filters = [Along::Time, Along::Depth].into_iter().flat_map(|along| {
        WINDOWS.into_iter().flat_map(move |window| {
            SMOOTHED.map(|smoothed| Filter {
                along,
                band: (window, smoothed),
                means: 1,
            })
        })
    });
    let all: Vec<ShortWaves> = filters
        .filter_map(|filter| recorded.least_shared(filter))
        .collect();
    let clearer =
        |a: &&ShortWaves, b: &&ShortWaves| a.standard_errors.total_cmp(&b.standard_errors);
    let found = *all.iter().max_by(clearer)?;
    let rows = courses.iter().flat_map(|course| &course.rows);
    let step_n = rows.map(|row| row.force_step_n).fold(0.0, f64::max);
    // Half a step each way is the most that rounding leaves.
    if found.rms_n < 0.5 * step_n || found.part < JOINED {
        return Some(ShortWaves {
            standard_errors: found.standard_errors.min(0.0),
            rms_n: 0.0,
            part: 0.0,
            ..found
        });
    }
    // Smoothed, or less a shorter mean, they may be clearer, and are smaller.
    let is_as_clear = |one: &&ShortWaves| {
        one.is_by_depth == found.is_by_depth
            && one.standard_errors > AS_CLEAR * found.standard_errors
    };
    let largest = |of: fn(&ShortWaves) -> f64| {
        all.iter()
            .filter(is_as_clear)
            .map(of)
            .fold(of(&found), f64::max)
    };
    Some(ShortWaves {
        rms_n: largest(|waves| waves.rms_n),
        part: largest(|waves| waves.part),
        ..found
    })
}

impl Recorded<'_> {
    /// What is shared in the force or in what the model leaves of it, whichever is less. A single running mean leaves a part of a curve that
    /// bends: where a second one can be taken off, waves are no larger than what it leaves, and hardly clearer.
    fn least_shared(self, filter: Filter) -> Option<ShortWaves> {
        let of_force = |row: &Row, _: usize| row.force_n;
        let of_rest = |row: &Row, k: usize| row.force_n - self.simulated[k];
        let of: [Value<'_>; 2] = [&of_force, &of_rest];
        let less = |means: usize| {
            let [force, rest] = of.map(|of| self.shared(Filter { means, ..filter }, of));
            let (force, rest) = (force?, rest?);
            Some(match rest.standard_errors < force.standard_errors {
                true => rest,
                false => force,
            })
        };
        let once = less(1)?;
        let Some(twice) = less(2) else {
            return Some(once);
        };
        Some(ShortWaves {
            standard_errors: once
                .standard_errors
                .min(TWICE * twice.standard_errors.max(0.0)),
            rms_n: once.rms_n.min(twice.rms_n),
            part: once.part.min(twice.part),
            ..once
        })
    }

    fn shared(self, filter: Filter, of: Value<'_>) -> Option<ShortWaves> {
        let waves = |course| Waves::of(course, filter, (of, self.simulated, self.hum_hz));
        let all: Vec<Option<Waves>> = self.courses.iter().map(waves).collect();
        let mut pairs = Vec::new();
        let every = match filter.along {
            Along::Time => 1,
            Along::Depth => self.courses.len().div_ceil(MOST_BY_DEPTH),
        };
        let numbers = || (0..self.courses.len()).step_by(every.max(1));
        for i in numbers() {
            for j in numbers().filter(|j| *j > i) {
                if !self.are_alike((&self.courses[i], &self.courses[j]), filter.along) {
                    continue;
                }
                if let (Some(a), Some(b)) = (&all[i], &all[j]) {
                    pairs.extend(Pair::of([i, j], (a, b)));
                }
            }
        }
        let count: usize = pairs.iter().map(|pair| pair.count).sum();
        let weight: f64 = pairs.iter().map(|pair| pair.weight).sum();
        let root = |which: usize| {
            let sum: f64 = pairs.iter().map(|pair| pair.squares[which]).sum();
            (sum / weight).max(0.0).sqrt()
        };
        (count >= FEWEST).then(|| ShortWaves {
            standard_errors: standard_errors(&pairs),
            rms_n: root(0),
            part: root(1),
            is_by_depth: filter.along == Along::Depth,
        })
    }

    fn are_alike(self, (one, other): (&ForceRecording, &ForceRecording), along: Along) -> bool {
        match along {
            Along::Time => one.protocol == other.protocol && one.place == other.place,
            Along::Depth => self.site_of[one.place] == self.site_of[other.place],
        }
    }
}

#[cfg(test)]
mod tests;
