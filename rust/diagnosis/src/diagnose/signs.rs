//! Necessary signs of an effect, looked for in what was measured, without a model of it.
//!
//! Each is a mean over the noise of its own; what is not clear either way at one in a hundred is not told.

use thenar_contact::effects::{Effect, Sign};

use super::checks::{SHARED, pulls};
use super::course::{Course, Row};
use super::ladder::Scored;
use super::prepare::Prepared;
use crate::Phase;

/// Standard errors that 1 % of a normal law exceed on one side.
const CLEAR: f64 = 2.33;
/// Ratio of speeds from which they are two.
const SPEEDS: f64 = 2.0;
/// Fewest readings in each of two means.
const FEW: usize = 3;

/// The sentences of an effect's signs that the recordings show clearly, and whether each holds.
pub fn looked_for(ready: &Prepared, (scored, effect): (&Scored, Effect)) -> Vec<(String, bool)> {
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

/// Two groups of readings of one recording whose means are compared: the first is to be larger.
type Two<'a> = (Vec<&'a Row>, Vec<&'a Row>);

/// Standard errors by which first means exceed second ones, over all recordings; None where no recording has both.
fn z(ready: &Prepared, two: &dyn Fn(&Course) -> Two<'_>) -> Option<f64> {
    let (mut sum, mut count) = (0.0, 0.0);
    for course in &ready.courses {
        let (first, second) = two(course);
        let (Some(a), Some(b)) = (mean(&first), mean(&second)) else {
            continue;
        };
        let Some(sample) = first[0].sample else {
            continue;
        };
        let worth = 1.0 / first.len() as f64 + 1.0 / second.len() as f64;
        sum += (a - b) / (ready.sigma[sample] * (SHARED * worth).sqrt());
        count += 1.0;
    }
    (count > 0.0).then(|| sum / f64::sqrt(count))
}

fn mean(rows: &[&Row]) -> Option<f64> {
    let all = rows.iter().map(|r| r.force_n).sum::<f64>();
    (rows.len() >= FEW).then(|| all / rows.len() as f64)
}

/// Rows with a force in a phase.
fn within(course: &Course, phase: Phase) -> Vec<&Row> {
    let rows = course.rows.iter();
    rows.filter(|r| r.phase == phase && r.sample.is_some())
        .collect()
}

/// First and last third of rows.
fn ends(rows: Vec<&Row>) -> Two<'_> {
    let third = rows.len() / 3;
    (rows[..third].to_vec(), rows[rows.len() - third..].to_vec())
}

fn in_hold(course: &Course) -> Two<'_> {
    ends(within(course, Phase::Hold))
}

fn apart(course: &Course) -> Two<'_> {
    ends(within(course, Phase::Apart))
}

/// Rows of the first loading and of the unloading that lie within the same depths.
fn in_loop(course: &Course) -> Two<'_> {
    let loading: Vec<&Row> = within(course, Phase::Load)
        .into_iter()
        .filter(|r| r.cycle == 0)
        .collect();
    let unloading = within(course, Phase::Unload);
    let deepest = course.deepest();
    let middle = |r: &&&Row| (0.25 * deepest..0.9 * deepest).contains(&r.depth_mm);
    let first: Vec<&Row> = loading.iter().filter(middle).copied().collect();
    let second: Vec<&Row> = unloading.iter().filter(middle).copied().collect();
    // The rows' depths are not the same: those that lie close are compared.
    let nearest = |a: &&'_ Row| -> Option<usize> {
        let off = |k: &usize| (second[*k].depth_mm - a.depth_mm).abs();
        let found = (0..second.len()).min_by(|j, k| off(j).total_cmp(&off(k)))?;
        (off(&found) < 0.02 * deepest).then_some(found)
    };
    let pairs = first.iter().filter_map(|a| Some((*a, second[nearest(a)?])));
    pairs.unzip()
}

/// Rows near the turning points of the first cycle and of the last.
fn in_cycles(course: &Course) -> Two<'_> {
    let last = course.rows.iter().map(|r| r.cycle).max().unwrap_or(0);
    let deepest = course.deepest();
    let of = |cycle: u32| -> Vec<&Row> {
        let loading = within(course, Phase::Load);
        loading
            .into_iter()
            .filter(|r| r.cycle == cycle && r.depth_mm > 0.75 * deepest)
            .collect()
    };
    match last {
        0 => (Vec::new(), Vec::new()),
        _ => (of(0), of(last)),
    }
}

/// Standard errors by which the fastest presses of a tool bear more than the slowest, over the scatter of gains.
fn by_speed(ready: &Prepared) -> Option<f64> {
    let (mut sum, mut count) = (0.0, 0.0);
    for place in 0..ready.elastic.places.len() {
        let own = ready
            .courses
            .iter()
            .filter(|c| c.place == place && c.speed() > 0.0);
        let own: Vec<&Course> = own.collect();
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
        let spread = ready.noise.gain.hypot(ready.noise_share());
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
    fn a_change_is_told_where_it_is_clear_and_sameness_only_denied() {
        let of = |z: f64| (clear(Some(z)), unlike(Some(z)));
        assert_eq!(of(3.0), (Some(true), Some(false)));
        assert_eq!(of(-3.0), (Some(false), Some(false)));
        assert_eq!(of(2.0), (None, None));
        assert_eq!((clear(None), unlike(None)), (None, None));
    }
}
