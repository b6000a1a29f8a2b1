//! The step to which readings of a depth are rounded, and whether the force follows what rounding leaves.
//!
//! Rounded to a step q, readings of a steady motion are off by an error that is even between -q/2 and q/2 (variance q^2/12; Widrow, Kollar
//! and Liu 1996, IEEE Transactions on Instrumentation and Measurement 45:353). At even times it is no noise but a wave, slow where the way
//! between readings is close to a whole number of steps, so that a smooth course follows it.

use std::ops::Range;

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
/// Logarithm of the likelihood ratio from which a stage is said to go in steps: most depths that seem to, are rounded.
const CLEARLY: f64 = 5.0;
/// Part of a step by which a line may bend between readings.
const STRAIGHT: f64 = 1e-2;
/// Standard deviations from which a stand's force falls.
const SURE: f64 = 3.0;

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

/// Whether the force does not follow what rounding seems to leave of the lines of a motion, as it would if the stage went in such steps and were
/// read as it is. Where nothing can be said, false: then the depth is believed.
///
/// By each reading less the line through its neighbors, in which a wave has its jumps and a straight motion nothing: with all of them the force is
/// not clearly likelier than with none. `slope` is the stiffness by reading (N/mm), `noise_n` the standard deviation of the force's noise.
pub(crate) fn is_refused(
    courses: Courses<'_>,
    (lines, slope): (&[f64], &[f64]),
    (step, noise_n): (f64, f64),
) -> bool {
    let (time, depth, force) = (courses.time_s, courses.depth_mm, courses.force_n);
    let (mut over, mut under) = (0.0, 0.0);
    for k in 1..time.len().saturating_sub(1) {
        let part = (time[k] - time[k - 1]) / (time[k + 1] - time[k - 1]);
        let bend = |of: &[f64]| of[k] - (1.0 - part) * of[k - 1] - part * of[k + 1];
        let is_leg = bend(lines).abs() < STRAIGHT * step;
        if is_leg && slope[k - 1..=k + 1].iter().all(|s| *s > 0.0) {
            let variance = 1.0 + (1.0 - part).powi(2) + part * part;
            let expected = slope[k] * bend(depth);
            over += expected * bend(force) / variance;
            under += expected * expected / variance;
        }
    }
    under > 0.0 && over - 0.5 * under <= CLEARLY * noise_n * noise_n
}

/// Steps that a leg goes, and readings, from which its force is continued.
const BEFORE: (f64, usize, usize) = (6.0, 6, 40);
/// Readings of a stand at whose beginning, and half as many more at whose end, the force is taken.
const AFTER: usize = 3;
/// Steps beyond which a force says something else than where in its step a stand is.
const FARTHEST: f64 = 0.75;
/// Part of a stand that is level.
const LEVEL: f64 = 0.8;

/// Moves stands to where, within half a step, the force of the leg before them comes to: all readings of a stand are off by the same. False if
/// one stays as it was read: its force falls (then it is not of the depth alone), or it does not follow a leg, or says otherwise than half a step.
pub(crate) fn level_stands(
    courses: Courses<'_>,
    (stretches, lines): (&[Stretch], &mut [f64]),
    (step, noise_n): (f64, f64),
) -> bool {
    let mut are_level = true;
    for (n, stand) in stretches.iter().enumerate() {
        let is_stand = stand.phase == Phase::Hold && stand.end - stand.start > 2 * AFTER;
        are_level &= stand.phase != Phase::Slide;
        if !is_stand {
            continue;
        }
        let leg = n.checked_sub(1).map(|before| stretches[before]);
        let moved = leg
            .filter(|leg| leg.phase == Phase::Load)
            .and_then(|leg| shift((courses, lines), [leg, *stand], (step, noise_n)));
        match moved {
            Some((own, off)) => lines[own].iter_mut().for_each(|depth| *depth += off),
            None => are_level = false,
        }
    }
    are_level
}

/// Readings of a stand after a leg, and by how much it is off; None where that cannot be told.
fn shift(
    (courses, lines): (Courses<'_>, &[f64]),
    [leg, stand]: [Stretch; 2],
    (step, noise_n): (f64, f64),
) -> Option<(Range<usize>, f64)> {
    let mut sorted = lines[stand.start..stand.end].to_vec();
    sorted.sort_by(f64::total_cmp);
    let level = sorted[sorted.len() / 2];
    let is_level = |k: &usize| (lines[*k] - level).abs() < 1e-3 * step;
    let start = (leg.start..stand.end).find(is_level)?;
    let end = (start..lines.len())
        .find(|k| !is_level(k))
        .unwrap_or(lines.len());
    if ((end - start) as f64) < LEVEL * (stand.end - stand.start) as f64 || end - start < 2 * AFTER
    {
        return None;
    }
    let mean = |of: Range<usize>| courses.force_n[of.clone()].iter().sum::<f64>() / of.len() as f64;
    let here = mean(start..start + AFTER);
    let late = mean(start + (end - start) / 2..end);
    let one = noise_n * noise_n / AFTER as f64;
    if here - late > SURE * (2.0 * one).sqrt() {
        return None;
    }
    let (way, least, most) = BEFORE;
    let goes = |k: &usize| level - lines[*k] < way * step || start - k <= least;
    let near = (leg.start..start).rev().take(most).take_while(goes);
    let points: Vec<(f64, f64)> = near
        .map(|k| (lines[k] - level, courses.force_n[k]))
        .collect();
    let (there, slope, variance) = (points.len() >= least).then(|| continued(&points))??;
    let known = noise_n * noise_n * variance + one;
    let rounded = slope * slope * step * step / 12.0;
    let off = (here - there) / slope * rounded / (rounded + known);
    let is_within = off.abs() <= FARTHEST * step;
    is_within.then_some((start..end, off.clamp(-0.5 * step, 0.5 * step)))
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
