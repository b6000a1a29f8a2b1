//! Signatures: necessary signs of an effect, tested on the recordings without a model of it.
//!
//! Each is a mean over the noise of its own; what is not clear either way at one in a hundred is not told.

use thenar_contact::effects::{Effect, Sign};

use crate::checks::heteroscedasticity::{SHARED, pulls};
use crate::forward::surrogate::force_recording::{ForceRecording, Row};
use crate::forward::surrogate::prepared_study::PreparedStudy;
use crate::observe::measured::Phase;
use crate::parameters::surrogate_parameter::{Kind, by_recording};
use crate::selection::scored::Scored;

/// Standard errors that 1 % of a normal law exceed on one side.
const CLEAR: f64 = 2.33;
/// Ratio of speeds from which they are two.
const SPEEDS: f64 = 2.0;
/// Fewest readings in each of two means.
const FEW: usize = 3;
/// Part of the deepest depth by which the depths of two rows may differ between which a force is taken.
const APART: f64 = 0.2;

/// The sentences of an effect's signs that the recordings show clearly, and whether each holds.
pub fn looked_for(
    ready: &PreparedStudy,
    (scored, effect): (&Scored, Effect),
) -> Vec<(String, bool)> {
    let seen = |sign: Sign| match sign {
        Sign::ForceFallsInHold => clear(z(ready, &in_hold)),
        Sign::ForceStaysInHold => unlike(z(ready, &in_hold)),
        Sign::LoopIsOpen => clear(z(ready, &in_loop)),
        Sign::LoopIsClosed => unlike(z(ready, &in_loop)),
        Sign::LaterCyclesAreSofter => clear(z(ready, &in_cycles)),
        Sign::ForceGrowsWithRate => clear(by_speed(ready)),
        Sign::SpeedDoesNotMatter => unlike(by_speed(ready)),
        Sign::TrendsWithoutContact => z(ready, &apart)
            .map(|z| z.abs())
            .and_then(|z| clear(Some(z))),
        Sign::ForcePulls => Some(pulls(
            &ready.courses,
            &by_recording(
                (&ready.shared, &scored.refit.at),
                ready.courses.len(),
                Kind::ForceZero,
            ),
            (&scored.refit.simulated, &ready.sigma),
        ))
        .filter(|p| *p),
        _ => None,
    };
    effect
        .entry()
        .consequences
        .iter()
        .filter_map(|c| Some((c.sentence.to_owned(), seen(c.sign)?)))
        .collect()
}

/// What is clear: true well above none, false well below.
fn clear(z: Option<f64>) -> Option<bool> {
    z.filter(|z| z.abs() > CLEAR).map(|z| z > 0.0)
}

/// Of a sign that two means are alike: false where they clearly differ, either way; that they are alike noise never shows.
fn unlike(z: Option<f64>) -> Option<bool> {
    clear(z).map(|_| false)
}

/// Two groups of forces (N) of one recording whose means are compared: the first is to be larger.
type Two = (Vec<f64>, Vec<f64>);

/// Standard errors by which first means exceed second ones, over all recordings; None where no recording has both.
fn z(ready: &PreparedStudy, two: &dyn Fn(&ForceRecording) -> Two) -> Option<f64> {
    let (mut sum, mut count) = (0.0, 0.0);
    for course in &ready.courses {
        let (first, second) = two(course);
        let (Some(a), Some(b)) = (mean(&first), mean(&second)) else {
            continue;
        };
        let Some(sample) = course.rows.iter().find_map(|r| r.sample) else {
            continue;
        };
        let worth = 1.0 / first.len() as f64 + 1.0 / second.len() as f64;
        sum += (a - b) / (ready.sigma[sample] * (SHARED * worth).sqrt());
        count += 1.0;
    }
    (count > 0.0).then(|| sum / f64::sqrt(count))
}

fn mean(forces: &[f64]) -> Option<f64> {
    (forces.len() >= FEW).then(|| forces.iter().sum::<f64>() / forces.len() as f64)
}

/// Rows with a force in a phase.
fn within(course: &ForceRecording, phase: Phase) -> Vec<&Row> {
    let rows = course.rows.iter();
    rows.filter(|r| r.phase == phase && r.sample.is_some())
        .collect()
}

/// First and last third of rows.
fn ends(rows: &[&Row]) -> Two {
    let third = rows.len() / 3;
    let forces = |some: &[&Row]| some.iter().map(|r| r.force_n).collect();
    (forces(&rows[..third]), forces(&rows[rows.len() - third..]))
}

fn in_hold(course: &ForceRecording) -> Two {
    ends(&within(course, Phase::Hold))
}

fn apart(course: &ForceRecording) -> Two {
    ends(&within(course, Phase::Apart))
}

/// The first loading and the unloading, at the same depths.
fn in_loop(course: &ForceRecording) -> Two {
    let mut loading = within(course, Phase::Load);
    loading.retain(|r| r.cycle == 0);
    at_same_depths(course.deepest(), (&loading, &within(course, Phase::Unload)))
}

/// The first loading and the last, at the same depths.
fn in_cycles(course: &ForceRecording) -> Two {
    let last = course.rows.iter().map(|r| r.cycle).max().unwrap_or(0);
    let of = |cycle: u32| -> Vec<&Row> {
        let mut loading = within(course, Phase::Load);
        loading.retain(|r| r.cycle == cycle);
        loading
    };
    match last {
        0 => (Vec::new(), Vec::new()),
        _ => at_same_depths(course.deepest(), (&of(0), &of(last))),
    }
}

/// Forces of the first rows between a quarter and nine tenths of the way, and those of the second at their depths: on straight lines
/// between rows that are not farther apart than [`APART`].
fn at_same_depths(deepest: f64, (first, second): (&[&Row], &[&Row])) -> Two {
    let is_between = |r: &&&Row| (0.25 * deepest..0.9 * deepest).contains(&r.depth_mm);
    let met = |depth: f64| {
        second.windows(2).find_map(|two| {
            let (from, to) = (two[0].depth_mm, two[1].depth_mm);
            let share = (depth - from) / (to - from);
            let is_met = (0.0..=1.0).contains(&share) && (to - from).abs() < APART * deepest;
            is_met.then(|| two[0].force_n * (1.0 - share) + two[1].force_n * share)
        })
    };
    let own = first.iter().filter(is_between);
    own.filter_map(|a| Some((a.force_n, met(a.depth_mm)?)))
        .unzip()
}

/// Standard errors by which the fastest presses of a tool bear more than the slowest, over the scatter of gains.
fn by_speed(ready: &PreparedStudy) -> Option<f64> {
    let (mut sum, mut count) = (0.0, 0.0);
    for place in 0..ready.elastic.places.len() {
        let own = ready
            .courses
            .iter()
            .filter(|c| c.place == place && c.speed() > 0.0);
        let own: Vec<&ForceRecording> = own.collect();
        let speeds = || own.iter().map(|c| c.speed());
        let (slow, fast) = (
            speeds().fold(f64::INFINITY, f64::min),
            speeds().fold(0.0, f64::max),
        );
        if fast < SPEEDS * slow {
            continue;
        }
        let peaks = |speed: f64| -> Vec<f64> {
            let near = own.iter().filter(|c| (c.speed() / speed - 1.0).abs() < 0.2);
            near.map(|c| libm::log(c.most().max(f64::MIN_POSITIVE)))
                .collect()
        };
        let (a, b) = (peaks(fast), peaks(slow));
        let mean = |list: &[f64]| list.iter().sum::<f64>() / list.len() as f64;
        let least = own.iter().map(|c| c.most()).fold(f64::INFINITY, f64::min);
        let zero = ready.noise.force_zero_n.unwrap_or(0.0) / least.max(f64::MIN_POSITIVE);
        let spread = ready.noise.gain.hypot(ready.noise_share()).hypot(zero);
        let error = spread * (1.0 / a.len() as f64 + 1.0 / b.len() as f64).sqrt();
        sum += (mean(&a) - mean(&b)) / error.max(f64::MIN_POSITIVE);
        count += 1.0;
    }
    (count > 0.0).then(|| sum / f64::sqrt(count))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 2.33 standard errors are what one in a hundred draws of noise exceeds on either side.
    #[test]
    fn signature_needs_significance_and_equality_is_only_rejected() {
        let of = |z: f64| (clear(Some(z)), unlike(Some(z)));
        assert_eq!(of(3.0), (Some(true), Some(false)));
        assert_eq!(of(-3.0), (Some(false), Some(false)));
        assert_eq!(of(2.0), (None, None));
        assert_eq!((clear(None), unlike(None)), (None, None));
    }

    /// Two loadings on one line: rows of the later one lie deeper, and would seem to bear more.
    #[test]
    fn signature_forces_are_paired_at_equal_depth() {
        let rows = |from: f64, step: f64| -> Vec<Row> {
            let row = |k: u32| Row {
                time_s: 0.0,
                depth_mm: from + step * f64::from(k),
                spread_mm: 0.0,
                force_step_n: 0.0,
                force_n: 3.0 * (from + step * f64::from(k)),
                phase: Phase::Load,
                cycle: 0,
                sample: Some(0),
            };
            (0..10).map(row).collect()
        };
        let (first, up, down) = (rows(0.0, 0.1), rows(0.02, 0.1), rows(0.95, -0.1));
        for second in [&up, &down] {
            let (a, b): (Vec<&Row>, Vec<&Row>) = (first.iter().collect(), second.iter().collect());
            let (a, b) = at_same_depths(1.0, (&a, &b));
            assert_eq!(a.len(), 6, "0.3 to 0.8 mm");
            assert!(
                a.iter().zip(&b).all(|(a, b)| (a - b).abs() < 1e-12),
                "{a:?} {b:?}"
            );
        }
        let (a, b): (Vec<&Row>, Vec<&Row>) = (first.iter().collect(), up.iter().collect());
        assert!(
            at_same_depths(0.45, (&a, &b)).0.is_empty(),
            "rows 0.1 mm apart of 0.45"
        );
    }
}
