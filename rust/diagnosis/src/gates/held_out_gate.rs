//! Gate of prediction: whatever is named must predict recordings that it was not fitted to.

use thenar_contact::effects::Effect;

use crate::gates::decision::{self, Decision};
use crate::wording::effect_in_words;
use thenar_inference::forward::surrogate::prepared_study::PreparedStudy;
use thenar_inference::observe::measured::Measured;
use thenar_inference::selection::cross_validation::{Gain, gain};
use thenar_inference::selection::scored::{Rungs, Scored};

/// Share of the reducible error of held-out recordings that a name must remove. Names that were wrong on studies by other finite elements
/// removed -1 to 28 %, right ones 54 to 95 %; on the calibration right ones as small as half the noise remove 34 %, a wrong one 25 %.
const LEAST: f64 = 0.3;
/// Share that each of two must remove of what the other alone leaves.
const LEAST_OF_REST: f64 = 0.1;
/// Share from which one of two is named when the other does not predict, though repeats agree on more than it explains.
const ALONE: f64 = 0.5;

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
    let of = |scored: &Scored| gain(ready, measured, scored, seed);
    let Some(mut all) = of(named) else {
        return (decision, None);
    };
    let mut alone = Vec::new();
    if let [first, second] = &named.mechanisms[..] {
        for (one, other) in [(first, second), (second, first)] {
            if one.effect == Effect::Gain {
                continue;
            }
            let is_other = |s: &&Scored| s.mechanisms[0].effect == other.effect;
            let Some(single) = rungs.singles.iter().find(is_other) else {
                continue;
            };
            let Some(own) = of(single) else {
                continue;
            };
            let share = share_of_rest(all.removed, own.removed);
            all.members.push((one.effect.name(), share));
            alone.push((single, own, share));
        }
    }
    alone.sort_by(|a, b| a.2.total_cmp(&b.2));
    // The one that adds least goes first, and what is left stands for itself.
    if let Some((single, own, share)) = alone.into_iter().next()
        && share < LEAST_OF_REST
    {
        let is_kept = !is_refuted(single, &own) && own.removed >= ALONE;
        return match is_kept {
            true => (without_the_other(single, named), Some(own)),
            false => (unnamed(ready, rungs, named), None),
        };
    }
    match is_refuted(named, &all) {
        true => (unnamed(ready, rungs, named), None),
        false => (decision, Some(all)),
    }
}

/// Share that a pair removes of what one of its members alone leaves, where both shares are of the same error.
fn share_of_rest(both: f64, one: f64) -> f64 {
    (both - one) / (1.0 - one).max(1e-3)
}

/// One of two is named, since the other does not predict what it leaves.
fn without_the_other<'a>(single: &'a Scored, pair: &Scored) -> Decision<'a> {
    let other = pair
        .mechanisms
        .iter()
        .find(|m| m.effect != single.mechanisms[0].effect);
    let other = other.map_or_else(String::new, |m| effect_in_words(m.effect.name()));
    decision::named(
        single,
        &format!(
            "with {other} it would fit better, but not predict recordings that were held out better"
        ),
    )
}

/// Nothing listed is there, since what would be named does not predict.
fn unnamed<'a>(ready: &PreparedStudy, rungs: &'a Rungs, named: &Scored) -> Decision<'a> {
    let names: Vec<String> = named
        .names()
        .iter()
        .map(|name| effect_in_words(name))
        .collect();
    let reason = format!(
        "{} is suspected, since it explains more than noise would, but with it recordings that it was not fitted to are predicted hardly \
         better than without",
        names.join(" and ")
    );
    Decision {
        reason,
        ..decision::undetected(ready, rungs)
    }
}

/// True of what does not predict recordings that were held out. A gain that changes within the session cannot be held to that: every
/// recording's own gain is fitted to itself.
fn is_refuted(named: &Scored, gain: &Gain) -> bool {
    let is_gain = named.mechanisms.iter().all(|m| m.effect == Effect::Gain);
    !is_gain && !predicts(gain.removed, gain.placebo)
}

/// Whether a share of the reducible error that is removed is enough, and more than its placebo removes.
fn predicts(removed: f64, placebo: Option<f64>) -> bool {
    match placebo {
        Some(placebo) => removed > placebo && removed >= LEAST,
        // There was nothing to remove.
        None => removed > 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_must_predict_and_beat_its_placebo() {
        assert!(predicts(0.8, Some(0.05)));
        assert!(!predicts(0.25, Some(0.05)), "too little");
        assert!(!predicts(0.35, Some(0.4)), "no better than its placebo");
        assert!(!predicts(-4.0, None));
        assert!(predicts(0.4, None));
    }

    /// Of a tenth that the other leaves half is much; of a half that it leaves a hundredth is nothing.
    #[test]
    fn a_second_effect_must_predict_what_the_first_leaves() {
        assert!(share_of_rest(0.95, 0.9) > LEAST_OF_REST);
        assert!(share_of_rest(0.51, 0.5) < LEAST_OF_REST);
        assert!(share_of_rest(0.7, 0.8) < 0.0);
    }
}
