//! Readings that are rounded so coarsely, or taken so fast, that many in a row are the same: the motion under the stairs.

use crate::observe::robust_scale::median;

/// Part of the range up to which a step of readings is one of rounding; a protocol that goes in steps and stands on each makes larger ones.
const LARGEST: f64 = 0.03;
/// Time between changes, s, its median, up to which a motion goes on under them: a stage that goes in steps and stands on each stands longer.
const LONGEST_S: f64 = 0.3;
/// Changes between readings, fewest, and part of them before and after which nothing changes: a motion that is seen in every reading has few.
const CHANGES: (usize, f64) = (8, 0.6);

/// Depths that pass each edge of the stairs at half its height, mm, and are straight between edges; None where there are no stairs.
///
/// They show motion and rest. Where a tool stands, they are off by half a step.
pub(crate) fn under_stairs(time_s: &[f64], depth_mm: &[f64]) -> Option<Vec<f64>> {
    let n = depth_mm.len();
    let low = depth_mm.iter().copied().fold(f64::INFINITY, f64::min);
    let high = depth_mm.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let changes = |k: usize| k > 0 && k < n && depth_mm[k] != depth_mm[k - 1];
    let edges: Vec<usize> = (1..n).filter(|k| changes(*k)).collect();
    let (fewest, part) = CHANGES;
    let alone = edges
        .iter()
        .filter(|k| !changes(**k - 1) && !changes(**k + 1))
        .count();
    if edges.len() < fewest || (alone as f64) < part * edges.len() as f64 {
        return None;
    }
    let mut heights: Vec<f64> = edges
        .iter()
        .map(|k| (depth_mm[*k] - depth_mm[k - 1]).abs())
        .collect();
    if median(&mut heights) > LARGEST * (high - low) {
        return None;
    }
    let mut times: Vec<f64> = edges
        .windows(2)
        .map(|two| time_s[two[1]] - time_s[two[0]])
        .collect();
    if median(&mut times) > LONGEST_S {
        return None;
    }
    let middle = |k: &usize| {
        let (a, b) = (k - 1, *k);
        (
            0.5 * (time_s[a] + time_s[b]),
            0.5 * (depth_mm[a] + depth_mm[b]),
        )
    };
    let mut knots = vec![(time_s[0], depth_mm[0])];
    knots.extend(edges.iter().map(middle));
    knots.push((time_s[n - 1], depth_mm[n - 1]));
    let mut next = 1;
    let at = |time: &f64| {
        while next + 1 < knots.len() && knots[next].0 < *time {
            next += 1;
        }
        let ((from, before), (to, after)) = (knots[next - 1], knots[next]);
        let part = ((time - from) / (to - from).max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
        before + part * (after - before)
    };
    Some(time_s.iter().map(at).collect())
}

#[cfg(test)]
mod tests {
    use super::under_stairs;
    use crate::observe::depth_jitter::without_jitter;
    use crate::observe::protocol_phases::{Courses, stretches};
    use crate::random::Random;

    /// Readings at 1 kHz of a motion to 1 mm in 2 s, a stand of 2 s and the way back, rounded to that step.
    fn read(step: f64) -> (Vec<f64>, Vec<f64>, Vec<f64>) {
        let time: Vec<f64> = (0..6000).map(|k| 1e-3 * f64::from(k)).collect();
        let path = |t: f64| (0.5 * t).min(1.0).min(0.5 * (6.0 - t));
        let truth: Vec<f64> = time.iter().map(|t| path(*t)).collect();
        let rounded = truth.iter().map(|d| (d / step).round() * step).collect();
        (time, truth, rounded)
    }

    #[test]
    fn motion_under_stairs_is_that_which_was_rounded() {
        let (time, truth, rounded) = read(0.011);
        let found = under_stairs(&time, &rounded).unwrap();
        for (k, (found, truth)) in found.iter().zip(&truth).enumerate() {
            let stands = (1950..4050).contains(&k);
            let most = if stands { 0.011 } else { 0.001 };
            assert!((found - truth).abs() < most, "{k}: {found} {truth}");
        }
    }

    /// The force says where in its step the stand is; what lines, of which many readings are rounded alike, are off by is far less than a step.
    #[test]
    fn depths_that_are_read_in_steps_many_times_are_those_of_the_motion() {
        let (time, truth, rounded) = read(0.011);
        let mut random = Random::new(5);
        let force: Vec<f64> = truth
            .iter()
            .map(|d| 0.2 * d.max(0.0).powf(1.5) + 0.003 * random.normal())
            .collect();
        let courses = Courses {
            time_s: &time,
            depth_mm: &rounded,
            force_n: &force,
            slide_mm: &[],
        };
        let found = without_jitter(courses, &stretches(courses)).expect("rounding matters");
        assert!((found.step_mm - 0.011).abs() < 1e-9, "{}", found.step_mm);
        assert!(found.left_mm > 0.1 * 0.011 && found.left_mm < 0.3 * 0.011);
        for (k, (found, truth)) in found.depth_mm.iter().zip(&truth).enumerate() {
            let stands = (1900..4100).contains(&k);
            let most = if stands { 0.008 } else { 0.001 };
            assert!((found - truth).abs() < most, "{k}: {found} {truth}");
        }
    }

    #[test]
    fn large_steps_and_changes_with_every_reading_are_no_stairs() {
        let (time, truth, _) = read(0.01);
        assert!(under_stairs(&time, &truth).is_none());
        let (time, _, coarse) = read(0.1);
        assert!(under_stairs(&time, &coarse).is_none());
        // A stage that goes 20 um every second, and stays there.
        let slow: Vec<f64> = (0..5000).map(|k| 0.01 * f64::from(k)).collect();
        let steps: Vec<f64> = slow.iter().map(|t| 0.02 * t.floor()).collect();
        assert!(under_stairs(&slow, &steps).is_none());
        // Read 25 times more seldom, each reading of the motion is another.
        let (time, _, rounded) = read(0.011);
        let few = |of: &[f64]| of.iter().step_by(25).copied().collect::<Vec<f64>>();
        assert!(under_stairs(&few(&time), &few(&rounded)).is_none());
    }
}
