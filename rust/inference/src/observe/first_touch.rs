//! First touch from the force: its onset, for recordings that give travel without a point of first touch, and how late a given one is.

use crate::observe::measured::{Measured, Quantity, Sample};
use crate::observe::robust_scale::{median, noise_of};

/// Part of a recording's depth within which one without approach begins at its depth 0.
const NEARLY: f64 = 0.05;
/// Standard deviations of noise that a force must exceed.
const RISES: f64 = 5.0;
/// Part of the largest force that it must exceed as well: drift of the instrument before the touch.
const RISES_OF_PEAK: f64 = 0.01;
/// Part of the approach over which the force at rest is taken.
const AT_REST: f64 = 0.1;

/// Part of the largest force from which one at depth 0 is no noise.
const AT_ZERO_OF_PEAK: f64 = 0.05;
/// Part of the largest force at depth 0 at most, for the rest of the press to show anything.
const LATEST: f64 = 0.35;

/// First touch as the force shows it.
pub struct Onset {
    /// Last sample before the force rises for good.
    pub sample: usize,
    /// Force before it, N.
    pub rest_n: f64,
}

/// The last sample of the approach at which the force is still within its noise.
///
/// `travel`, mm, and `force`, N, of equal length, not empty.
pub(crate) fn onset(travel: &[f64], force: &[f64]) -> Onset {
    let largest = |from: usize, to: usize| {
        (from..to).fold(
            from,
            |best, k| if force[k] > force[best] { k } else { best },
        )
    };
    let peak = largest(0, force.len());
    // The approach begins where the tool is farthest out before the peak.
    let begin = (0..=peak).fold(0, |best, k| if travel[k] < travel[best] { k } else { best });
    let count = (((peak - begin) as f64 * AT_REST) as usize).max(1);
    let rest_n = median(&mut force[begin..(begin + count).min(force.len())].to_vec());
    let above = f64::max(
        RISES * noise_of(&force[begin..=peak]),
        RISES_OF_PEAK * (force[peak] - rest_n),
    );
    let within = |k: &usize| force[*k] - rest_n <= above;
    let sample = (begin..=peak).rev().find(within).unwrap_or(begin);
    Onset { sample, rest_n }
}

/// What a recording shows as it first passes its depth 0.
pub(crate) struct AtZero {
    /// The first reading at or beyond it.
    pub reading: usize,
    /// Depth at which the force is, mm: 0, or where a recording without approach begins.
    pub depth_mm: f64,
    /// Force there, less that with which the approach begins, N.
    pub force_n: f64,
    /// Largest force, less the same, N.
    pub most_n: f64,
    /// Largest depth, mm.
    pub deepest_mm: f64,
}

/// The passage through depth 0, `of` being depth (mm) and force (N) of a reading. A recording without approach shows it where it begins at most
/// [`NEARLY`] of its depth deeper; its force then counts from 0. None where it begins deeper, or gives no depth.
pub(crate) fn at_zero<T>(readings: &[T], of: impl Fn(&T) -> (f64, f64)) -> Option<AtZero> {
    let all: Vec<(f64, f64)> = readings.iter().map(of).collect();
    let deepest_mm = all.iter().fold(0.0, |most, r| f64::max(most, r.0));
    let reading = all.iter().position(|one| one.0 >= 0.0)?;
    let approach = &all[..reading];
    let (rest, depth_mm, force) = match approach.last() {
        None if all[0].0 > NEARLY * deepest_mm => return None,
        None => (0.0, all[0].0, all[0].1),
        Some(below) => {
            let above = all[reading];
            let part = (-below.0 / (above.0 - below.0).max(f64::MIN_POSITIVE)).min(1.0);
            let first = &approach[..reading.div_ceil(4)];
            let rest = first.iter().map(|r| r.1).sum::<f64>() / first.len() as f64;
            (rest, 0.0, below.1 + part * (above.1 - below.1))
        }
    };
    Some(AtZero {
        reading,
        depth_mm,
        force_n: force - rest,
        most_n: all.iter().fold(0.0, |most, r| f64::max(most, r.1)) - rest,
        deepest_mm,
    })
}

impl AtZero {
    /// About how deep the tool is pressed at its depth 0, mm.
    ///
    /// Hertz: force grows as the true depth to the power 1.5.
    pub(crate) fn late_mm(&self) -> f64 {
        let share = (self.force_n / self.most_n).clamp(0.0, LATEST);
        let part = libm::cbrt(share).powi(2);
        ((self.deepest_mm * part - self.depth_mm) / (1.0 - part)).max(0.0)
    }
}

/// About how late a recording's depth 0 is, mm, so that it is pressed so much deeper than it says; 0 where there is no clear force at it.
pub(crate) fn late_of(measured: &Measured) -> f64 {
    let is_force = |s: &&Sample| s.quantity == Quantity::Force;
    let samples: Vec<&Sample> = measured.samples.iter().filter(is_force).collect();
    let of = |s: &&Sample| (measured.moments[s.moment as usize].depth_mm, s.value);
    match at_zero(&samples, of) {
        Some(seen) if seen.force_n > AT_ZERO_OF_PEAK * seen.most_n => seen.late_mm(),
        _ => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    #[test]
    fn first_touch_is_found_at_the_force_onset() {
        let mut random = Random::new(2);
        let travel: Vec<f64> = (0..3000).map(|k| f64::from(k) * 1e-3).collect();
        let clean = |t: &f64| (t - 1.0f64).max(0.0).powf(1.5) + 0.3;
        let force: Vec<f64> = travel
            .iter()
            .map(|t| clean(t) + 1e-3 * random.normal())
            .collect();
        let onset = onset(&travel, &force);
        let at = travel[onset.sample];
        assert!((at - 1.0).abs() < 0.1, "{at}");
        assert!((onset.rest_n - 0.3).abs() < 1e-3);
    }

    /// Readings of a Hertz press whose depths begin late, from `from` on, with a force zero that is off.
    fn press((late, from, off): (f64, f64, f64)) -> Vec<(f64, f64)> {
        (0..60)
            .map(|k| 0.025 * f64::from(k) + from)
            .map(|depth| (depth, (depth + late).max(0.0).powf(1.5) + off))
            .collect()
    }

    #[test]
    fn how_late_depth_zero_is_follows_from_the_force_at_it() {
        // The last starts to record as its trigger is passed.
        for (late, from, off) in [
            (0.2, -0.31, 0.0),
            (0.0, -0.31, 0.0),
            (0.2, -0.31, 3.0),
            (0.2, 0.01, 0.0),
            (0.2, 0.07, 0.0),
            (0.0, 0.07, 0.0),
        ] {
            let seen = at_zero(&press((late, from, off)), |one| *one).unwrap();
            let found = seen.late_mm();
            assert!((found - late).abs() < 0.03, "{late} {from} {off}: {found}");
        }
        let deeper = at_zero(&press((0.2, 0.2, 0.0)), |one| *one);
        assert!(deeper.is_none() && at_zero(&[(f64::NAN, 1.0)], |one| *one).is_none());
        let constant = at_zero(&[(0.0, 1.0), (1.0, 1.0)], |one| *one).unwrap();
        assert!(constant.late_mm() < 1.0, "at most as deep again");
    }
}
