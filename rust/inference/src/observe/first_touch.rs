//! First touch from the force onset, for recordings that give travel without a point of first touch.

use crate::observe::robust_scale::{median, noise_of};

/// Standard deviations of noise that a force must exceed.
const RISES: f64 = 5.0;
/// Part of the largest force that it must exceed as well: drift of the instrument before the touch.
const RISES_OF_PEAK: f64 = 0.01;
/// Part of the approach over which the force at rest is taken.
const AT_REST: f64 = 0.1;

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
}
