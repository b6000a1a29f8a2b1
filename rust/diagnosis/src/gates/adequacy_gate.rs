//! Gate of adequacy: what is named must leave no short waves that recordings share.

use thenar_contact::effects::Effect;
use thenar_inference::checks::short_waves::ShortWaves;
use thenar_inference::forward::surrogate::prepared_study::PreparedStudy;
use thenar_inference::observe::measured::Measured;
use thenar_inference::selection::ladder::short_waves_left;
use thenar_inference::selection::scored::{Rungs, Scored};
use thenar_recordings::Study;

use crate::findings::Verdict;
use crate::gates::decision::silent;
use crate::gates::first_touch_gate;
use crate::gates::size_gate::Sized;
use crate::gates::waves_gate::in_words;
use crate::wording::effect_in_words;

/// Standard errors of the waves that what is named leaves, from which it is not enough: more than where nothing is named (`waves_gate`), since a
/// right name may be off at a corner of the motion.
const LEFT: f64 = 6.0;
/// Part of the range of forces from which these waves are more than a lead screw or an encoder makes: 2 um of 1 mm.
const LEFT_PART: f64 = 0.004;

/// What the gates before this one decide, unless recordings share short waves in what the named effects leave: then these are suspected only.
pub fn decide<'a>(
    study: &Study,
    (ready, rungs): (&PreparedStudy, &'a Rungs),
    measured: &[Measured],
    seed: u64,
) -> Sized<'a> {
    let sized = first_touch_gate::decide(study, (ready, rungs), measured, seed);
    // Where forces end at a ceiling or a floor, predictions go on.
    let is_cut = |m: Effect| matches!(m, Effect::Saturation | Effect::Threshold);
    let all_read = |named: &&Scored| !named.mechanisms.iter().any(|m| is_cut(m.effect));
    let Some(named) = sized.decision.named.filter(all_read) else {
        return sized;
    };
    match short_waves_left(ready, named).and_then(|waves| not_enough(named, waves)) {
        None => sized,
        Some(reason) => Sized {
            decision: silent(Verdict::Unlisted, &sized.decision.with_reason(reason))
                .suspecting(&sized.decision.with_suspected(&named.names())),
            gain: None,
            profiled: Vec::new(),
        },
    }
}

/// Why what would be named is not enough, if recordings clearly share waves in what it leaves.
fn not_enough(named: &Scored, left: ShortWaves) -> Option<String> {
    let is_left = left.standard_errors > LEFT && left.part > LEFT_PART;
    is_left.then(|| {
        let names = named.names();
        let names: Vec<String> = names.iter().map(|name| effect_in_words(name)).collect();
        format!(
            "{} would not be enough: {}",
            names.join(" and "),
            in_words(left)
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::synthetic_rungs::scored;
    use thenar_contact::effects::Effect::Relaxation;

    #[test]
    fn what_leaves_clear_waves_is_not_enough() {
        let of = |standard_errors, part| ShortWaves {
            standard_errors,
            rms_n: 0.004,
            part,
            is_by_depth: true,
        };
        let named = scored(&[Relaxation], 40.0);
        assert_eq!(not_enough(&named, of(5.0, 0.02)), None);
        assert_eq!(
            not_enough(&named, of(15.0, 0.002)),
            None,
            "as small as an encoder makes"
        );
        let words = not_enough(&named, of(15.0, 0.02)).unwrap();
        assert!(
            words.starts_with("relaxation of the tissue would not be enough: recordings share"),
            "{words}"
        );
    }
}
