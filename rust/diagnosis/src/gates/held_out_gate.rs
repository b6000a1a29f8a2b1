//! Gate of prediction: an effect with a small QAIC gain must predict held-out recordings.

use crate::gates::decision::{self, Decision};
use crate::wording::effect_in_words;
use thenar_inference::forward::surrogate::mechanism::{Law, Mechanism};
use thenar_inference::forward::surrogate::prepared_study::PreparedStudy;
use thenar_inference::observe::measured::Measured;
use thenar_inference::selection::cross_validation::{Gain, gain};
use thenar_inference::selection::scored::{Rungs, Scored};

/// Evidence, nats, below which one effect of the skin must predict recordings that it was not fitted to better than nothing does. More
/// stands by itself: it may come from a single protocol, which none of the others predicts. On calibration cases this takes away one name, a
/// wrong one of 7.5 nats: softening where the load cell hums (`tests/trial/test_named.py`).
const SLIGHT: f64 = 8.0;
/// The same of a floor of the sensor, which every press passes twice: one that a single outlier shows reached 20.4 nats where nothing was
/// (second trial, fourth draw), those that were planted 120 and more (that trial's draws and the calibration).
const SLIGHT_FLOOR: f64 = 60.0;

/// What the rungs decide, and the gain of what is named.
pub fn decide<'a>(
    ready: &PreparedStudy,
    rungs: &'a Rungs,
    measured: &[Measured],
    seed: u64,
) -> (Decision<'a>, Option<Gain>) {
    let decision = decision::decide(ready, rungs);
    let Some(named) = decision.named else {
        return (decision, None);
    };
    let gain = gain(ready, measured, named, seed);
    let told = (&named.mechanisms[..], named.qaic_gain);
    let is_worse = |g: &Gain| is_refuted(told, (g.removed, g.placebo));
    match is_last(rungs, named) && gain.as_ref().is_some_and(is_worse) {
        true => (unnamed(ready, rungs, named), None),
        false => (decision, gain),
    }
}

/// True if nothing else on the list could be said in a floor's place; an effect of the skin that shows slightly leads what else there is.
fn is_last(rungs: &Rungs, named: &Scored) -> bool {
    let is_floor = |s: &Scored| matches!(s.mechanisms[0].law, Law::Floor(_));
    let mut others = rungs.singles.iter().filter(|s| !is_floor(s));
    let is_seen = |s: &Scored| s.qaic_gain >= decision::needed(&s.mechanisms[0]);
    !is_floor(named) || !others.any(is_seen)
}

/// Nothing listed is there, since what would be named does not predict.
fn unnamed<'a>(ready: &PreparedStudy, rungs: &'a Rungs, named: &Scored) -> Decision<'a> {
    let name = effect_in_words(named.mechanisms[0].effect.name());
    let reason = format!(
        "{name} would explain more than noise would, but not much more, and predicts recordings that it was not fitted to worse than nothing does"
    );
    Decision {
        reason,
        ..decision::undetected(ready, rungs)
    }
}

/// True of one effect of the skin, or a floor of the sensor, that shows slightly, and with which recordings that were held out are predicted
/// worse than without and no better than with its placebo; `removed`: share of the reducible error, with the placebo's.
fn is_refuted(
    (mechanisms, qaic_gain): (&[Mechanism], f64),
    (removed, placebo): (f64, Option<f64>),
) -> bool {
    let is_worse = removed <= 0.0 && placebo.is_some_and(|most| removed <= most);
    let slight = match mechanisms {
        [one] if matches!(one.law, Law::Floor(_)) => SLIGHT_FLOOR,
        [one] if !one.is_instrument() => SLIGHT,
        _ => 0.0,
    };
    qaic_gain < slight && is_worse
}

#[cfg(test)]
mod tests {
    use thenar_contact::effects::Effect;

    use super::*;
    use thenar_inference::forward::surrogate::mechanism::Stage;

    #[test]
    fn weak_skin_effect_must_predict_held_out_recordings() {
        let softening = Mechanism {
            effect: Effect::CycleSoftening,
            law: Law::Softening {
                travel_mm: 1.0,
                recovery_s: 60.0,
            },
        };
        let offset = Mechanism {
            effect: Effect::Offset,
            law: Law::Offset,
        };
        let (worse, better) = ((-0.2, Some(0.1)), (0.2, Some(0.1)));
        let one = std::slice::from_ref(&softening);
        assert!(is_refuted((one, 7.0), worse));
        assert!(!is_refuted((one, 7.0), better));
        assert!(!is_refuted((one, 7.0), (0.05, Some(0.1))));
        assert!(!is_refuted((one, 9.0), worse));
        assert!(!is_refuted((one, 7.0), (-0.1, Some(-0.2))));
        // Where nothing could be removed there is no placebo, and nothing to hold against it.
        assert!(!is_refuted((one, 7.0), (-0.2, None)));
        assert!(!is_refuted((std::slice::from_ref(&offset), 7.0), worse));
        assert!(!is_refuted((&[softening, offset], 7.0), worse));
    }

    /// A floor cuts every press, and so predicts those that it was not fitted to; one that an outlier shows does not.
    #[test]
    fn weak_sensor_floor_must_predict_held_out_recordings() {
        let floor = [Mechanism {
            effect: Effect::Threshold,
            law: Law::Floor(Stage::Last),
        }];
        let worse = (-0.02, Some(0.06));
        assert!(is_refuted((&floor, 20.4), worse));
        assert!(!is_refuted((&floor, 120.0), worse));
        assert!(!is_refuted((&floor, 20.4), (0.3, Some(0.06))));
        // One that predicts something, though not clearly more than its placebo, stays.
        assert!(!is_refuted((&floor, 20.4), (0.01, Some(0.06))));
    }
}
