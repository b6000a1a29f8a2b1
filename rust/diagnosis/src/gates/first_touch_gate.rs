//! Gate of first touch: what bends the start of a curve is no finding where its fit needs a depth 0 that is off as well.
//!
//! Where a tissue gives way at some depth, or does anything else that no listed effect does, a stiff skin follows the curve if the first touch
//! may move with it. With a true stiff skin, stiffening law or bone, and depths that begin at first touch, the fit leaves it there. Where depths do
//! not begin there, as after a trigger, such an effect is suspected only, until it is stated how well first touch is known.

use thenar_contact::effects::Effect;
use thenar_inference::forward::surrogate::prepared_study::PreparedStudy;
use thenar_inference::observe::measured::Measured;
use thenar_inference::selection::scored::{Rungs, Scored};
use thenar_recordings::Study;

use crate::channels::depth_zero::{BEND_THE_START, FirstTouch, KNOWN_MM, fitted_off, in_words};
use crate::gates::size_gate::{self, Narrowed, Sized};
use crate::wording::effect_in_words;

/// What the gates before this one decide, without effects that bend the start of a curve together with a first touch that is off and of which
/// the study does not say how well it is known.
pub fn decide<'a>(
    study: &Study,
    (ready, rungs): (&PreparedStudy, &'a Rungs),
    measured: &[Measured],
    seed: u64,
) -> Sized<'a> {
    let sized = size_gate::decide(ready, rungs, measured, seed);
    let sheet = study.instrument.as_ref();
    let stated = sheet.and_then(|sheet| sheet.first_touch_mm);
    let is_known = stated.is_some_and(|mm| mm <= KNOWN_MM);
    let Some(named) = sized.decision.named.filter(|_| !is_known) else {
        return sized;
    };
    match refused(named, &fitted_off(study, ready, named)) {
        None => sized,
        Some((kept, reason)) => {
            let narrowed = Narrowed {
                named,
                kept,
                reason: sized.decision.with_reason(reason),
                suspected: sized.decision.suspected,
            };
            narrowed.decide((ready, rungs), measured, seed)
        }
    }
}

/// The effects that are kept, and why others are not; None where all are. `off`: first touches that the fit moves.
fn refused(named: &Scored, off: &[FirstTouch]) -> Option<(Vec<Effect>, String)> {
    let effects = named.mechanisms.iter().map(|m| m.effect);
    let (bending, kept): (Vec<Effect>, Vec<Effect>) =
        effects.partition(|effect| BEND_THE_START.contains(effect));
    let is_zero = |effect| matches!(effect, &Effect::Offset | &Effect::Drift);
    // Next to a zero of the force that is off, a first touch says nothing.
    if bending.is_empty() || off.is_empty() || kept.iter().any(is_zero) {
        return None;
    }
    let names: Vec<String> = bending.iter().map(|e| effect_in_words(e.name())).collect();
    let reason = format!(
        "{} is suspected: it fits only with a depth 0 that is off as well ({}), and together they may stand for something that is on no list. If you \
         know first touch well, from an electric contact or a camera, state how well (first_touch_mm in [instrument], {KNOWN_MM} or less)",
        names.join(" and "),
        in_words(off).join(", ")
    );
    Some((kept, reason))
}

#[cfg(test)]
mod tests {
    use super::refused;
    use crate::synthetic_rungs::scored;
    use thenar_contact::effects::Effect::{Offset, Relaxation, StiffSkin, Timing};

    #[test]
    fn what_bends_the_start_is_refused_where_depth_0_is_off_as_well() {
        let off = [("ball at pad".to_owned(), (0.05, 0.005))];
        assert_eq!(refused(&scored(&[StiffSkin], 30.0), &[]), None);
        assert_eq!(refused(&scored(&[Relaxation], 30.0), &off), None);
        assert_eq!(refused(&scored(&[Offset, StiffSkin], 30.0), &off), None);
        let (kept, reason) = refused(&scored(&[StiffSkin], 30.0), &off).unwrap();
        assert!(kept.is_empty());
        assert!(
            reason.contains("0.05 mm early with ball at pad") && reason.contains("first_touch_mm"),
            "{reason}"
        );
        let (kept, reason) = refused(&scored(&[StiffSkin, Timing], 30.0), &off).unwrap();
        assert_eq!(kept, [Timing]);
        assert!(
            reason.starts_with("a stiff skin") && !reason.contains("clock"),
            "{reason}"
        );
    }
}
