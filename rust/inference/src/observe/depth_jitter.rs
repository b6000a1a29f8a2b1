//! Jitter of a depth's readings: a stage moves smoothly, and where the force does not follow what its encoder reads in addition, that is noise.
//!
//! A model that is pressed to a depth as it was read predicts a force that jitters with it. Any hypothesis that flattens the force, such as
//! a ceiling, then fits better than the truth. So a depth is taken as its smooth course and as much of the rest as the force follows: the
//! reliability of the readings (Fuller 1987, Measurement Error Models, section 1.1).

use crate::observe::downsampling::is_kept_whole;
use crate::observe::limits::MOST_MOMENTS;
use crate::observe::motion::by_lines::by_lines;
use crate::observe::motion::rounding::{Rounded, step_of};
use crate::observe::motion::stiffness::slopes;
use crate::observe::protocol_phases::{Courses, Stretch};
use crate::observe::robust_scale::{median_deviation, trimmed_deviation};
use crate::observe::smoothing::smoothed;

/// What a jitter does to the force, over the noise of the force, below which depths are left as they were read.
const LEAST: f64 = 0.25;
/// Readings farther than this many standard deviations from the smooth course are movement, and stay; forces count for no more.
const MOVES: f64 = 5.0;
/// What straight lines may leave of the readings, in standard deviations of what smooth courses leave: straight legs of 6 and more readings
/// reach 1.3, fast cycles that are no lines 4 and more.
const LINES_LEAVE: f64 = 1.5;
/// Readings that follow the force by assumption, in samples whose jitter does as much as the noise of the force: where nothing can be said
/// the depth is believed.
const BELIEVED: f64 = 2.0;

/// Depths without their jitter.
pub(crate) struct Depths {
    /// mm.
    pub depth_mm: Vec<f64>,
    /// Standard deviation of the readings about a smooth course, mm.
    pub jitter_mm: f64,
    /// Part of it that the force follows, 0 to 1.
    pub reliability: f64,
    /// Step to which readings are rounded, mm, where that is all that parts them from the motion; else 0.
    pub step_mm: f64,
    /// Standard deviation of what rounding still leaves, mm; else 0.
    pub left_mm: f64,
}

/// Takes the jitter off the depths of a course; None where it does not matter, or where the force follows it.
pub(crate) fn without_jitter(courses: Courses<'_>, stretches: &[Stretch]) -> Option<Depths> {
    let n = courses.depth_mm.len();
    // What the force follows is judged with depth and force smoothed alike: lines would leave of the depth what the force has lost.
    let (mut depth, mut force) = (courses.depth_mm.to_vec(), courses.force_n.to_vec());
    for stretch in stretches {
        let own = stretch.start..stretch.end;
        let time = &courses.time_s[own.clone()];
        depth[own.clone()].copy_from_slice(&smoothed(time, &courses.depth_mm[own.clone()]));
        force[own.clone()].copy_from_slice(&smoothed(time, &courses.force_n[own]));
    }
    let off = |read: &[f64], smooth: &[f64]| -> Vec<f64> {
        read.iter().zip(smooth).map(|(r, s)| r - s).collect()
    };
    let (moved, pushed) = (off(courses.depth_mm, &depth), off(courses.force_n, &force));
    let deviation =
        |of: &[f64]| median_deviation(&mut of.iter().map(|x| x.abs()).collect::<Vec<f64>>());
    let (jitter_mm, noise_n) = (deviation(&moved), deviation(&pushed));
    let slope = slopes((courses.time_s, &depth, &force), stretches);
    let is_jitter = |k: usize| moved[k].abs() <= MOVES * jitter_mm;
    let (mut over, mut under) = (0.0, 0.0);
    for k in (0..n).filter(|&k| is_jitter(k)) {
        let expected = slope[k] * moved[k];
        over += expected * pushed[k].clamp(-MOVES * noise_n, MOVES * noise_n);
        under += expected * expected;
    }
    let pressed = slope.iter().filter(|s| **s != 0.0).count();
    let matters =
        jitter_mm > 0.0 && pressed > 0 && (under / pressed as f64).sqrt() > LEAST * noise_n;
    let rounded = Rounded {
        courses,
        stretches,
        slope: &slope,
        step_mm: step_of(courses.depth_mm),
        noise_n,
    };
    // Rounding is alike in readings that follow each other: a mean over them has their noise no more, and still its error.
    let in_mean = match is_kept_whole(n, MOST_MOMENTS) {
        true => 1.0,
        false => n as f64 / MOST_MOMENTS as f64,
    };
    let does = rounded.does_n() > LEAST * noise_n / in_mean.sqrt();
    if !matters && !does {
        return None;
    }
    let read = (courses.time_s, courses.depth_mm);
    let motion = by_lines(read, (&depth, rounded.step_mm));
    if let Some((depth_mm, left_mm)) = does.then(|| rounded.unrounded(&motion)).flatten() {
        return Some(Depths {
            depth_mm,
            jitter_mm: rounded.step_mm / 12f64.sqrt(),
            reliability: 0.0,
            step_mm: rounded.step_mm,
            left_mm,
        });
    }
    if !matters {
        return None;
    }
    let prior = BELIEVED * noise_n * noise_n;
    let reliability = ((over + prior) / (under + prior)).clamp(0.0, 1.0);
    let lines = motion.depth_mm;
    let is_motion = deviation(&off(courses.depth_mm, &lines)) <= LINES_LEAVE * jitter_mm;
    let mut course = if is_motion { lines } else { depth };
    let read = off(courses.depth_mm, &course);
    let jitter_mm = trimmed_deviation(&read, MOVES);
    for k in 0..n {
        course[k] += match read[k].abs() <= MOVES * jitter_mm {
            true => reliability * read[k],
            false => read[k],
        };
    }
    (reliability < 1.0).then_some(Depths {
        depth_mm: course,
        jitter_mm,
        reliability,
        step_mm: 0.0,
        left_mm: 0.0,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::observe::protocol_phases::stretches;
    use crate::random::Random;

    /// A ball pressed at 0.5 mm/s, held and lifted; the stage shakes by `shakes` and its encoder by `reads`, mm.
    fn found(shakes: f64, reads: f64, seed: u64) -> (Option<Depths>, Vec<f64>) {
        let mut random = Random::new(seed);
        let time: Vec<f64> = (0..300).map(|k| f64::from(k) * 0.03).collect();
        let path = |t: f64| (0.5 * t).min(1.0).min(0.5 * (9.0 - t)) - 0.01;
        let meant: Vec<f64> = time.iter().map(|t| path(*t)).collect();
        let truth: Vec<f64> = meant.iter().map(|d| d + shakes * random.normal()).collect();
        let read: Vec<f64> = truth.iter().map(|d| d + reads * random.normal()).collect();
        let force: Vec<f64> = truth
            .iter()
            .map(|d| 0.5 * d.max(0.0).powf(1.5) + 0.002 * random.normal())
            .collect();
        let courses = Courses {
            time_s: &time,
            depth_mm: &read,
            force_n: &force,
            slide_mm: &[],
        };
        (without_jitter(courses, &stretches(courses)), truth)
    }

    #[test]
    fn encoder_jitter_goes_and_a_stage_that_shakes_stays() {
        for seed in 1..6 {
            let (read, truth) = found(0.0, 0.01, seed);
            let read = read.expect("it jitters");
            assert!(read.reliability < 0.25, "{}", read.reliability);
            assert!((read.jitter_mm / 0.01 - 1.0).abs() < 0.25);
            let pairs = read.depth_mm.iter().zip(&truth);
            let squares: f64 = pairs.map(|(a, b)| (a - b).powi(2)).sum();
            assert!((squares / 300.0).sqrt() < 0.005);
            let (shaken, _) = found(0.01, 0.0, seed);
            assert!(shaken.is_none_or(|s| s.reliability > 0.8));
            let (both, _) = found(0.01, 0.01, seed);
            let both = both.expect("half of it is noise").reliability;
            assert!((both - 0.5).abs() < 0.25, "{both}");
        }
    }

    const JITTER_MM: f64 = 0.016;

    /// Depths less the truth, mm, of 12 recordings at these moments: readings jitter about a motion that the force follows. Only where asked.
    fn errors(
        (path, time): (&dyn Fn(f64) -> f64, &[f64]),
        is_asked: &dyn Fn(f64) -> bool,
    ) -> Vec<f64> {
        let of = |seed: u64| {
            let mut random = Random::new(seed);
            let read: Vec<f64> = time
                .iter()
                .map(|t| path(*t) + JITTER_MM * random.normal())
                .collect();
            let force: Vec<f64> = time
                .iter()
                .map(|t| 0.5 * path(*t).max(0.0).powf(1.5) + 0.002 * random.normal())
                .collect();
            let courses = Courses {
                time_s: time,
                depth_mm: &read,
                force_n: &force,
                slide_mm: &[],
            };
            let found = without_jitter(courses, &stretches(courses));
            let depth = found.map_or(read.clone(), |found| found.depth_mm);
            let errors = time.iter().zip(depth).map(|(t, d)| (*t, d - path(*t)));
            let asked = errors.filter(|(t, _)| is_asked(*t)).map(|(_, error)| error);
            asked.collect::<Vec<f64>>()
        };
        (1..13).flat_map(of).collect()
    }

    fn mean(of: &[f64]) -> f64 {
        of.iter().sum::<f64>() / of.len() as f64
    }

    fn rms(of: &[f64]) -> f64 {
        mean(&of.iter().map(|x| x * x).collect::<Vec<f64>>()).sqrt()
    }

    fn moments(count: u32, step: f64) -> Vec<f64> {
        (0..count).map(|k| step * f64::from(k)).collect()
    }

    /// Lines along the flanks of a sine meet in a corner above its crest.
    #[test]
    fn crest_of_a_sine_is_read_no_deeper_than_it_is() {
        let sine = |t: f64| 0.55 - 0.65 * libm::cos(2.0 * std::f64::consts::PI * t / 3.0);
        let top = errors((&sine, &moments(200, 0.06)), &|t| sine(t) > 0.99 * 1.2);
        assert!(mean(&top).abs() < 0.3 * JITTER_MM, "{}", mean(&top));
        // Where a course is cut at noisy extremes, its ends are worse.
        assert!(rms(&top) < 0.5 * JITTER_MM, "{}", rms(&top));
    }

    /// A ramp of two or three readings belongs to no hold: of its 98 readings the level is known to a tenth of the jitter, of its ends less.
    #[test]
    fn hold_after_a_step_stays_level() {
        let step = |t: f64| ((t - 2.0) / 0.25).min((14.0 - t) / 2.0).clamp(0.0, 1.0) * 1.3 - 0.1;
        let held = errors((&step, &moments(200, 0.1)), &|t| (2.25..=12.0).contains(&t));
        assert!(rms(&held) < 0.3 * JITTER_MM, "{}", rms(&held));
    }

    #[test]
    fn cycles_of_a_few_readings_keep_their_turns() {
        for readings in [3.0, 4.0] {
            let cycles = |t: f64| {
                let phase = (t / (0.05 * readings)) % 2.0;
                1.3 * phase.min(2.0 - phase) - 0.1
            };
            let all = errors((&cycles, &moments(61, 0.05)), &|_| true);
            assert!(rms(&all) < 1.2 * JITTER_MM, "{readings}: {}", rms(&all));
        }
    }

    #[test]
    fn small_jitter_leaves_the_readings() {
        assert!(found(0.0, 2e-4, 1).0.is_none());
    }

    const STEP_MM: f64 = 0.01;
    const SPEED_MM_S: f64 = 0.506;

    /// From above the skin in to `deepest`, a stand of 3 s and out.
    fn stood(deepest: f64) -> impl Fn(f64) -> f64 {
        let ramp = (deepest + 0.1) / SPEED_MM_S;
        move |t: f64| (SPEED_MM_S * t.min(2.0 * ramp + 3.0 - t) - 0.1).clamp(-0.1, deepest)
    }

    /// What is found of a stage that rounds where it goes (or not), read every 0.08 s (rounding is a wave of 1.7 s), and where it went, mm.
    fn rounded(
        deepest: f64,
        (goes_in_steps, fades): (bool, f64),
        seed: u64,
    ) -> (Option<Depths>, Vec<f64>) {
        let (path, time) = (stood(deepest), moments(130, 0.08));
        let round = |d: f64| STEP_MM * (d / STEP_MM).round();
        let read: Vec<f64> = time.iter().map(|t| round(path(*t))).collect();
        let truth: Vec<f64> = match goes_in_steps {
            true => read.clone(),
            false => time.iter().map(|t| path(*t)).collect(),
        };
        let begins = (deepest + 0.1) / SPEED_MM_S;
        let left = |t: f64| 1.0 - fades * (1.0 - libm::exp(-(t - begins).max(0.0) / 0.4));
        (read_at(&time, (&read, &truth), (&left, seed)), truth)
    }

    /// Rounding is off by 2.9 um (root mean square), and by the same all along a stand.
    #[test]
    fn rounded_depths_are_read_as_the_motion_was() {
        let (mut legs, mut stands) = (Vec::new(), Vec::new());
        for seed in 1..13 {
            // A stand between two steps, each time elsewhere.
            let deepest = 1.3 + STEP_MM * (seed as f64 / 12.0);
            let (found, truth) = rounded(deepest, (false, 0.0), seed);
            let found = found.expect("its steps matter");
            assert!(found.left_mm < 0.2 * STEP_MM);
            assert!((found.step_mm / STEP_MM - 1.0).abs() < 1e-6);
            for (is, was) in found.depth_mm.iter().zip(&truth) {
                match *was == deepest {
                    true => stands.push(is - was),
                    false => legs.push(is - was),
                }
            }
        }
        assert!(rms(&legs) < 0.0015, "{}", rms(&legs));
        assert!(rms(&stands) < 0.0015, "{}", rms(&stands));
    }

    /// Force that fades in a stand says nothing of its depth: it stays where it was read, and counts as known to a step's rounding.
    #[test]
    fn stand_in_which_the_force_fades_is_not_moved() {
        for fades in [0.2, 0.02] {
            let mut stands = Vec::new();
            for seed in 1..13 {
                let deepest = 1.3 + STEP_MM * (seed as f64 / 12.0);
                let (found, truth) = rounded(deepest, (false, fades), seed);
                let found = found.expect("its steps matter");
                assert!(found.left_mm > 0.25 * STEP_MM);
                let held = found.depth_mm.iter().zip(&truth);
                let held = held.filter(|(_, was)| **was == deepest);
                stands.extend(held.map(|(is, was)| is - was));
            }
            assert!(mean(&stands).abs() < 0.001, "{}", mean(&stands));
            assert!(rms(&stands) < 0.0032, "{}", rms(&stands));
        }
    }

    /// What is found of readings at these times with a force that follows `truth`, of which `left` is left.
    fn read_at(
        time: &[f64],
        (read, truth): (&[f64], &[f64]),
        (left, seed): (&dyn Fn(f64) -> f64, u64),
    ) -> Option<Depths> {
        let mut random = Random::new(seed);
        let push =
            |(d, t): (&f64, &f64)| 1.5 * d.max(0.0).powf(1.5) * left(*t) + 0.002 * random.normal();
        let force: Vec<f64> = truth.iter().zip(time).map(push).collect();
        let courses = Courses {
            time_s: time,
            depth_mm: read,
            force_n: &force,
            slide_mm: &[],
        };
        without_jitter(courses, &stretches(courses))
    }

    /// A stage that goes in steps is left as it was read; so is a micrometer that a hand turned by one mark in and by two out, when it came to it.
    #[test]
    fn steps_of_the_stage_stay() {
        for seed in 1..7 {
            assert!(rounded(1.3, (true, 0.0), seed).0.is_none(), "{seed}");
        }
        let marks = |k: i32| if k <= 20 { k } else { 20 - 2 * (k - 20) };
        let depth: Vec<f64> = (0..31).map(|k| 0.1 * f64::from(marks(k))).collect();
        let mut random = Random::new(5);
        let pause = |time: &mut f64, _| {
            *time += 1.0 + 0.3 * random.uniform();
            Some(*time)
        };
        let time: Vec<f64> = (0..31).scan(0.0, pause).collect();
        let found = read_at(&time, (&depth, &depth), (&|_| 1.0, 3));
        let found = found.map_or(depth.clone(), |found| found.depth_mm);
        let off: Vec<f64> = found.iter().zip(&depth).map(|(a, b)| a - b).collect();
        assert!(rms(&off) < 0.02, "{off:?}");
    }

    /// A sine is no straight line, whatever the step of its readings.
    #[test]
    fn rounded_sine_is_not_called_straight() {
        let time = moments(250, 0.08);
        let sine = |t: &f64| 0.5 - 0.6 * libm::cos(0.2 * std::f64::consts::PI * t);
        let truth: Vec<f64> = time.iter().map(sine).collect();
        let read: Vec<f64> = truth
            .iter()
            .map(|d| STEP_MM * (d / STEP_MM).round())
            .collect();
        let found = read_at(&time, (&read, &truth), (&|_| 1.0, 3));
        assert!(found.is_none_or(|found| found.step_mm == 0.0));
    }
}
