//! Stages 7 to 10: from what the parameters leave to a diagnosis.
//!
//! Conducts the ladder noise, parameters, instrument, one effect, two effects, unlisted. Screening models the force of every recording
//! by tables of elastic presses and springs that remember (`memory.rs`), under the same noise and priors as the fit.

mod acting;
mod balls;
mod borne_out;
mod checks;
mod choices;
mod course;
mod elastic;
mod empirical;
mod findings;
mod findings_json;
mod gain;
mod gates;
mod ladder;
mod local;
#[cfg(test)]
mod made;
mod mechanism;
mod memory;
mod model;
mod next_record;
mod numbers;
mod placebo;
mod planned;
mod possible;
mod posterior;
mod prepare;
mod promise;
mod refine;
mod refit;
mod screen;
mod sentence;
mod shown;
mod signs;
mod skins;
mod slopes;
mod spectrum;
mod stiffness;
mod trial;
mod unlisted;

pub use findings::{
    Curve, Diagnosis, Finding, Gain, Number, Rival, Spread, Suggestion, Switched, Verdict, When,
    Where,
};
pub use findings_json::findings_json;
pub use unlisted::{Correction, Unlisted, words};

use std::sync::{Mutex, PoisonError};

use thenar_contact::Control;
use thenar_recordings::Study;

use crate::comparison::Comparison;
use crate::fit::Fitting;
use crate::{DiagnosisError, Options, compare};
use course::Course;
use gates::Decision;
use ladder::Rungs;
use prepare::{Prepared, form_note, prepare};

/// What a diagnosis is asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct DiagnoseOptions {
    /// Seed of all that is drawn: the same seed gives the same bytes.
    pub seed: u64,
}

impl Default for DiagnoseOptions {
    fn default() -> Self {
        DiagnoseOptions { seed: 1 }
    }
}

/// Says what a study's recordings show that the model leaves out.
///
/// # Errors
/// [`DiagnosisError`]: skin, tools or mats that cannot be used, presses that fail, too few samples, or `Cancelled`.
pub fn diagnose(
    study: &Study,
    options: &DiagnoseOptions,
    control: &Control<'_>,
) -> Result<Diagnosis, DiagnosisError> {
    let parts = Parts::new(control);
    let asked = Options {
        seed: options.seed,
        ..Options::default()
    };
    let comparison = parts.run((0.0, 0.3), |within| compare(study, &asked, within))?;
    let quiet = Control {
        cancelled: control.cancelled,
        progress: &|_, _| {},
    };
    let mut fitting = Fitting::new(study, &quiet)?;
    step(control, ("pressing the tools", 0.3))?;
    if let Some(finer) = refine::refined(study, &fitting) {
        fitting = Fitting::new(&finer, &quiet)?;
    }
    let found = match prepare(study, &mut fitting, &quiet)? {
        Some(ready) => {
            let climb = |within: &Control<'_>| ladder::climb(&ready, fitting.measured(), within);
            let rungs = parts.run((0.4, 0.95), climb)?;
            let ladder = (&ready, &rungs);
            explained(study, (comparison, &mut fitting), ladder, (options, &quiet))?
        }
        None => local::without_curves(study, comparison),
    };
    step(control, ("diagnosing", 1.0))?;
    Ok(found)
}

fn step(control: &Control<'_>, (stage, share): (&str, f64)) -> Result<(), DiagnosisError> {
    let step = control.step(stage, share);
    step.map_err(|_| DiagnosisError::Cancelled)
}

/// Parts of a run, each of which begins its own count; what the caller is told does not fall.
struct Parts<'a> {
    control: &'a Control<'a>,
    furthest: Mutex<f64>,
}

impl<'a> Parts<'a> {
    fn new(control: &'a Control<'a>) -> Parts<'a> {
        Parts {
            control,
            furthest: Mutex::new(0.0),
        }
    }

    /// Runs a part that takes this stretch of the whole.
    fn run<T>(&self, (from, to): (f64, f64), part: impl FnOnce(&Control<'_>) -> T) -> T {
        let tell = |stage: &str, share: f64| {
            let share = from + (to - from) * share.clamp(0.0, 1.0);
            let mut furthest = self.furthest.lock().unwrap_or_else(PoisonError::into_inner);
            *furthest = f64::max(*furthest, share);
            (self.control.progress)(stage, *furthest);
        };
        part(&Control {
            cancelled: self.control.cancelled,
            progress: &tell,
        })
    }
}

/// What the rungs decide, and what should be recorded next.
fn explained(
    study: &Study,
    (comparison, fitting): (Comparison, &mut Fitting),
    (ready, rungs): (&Prepared, &Rungs),
    (options, quiet): (&DiagnoseOptions, &Control<'_>),
) -> Result<Diagnosis, DiagnosisError> {
    let (decision, gain) = borne_out::decide(ready, rungs, fitting.measured(), options.seed);
    let asked = (&decision.cannot_tell[..], quiet);
    let next = next_record::suggestions(study, fitting, (ready, rungs), asked)?;
    let ladder = (ready, rungs, decision);
    Ok(told(study, (comparison, fitting), (ladder, next, gain)))
}

/// What the recordings could not show.
fn untested(courses: &[Course]) -> Option<String> {
    let missing = match (course::goes_on(courses), course::unloads(courses)) {
        (false, _) if !course::changes_speed(courses) => {
            "memory, hysteresis, adhesion and drift were not tested: no recording holds, unloads or changes its speed"
        }
        (_, false) => "hysteresis and adhesion were not tested: no recording unloads",
        _ => return None,
    };
    Some(missing.to_owned())
}

/// What was prepared, what the rungs found, and what they decide.
type Climbed<'a> = (&'a Prepared, &'a Rungs, Decision<'a>);

/// All that is said, from what was found.
fn told(
    study: &Study,
    (comparison, fitting): (Comparison, &Fitting),
    ((ready, rungs, decision), next, gain): (Climbed<'_>, Vec<Suggestion>, Option<Gain>),
) -> Diagnosis {
    let probabilities = posterior::probabilities(rungs);
    let mut found = Diagnosis {
        comparison,
        verdict: decision.verdict,
        sentence: String::new(),
        findings: shown::findings(study, (ready, rungs), &decision, &probabilities),
        unlisted: None,
        names_90: posterior::names_90(&probabilities),
        cannot_tell: decision.cannot_tell.clone(),
        gain,
        smallest_seen: shown::smallest_seen(ready, rungs),
        record_next: next,
        materials: shown::materials(fitting, (ready, rungs), &decision),
        effects: shown::effects(ready, &decision),
        rivals: shown::rivals(ready, rungs, &probabilities),
        curves: shown::curves(ready, rungs, &decision),
        evidence: shown::evidence(ready, rungs),
        notes: vec![decision.reason.clone()],
    };
    if found.verdict == Verdict::InsufficientData {
        found.names_90 = Vec::new();
    }
    let mut reason = decision.reason.clone();
    let restless = checks::restless(&ready.noise, rungs.unsteady);
    found.notes.extend(restless.filter(|told| *told != reason));
    if found.verdict == Verdict::Unlisted {
        let described = unlisted::unlisted(study, ready, rungs);
        reason = format!("{reason}; {}", described.told());
        if let Some(correction) = &described.correction {
            unlisted::draw(ready, rungs, correction, &mut found.curves);
        }
        found.unlisted = Some(described);
    }
    add_notes(study, &mut found, ready);
    found.sentence = sentence::sentence(
        found.verdict,
        (&found.findings, found.gain.as_ref()),
        (&found.cannot_tell, &decision.beside, &found.record_next),
        &reason,
    );
    found
}

/// What a reader should be told besides, and the place that maps show.
fn add_notes(study: &Study, found: &mut Diagnosis, ready: &Prepared) {
    let is_no_better = |g: &Gain| g.placebo.is_some_and(|placebo| g.removed <= placebo);
    if found.gain.as_ref().is_some_and(is_no_better) {
        found.notes.push(
            "on held-out recordings the finding gains no more than its change on the wrong recordings at the wrong moments does"
                .to_owned(),
        );
    }
    local::add_place(study, found);
    found.notes.push(form_note(&ready.elastic));
    found.notes.extend(untested(&ready.courses));
}
