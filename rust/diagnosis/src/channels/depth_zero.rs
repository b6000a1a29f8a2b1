//! Where depth counts from: how far that lies from first touch, alike in all recordings of a tool at a site.

use thenar_contact::effects::Effect;
use thenar_inference::forward::surrogate::candidate_model::Model;
use thenar_inference::forward::surrogate::prepared_study::PreparedStudy;
use thenar_inference::parameters::surrogate_parameter::Kind;
use thenar_inference::parameters::surrogate_priors::is_form_known;
use thenar_inference::selection::scored::{Rungs, Scored};
use thenar_recordings::Study;
use thenar_recordings::study::Data;

use crate::findings::Verdict;
use crate::free_numbers::HALF;
use crate::gates::decision::Decision;

/// How well a first touch must be known that tells what bends the start of a curve from one that is off, mm.
pub(crate) const KNOWN_MM: f64 = 0.03;
/// Distance that is worth a sentence, mm: where the form of the model is known, and where it is off by some percent, which a fit also meets with
/// a first touch that is off. How many standard errors it must be.
const WORTH_MM: (f64, f64) = (KNOWN_MM, 0.06);
const SURE: f64 = 4.0;

/// A sentence for each tool at a site whose depths, as the files give them, begin clearly before or after first touch. Where something else may
/// have been taken for it, since something is only suspected, it says how that is settled; None where nothing is decided, or the zero of the
/// force is off.
pub(crate) fn depth_zero_notes(
    study: &Study,
    (ready, rungs): (&PreparedStudy, &Rungs),
    decision: &Decision<'_>,
) -> Vec<String> {
    let scored = decision.named.unwrap_or(&rungs.base);
    let Some(what) = decided(decision) else {
        return Vec::new();
    };
    // A gate that refused an effect for it has asked already.
    let is_asked = is_stated(study) || decision.reason.contains("first_touch_mm");
    if what == Decided::Suspected && is_asked {
        return Vec::new();
    }
    let is_exact = is_form_known(&ready.elastic);
    let off = fitted_off(study, ready, scored);
    match what {
        Decided::Said => off
            .iter()
            .map(|(tool, touch)| format!("depth 0 of {tool} {}", sentence(*touch, is_exact)))
            .collect(),
        Decided::Suspected => open_sentence(&off).into_iter().collect(),
    }
}

/// Whether the study says how well first touch is known.
fn is_stated(study: &Study) -> bool {
    let sheet = study.instrument.as_ref();
    sheet.is_some_and(|sheet| sheet.first_touch_mm.is_some())
}

/// A tool at a site, and the depth of its first touch with its standard error, mm.
pub(crate) type FirstTouch = (String, (f64, f64));

/// Those tools at a site whose depths, as the files give them, begin clearly before or after first touch, as an explanation fits it.
pub(crate) fn fitted_off(study: &Study, ready: &PreparedStudy, scored: &Scored) -> Vec<FirstTouch> {
    let surrogate = ready.surrogate();
    let model = Model::new(&surrogate, &scored.mechanisms);
    let is_exact = is_form_known(&ready.elastic);
    let off = model.coordinates.iter().enumerate().filter_map(|(k, coordinate)| {
        let Kind::Touch(place) = coordinate.kind else {
            return None;
        };
        let course = ready.courses.iter().find(|c| c.place == place)?;
        let recording = &study.recordings[course.recording];
        let gives_depth = matches!(&recording.data, Data::Indentation(curve) if curve.channel("depth_mm").is_some());
        let error = scored.refit.covariance[(k, k)].max(0.0).sqrt();
        let touch = (scored.refit.at[k], error);
        let tool = format!("{} at {}", recording.indenter, recording.site);
        (gives_depth && is_off(touch, is_exact)).then_some((tool, touch))
    });
    off.collect()
}

/// What was decided, and so what a fitted first touch says.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Decided {
    /// A verdict with which a fitted first touch is what it says.
    Said,
    /// Something is suspected, for which a first touch that is off may stand.
    Suspected,
}

/// None where no fitted first touch is worth a word.
fn decided(decision: &Decision<'_>) -> Option<Decided> {
    let has_other_zero = |named: &Scored| {
        let is_zero = |effect| matches!(effect, Effect::Offset | Effect::Drift);
        named.mechanisms.iter().any(|m| is_zero(m.effect))
    };
    match decision.verdict {
        Verdict::NothingMissing | Verdict::Parameters => match decision.suspected.is_empty() {
            true => Some(Decided::Said),
            false => bend_the_start(&decision.suspected).then_some(Decided::Suspected),
        },
        Verdict::MissingPhysics | Verdict::Instrument => {
            (!decision.named.is_some_and(has_other_zero)).then_some(Decided::Said)
        }
        _ => None,
    }
}

/// Effects that bend the start of a curve as a first touch that is off does.
pub(crate) const BEND_THE_START: [Effect; 4] = [
    Effect::StiffSkin,
    Effect::StiffeningLaw,
    Effect::Bone,
    Effect::Compressibility,
];

/// Whether one of these effects bends the start of a curve as a first touch that is off does, and none is a zero of the force.
fn bend_the_start(names: &[&str]) -> bool {
    let zeros = [Effect::Offset, Effect::Drift];
    let is_one = |of: &[Effect]| names.iter().any(|n| of.iter().any(|e| e.name() == *n));
    is_one(&BEND_THE_START) && !is_one(&zeros)
}

/// Whether a first touch at that depth with its standard error, mm, is clearly off.
fn is_off((touch_mm, error): (f64, f64), is_exact: bool) -> bool {
    let worth = if is_exact { WORTH_MM.0 } else { WORTH_MM.1 };
    touch_mm.abs() >= worth && touch_mm.abs() >= SURE * error
}

/// What is said of them where something is suspected that bends the start of a curve likewise; None if there are none.
fn open_sentence(off: &[FirstTouch]) -> Option<String> {
    let all = in_words(off);
    (!all.is_empty()).then(|| {
        format!(
            "depth 0 is fitted to be {}, which may stand for an effect that bends the start of a curve alike (a stiff skin, a stiffening law, a bone). \
             If you know first touch well, from an electric contact or a camera, state how well (first_touch_mm in [instrument]) to have such effects named",
            all.join(", ")
        )
    })
}

/// Each in words, with its size and side.
pub(crate) fn in_words(off: &[FirstTouch]) -> Vec<String> {
    let one = |(tool, (touch_mm, _)): &FirstTouch| {
        let side = if *touch_mm < 0.0 { "late" } else { "early" };
        format!("{:.2} mm {side} with {tool}", touch_mm.abs())
    };
    off.iter().map(one).collect()
}

/// What is said of a first touch that is clearly off, at that depth with its standard error, mm. `is_exact`: the form of the model is known, so
/// that an interval holds.
fn sentence((touch_mm, error): (f64, f64), is_exact: bool) -> String {
    let size = touch_mm.abs();
    let half = HALF * error;
    let by = match is_exact {
        true => format!(
            "{size:.2} mm (90 %: {:.2} to {:.2})",
            size - half,
            size + half
        ),
        false => format!("about {size:.2} mm"),
    };
    match touch_mm < 0.0 {
        true => format!(
            "is late: in all recordings the tool touches the skin {by} above it, as where a trigger of the force begins the depth. The fit allows for it"
        ),
        false => format!(
            "is early: in all recordings the tool touches the skin {by} below it. The fit allows for it"
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::{bend_the_start, is_off, open_sentence, sentence};

    #[test]
    fn a_zero_is_said_to_be_off_only_where_that_is_clear_and_in_its_direction() {
        let late = sentence((-0.1, 0.01), true);
        assert!(
            late.contains("is late") && late.contains("0.10 mm (90 %: 0.08 to 0.12) above"),
            "{late}"
        );
        let early = sentence((0.1, 0.01), false);
        assert!(
            early.contains("is early") && early.contains("about 0.10 mm below"),
            "{early}"
        );
        assert!(is_off((-0.1, 0.01), true) && is_off((0.1, 0.01), false));
        assert!(!is_off((-0.1, 0.03), true), "it may be no more than noise");
        assert!(!is_off((-0.02, 1e-4), true), "too small to matter");
        assert!(!is_off((-0.05, 1e-4), false), "the form may do as much");
    }

    #[test]
    fn a_first_touch_that_may_stand_for_an_effect_asks_how_well_it_is_known() {
        let off = [
            ("ball at pad".to_owned(), (-0.13, 0.008)),
            ("plate at pad".to_owned(), (0.09, 0.008)),
        ];
        let said = open_sentence(&off).unwrap();
        assert!(
            said.contains("0.13 mm late with ball at pad, 0.09 mm early with plate at pad")
                && said.contains("first_touch_mm"),
            "{said}"
        );
        assert_eq!(open_sentence(&[]), None);
        assert!(bend_the_start(&["stiffening_law"]) && bend_the_start(&["relaxation", "bone"]));
        assert!(!bend_the_start(&["relaxation"]) && !bend_the_start(&["bone", "drift"]));
    }
}
