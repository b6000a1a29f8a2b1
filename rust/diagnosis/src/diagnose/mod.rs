//! Stages 7 to 10: from what the parameters leave to a diagnosis.
//!
//! Conducts the ladder noise, parameters, instrument, one effect, two effects, unlisted. Screening models the force of every recording
//! by tables of elastic presses and springs that remember (`memory.rs`), under the same noise and priors as the fit.

mod acting;
mod checks;
mod choices;
mod course;
mod elastic;
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
mod posterior;
mod prepare;
mod promise;
mod refine;
mod refit;
mod screen;
mod sentence;
mod shown;
mod signs;
mod spectrum;
mod stiffness;
mod trial;

pub use findings::{
    Curve, Diagnosis, Finding, Gain, Number, Rival, Spread, Suggestion, Switched, Verdict, When,
    Where,
};
pub use findings_json::findings_json;

use std::sync::{Mutex, PoisonError};

use thenar_contact::Control;
use thenar_recordings::Study;

use crate::comparison::Comparison;
use crate::fit::Fitting;
use crate::{DiagnosisError, Options, compare};
use gates::Decision;
use ladder::Rungs;
use prepare::{Prepared, prepare};

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
    // Each part begins its own count; what the caller is told does not fall.
    let furthest = Mutex::new(0.0);
    let tell = |stage: &str, share: f64| {
        let mut furthest = furthest.lock().unwrap_or_else(PoisonError::into_inner);
        *furthest = f64::max(*furthest, share);
        (control.progress)(stage, *furthest);
    };
    let part = |from: f64, to: f64| {
        let tell = &tell;
        move |stage: &str, share: f64| tell(stage, from + (to - from) * share.clamp(0.0, 1.0))
    };
    let progress = part(0.0, 0.3);
    let within = Control {
        cancelled: control.cancelled,
        progress: &progress,
    };
    let asked = Options {
        seed: options.seed,
        ..Options::default()
    };
    let comparison = compare(study, &asked, &within)?;
    let quiet = Control {
        cancelled: control.cancelled,
        progress: &|_, _| {},
    };
    let mut fitting = Fitting::new(study, &quiet)?;
    control
        .step("pressing the tools", 0.3)
        .map_err(|_| DiagnosisError::Cancelled)?;
    let finer = refine::refined(study, &fitting);
    if let Some(finer) = &finer {
        fitting = Fitting::new(finer, &quiet)?;
    }
    let ready = prepare(study, &mut fitting, &quiet)?;
    let progress = part(0.4, 0.95);
    let within = Control {
        cancelled: control.cancelled,
        progress: &progress,
    };
    let rungs = match &ready {
        Some(ready) => Some(ladder::climb(ready, fitting.measured(), &within)?),
        None => None,
    };
    let found = match (&ready, &rungs) {
        (Some(ready), Some(rungs)) => {
            let decision = gates::decide(ready, rungs);
            let next = next_record::suggestions(
                study,
                &mut fitting,
                (ready, rungs),
                (&decision.cannot_tell, &quiet),
            )?;
            let ladder = (ready, rungs, decision);
            told(study, (comparison, &fitting), (ladder, next), options)
        }
        _ => local::without_curves(study, comparison),
    };
    control
        .step("diagnosing", 1.0)
        .map_err(|_| DiagnosisError::Cancelled)?;
    Ok(found)
}

/// What the recordings could not show.
fn untested(courses: &[course::Course]) -> Option<String> {
    let missing = match (course::goes_on(courses), course::unloads(courses)) {
        (false, _) if !course::changes_speed(courses) => {
            "memory, hysteresis, adhesion and drift were not tested: no recording holds, unloads or changes its speed"
        }
        (_, false) => "hysteresis and adhesion were not tested: no recording unloads",
        _ => return None,
    };
    Some(missing.to_owned())
}

/// All that is said, from what was found.
fn told(
    study: &Study,
    (comparison, fitting): (Comparison, &Fitting),
    ((ready, rungs, decision), next): ((&Prepared, &Rungs, Decision<'_>), Vec<Suggestion>),
    options: &DiagnoseOptions,
) -> Diagnosis {
    let probabilities = posterior::probabilities(rungs);
    let gain = decision
        .named
        .and_then(|named| gain::gain(ready, fitting.measured(), named, options.seed));
    let mut found = Diagnosis {
        comparison,
        verdict: decision.verdict,
        sentence: String::new(),
        findings: shown::findings(study, (ready, rungs), &decision, &probabilities),
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
    let is_no_better = |g: &Gain| g.placebo.is_some_and(|placebo| g.removed <= placebo);
    if found.gain.as_ref().is_some_and(is_no_better) {
        found.notes.push(
            "on held-out recordings the finding gains no more than its change on the wrong recordings at the wrong moments does"
                .to_owned(),
        );
    }
    local::add_place(study, &mut found);
    found.notes.extend(untested(&ready.courses));
    found.sentence = sentence::sentence(
        found.verdict,
        (&found.findings, found.gain.as_ref()),
        (&found.cannot_tell, &found.record_next),
        &decision.reason,
    );
    found
}
