//! Straight lines through the readings of a leg, and whether a leg is straight.

use crate::observe::measured::Phase;
use crate::observe::motion::legs::{FEWEST, Leg};
use crate::observe::smoothing::smoothed_with_freedom;

/// Fall of the deviance from which a stand creeps: the 99.9 % point of chi-squared with one degree of freedom, since a session has many stands.
const CREEPS: f64 = 10.83;

/// Readings in a row that are the same, in the mean of a motion, from which they are stairs.
const STAIRS: f64 = 2.0;

/// Distance from a line by least squares within which readings that are rounded lie, in their steps: half of one, and what the line is off by.
pub(crate) const ROUNDED: f64 = 1.001;

/// Readings of a recording: s, mm, the variance of their jitter, mm2, and the step to which they are rounded, mm.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Readings<'a> {
    pub(crate) time: &'a [f64],
    pub(crate) depth: &'a [f64],
    pub(crate) variance: f64,
    pub(crate) step: f64,
}

impl<'a> Readings<'a> {
    /// With the variance that smooth courses leave of all legs together: of one short leg a smooth course may leave next to nothing. Where many
    /// readings in a row are rounded to the same, a smooth course follows them: they are off alike, and count for one.
    pub(crate) fn new(
        (time, depth): (&'a [f64], &'a [f64]),
        (legs, step): (&[Leg], f64),
    ) -> Readings<'a> {
        let bare = Readings {
            time,
            depth,
            variance: f64::NAN,
            step,
        };
        let (mut squares, mut left) = (0.0, 0.0);
        let (mut moving, mut changes) = (0.0, 0.0);
        for leg in legs {
            let (own, freedom) = smooth_squares(*leg, bare);
            squares += own;
            let count = (leg.end - leg.start) as f64;
            left += count - freedom;
            if leg.phase != Phase::Hold {
                let pairs = depth[leg.start..leg.end].windows(2);
                moving += count;
                changes += pairs.filter(|two| two[0] != two[1]).count() as f64;
            }
        }
        let alike = moving / f64::max(changes, 1.0);
        let of_stairs = match alike > STAIRS {
            true => alike * step * step / 12.0,
            false => 0.0,
        };
        Readings {
            variance: (squares / left.max(1.0))
                .max(of_stairs)
                .max(f64::MIN_POSITIVE),
            ..bare
        }
    }
}

/// A straight line over time.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Line {
    /// At time 0, mm.
    pub(crate) height: f64,
    /// mm/s.
    pub(crate) speed: f64,
    /// Sum of squared deviations of the readings, mm2.
    pub(crate) squares: f64,
    /// Free numbers.
    pub(crate) freedom: f64,
}

impl Line {
    pub(crate) fn at(&self, time: f64) -> f64 {
        self.height + self.speed * time
    }

    /// Through readings of a leg: of a stand level, unless it creeps.
    pub(crate) fn through(leg: Leg, Readings { time, depth, .. }: Readings<'_>) -> Line {
        let own = leg.start..leg.end;
        let n = own.len() as f64;
        let mean = |of: &[f64]| of[own.clone()].iter().sum::<f64>() / n;
        let (middle, level) = (mean(time), mean(depth));
        let (mut over, mut under, mut whole) = (0.0, 0.0, 0.0);
        for k in own.clone() {
            let (t, d) = (time[k] - middle, depth[k] - level);
            over += t * d;
            under += t * t;
            whole += d * d;
        }
        let speed = if under > 0.0 { over / under } else { 0.0 };
        let squares = (whole - speed * over).max(0.0);
        let fall = n * libm::log(whole.max(f64::MIN_POSITIVE) / squares.max(f64::MIN_POSITIVE));
        let (speed, squares, freedom) = match leg.phase == Phase::Hold && fall < CREEPS {
            true => (0.0, whole, 1.0),
            false => (speed, squares, 2.0),
        };
        Line {
            height: level - speed * middle,
            speed,
            squares,
            freedom,
        }
    }
}

/// Bayesian information criterion of squares that are left of a leg's readings, of known variance, and the free numbers that it took.
pub(crate) fn bic((squares, freedom): (f64, f64), leg: Leg, of: Readings<'_>) -> f64 {
    let n = (leg.end - leg.start) as f64;
    squares / of.variance + freedom * libm::log(n)
}

/// Squares that the smooth course of generalized cross-validation leaves of a leg, and the free numbers that it takes.
pub(crate) fn smooth_squares(leg: Leg, of: Readings<'_>) -> (f64, f64) {
    let own = leg.start..leg.end;
    let (smooth, freedom) = smoothed_with_freedom(&of.time[own.clone()], &of.depth[own.clone()]);
    let pairs = smooth.iter().zip(&of.depth[own]);
    let squares = pairs.map(|(s, d)| (s - d).powi(2)).sum();
    (squares, freedom)
}

/// Whether BIC prefers a leg's line to its smooth course, or the smooth course by less than `lead`, or rounding is all that parts readings from
/// the line: at even times the error of rounding is a slow wave, which a smooth course follows.
pub(crate) fn is_straight((leg, lead): (Leg, f64), of: Readings<'_>) -> bool {
    let line = Line::through(leg, of);
    let off = |k: usize| (of.depth[k] - line.at(of.time[k])).abs();
    if (leg.start..leg.end).all(|k| off(k) < ROUNDED * of.step) {
        return true;
    }
    bic((line.squares, line.freedom), leg, of) <= bic(smooth_squares(leg, of), leg, of) + lead
}

/// Where two lines leave least of a leg: the first reading of the second.
pub(crate) fn best_kink(leg: Leg, Readings { time, depth, .. }: Readings<'_>) -> Option<usize> {
    // Squares that a line leaves of the readings so far, by updating (Welford 1962, Technometrics 4:419).
    let left = |order: &mut dyn Iterator<Item = usize>| -> Vec<f64> {
        let (mut n, mut middle, mut level) = (0.0, 0.0, 0.0);
        let (mut over, mut under, mut whole) = (0.0, 0.0, 0.0);
        let mut squares = |k: usize| {
            let (t, d) = (time[k] - middle, depth[k] - level);
            n += 1.0;
            middle += t / n;
            level += d / n;
            under += t * (time[k] - middle);
            over += t * (depth[k] - level);
            whole += d * (depth[k] - level);
            let explained = if under > 0.0 {
                over * over / under
            } else {
                0.0
            };
            f64::max(whole - explained, 0.0)
        };
        order.map(&mut squares).collect()
    };
    let before = left(&mut (leg.start..leg.end));
    let after = left(&mut (leg.start..leg.end).rev());
    let n = before.len();
    // Two readings are always on a line, and say nothing of a kink.
    let all = FEWEST / 2..=n - FEWEST / 2;
    let both = |k: usize| before[k - 1] + after[n - k - 1];
    let best = all.min_by(|a, b| both(*a).total_cmp(&both(*b)))?;
    Some(leg.start + best)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A ramp of 0.5 mm/s at 1 kHz that is read in steps of 0.011 mm and stops a little before its end: a smooth course that follows every step of the
    /// readings is no better than its line.
    #[test]
    fn readings_that_are_rounded_alike_count_for_one() {
        let time: Vec<f64> = (0..2000).map(|k| 1e-3 * f64::from(k)).collect();
        let path = |t: f64| 0.5 * t.min(1.93);
        let depth: Vec<f64> = time
            .iter()
            .map(|t| (path(*t) / 0.011).round() * 0.011)
            .collect();
        let leg = Leg {
            start: 0,
            end: 2000,
            phase: Phase::Load,
        };
        let read = (&time[..], &depth[..]);
        let of = Readings::new(read, (&[leg], 0.011));
        assert!(is_straight((leg, 0.0), of));
    }
}
