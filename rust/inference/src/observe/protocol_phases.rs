//! Phases of a protocol (load, hold, unload, slide, apart) from noisy depths.

use crate::observe::measured::Phase;
use crate::observe::motion::stairs::under_stairs;
use crate::observe::robust_scale::noise_of;

/// Part of the depth's range that a movement must exceed to count as one; passes from 0.005 to 0.05.
const LEAST_MOVE: f64 = 0.02;
/// The same in standard deviations of the depth's noise.
const LEAST_MOVE_IN_NOISE: f64 = 8.0;
/// Speed below which a tool stands, as a part of the fastest of its leg.
const STANDS: f64 = 0.05;
/// Force that the noise cannot explain where a tool seems apart: standard deviations, and part of the largest force.
const TOUCHES: (f64, f64) = (4.0, 0.01);

/// A stretch lasts at least this part of a recording.
const MOST_STRETCHES: usize = 200;

/// Samples of one phase, without a break.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Stretch {
    /// First sample.
    pub start: usize,
    /// One past the last sample.
    pub end: usize,
    /// What the tool does.
    pub phase: Phase,
    /// Loadings before this one.
    pub cycle: u32,
}

/// A course to be divided; slices of equal length.
#[derive(Clone, Copy)]
pub struct Courses<'a> {
    /// s, growing.
    pub time_s: &'a [f64],
    /// mm.
    pub depth_mm: &'a [f64],
    /// N.
    pub force_n: &'a [f64],
    /// Travel along the skin, mm; empty if there is none.
    pub slide_mm: &'a [f64],
}

/// Divides a course into stretches of one phase each; in long recordings, what lasts less than a part of them is noise.
pub fn stretches(courses: Courses<'_>) -> Vec<Stretch> {
    let mut phases = moves(courses.time_s, courses.depth_mm);
    mark_slides(courses, &mut phases);
    mark_apart(courses, &mut phases);
    let shortest = courses.depth_mm.len() / MOST_STRETCHES;
    while let Some((start, end, phase)) = flicker(&phases, shortest) {
        phases[start..end].fill(phase);
    }
    let mut found: Vec<Stretch> = Vec::new();
    let (mut cycle, mut has_left) = (0, false);
    for (k, phase) in phases.into_iter().enumerate() {
        match found.last_mut() {
            Some(last) if last.phase == phase => last.end = k + 1,
            last => {
                let has_begun = last.is_some();
                has_left |= matches!(phase, Phase::Unload);
                if phase == Phase::Load && has_left && has_begun {
                    cycle += 1;
                    has_left = false;
                }
                let (start, end) = (k, k + 1);
                found.push(Stretch {
                    start,
                    end,
                    phase,
                    cycle,
                });
            }
        }
    }
    found
}

/// The shortest run of one phase, if it is shorter than `shortest`, and the phase of the longer of its neighbors.
fn flicker(phases: &[Phase], shortest: usize) -> Option<(usize, usize, Phase)> {
    let mut runs: Vec<(usize, usize)> = Vec::new();
    for (k, phase) in phases.iter().enumerate() {
        match runs.last_mut() {
            Some(run) if phases[run.0] == *phase => run.1 = k + 1,
            _ => runs.push((k, k + 1)),
        }
    }
    let length = |run: &(usize, usize)| run.1 - run.0;
    let (at, run) = runs.iter().enumerate().min_by_key(|(_, run)| length(run))?;
    if runs.len() < 2 || length(run) >= shortest {
        return None;
    }
    let before = at.checked_sub(1).map(|k| runs[k]);
    let neighbors = [before, runs.get(at + 1).copied()];
    let longer = neighbors.into_iter().flatten().max_by_key(length)?;
    Some((run.0, run.1, phases[longer.0]))
}

/// Load, hold or unload by sample, from the depth alone.
pub(crate) fn moves(time: &[f64], depth: &[f64]) -> Vec<Phase> {
    let n = depth.len();
    let under = under_stairs(time, depth);
    let depth = under.as_deref().unwrap_or(depth);
    let mut phases = vec![Phase::Hold; n];
    let noise = noise_of(depth);
    let (low, high) = range(depth);
    let least = least_move(depth);
    if n < 2 || high - low <= 0.0 {
        return phases;
    }
    let turns = turning_points(depth, least);
    for leg in turns.windows(2) {
        let (a, b) = (leg[0], leg[1]);
        let near = f64::max(0.25 * least, 3.0 * noise);
        if (depth[b] - depth[a]).abs() <= near {
            continue;
        }
        let phase = match depth[b] > depth[a] {
            true => Phase::Load,
            false => Phase::Unload,
        };
        let starts = (a..=b).rev().find(|&k| (depth[k] - depth[a]).abs() <= near);
        let ends = (a..=b).find(|&k| (depth[k] - depth[b]).abs() <= near);
        let (start, end) = (starts.unwrap_or(a), ends.unwrap_or(b));
        if start >= end {
            phases[a..=b].fill(phase);
            continue;
        }
        phases[start..=end].fill(phase);
        let rate = (depth[end] - depth[start]) / (time[end] - time[start]);
        // A tolerance's worth of travel at the leg's speed belongs to the leg; longer standing is a hold.
        let lag = (2.0 * near / rate.abs()).max(0.0);
        if time[start] - time[a] <= lag {
            phases[a..start].fill(phase);
        }
        if time[b] - time[end] <= lag {
            phases[end..=b].fill(phase);
        }
        mark_pauses((time, depth), (start, end), near, &mut phases);
    }
    phases
}

/// Way from which a movement counts as one, mm.
pub(crate) fn least_move(depth: &[f64]) -> f64 {
    let (low, high) = range(depth);
    f64::max(
        LEAST_MOVE * (high - low),
        LEAST_MOVE_IN_NOISE * noise_of(depth),
    )
}

/// Marks where a leg pauses on its way.
fn mark_pauses(
    (time, depth): (&[f64], &[f64]),
    (start, end): (usize, usize),
    near: f64,
    phases: &mut [Phase],
) {
    let fastest = (start..end)
        .map(|k| ((depth[k + 1] - depth[k]) / (time[k + 1] - time[k])).abs())
        .fold(0.0, f64::max);
    let mut from = start;
    while from < end {
        let mut to = from;
        while to < end && (depth[to + 1] - depth[from]).abs() <= near {
            to += 1;
        }
        let travel = (depth[to] - depth[from]).abs().max(near);
        let is_pause = to >= from + 4 && travel / (time[to] - time[from]) < STANDS * fastest;
        if is_pause {
            phases[from + 1..=to].fill(Phase::Hold);
        }
        from = to.max(from + 1);
    }
}

/// Ends and extremes of a course, with swings below `least` ignored.
fn turning_points(depth: &[f64], least: f64) -> Vec<usize> {
    let (mut points, mut lowest, mut highest) = (vec![0], 0, 0);
    let mut rises = None;
    for (k, d) in depth.iter().enumerate() {
        if *d < depth[lowest] {
            lowest = k;
        }
        if *d > depth[highest] {
            highest = k;
        }
        let (falls_from, rises_from) = (depth[highest] - d > least, d - depth[lowest] > least);
        match rises {
            None if rises_from || falls_from => {
                let extreme = if rises_from { lowest } else { highest };
                points.push(extreme);
                rises = Some(rises_from);
                (lowest, highest) = if rises_from {
                    (lowest, k)
                } else {
                    (k, highest)
                };
            }
            Some(true) if falls_from => {
                points.push(highest);
                (rises, lowest, highest) = (Some(false), k, k);
            }
            Some(false) if rises_from => {
                points.push(lowest);
                (rises, lowest, highest) = (Some(true), k, k);
            }
            _ => {}
        }
    }
    points.push(if rises == Some(false) {
        lowest
    } else {
        highest
    });
    points.push(depth.len() - 1);
    points.dedup();
    points
}

fn mark_slides(courses: Courses<'_>, phases: &mut [Phase]) {
    let Courses {
        time_s, slide_mm, ..
    } = courses;
    if slide_mm.len() != phases.len() || phases.len() < 2 {
        return;
    }
    let speed = |k: usize| {
        let (a, b) = (k.saturating_sub(1), (k + 1).min(slide_mm.len() - 1));
        ((slide_mm[b] - slide_mm[a]) / (time_s[b] - time_s[a])).abs()
    };
    let fastest = (0..slide_mm.len()).map(speed).fold(0.0, f64::max);
    for (k, phase) in phases.iter_mut().enumerate() {
        if fastest > 0.0 && speed(k) > STANDS * fastest && *phase == Phase::Hold {
            *phase = Phase::Slide;
        }
    }
}

fn mark_apart(courses: Courses<'_>, phases: &mut [Phase]) {
    let noise = noise_of(courses.force_n);
    let most = courses
        .force_n
        .iter()
        .fold(0.0, |most, f| f64::max(most, f.abs()));
    let touches = f64::max(TOUCHES.0 * noise, TOUCHES.1 * most);
    for (k, phase) in phases.iter_mut().enumerate() {
        if courses.depth_mm[k] <= 0.0 && courses.force_n[k].abs() <= touches {
            *phase = Phase::Apart;
        }
    }
}

/// Smallest and largest number of a list.
pub fn range(values: &[f64]) -> (f64, f64) {
    values
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| {
            (low.min(*v), high.max(*v))
        })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    /// Ramp up, hold, ramp down, apart, with noise in depth.
    fn cycle(noise: f64, times: usize) -> (Vec<f64>, Vec<f64>) {
        let mut random = Random::new(3);
        let knots = [
            (0.0, -0.2),
            (2.2, 2.0),
            (12.0, 2.0),
            (14.2, -0.2),
            (16.0, -0.2),
        ];
        let at = |t: f64| {
            let k = (1..5).find(|&k| t <= knots[k].0).unwrap_or(4);
            let share = (t - knots[k - 1].0) / (knots[k].0 - knots[k - 1].0);
            knots[k - 1].1 + share * (knots[k].1 - knots[k - 1].1)
        };
        let time: Vec<f64> = (0..160 * times).map(|k| 0.1 * k as f64).collect();
        let depth = time
            .iter()
            .map(|t| at(t % 16.0) + noise * random.normal())
            .collect();
        (time, depth)
    }

    #[test]
    fn ramps_holds_and_cycles_are_told_apart_through_noise() {
        for noise in [0.0, 0.01] {
            let (time, depth) = cycle(noise, 3);
            let force: Vec<f64> = depth.iter().map(|d| d.max(0.0)).collect();
            let found = stretches(Courses {
                time_s: &time,
                depth_mm: &depth,
                force_n: &force,
                slide_mm: &[],
            });
            let at = |t: f64| {
                let k = (t / 0.1).round() as usize;
                let stretch = found.iter().find(|s| s.start <= k && k < s.end).unwrap();
                (stretch.phase, stretch.cycle)
            };
            for turn in 0..3 {
                let begin = 16.0 * f64::from(turn);
                assert_eq!(at(begin + 1.2), (Phase::Load, turn), "{noise}");
                assert_eq!(at(begin + 7.0), (Phase::Hold, turn), "{noise}");
                assert_eq!(at(begin + 13.2), (Phase::Unload, turn), "{noise}");
                assert_eq!(at(begin + 15.2).0, Phase::Apart, "{noise}");
            }
            assert!(found.len() <= 15, "{noise}: {found:?}");
        }
    }

    /// Two cycles at 1 kHz, of which some 25 readings in a row are rounded to the same.
    #[test]
    fn ramps_that_are_read_in_steps_are_ramps() {
        let (_, moved) = cycle(0.0, 2);
        let time: Vec<f64> = (0..31_900).map(|k| 1e-3 * f64::from(k)).collect();
        let at = |t: &f64| {
            let (k, part) = ((t / 0.1) as usize, (t / 0.1).fract());
            moved[k] + part * (moved[k + 1] - moved[k])
        };
        let depth: Vec<f64> = time
            .iter()
            .map(|t| (at(t) / 0.025).round() * 0.025)
            .collect();
        let force: Vec<f64> = depth.iter().map(|d| d.max(0.0)).collect();
        let found = stretches(Courses {
            time_s: &time,
            depth_mm: &depth,
            force_n: &force,
            slide_mm: &[],
        });
        assert!(found.len() <= 10, "{found:?}");
        for turn in 0..2 {
            let of = |t: f64| {
                let k = (1000.0 * (16.0 * f64::from(turn) + t)) as usize;
                let stretch = found.iter().find(|s| s.start <= k && k < s.end).unwrap();
                (stretch.phase, stretch.cycle)
            };
            assert_eq!(of(1.2), (Phase::Load, turn), "{found:?}");
            assert_eq!(of(7.0), (Phase::Hold, turn), "{found:?}");
            assert_eq!(of(13.2), (Phase::Unload, turn), "{found:?}");
        }
    }

    #[test]
    fn a_staircase_is_one_loading_with_holds() {
        let time: Vec<f64> = (0..90).map(|k| 0.1 * f64::from(k)).collect();
        let stair = |t: f64| (t / 3.0).floor() + ((t % 3.0) / 1.0).min(1.0);
        let depth: Vec<f64> = time.iter().map(|t| stair(*t)).collect();
        let found = stretches(Courses {
            time_s: &time,
            depth_mm: &depth,
            force_n: &depth,
            slide_mm: &[],
        });
        let holds = found.iter().filter(|s| s.phase == Phase::Hold).count();
        assert_eq!(holds, 3, "{found:?}");
        assert!(found.iter().all(|s| s.cycle == 0));
    }
}
