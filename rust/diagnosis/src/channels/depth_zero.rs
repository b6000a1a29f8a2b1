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

/// Distance that is worth a sentence, mm: where the form of the model is known, and where it is off by some percent, which a fit also meets with
/// a first touch that is off. How many standard errors it must be.
const WORTH_MM: (f64, f64) = (0.03, 0.06);
const SURE: f64 = 4.0;

/// A sentence for each tool at a site whose depths, as the files give them, begin clearly before or after first touch. None where the fit may
/// have taken something else for it: nothing is decided, something is suspected, or the zero of the force is off.
pub(crate) fn depth_zero_notes(
    study: &Study,
    (ready, rungs): (&PreparedStudy, &Rungs),
    decision: &Decision<'_>,
) -> Vec<String> {
    let scored = decision.named.unwrap_or(&rungs.base);
    if !is_decided(decision) {
        return Vec::new();
    }
    let surrogate = ready.surrogate();
    let model = Model::new(&surrogate, &scored.mechanisms);
    let is_exact = is_form_known(&ready.elastic);
    let all = model.coordinates.iter().enumerate();
    let sentences = all.filter_map(|(k, coordinate)| {
        let Kind::Touch(place) = coordinate.kind else {
            return None;
        };
        let course = ready.courses.iter().find(|c| c.place == place)?;
        let recording = &study.recordings[course.recording];
        let gives_depth = matches!(&recording.data, Data::Indentation(curve) if curve.channel("depth_mm").is_some());
        let error = scored.refit.covariance[(k, k)].max(0.0).sqrt();
        let found = sentence((scored.refit.at[k], error), is_exact).filter(|_| gives_depth)?;
        Some(format!(
            "depth 0 of {} at {} {found}",
            recording.indenter, recording.site
        ))
    });
    sentences.collect()
}

/// Whether a fitted first touch is what it says.
fn is_decided(decision: &Decision<'_>) -> bool {
    let is_said = match decision.verdict {
        Verdict::NothingMissing | Verdict::Parameters => decision.suspected.is_empty(),
        Verdict::MissingPhysics | Verdict::Instrument => true,
        _ => false,
    };
    let has_other_zero = |named: &Scored| {
        named
            .mechanisms
            .iter()
            .any(|m| matches!(m.effect, Effect::Offset | Effect::Drift))
    };
    is_said && !decision.named.is_some_and(has_other_zero)
}

/// What is said of a first touch at that depth with its standard error, mm; None where it is not clearly off. `is_exact`: the form of the model is
/// known, so that an interval holds.
fn sentence((touch_mm, error): (f64, f64), is_exact: bool) -> Option<String> {
    let size = touch_mm.abs();
    let worth = if is_exact { WORTH_MM.0 } else { WORTH_MM.1 };
    if size < worth || size < SURE * error {
        return None;
    }
    let half = HALF * error;
    let by = match is_exact {
        true => format!(
            "{size:.2} mm (90 %: {:.2} to {:.2})",
            size - half,
            size + half
        ),
        false => format!("about {size:.2} mm"),
    };
    Some(match touch_mm < 0.0 {
        true => format!(
            "is late: in all recordings the tool touches the skin {by} above it, as where a trigger of the force begins the depth. The fit allows for it"
        ),
        false => format!(
            "is early: in all recordings the tool touches the skin {by} below it. The fit allows for it"
        ),
    })
}

#[cfg(test)]
mod tests {
    use super::sentence;

    #[test]
    fn a_zero_is_said_to_be_off_only_where_that_is_clear_and_in_its_direction() {
        let late = sentence((-0.1, 0.01), true).unwrap();
        assert!(
            late.contains("is late") && late.contains("0.10 mm (90 %: 0.08 to 0.12) above"),
            "{late}"
        );
        let early = sentence((0.1, 0.01), false).unwrap();
        assert!(
            early.contains("is early") && early.contains("about 0.10 mm below"),
            "{early}"
        );
        assert_eq!(
            sentence((-0.1, 0.03), true),
            None,
            "it may be no more than noise"
        );
        assert_eq!(sentence((-0.02, 1e-4), true), None, "too small to matter");
        assert_eq!(
            sentence((-0.05, 1e-4), false),
            None,
            "the form may do as much"
        );
    }
}
