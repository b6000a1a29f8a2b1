//! The step to which readings of a depth are rounded, and whether the force follows what rounding leaves.
//!
//! Rounded to a step q, readings of a steady motion are off by an error that is even between -q/2 and q/2 (variance q^2/12; Widrow, Kollar
//! and Liu 1996, IEEE Transactions on Instrumentation and Measurement 45:353). At even times it is no noise but a wave, slow where the way
//! between readings is close to a whole number of steps, so that a smooth course follows it.

use nalgebra::{Matrix3, Vector3};

use crate::observe::measured::Phase;
use crate::observe::motion::line::ROUNDED;
use crate::observe::protocol_phases::{Courses, Stretch};

/// Part of the range by which readings differ that are the same.
const SAME: f64 = 1e-7;
/// Smallest step, as a part of the range: what has no step seems to have one far below.
const FINEST: f64 = 1e-5;
/// Part of a step by which a multiple of it may be off.
const WHOLE: f64 = 1e-2;
/// Fewest different readings in which a step is sought.
const FEWEST: usize = 8;
/// Least that rounding leaves about lines, in steps: less is a motion in even steps that was read as it is.
const LEAST: f64 = 0.1;
/// Logarithm of the likelihood ratio from which a stage is said to go in steps: most depths that seem to are rounded.
const CLEARLY: f64 = 5.0;
/// Variance of a second difference over that of a reading.
const SECOND: f64 = 6.0;
/// Part of the time between readings by which even times may differ, and of a step by which a line may bend.
const EVEN: f64 = 1e-2;

/// The step of which all readings are multiples, from one of them on, mm; 0 where there is none, or where a motion goes on by one step at a time.
pub(crate) fn step_mm(depth: &[f64], stretches: &[Stretch]) -> f64 {
    let mut sorted = depth.to_vec();
    sorted.sort_by(f64::total_cmp);
    let (Some(first), Some(last)) = (sorted.first(), sorted.last()) else {
        return 0.0;
    };
    let range = last - first;
    let gaps = sorted.windows(2).map(|two| two[1] - two[0]);
    let gaps: Vec<f64> = gaps.filter(|gap| *gap > SAME * range).collect();
    // Euclid's algorithm over all gaps.
    let step = gaps.iter().fold(0.0, |step, gap| {
        let (mut large, mut small) = (f64::max(step, *gap), f64::min(step, *gap));
        while small > SAME * range {
            let left = large - (large / small).round() * small;
            (large, small) = (small, left.abs());
        }
        large
    });
    if gaps.len() + 1 < FEWEST || step < FINEST * range {
        return 0.0;
    }
    let is_leg = |stretch: &&Stretch| matches!(stretch.phase, Phase::Load | Phase::Unload);
    let mut ways = stretches.iter().filter(is_leg).flat_map(|stretch| {
        let own = &depth[stretch.start..stretch.end];
        own.windows(2).map(|two| ((two[1] - two[0]) / step).abs())
    });
    match ways.any(|way| (way - 1.0).abs() > WHOLE) {
        true => step,
        false => 0.0,
    }
}

/// Whether rounding to this step is what parts readings from the lines of a motion, and not less.
pub(crate) fn is_rounding((read, lines): (&[f64], &[f64]), step: f64) -> bool {
    let off = || read.iter().zip(lines).map(|(r, l)| r - l);
    let squares: f64 = off().map(|d| d * d).sum();
    let rms = (squares / read.len().max(1) as f64).sqrt();
    step > 0.0 && rms > LEAST * step && off().all(|d| d.abs() < ROUNDED * step)
}

/// Whether the force follows what rounding seems to leave of the lines of a motion: a stage that goes in such steps and is read as it is.
///
/// By second differences, in which a wave has its jumps and a line nothing: with all of them the force is clearly likelier than with none.
/// `slope` is the stiffness by reading (N/mm), `noise_n` the standard deviation of the force's noise.
pub(crate) fn is_followed(
    courses: Courses<'_>,
    (lines, slope): (&[f64], &[f64]),
    (step, noise_n): (f64, f64),
) -> bool {
    let (time, depth, force) = (courses.time_s, courses.depth_mm, courses.force_n);
    let second = |of: &[f64], k: usize| of[k + 1] - 2.0 * of[k] + of[k - 1];
    let (mut over, mut under) = (0.0, 0.0);
    for k in 1..time.len().saturating_sub(1) {
        let is_even = second(time, k).abs() < EVEN * (time[k + 1] - time[k - 1]);
        let is_leg = second(lines, k).abs() < EVEN * step;
        if is_even && is_leg && slope[k - 1..=k + 1].iter().all(|s| *s > 0.0) {
            let expected = slope[k] * second(depth, k);
            over += expected * second(force, k);
            under += expected * expected;
        }
    }
    over - 0.5 * under > CLEARLY * SECOND * noise_n * noise_n
}

/// Readings of a leg from which its force is continued, and of a stand at whose beginning the force is taken.
const BEFORE: usize = 8;
const AFTER: usize = 3;

/// Moves stands to where, within half a step, the force of the leg before them comes to: all readings of a stand are off by the same.
pub(crate) fn level_stands(
    courses: Courses<'_>,
    (stretches, lines): (&[Stretch], &mut [f64]),
    (step, noise_n): (f64, f64),
) {
    for pair in stretches.windows(2) {
        let (leg, stand) = (pair[0], pair[1]);
        let is_pressed = leg.phase == Phase::Load && stand.phase == Phase::Hold;
        if !is_pressed || leg.end - leg.start < BEFORE || stand.end - stand.start < 2 * AFTER {
            continue;
        }
        let level = lines[stand.end - AFTER];
        let is_level = |k: &usize| (lines[*k] - level).abs() < 0.5 * step;
        let own: Vec<usize> = (leg.end..stand.end).filter(is_level).collect();
        if own.len() < AFTER {
            continue;
        }
        let near = || (leg.end - BEFORE..leg.end).filter(|k| !is_level(k));
        let Some((there, slope, variance)) =
            continued(near().map(|k| (lines[k] - level, courses.force_n[k])))
        else {
            continue;
        };
        let here = own[..AFTER]
            .iter()
            .map(|k| courses.force_n[*k])
            .sum::<f64>()
            / AFTER as f64;
        let known = (noise_n / slope).powi(2) * (variance + 1.0 / AFTER as f64);
        let rounded = step * step / 12.0;
        let off = (here - there) / slope * rounded / (rounded + known);
        let off = off.clamp(-0.5 * step, 0.5 * step);
        for k in own {
            lines[k] += off;
        }
    }
}

/// A force at depth 0, its slope there and the force's variance over that of a reading, by a parabola through (depth, force); None unless
/// it grows.
fn continued(points: impl Iterator<Item = (f64, f64)>) -> Option<(f64, f64, f64)> {
    let (mut normal, mut right) = (Matrix3::zeros(), Vector3::zeros());
    for (depth, force) in points {
        let powers = Vector3::new(1.0, depth, depth * depth);
        normal += powers * powers.transpose();
        right += powers * force;
    }
    let inverse = normal.try_inverse()?;
    let found = inverse * right;
    (found.y > 0.0 && inverse.m11 > 0.0).then_some((found.x, found.y, inverse.m11))
}
