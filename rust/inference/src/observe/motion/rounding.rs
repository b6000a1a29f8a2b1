//! The step to which readings are rounded, and of depths whether the force follows what rounding leaves.
//!
//! Rounded to a step q, readings of a steady motion are off by an error that is even between -q/2 and q/2 (variance q^2/12; Widrow, Kollar
//! and Liu 1996, IEEE Transactions on Instrumentation and Measurement 45:353). At even times it is no noise but a wave, slow where the way
//! between readings is close to a whole number of steps, so that a smooth course follows it.

use std::ops::Range;

use nalgebra::{Matrix3, Vector3};

use crate::observe::measured::Phase;
use crate::observe::motion::by_lines::Motion;
use crate::observe::motion::line::ROUNDED;
use crate::observe::protocol_phases::{Courses, Stretch, range};
use crate::observe::robust_scale::median;

/// Part of the range by which readings differ that are the same.
const SAME: f64 = 1e-7;
/// Smallest step, as a part of the range: what has no step seems to have one far below.
const FINEST: f64 = 1e-5;
/// A step that is larger than the digit in which readings are written: by so many digits, and the smallest gap by so many steps at most.
const DIGITS: f64 = 20.0;
const PARTS: u32 = 4;
/// Fewest different readings in which a step of a depth, and of a force, is sought.
const FEWEST: usize = 8;
const FEWEST_FORCES: usize = 5;
/// Least that rounding leaves about lines, in steps: less is a motion in even steps that was read as it is.
const LEAST: f64 = 0.1;
/// Logarithm of the likelihood ratio from which a stage is said to go in steps: most depths that seem to, are rounded.
const CLEARLY: f64 = 5.0;
/// Part of a step by which a line may bend between readings.
const STRAIGHT: f64 = 1e-2;
/// Standard deviations from which a stand's force falls.
const SURE: f64 = 3.0;

/// Steps that a leg goes, and fewest and most readings, from which its force is continued.
const BEFORE: (f64, usize, usize) = (6.0, 6, 40);
/// Readings of a stand at whose beginning the force is taken; it has twice as many at least.
const AFTER: usize = 3;
/// Steps by which depths of one level differ at most.
const SAME_LEVEL: f64 = 1e-3;
/// Steps beyond which a force says something else than where in its step a stand is.
const FARTHEST: f64 = 0.75;
/// Part of a stand that is level.
const LEVEL: f64 = 0.8;
/// What lines through rounded readings are off by, over the step: root mean square of motions between any two steps (tests of `depth_jitter`).
const LINES_ARE_OFF: f64 = 0.12;
/// The same where a stand is left where it was read: all of its readings are off by one error of rounding.
const STANDS_ARE_OFF: f64 = 0.29;

/// Least step over the range of readings that is more than digits of a file.
const MORE_THAN_DIGITS: f64 = 2e-4;
/// Part of neighboring readings that are the same, from which noise is smaller than the step to which they are rounded; and part of a step by which
/// they differ at most.
const STILL: (f64, f64) = (0.4, 1e-2);

/// The step to which forces are rounded, in their unit, if it is more than digits of a file; 0 of others.
pub(crate) fn wide_step(readings: &[f64]) -> f64 {
    let (low, high) = range(readings);
    let step = step_of_at_least(FEWEST_FORCES, readings);
    if step > MORE_THAN_DIGITS * (high - low) {
        step
    } else {
        0.0
    }
}

/// Whether a step is larger than the noise of readings that are rounded to it: many are the same as the one before. Noise that is larger makes
/// rounding a part of itself (Widrow, Kollar and Liu 1996).
pub(crate) fn exceeds_noise(step: f64, readings: &[f64]) -> bool {
    let (part, same) = STILL;
    let (low, high) = range(readings);
    let is_same = |two: &&[f64]| (two[1] - two[0]).abs() < same * step;
    // At its least and its most an instrument stands for other reasons.
    let is_between = |two: &&[f64]| two[0] > low && two[0] < high;
    let between = readings.windows(2).filter(is_between);
    let count = between.clone().count();
    step > 0.0 && between.filter(is_same).count() as f64 >= part * f64::max(count as f64, 1.0)
}

/// The step of which all readings are multiples, from one of them on, in their unit; 0 where there is none. A file that writes few digits rounds
/// them once more: then multiples are off by one of its last digit at most.
pub(crate) fn step_of(readings: &[f64]) -> f64 {
    step_of_at_least(FEWEST, readings)
}

/// As [`step_of`], of so many different readings at least.
fn step_of_at_least(fewest: usize, readings: &[f64]) -> f64 {
    let mut sorted = readings.to_vec();
    sorted.sort_by(f64::total_cmp);
    let (Some(first), Some(last)) = (sorted.first(), sorted.last()) else {
        return 0.0;
    };
    let range = last - first;
    sorted.dedup_by(|b, a| *b - *a <= SAME * range);
    let digit = common_step(&sorted, range);
    let coarser = if digit > 0.0 {
        coarser_step(&sorted, digit)
    } else {
        None
    };
    let step = coarser.unwrap_or(digit);
    match sorted.len() < fewest || step < FINEST * range {
        true => 0.0,
        false => step,
    }
}

/// The step of which different readings, in their order, are multiples to within the digit in which they are written, many times as large as that.
///
/// As counts of an encoder are that a program has turned into millimeters.
fn coarser_step(sorted: &[f64], digit: f64) -> Option<f64> {
    let gaps: Vec<f64> = sorted.windows(2).map(|two| two[1] - two[0]).collect();
    let least = gaps.iter().copied().fold(f64::INFINITY, f64::min);
    let tried = (1..=PARTS).map(|part| least / f64::from(part));
    tried
        .take_while(|step| *step > DIGITS * digit)
        .find_map(|first| {
            // From gaps, that are few steps each, to the whole range, in which an error of the step has grown.
            let rough = proportion(gaps.iter().copied(), first);
            let step = proportion(sorted.iter().map(|value| value - sorted[0]), rough);
            let of = |value: f64| ((value - sorted[0]) / rough).round();
            let is_multiple =
                |value: &f64| (value - sorted[0] - of(*value) * step).abs() <= 1.5 * digit;
            sorted.iter().all(is_multiple).then_some(step)
        })
}

/// The step, by least squares, of lengths that are whole multiples of about that step.
fn proportion(lengths: impl Iterator<Item = f64>, about: f64) -> f64 {
    let (mut over, mut under) = (0.0, 0.0);
    for length in lengths {
        let count = (length / about).round();
        over += count * length;
        under += count * count;
    }
    over / under
}

/// Euclid's algorithm over the gaps between different readings, in their order.
fn common_step(sorted: &[f64], range: f64) -> f64 {
    let gaps = sorted.windows(2).map(|two| two[1] - two[0]);
    gaps.fold(0.0, |step, gap| {
        let (mut large, mut small) = (f64::max(step, gap), f64::min(step, gap));
        while small > SAME * range {
            let left = large - (large / small).round() * small;
            (large, small) = (small, left.abs());
        }
        large
    })
}

/// Readings that are rounded to a step, and what the force does with it.
pub(crate) struct Rounded<'a> {
    /// The readings.
    pub(crate) courses: Courses<'a>,
    /// Their stretches.
    pub(crate) stretches: &'a [Stretch],
    /// Stiffness by reading, N/mm.
    pub(crate) slope: &'a [f64],
    /// The step, mm; 0 where there is none.
    pub(crate) step_mm: f64,
    /// Standard deviation of the force's noise, N.
    pub(crate) noise_n: f64,
}

impl Rounded<'_> {
    /// What rounding does to the force, N, root mean square where the tool touches.
    pub(crate) fn does_n(&self) -> f64 {
        let squares: f64 = self.slope.iter().map(|s| s * s).sum();
        let pressed = self.slope.iter().filter(|s| **s != 0.0).count();
        (squares / pressed.max(1) as f64).sqrt() * self.step_mm / 12f64.sqrt()
    }

    /// Depths of the motion, and the standard deviation of what they are still off by, mm; None where it is not straight, where not rounding alone
    /// parts the readings from it, or where the force follows them.
    pub(crate) fn unrounded(&self, motion: &Motion) -> Option<(Vec<f64>, f64)> {
        let lines = &motion.depth_mm;
        if !motion.is_straight || !self.is_rounding(lines) || !self.is_refused(lines) {
            return None;
        }
        let mut depth = lines.clone();
        let left = self.level_stands(&mut depth);
        Some((depth, left * self.step_mm))
    }

    /// Whether rounding is what parts readings from these lines, and not less.
    fn is_rounding(&self, lines: &[f64]) -> bool {
        let read = self.courses.depth_mm;
        let off = || read.iter().zip(lines).map(|(r, l)| r - l);
        let squares: f64 = off().map(|d| d * d).sum();
        let rms = (squares / read.len().max(1) as f64).sqrt();
        self.step_mm > 0.0
            && rms > LEAST * self.step_mm
            && off().all(|d| d.abs() < ROUNDED * self.step_mm)
    }

    /// Whether the force does not follow what rounding seems to leave of these lines, as it would if the stage went in such steps and were read as
    /// it is. Where nothing can be said, false: then the depth is believed.
    ///
    /// By each reading less the line through its neighbors, in which a wave has its jumps and a straight motion nothing: with all of them the force
    /// is not clearly likelier than with none.
    fn is_refused(&self, lines: &[f64]) -> bool {
        let Courses {
            time_s: time,
            depth_mm: depth,
            force_n: force,
            ..
        } = self.courses;
        let (mut over, mut under) = (0.0, 0.0);
        for k in 1..time.len().saturating_sub(1) {
            let part = (time[k] - time[k - 1]) / (time[k + 1] - time[k - 1]);
            let bend = |of: &[f64]| of[k] - (1.0 - part) * of[k - 1] - part * of[k + 1];
            let is_leg = bend(lines).abs() < STRAIGHT * self.step_mm;
            if is_leg && self.slope[k - 1..=k + 1].iter().all(|s| *s > 0.0) {
                let variance = 1.0 + (1.0 - part).powi(2) + part * part;
                let expected = self.slope[k] * bend(depth);
                over += expected * bend(force) / variance;
                under += expected * expected / variance;
            }
        }
        under > 0.0 && over - 0.5 * under <= CLEARLY * self.noise_n * self.noise_n
    }

    /// Moves stands to where, within half a step, the force of the leg before them comes to: all readings of a stand are off by the same. Returns
    /// what depths are then off by (standard deviation), in steps: as stands that stay as they were read, since their force falls (then it is not of
    /// the depth alone), they do not follow a leg, or the force says more than half a step; as well as the noise of the force lets know; or as lines.
    fn level_stands(&self, lines: &mut [f64]) -> f64 {
        let mut off_steps = LINES_ARE_OFF;
        for (n, stand) in self.stretches.iter().enumerate() {
            if stand.phase == Phase::Slide {
                off_steps = STANDS_ARE_OFF;
            }
            if stand.phase != Phase::Hold || stand.end - stand.start <= 2 * AFTER {
                continue;
            }
            let leg = n.checked_sub(1).map(|before| self.stretches[before]);
            let moved = leg
                .filter(|leg| leg.phase == Phase::Load)
                .and_then(|leg| self.shift(lines, leg, *stand));
            match moved {
                Some((own, off, known)) => {
                    lines[own].iter_mut().for_each(|depth| *depth += off);
                    off_steps = off_steps.max(STANDS_ARE_OFF * (1.0 - known).max(0.0).sqrt());
                }
                None => off_steps = STANDS_ARE_OFF,
            }
        }
        off_steps
    }

    /// Readings of a stand after a leg, by how much it is off, mm, and which part of the variance of rounding the force takes away; None where it
    /// does not say.
    fn shift(
        &self,
        lines: &[f64],
        leg: Stretch,
        stand: Stretch,
    ) -> Option<(Range<usize>, f64, f64)> {
        let (force, step) = (self.courses.force_n, self.step_mm);
        let level = median(&mut lines[stand.start..stand.end].to_vec());
        let is_level = |k: &usize| (lines[*k] - level).abs() < SAME_LEVEL * step;
        let start = (leg.start..stand.end).find(is_level)?;
        let end = (start..lines.len()).find(|k| !is_level(k));
        let own = start..end.unwrap_or(lines.len());
        let least = LEVEL * (stand.end - stand.start) as f64;
        if (own.len() as f64) < least || own.len() < 2 * AFTER {
            return None;
        }
        let mean = |of: Range<usize>| force[of.clone()].iter().sum::<f64>() / of.len() as f64;
        let here = mean(start..start + AFTER);
        let late = mean(start + own.len() / 2..own.end);
        let noise = self.noise_n * self.noise_n;
        let known = noise / AFTER as f64;
        if here - late > SURE * (2.0 * known).sqrt() {
            return None;
        }
        let (way, fewest, most) = BEFORE;
        let goes = |k: &usize| level - lines[*k] < way * step || start - k <= fewest;
        let near = (leg.start..start).rev().take(most).take_while(goes);
        let points: Vec<(f64, f64)> = near.map(|k| (lines[k] - level, force[k])).collect();
        if points.len() < fewest {
            return None;
        }
        let (there, slope, variance) = continued(&points)?;
        let rounded = slope * slope * step * step / 12.0;
        let part = rounded / (rounded + noise * variance + known);
        let off = (here - there) / slope * part;
        let is_within = off.abs() <= FARTHEST * step;
        is_within.then_some((own, off.clamp(-0.5 * step, 0.5 * step), part))
    }
}

/// A force at depth 0, its slope there and the force's variance over that of a reading, by a parabola through (depth, force); None unless
/// it grows.
fn continued(points: &[(f64, f64)]) -> Option<(f64, f64, f64)> {
    let way = points
        .iter()
        .fold(0.0, |most, (depth, _)| f64::max(most, depth.abs()));
    let (mut normal, mut right) = (Matrix3::zeros(), Vector3::zeros());
    for (depth, force) in points {
        let part = depth / way;
        let powers = Vector3::new(1.0, part, part * part);
        normal += powers * powers.transpose();
        right += powers * *force;
    }
    let inverse = normal.try_inverse()?;
    let found = inverse * right;
    let grows = found.y > 0.0 && inverse.m11 > 0.0 && way > 0.0;
    grows.then_some((found.x, found.y / way, inverse.m11))
}

#[cfg(test)]
mod tests {
    use super::{exceeds_noise, step_of, wide_step};
    use crate::random::Random;

    /// Readings of an uneven motion, each rounded to the step and then to the digit.
    fn found(step: f64, digit: f64) -> f64 {
        let path = |k: u32| 1.3 * (f64::from(k) / 60.0).powf(1.2) - 0.15;
        let round = |value: f64, to: f64| {
            if to > 0.0 {
                (value / to).round() * to
            } else {
                value
            }
        };
        let read: Vec<f64> = (0..=60)
            .map(|k| round(round(path(k), step), digit))
            .collect();
        step_of(&read)
    }

    /// Forces up to 80 mN with that noise, rounded to 16 mN, and to the 10 uN of a file.
    #[test]
    fn a_wide_step_of_few_readings_is_found_and_held_against_the_noise() {
        let mut random = Random::new(1);
        let mut read = |noise: f64, step: f64| -> Vec<f64> {
            let force = |k: i32| 0.08 * (f64::from(k) / 100.0).powf(1.5);
            let noisy = (0..=100).map(|k| force(k) + noise * random.normal());
            noisy.map(|f| (f / step).round() * step).collect()
        };
        let still = read(0.002, 0.016);
        assert!((wide_step(&still) / 0.016 - 1.0).abs() < 1e-6);
        assert!(exceeds_noise(0.016, &still));
        let dithered = read(0.016, 0.016);
        assert!((wide_step(&dithered) / 0.016 - 1.0).abs() < 1e-6);
        assert!(!exceeds_noise(0.016, &dithered));
        // At a ceiling readings are the same for another reason.
        let clipped: Vec<f64> = dithered.iter().map(|f| f.min(0.048)).collect();
        assert!(!exceeds_noise(0.016, &clipped));
        let digits = read(0.002, 1e-5);
        assert!(wide_step(&digits) == 0.0 && !exceeds_noise(0.0, &digits));
    }

    #[test]
    fn a_step_is_found_through_the_digits_of_a_file() {
        for step in [0.010_914_46, 0.007_333, 0.02] {
            assert!((found(step, 0.0) / step - 1.0).abs() < 1e-6, "{step}");
            assert!(
                (found(step, 1e-5) / step - 1.0).abs() < 1e-3,
                "{step} {}",
                found(step, 1e-5)
            );
        }
        assert!((found(0.0, 1e-3) - 1e-3).abs() < 1e-9, "digits alone");
        assert!(found(0.0, 1e-5) < 1.1e-5 && found(0.0, 0.0) == 0.0);
    }
}
