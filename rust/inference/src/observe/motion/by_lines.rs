//! The motion of a stage under noisy readings of its depth, where it is made of legs of constant speed and stands that meet at turning points.
//!
//! The turning points of noisy readings are their extremes, and so lie beyond those of the motion, at moments of their own. A force that is
//! predicted from them overshoots where the load is largest, which a ceiling of the sensor explains. Where two lines meet is known far better
//! (joinpoint regression, Hudson 1966, Journal of the American Statistical Association 61:1097).
//!
//! Lines are a model, and a wrong one elsewhere: under a sine they meet in a corner above its crest. So lines are for legs that are straight
//! for at least six readings, or in parts between kinks; any other leg is smoothed, and so is a recording with a step of fewer readings, in one
//! with its neighbors where no corner parts them. A short stand at the beginning or the end is no step: it is left as it was read.

use crate::observe::measured::Phase;
use crate::observe::motion::cut::{CURVED, ROUNDS, cut_where_straight, meeting};
use crate::observe::motion::legs::{EndStands, FEWEST, Leg, is_end_stand, joined, legs};
use crate::observe::motion::line::{Line, Readings, best_kink, bic, is_straight, smooth_squares};
use crate::observe::smoothing::smoothed;

/// Fewest readings of a line next to a leg that is curved: the crest of a sine is level within the noise for fewer.
const LONG: usize = 20;
/// Times that a leg is divided in two: an approach, a press and a slower end.
const MOST_KINKS: usize = 2;
/// Lead by which a line of few readings is given up: more than any BIC of readings.
const CHAMFER: f64 = 1e12;
/// Distance from a line within which a reading of a short leg lies on it, in standard deviations of its readings.
const NEAR: f64 = 3.0;

/// What a leg is read by.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Course {
    /// A straight line.
    Line,
    /// Its few readings as they are.
    Read,
    /// A smooth course.
    Smooth,
}

type Part = (Leg, Course);

/// A motion as it is read.
pub(crate) struct Motion {
    /// At every reading, mm.
    pub(crate) depth_mm: Vec<f64>,
    /// Whether no part of it is a smooth course.
    pub(crate) is_straight: bool,
}

/// Depths of the motion at every reading, mm; `smooth` are those of smooth courses between turning points, `step` is the step to which
/// readings are rounded, mm.
pub(crate) fn by_lines((time, depth): (&[f64], &[f64]), (smooth, step): (&[f64], f64)) -> Motion {
    let mut found = depth.to_vec();
    let joined = legs((time, depth), EndStands::Joined);
    // A step of few readings is no line: its recording is smoothed.
    if joined.iter().any(|leg| leg.end - leg.start < FEWEST) {
        return Motion {
            depth_mm: smooth.to_vec(),
            is_straight: false,
        };
    }
    let of = Readings::new((time, depth), (&joined, step));
    let parts = parts(joined, of);
    for run in parts.chunk_by(|a, b| a.1 == Course::Smooth && b.1 == Course::Smooth) {
        let (leg, course) = run[0];
        let own = leg.start..run[run.len() - 1].0.end;
        match course {
            Course::Line => {
                let line = Line::through(leg, of);
                own.for_each(|k| found[k] = line.at(time[k]));
            }
            Course::Read => {}
            Course::Smooth => {
                let whole = through_turns(run, of);
                let course = whole.as_deref().unwrap_or(&smooth[own.clone()]);
                found[own].copy_from_slice(course);
            }
        }
    }
    Motion {
        depth_mm: found,
        is_straight: parts.iter().all(|part| part.1 != Course::Smooth),
    }
}

/// One smooth course of legs that BIC does not want parted where they turn: noise moves a turning point to its own extreme.
fn through_turns(run: &[Part], of: Readings<'_>) -> Option<Vec<f64>> {
    let all = run[1..]
        .iter()
        .fold(run[0].0, |all, next| joined(all, next.0));
    let mut parted = (0.0, (run.len() - 1) as f64);
    for (leg, _) in run {
        let (squares, freedom) = smooth_squares(*leg, of);
        parted = (parted.0 + squares, parted.1 + freedom);
    }
    let is_whole = run.len() > 1 && bic(smooth_squares(all, of), all, of) <= bic(parted, all, of);
    let own = all.start..all.end;
    is_whole.then(|| smoothed(&of.time[own.clone()], &of.depth[own]))
}

/// Legs with what each is read by, where lines have taken what readings of short legs lie on them.
fn parts(legs: Vec<Leg>, of: Readings<'_>) -> Vec<Part> {
    let apart = self::legs((of.time, of.depth), EndStands::Apart);
    let count = apart.len();
    let is_step =
        |(k, leg): (usize, &Leg)| leg.end - leg.start < FEWEST && !is_end_stand(leg, (k, count));
    let first = match apart.iter().enumerate().any(is_step) {
        true => legs.clone(),
        false => apart,
    };
    let cut = cut_where_straight(first, of);
    let divided: Option<Vec<Vec<Part>>> = cut.into_iter().map(|leg| divided(leg, of)).collect();
    match divided {
        Some(parts) => settled(of, grown(of, parts.concat())),
        None => settled(
            of,
            legs.into_iter().map(|leg| (leg, amid(leg, of))).collect(),
        ),
    }
}

/// Lines that end where they meet, and none that its neighbor does as well.
fn settled(of: Readings<'_>, parts: Vec<Part>) -> Vec<Part> {
    let count = parts.len();
    let found = merged(of, turned(of, merged(of, parts)));
    match found.len() < count {
        true => settled(of, found),
        false => found,
    }
}

/// What a leg is read by where others are curved: by a line only if it is long, and a stand only if it is level.
fn amid(leg: Leg, of: Readings<'_>) -> Course {
    let is_level = leg.phase != Phase::Hold || Line::through(leg, of).speed == 0.0;
    match leg.end - leg.start >= LONG && is_level && is_straight((leg, 0.0), of) {
        true => Course::Line,
        false => Course::Smooth,
    }
}

/// Straight parts of a leg that meet in kinks, those of few readings as they were read; None where it is curved.
fn divided(leg: Leg, of: Readings<'_>) -> Option<Vec<Part>> {
    if leg.end - leg.start < FEWEST {
        return Some(vec![(leg, Course::Read)]);
    }
    if is_straight((leg, CURVED), of) {
        return Some(vec![(leg, Course::Line)]);
    }
    let parts = kinked((leg, MOST_KINKS), of)?;
    let (mut squares, mut freedom) = (0.0, (parts.len() - 1) as f64);
    for (part, course) in &parts {
        match course {
            Course::Line => {
                let line = Line::through(*part, of);
                squares += line.squares;
                freedom += line.freedom;
            }
            _ => freedom += (part.end - part.start) as f64,
        }
    }
    let is_better = bic((squares, freedom), leg, of) <= bic(smooth_squares(leg, of), leg, of);
    is_better.then_some(parts)
}

/// A leg in two where that leaves least, and each of them again until it is straight; None after too many kinks.
fn kinked((leg, kinks): (Leg, usize), of: Readings<'_>) -> Option<Vec<Part>> {
    if leg.end - leg.start < FEWEST {
        return Some(vec![(leg, Course::Read)]);
    }
    if is_straight((leg, CURVED), of) {
        return Some(vec![(leg, Course::Line)]);
    }
    if kinks == 0 {
        return None;
    }
    let at = best_kink(leg, of)?;
    let (first, second) = (Leg { end: at, ..leg }, Leg { start: at, ..leg });
    let mut found = kinked((first, kinks - 1), of)?;
    found.extend(kinked((second, kinks - 1), of)?);
    Some(found)
}

/// Neighboring lines that BIC would rather have as one: a leg's end that noise has put beyond a turning point, or a pause that is none. What
/// of a line is left with few readings when it meets its neighbors is a corner cut off, and goes to the one that takes it better.
fn merged(of: Readings<'_>, mut parts: Vec<Part>) -> Vec<Part> {
    let lead = |pair: &[Part]| {
        let [(a, Course::Line), (b, Course::Line)] = *pair else {
            return f64::NEG_INFINITY;
        };
        let [one, other, both] = [a, b, joined(a, b)].map(|leg| Line::through(leg, of));
        let two = (
            one.squares + other.squares,
            one.freedom + other.freedom + 1.0,
        );
        let lead = bic(two, joined(a, b), of) - bic((both.squares, both.freedom), joined(a, b), of);
        let is_short = [a, b].iter().any(|leg| leg.end - leg.start < FEWEST);
        if is_short { lead + CHAMFER } else { lead }
    };
    loop {
        let leads: Vec<f64> = parts.windows(2).map(lead).collect();
        let best = (0..leads.len()).max_by(|a, b| leads[*a].total_cmp(&leads[*b]));
        let Some(k) = best.filter(|k| leads[*k] > 0.0) else {
            return parts;
        };
        parts[k].0 = joined(parts[k].0, parts[k + 1].0);
        parts.remove(k + 1);
    }
}

/// Lines take the readings of short parts next to them that lie on them, or beyond them as seen from the short part.
fn grown(of: Readings<'_>, mut parts: Vec<Part>) -> Vec<Part> {
    for k in 0..parts.len() {
        let (leg, course) = parts[k];
        if course != Course::Line {
            continue;
        }
        let line = Line::through(leg, of);
        let n = (leg.end - leg.start) as f64;
        let near = NEAR * (line.squares / (n - line.freedom)).sqrt();
        let off = |at: usize| of.depth[at] - line.at(of.time[at]);
        let is_on = |at: usize, far: usize| off(at).abs() <= near || off(at) * off(far) < 0.0;
        if k > 0 && parts[k - 1].1 == Course::Read {
            let before = parts[k - 1].0;
            let far = before.start;
            let from = (before.start..before.end).rev().find(|at| !is_on(*at, far));
            let from = from.map_or(before.start, |at| at + 1);
            (parts[k - 1].0.end, parts[k].0.start) = (from, from);
        }
        if k + 1 < parts.len() && parts[k + 1].1 == Course::Read {
            let after = parts[k + 1].0;
            let to = (after.start..after.end).find(|at| !is_on(*at, after.end - 1));
            let to = to.unwrap_or(after.end);
            (parts[k].0.end, parts[k + 1].0.start) = (to, to);
        }
    }
    parts.retain(|(leg, _)| leg.end > leg.start);
    parts
}

/// Legs that end where their lines meet.
fn turned(of: Readings<'_>, mut parts: Vec<Part>) -> Vec<Part> {
    for _ in 0..ROUNDS {
        let mut next = parts.clone();
        for k in 1..parts.len() {
            let (before, after) = (parts[k - 1], parts[k]);
            if before.1 != Course::Line || after.1 != Course::Line {
                continue;
            }
            if let Some(at) = meeting((before.0, after.0), of) {
                (next[k - 1].0.end, next[k].0.start) = (at, at);
            }
        }
        let is_too_short =
            |(leg, course): &Part| *course == Course::Line && leg.end < leg.start + FEWEST / 2;
        if next == parts || next.iter().any(is_too_short) {
            break;
        }
        parts = next;
    }
    parts
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    const JITTER_MM: f64 = 0.016;

    fn moments() -> Vec<f64> {
        (0..150).map(|k| 0.04 * f64::from(k)).collect()
    }

    /// Readings that jitter about a truth.
    fn jittering(truth: &dyn Fn(f64) -> f64, time: &[f64], seed: u64) -> Vec<f64> {
        let mut random = Random::new(seed);
        let one = |t: &f64| truth(*t) + JITTER_MM * random.normal();
        time.iter().map(one).collect()
    }

    /// Roots of the mean square of the depths by lines less the truth, mm, of 20 recordings; where there is no line they are as read.
    fn rms(truth: &dyn Fn(f64) -> f64, is_counted: &dyn Fn(f64) -> bool) -> Vec<f64> {
        let time = moments();
        let of = |seed: u64| {
            let read = jittering(truth, &time, seed);
            let found = by_lines((&time, &read), (&read, 0.0)).depth_mm;
            let off = time.iter().zip(found).filter(|(t, _)| is_counted(**t));
            let squares: Vec<f64> = off.map(|(t, d)| (d - truth(*t)).powi(2)).collect();
            (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
        };
        (1..21).map(of).collect()
    }

    fn mean(of: &[f64]) -> f64 {
        of.iter().sum::<f64>() / of.len() as f64
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
        let most = rms(&triangle, &near).into_iter().fold(0.0, f64::max);
        // Two lines through 75 readings each are known to 2 / sqrt(75) of the jitter at their ends; of 20 draws the largest, 2.5 times that.
        assert!(most < 2.5 * 2.0 / f64::sqrt(75.0) * JITTER_MM, "{most}");
    }

    /// A stand of 50 readings is known to 1 / sqrt(50) of the jitter in all of its length.
    #[test]
    fn stand_is_level_to_its_ends() {
        let each = mean(&rms(&trapezoid, &|time| (time - 3.0).abs() < 0.95));
        assert!(each < 1.5 / f64::sqrt(50.0) * JITTER_MM, "{each}");
    }

    /// An approach at 0.9 mm/s, a press at 0.2 mm/s, a stand and a lift at 0.8 mm/s.
    fn kinked(time: f64) -> f64 {
        let down = (0.9 * time - 0.9).min(0.2 * time - 0.2);
        down.min(0.45).min(0.8 * (5.5 - time))
    }

    /// Four lines that meet have five heights and speeds and three kinks to find: the mean square of their error is 8 of 150 of the jitter's.
    #[test]
    fn leg_with_a_kink_is_read_by_two_lines() {
        let all = mean(&rms(&kinked, &|_| true));
        assert!(all < 1.4 * f64::sqrt(8.0 / 150.0) * JITTER_MM, "{all}");
        let held = mean(&rms(&kinked, &|time| (3.3..4.9).contains(&time)));
        assert!(held < 1.5 / f64::sqrt(40.0) * JITTER_MM, "{held}");
    }

    /// A stage that a force controls, or that turns as a sine, follows no lines: it is left to the smooth course.
    #[test]
    fn legs_that_are_curved_are_not_read_by_lines() {
        let approached = |time: f64| 1.0 - libm::exp(-time / 2.0);
        let sine = |time: f64| 0.55 - 0.65 * libm::cos(2.0 * std::f64::consts::PI * time / 3.0);
        let time = moments();
        for shape in [&approached as &dyn Fn(f64) -> f64, &sine] {
            for seed in 1..21 {
                let read = jittering(shape, &time, seed);
                let legs = legs((&time, &read), EndStands::Joined);
                let of = Readings::new((&time, &read), (&legs, 0.0));
                let lines = parts(legs, of);
                let lines = lines.iter().filter(|part| part.1 == Course::Line);
                assert_eq!(lines.count(), 0, "{seed}");
            }
        }
    }

    /// Readings at 10 Hz: a stand of 0.4 s, a ramp of 1 mm/s, a hold of 3 s, a lift.
    fn stood(time: f64) -> f64 {
        (time - 0.5).clamp(-0.1, 0.9).min(0.5 * (6.3 - time))
    }

    /// Lines of 14 and of 29 readings are known to 2 / sqrt(14) of the jitter at their ends, to less in between; the stand is as it was read.
    #[test]
    fn ramp_after_a_short_stand_is_a_line() {
        let time: Vec<f64> = (0..65).map(|k| 0.1 * f64::from(k)).collect();
        let held = |t: f64| (1.55..4.4).contains(&t);
        let (mut squares, mut count) = (0.0, 0.0);
        for seed in 1..41 {
            let read = jittering(&stood, &time, seed);
            let found = by_lines((&time, &read), (&read, 0.0)).depth_mm;
            for (t, d) in time.iter().zip(found).filter(|(t, _)| held(**t)) {
                squares += (d - stood(*t)).powi(2);
                count += 1.0;
            }
        }
        let each = f64::sqrt(squares / count);
        assert!(each < 1.5 / f64::sqrt(29.0) * JITTER_MM, "{each}");
    }
}
