//! Short waves of the force that repeats of a protocol share: what sums over whole parts of a phase cancel out.
//!
//! Each recording's force is taken less its running mean, stage by stage, and multiplied moment by moment with the same of its repeats.
//! Noise of two recordings knows nothing of each other, so that the products' sum is 0 within its own standard error (the test of a
//! covariance; its error under memory after Bartlett 1935, Journal of the Royal Statistical Society 98:536).

use crate::forward::surrogate::force_recording::{ForceRecording, Row};
use crate::observe::measured::Phase;
use crate::observe::motion::rounding::step_mm;
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

/// One recording's waves: seconds since its first row, and force less its running mean, in deviations of it.
struct Waves {
    time_s: Vec<f64>,
    force: Vec<f64>,
    /// One deviation, N.
    deviation_n: f64,
}

/// The waves that repeats of all protocols share, in the force and in what the model leaves of it, whichever is less: a motion that goes in
/// steps shows in the force, and a depth that is read in steps in the rest. None where too few moments were recorded twice. `simulated`
/// holds predictions by sample, N.
///
/// Forces that are read in steps share waves of that size, which are none.
pub fn short_waves(courses: &[ForceRecording], simulated: &[f64]) -> Option<ShortWaves> {
    let clearer = |a: ShortWaves, b: ShortWaves| match b.standard_errors > a.standard_errors {
        true => b,
        false => a,
    };
    let bands = WINDOWS
        .iter()
        .flat_map(|window| SMOOTHED.map(|smoothed| (*window, smoothed)));
    let each = bands.filter_map(|band| in_both(courses, simulated, band));
    let found = each.reduce(clearer)?;
    let forces: Vec<f64> = courses
        .iter()
        .flat_map(|c| &c.rows)
        .filter(|row| row.sample.is_some())
        .map(|row| row.force_n)
        .collect();
    // Half a step each way is the most that rounding leaves.
    let is_rounding = found.rms_n < 0.5 * step_mm(&forces);
    Some(match is_rounding {
        true => ShortWaves {
            standard_errors: found.standard_errors.min(0.0),
            rms_n: 0.0,
        },
        false => found,
    })
}

/// What is shared in the force or in what the model leaves of it, whichever is less, in a band: a window and how much of it is
/// smoothed.
fn in_both(
    courses: &[ForceRecording],
    simulated: &[f64],
    band: (usize, f64),
) -> Option<ShortWaves> {
    let of_force = shared(courses, band, &|row: &Row, _| row.force_n)?;
    let of_rest = shared(courses, band, &|row: &Row, k| row.force_n - simulated[k])?;
    Some(match of_rest.standard_errors < of_force.standard_errors {
        true => of_rest,
        false => of_force,
    })
}

/// Sums over pairs of repeats.
#[derive(Default)]
struct Sums {
    products: f64,
    squares: f64,
    newtons: f64,
    count: usize,
}

fn shared(
    courses: &[ForceRecording],
    band: (usize, f64),
    of: &dyn Fn(&Row, usize) -> f64,
) -> Option<ShortWaves> {
    let all: Vec<Option<Waves>> = courses.iter().map(|c| waves(c, band, of)).collect();
    let mut sums = Sums::default();
    for (i, one) in courses.iter().enumerate() {
        for (j, other) in courses.iter().enumerate().skip(i + 1) {
            if one.protocol != other.protocol || one.place != other.place {
                continue;
            }
            if let (Some(a), Some(b)) = (&all[i], &all[j]) {
                sums.add((a, b));
            }
        }
    }
    (sums.count >= FEWEST && sums.squares > 0.0).then(|| ShortWaves {
        standard_errors: sums.products / sums.squares.sqrt(),
        rms_n: (sums.newtons / sums.count as f64).max(0.0).sqrt(),
    })
}

impl Sums {
    fn add(&mut self, (a, b): (&Waves, &Waves)) {
        let pairs = same_moments(a, b);
        let products: Vec<f64> = pairs.iter().map(|(x, y)| x * y).collect();
        // What two repeats do not share is noise, and tells how far noise remembers.
        let off: Vec<f64> = pairs.iter().map(|(x, y)| x - y).collect();
        let squares: f64 = products.iter().map(|p| p * p).sum();
        let sum: f64 = products.iter().sum();
        self.products += sum;
        self.squares += squares * memory(&off);
        self.newtons += sum * a.deviation_n * b.deviation_n;
        self.count += products.len();
    }
}

/// How many neighbors count as one in a sum of products: 1 and twice the squares of the correlations at all lags of a running mean.
fn memory(off: &[f64]) -> f64 {
    let lags = FEWEST_IN_MEAN.max(off.len() / WINDOWS[1]).min(off.len());
    let at = |lag: usize| -> f64 { off[lag..].iter().zip(off).map(|(a, b)| a * b).sum() };
    let all = at(0).max(f64::MIN_POSITIVE);
    1.0 + 2.0 * (1..lags).map(|lag| (at(lag) / all).powi(2)).sum::<f64>()
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

/// The waves of one recording; None where it has too few samples under load.
fn waves(
    course: &ForceRecording,
    (part, smoothed): (usize, f64),
    of: &dyn Fn(&Row, usize) -> f64,
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
        for (n, window) in values.windows(2 * half + 1).enumerate() {
            let smooth = mean(&window[half - near..=half + near]);
            time_s.push(stage[n + half].0.time_s - start);
            force.push(smooth - mean(window));
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
    })
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::forward::surrogate::synthetic::{Reading, ready, tool};
    use crate::random::Random;

    /// Two repeats of a press of a flat punch of 10 N/mm to 1 mm at 1 mm/s and back, read 100 times a way.
    #[derive(Default, Clone)]
    struct Presses {
        /// Standard deviation of noise, N; part of it that the next sample keeps.
        noise: (f64, f64),
        /// Teeth in the force, N from top to bottom, over 0.15 mm of way; and by how much of one those of the second repeat begin later.
        teeth: (f64, f64),
        /// The stage goes in steps, of which ten make a tooth's way.
        goes_in_steps: bool,
        /// Step in which the depth is read, mm, and the force, N.
        read_in: (f64, f64),
        /// Readings (by number) that are off by 2 N in each repeat.
        astray: [Option<usize>; 2],
        /// Seconds by which the second repeat's samples come later, but for its first.
        later_s: f64,
    }

    impl Presses {
        fn reading(&self, repeat: usize, k: usize, noise: f64) -> Reading {
            let time = 0.01 * k as f64 + self.later_s * (repeat * k.min(1)) as f64;
            let way = match self.goes_in_steps {
                true => (time / 0.06).floor() * 0.06,
                false => time,
            };
            let depth = if way < 1.0 { way } else { 2.0 - way };
            let side = if way < 1.0 { 1.0 } else { -1.0 };
            let phase = if time < 1.0 {
                Phase::Load
            } else {
                Phase::Unload
            };
            let (most, later) = self.teeth;
            let tooth = (way / 0.15 + later * repeat as f64).fract() - 0.5;
            let astray = if self.astray[repeat] == Some(k) {
                2.0
            } else {
                0.0
            };
            let rounded = |x: f64, step: f64| {
                if step > 0.0 {
                    (x / step).round() * step
                } else {
                    x
                }
            };
            let force = 10.0 * depth + side * most * tooth + noise + astray;
            (
                time,
                rounded(depth, self.read_in.0),
                phase,
                rounded(force, self.read_in.1),
            )
        }

        fn found(&self, seed: u64) -> ShortWaves {
            let mut random = Random::new(seed);
            let (sigma, keeps) = self.noise;
            let mut recordings = Vec::new();
            for repeat in 0..2 {
                let mut noise = sigma * random.normal();
                let mut all = Vec::new();
                for k in 0..200 {
                    noise = keeps * noise + (1.0 - keeps * keeps).sqrt() * sigma * random.normal();
                    all.push(self.reading(repeat, k, noise));
                }
                recordings.push((0, all));
            }
            let (made, _) = ready(vec![tool(1.0, |d| d, |_| 1.0)], &recordings, sigma);
            let depths = made.courses.iter().flat_map(|c| &c.rows);
            let simulated: Vec<f64> = depths.map(|row| 10.0 * row.depth_mm).collect();
            short_waves(&made.courses, &simulated).expect("two repeats")
        }

        /// The most that ten seeds show.
        fn most(&self) -> f64 {
            let each = (1..11).map(|seed| self.found(seed).standard_errors);
            each.fold(f64::NEG_INFINITY, f64::max)
        }

        /// The least that ten seeds show.
        fn least(&self) -> f64 {
            let each = (1..11).map(|seed| self.found(seed).standard_errors);
            each.fold(f64::INFINITY, f64::min)
        }
    }

    const NOISE: (f64, f64) = (0.05, 0.0);

    #[test]
    fn noise_shares_no_waves_however_long_it_remembers() {
        for keeps in [0.0, 0.5, 0.9, 0.99] {
            let quiet = Presses {
                noise: (0.05, keeps),
                ..Presses::default()
            };
            assert!(quiet.most() < 4.0, "{keeps}: {}", quiet.most());
        }
    }

    /// Teeth of four times the noise from top to bottom: their root mean square is that over the root of 12.
    #[test]
    fn teeth_at_the_same_way_are_shared_and_measured() {
        let teeth = Presses {
            noise: NOISE,
            teeth: (0.2, 0.0),
            ..Presses::default()
        };
        assert!(teeth.least() > 4.0, "{}", teeth.least());
        let larger = Presses {
            teeth: (0.3, 0.0),
            ..teeth.clone()
        };
        let rms = larger.found(1).rms_n * 12f64.sqrt();
        assert!((0.2..0.4).contains(&rms), "{rms}");
        // Samples of the second repeat fall between those of the first, or half a tooth on.
        let between = Presses {
            later_s: 0.004,
            ..teeth.clone()
        };
        assert!(between.least() > 4.0, "{}", between.least());
        let one_astray = Presses {
            astray: [Some(60), None],
            ..teeth.clone()
        };
        assert!(one_astray.least() > 4.0, "{}", one_astray.least());
        let apart = Presses {
            teeth: (0.2, 0.5),
            ..teeth
        };
        assert!(apart.most() < 4.0, "{}", apart.most());
    }

    /// Each shares waves in the force or in the rest, and neither in both; a force that is read in steps shares them in both.
    #[test]
    fn steps_of_the_stage_and_of_the_readings_are_no_waves_of_the_skin() {
        let quiet = Presses {
            noise: (0.005, 0.0),
            ..Presses::default()
        };
        let stage = Presses {
            goes_in_steps: true,
            ..quiet.clone()
        };
        assert!(stage.most() < 4.0, "{}", stage.most());
        let read_in = |read_in: (f64, f64)| Presses {
            read_in,
            ..quiet.clone()
        };
        let (encoder, converter) = (read_in((0.03, 0.0)), read_in((0.0, 0.3)));
        assert!(encoder.most() < 4.0, "{}", encoder.most());
        assert!(converter.most() < 4.0, "{}", converter.most());
    }

    #[test]
    fn readings_that_are_astray_decide_nothing() {
        let far = Presses {
            noise: NOISE,
            astray: [Some(60), Some(60)],
            ..Presses::default()
        };
        assert!(far.most() < 4.0, "{}", far.most());
    }
}
