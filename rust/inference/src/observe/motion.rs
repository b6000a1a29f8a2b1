//! The motion of a stage under noisy readings of its depth, where it is made of legs of constant speed and stands that meet at turning points.
//!
//! The turning points of noisy readings are their extremes, and so lie beyond those of the motion, at moments of their own. A force that is
//! predicted from them overshoots where the load is largest, which a ceiling of the sensor explains. Where two lines meet is known far better
//! (joinpoint regression, Hudson 1966, Journal of the American Statistical Association 61:1097).
//!
//! Lines are a model, and a wrong one elsewhere: under a sine they meet in a corner above its crest. So a recording is read by lines only if
//! each of its legs is straight and long; any other is smoothed.

use crate::observe::measured::Phase;
use crate::observe::protocol_phases::{least_move, moves};
use crate::observe::smoothing::smoothed_with_freedom;

/// Fewest readings of a leg.
const FEWEST: usize = 6;
/// Most rounds in which turning points are sought.
const ROUNDS: usize = 10;
/// Fall of the deviance from which a stand creeps: the 99.9 % point of chi-squared with one degree of freedom, since a session has many stands.
const CREEPS: f64 = 10.83;

/// Lead in BIC from which a smooth course shows that a leg is not straight: strong evidence (Kass and Raftery 1995, Journal of the American
/// Statistical Association 90:773). The course has the best of many strengths, so that on straight legs it often leads by less.
const CURVED: f64 = 6.0;

/// Readings of one leg or stand: first, one past the last, and what the stage does.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Leg {
    start: usize,
    end: usize,
    phase: Phase,
}

/// A straight line over time.
#[derive(Debug, Clone, Copy)]
struct Line {
    /// At time 0, mm.
    height: f64,
    /// mm/s.
    speed: f64,
    /// Sum of squared deviations of the readings, mm2.
    squares: f64,
    /// Free numbers.
    freedom: f64,
}

impl Line {
    fn at(&self, time: f64) -> f64 {
        self.height + self.speed * time
    }

    /// Through readings of a leg: of a stand level, unless it creeps.
    fn through(leg: Leg, (time, depth): (&[f64], &[f64])) -> Line {
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

/// Depths of the motion at every reading, mm; None where it is not made of straight legs and stands of at least six readings each.
pub(crate) fn by_lines(time: &[f64], depth: &[f64]) -> Option<Vec<f64>> {
    let mut found = depth.to_vec();
    for leg in turned((time, depth), legs(time, depth)?) {
        let line = straight(leg, (time, depth))?;
        for k in leg.start..leg.end {
            found[k] = line.at(time[k]);
        }
    }
    Some(found)
}

/// The line of a leg; None where BIC prefers the smooth course of generalized cross-validation, or where the leg is short.
fn straight(leg: Leg, (time, depth): (&[f64], &[f64])) -> Option<Line> {
    let own = leg.start..leg.end;
    let line = Line::through(leg, (time, depth));
    let (smooth, freedom) = smoothed_with_freedom(&time[own.clone()], &depth[own.clone()]);
    let n = own.len() as f64;
    let pairs = smooth.iter().zip(&depth[own.clone()]);
    let squares: f64 = pairs.map(|(s, d)| (s - d).powi(2)).sum();
    let bic = |squares: f64, freedom: f64| {
        n * libm::log(squares.max(f64::MIN_POSITIVE) / n) + freedom * libm::log(n)
    };
    let is_straight = bic(line.squares, line.freedom) <= bic(squares, freedom) + CURVED;
    (own.len() >= FEWEST && is_straight).then_some(line)
}

/// Legs and stands by the depth alone; what has few readings and goes no way belongs to the longer of its neighbors. None where something
/// of few readings moves: no line is known there.
fn legs(time: &[f64], depth: &[f64]) -> Option<Vec<Leg>> {
    let mut found: Vec<Leg> = Vec::new();
    for (k, phase) in moves(time, depth).into_iter().enumerate() {
        match found.last_mut() {
            Some(last) if last.phase == phase => last.end = k + 1,
            _ => found.push(Leg {
                start: k,
                end: k + 1,
                phase,
            }),
        }
    }
    let length = |leg: &Leg| leg.end - leg.start;
    let least = least_move(depth);
    let goes = |leg: &Leg| {
        let (from, to) = (leg.start.saturating_sub(1), leg.end.min(depth.len() - 1));
        leg.phase != Phase::Hold && (depth[to] - depth[from]).abs() > least
    };
    if found.iter().any(|leg| length(leg) < FEWEST && goes(leg)) {
        return None;
    }
    while found.len() > 1 {
        let shortest = (0..found.len()).min_by_key(|k| length(&found[*k]));
        let Some(k) = shortest.filter(|k| length(&found[*k]) < FEWEST) else {
            break;
        };
        let is_before = k > 0
            && found
                .get(k + 1)
                .is_none_or(|next| length(next) <= length(&found[k - 1]));
        let gone = found.remove(k);
        match is_before {
            true => found[k - 1].end = gone.end,
            false => found[k].start = gone.start,
        }
        found.dedup_by(|next, last| {
            let is_same = next.phase == last.phase;
            if is_same {
                last.end = next.end;
            }
            is_same
        });
    }
    Some(found)
}

/// Legs that end where their lines meet.
fn turned((time, depth): (&[f64], &[f64]), mut legs: Vec<Leg>) -> Vec<Leg> {
    for _ in 0..ROUNDS {
        let lines: Vec<Line> = legs
            .iter()
            .map(|leg| Line::through(*leg, (time, depth)))
            .collect();
        let mut next = legs.clone();
        for k in 1..legs.len() {
            let (before, after) = (lines[k - 1], lines[k]);
            let meets = (before.height - after.height) / (after.speed - before.speed);
            let at = time.partition_point(|t| *t < meets);
            let within = legs[k - 1].start + FEWEST / 2..=legs[k].end - FEWEST / 2;
            if meets.is_finite() && within.contains(&at) {
                (next[k - 1].end, next[k].start) = (at, at);
            }
        }
        let is_too_short = |leg: &Leg| leg.end < leg.start + FEWEST / 2;
        if next == legs || next.iter().any(is_too_short) {
            break;
        }
        legs = next;
    }
    legs
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    /// Readings that jitter by 0.016 mm about a truth that is up by this shape, mm: moments, and the lines of their motion.
    fn lines_of(truth: &dyn Fn(f64) -> f64, seed: u64) -> (Vec<f64>, Option<Vec<f64>>) {
        let mut random = Random::new(seed);
        let time: Vec<f64> = (0..150).map(|k| 0.04 * f64::from(k)).collect();
        let read: Vec<f64> = time
            .iter()
            .map(|t| truth(*t) + 0.016 * random.normal())
            .collect();
        let found = by_lines(&time, &read);
        (time, found)
    }

    /// Roots of the mean square of the lines less the truth, mm, of those of 20 recordings that are read by lines.
    fn rms(truth: &dyn Fn(f64) -> f64, is_counted: &dyn Fn(f64) -> bool) -> Vec<f64> {
        let of = |seed: u64| {
            let (time, found) = lines_of(truth, seed);
            let off = time.iter().zip(found?).filter(|(t, _)| is_counted(**t));
            let squares: Vec<f64> = off.map(|(t, d)| (d - truth(*t)).powi(2)).collect();
            Some((squares.iter().sum::<f64>() / squares.len() as f64).sqrt())
        };
        (1..21).filter_map(of).collect()
    }

    fn triangle(time: f64) -> f64 {
        (0.4 * time).min(0.4 * (6.0 - time)) - 0.1
    }

    fn trapezoid(time: f64) -> f64 {
        triangle(time).min(0.7)
    }

    /// At a turning point the extremes of the readings are deeper than the motion by one or two standard deviations.
    #[test]
    fn motion_has_no_overshoot_where_it_turns() {
        let near = |time: f64| (time - 3.0).abs() < 0.13;
        let each = rms(&triangle, &near);
        assert!(each.len() >= 18, "{}", each.len());
        let most = each.into_iter().fold(0.0, f64::max);
        // Two lines through 75 readings each are known to 2 / sqrt(75) of the jitter at their ends; of 20 draws the largest, 2.5 times that.
        assert!(most < 2.5 * 2.0 / f64::sqrt(75.0) * 0.016, "{most}");
    }

    /// A stand of 50 readings is known to 1 / sqrt(50) of the jitter in all of its length.
    #[test]
    fn stand_is_level_to_its_ends() {
        let each = rms(&trapezoid, &|time| (time - 3.0).abs() < 0.95);
        assert!(each.len() >= 18, "{}", each.len());
        let mean = each.iter().sum::<f64>() / each.len() as f64;
        assert!(mean < 1.5 / f64::sqrt(50.0) * 0.016, "{mean}");
    }

    /// A stage that a force controls follows no lines, and an approach and a press are not one: its line would end elsewhere.
    #[test]
    fn legs_that_are_not_straight_are_not_read_by_lines() {
        let curved = |time: f64| 1.0 - libm::exp(-time / 2.0);
        let kinked = |time: f64| {
            let down = (0.9 * time - 0.9).min(0.2 * time - 0.2);
            down.min(0.45).min(0.8 * (5.5 - time))
        };
        for shape in [&curved as &dyn Fn(f64) -> f64, &kinked] {
            // Some are read by lines: where a leg was divided at its kink.
            let wrong = rms(shape, &|_| true)
                .into_iter()
                .filter(|error| *error > 0.5 * 0.016);
            assert_eq!(wrong.count(), 0);
        }
    }
}
