//! Conducts a diagnosis: from what the fitted parameters leave to a verdict, findings, and the next recording.
//!
//! The ladder is noise, parameters, instrument, one effect, two effects, unlisted. Candidates are fitted with the surrogate model
//! (`forward::surrogate`), under the same noise and priors as the fit.

use std::sync::{Mutex, PoisonError};

use thenar_contact::Control;
use thenar_recordings::Study;

use crate::by_contact_model::Judging;
use crate::channels::mat_ceiling::{Ceiling, add_ceiling, with_ceiling};
use crate::channels::mat_gain::add_gain;
use crate::channels::slides::add_friction;
use crate::findings::{Diagnosis, Suggestion, Verdict};
use crate::gates::decision::Decision;
use crate::gates::pair_gates::is_pair;
use crate::gates::size_gate::{Sized, open_note};
use crate::grasp::diagnose_grasps;
use thenar_comparison::Comparison;
use thenar_comparison::compare;
use thenar_inference::checks::coarse_forces::coarse_forces_note;
use thenar_inference::errors::InferenceError;
use thenar_inference::fit::fitting::{Fitting, Options};
use thenar_inference::forward::surrogate::force_recording::ForceRecording;
use thenar_inference::forward::surrogate::prepared_study::{PreparedStudy, prepare};
use thenar_inference::parameters::surrogate_priors::form_note;
use thenar_inference::selection::cross_validation::Gain;
use thenar_inference::selection::scored::Rungs;

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
/// [`InferenceError`]: skin, tools or mats that cannot be used, presses that fail, too few samples, or `Cancelled`.
pub fn diagnose(
    study: &Study,
    options: &DiagnoseOptions,
    control: &Control<'_>,
) -> Result<Diagnosis, InferenceError> {
    if study.has_grasps() {
        return diagnose_grasps(study, control);
    }
    let parts = Parts::new(control);
    let clipped = with_ceiling(study);
    let study = clipped.as_ref().map_or(study, |(stated, _)| stated);
    let ceiling = clipped.as_ref().map(|(_, ceiling)| *ceiling);
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
    if let Some(finer) =
        thenar_inference::forward::setup::refinement::refined(study, &fitting.replay)
    {
        fitting = Fitting::new(&finer, &quiet)?;
    }
    let found = match prepare(study, &mut fitting.replay, &quiet)? {
        Some(ready) => {
            let climb = |within: &Control<'_>| {
                thenar_inference::selection::ladder::climb(&ready, fitting.measured(), within)
            };
            let rungs = parts.run((0.4, 0.8), climb)?;
            let ladder = (&ready, &rungs);
            let studied = (study, ceiling);
            parts.run((0.8, 1.0), |within| {
                let fitted = (comparison, &mut fitting);
                explained(studied, fitted, ladder, (options, within))
            })?
        }
        None => {
            let mut found = crate::place::without_curves(study, comparison);
            ceiling
                .into_iter()
                .for_each(|seen| add_ceiling(&mut found, seen));
            found
        }
    };
    step(control, ("diagnosing", 1.0))?;
    Ok(found)
}

fn step(control: &Control<'_>, (stage, share): (&str, f64)) -> Result<(), InferenceError> {
    let step = control.step(stage, share);
    step.map_err(|_| InferenceError::Cancelled)
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
    (study, ceiling): (&Study, Option<Ceiling>),
    (comparison, fitting): (Comparison, &mut Fitting),
    (ready, rungs): (&PreparedStudy, &Rungs),
    (options, control): (&DiagnoseOptions, &Control<'_>),
) -> Result<Diagnosis, InferenceError> {
    let quiet = Control {
        cancelled: control.cancelled,
        progress: &|_, _| {},
    };
    let measured = fitting.measured();
    let mut sized =
        crate::gates::adequacy_gate::decide(study, (ready, rungs), measured, options.seed);
    let asked = (&sized.decision.cannot_tell[..], &quiet);
    let next =
        crate::next_recording::suggestions(study, &mut fitting.replay, (ready, rungs), asked)?;
    let judging = Judging {
        ready,
        rungs,
        seed: options.seed,
    };
    let failed = crate::by_contact_model::check(&mut sized, fitting, &judging, control)?;
    let mut found = told(
        (study, ceiling),
        (comparison, fitting),
        ((ready, rungs, sized), next),
    );
    found.notes.extend(failed);
    crate::by_contact_model::switch_on(&mut found);
    Ok(found)
}

/// What the recordings could not show.
fn untested(courses: &[ForceRecording]) -> Option<String> {
    let missing = match (
        thenar_inference::forward::surrogate::force_recording::goes_on(courses),
        thenar_inference::forward::surrogate::force_recording::unloads(courses),
    ) {
        (false, _)
            if !thenar_inference::forward::surrogate::force_recording::changes_speed(courses) =>
        {
            "memory, hysteresis, adhesion and drift were not tested: no recording holds, unloads or changes its speed"
        }
        (_, false) => "hysteresis and adhesion were not tested: no recording unloads",
        _ => return None,
    };
    Some(missing.to_owned())
}

/// What was prepared, what the rungs found, and what they decide.
type Climbed<'a> = (&'a PreparedStudy, &'a Rungs, Sized<'a>);

/// All that is said, from what was found.
fn told(
    (study, ceiling): (&Study, Option<Ceiling>),
    (comparison, fitting): (Comparison, &Fitting),
    ((ready, rungs, sized), next): (Climbed<'_>, Vec<Suggestion>),
) -> Diagnosis {
    let decision = &sized.decision;
    let probabilities = thenar_inference::selection::model_weights::probabilities(rungs, |pair| {
        is_pair(pair, rungs)
    });
    let mut found = Diagnosis {
        comparison,
        verdict: decision.verdict,
        sentence: String::new(),
        findings: crate::findings_content::findings(study, (ready, rungs), &sized, &probabilities),
        unlisted: None,
        names_90: thenar_inference::selection::model_weights::names_90(&probabilities),
        cannot_tell: decision.cannot_tell.clone(),
        suspected: decision.suspected.clone(),
        is_more_than_noise: decision.is_more_than_noise,
        gain: sized.gain.clone(),
        smallest_seen: crate::gates::detection_limits::smallest_seen(ready, rungs),
        record_next: next,
        materials: crate::findings_content::materials(&fitting.replay, (ready, rungs), decision),
        effects: crate::findings_content::effects(ready, &sized),
        rivals: crate::findings_content::rivals(ready, rungs, &probabilities),
        curves: crate::findings_content::curves(ready, rungs, decision),
        evidence: crate::findings_content::evidence(ready, rungs),
        notes: vec![decision.reason.clone()],
    };
    found.names_90 = with_what_is_said(found.names_90, decision);
    let mut reason = decision.reason.clone();
    let unmodeled_repeat_noise =
        thenar_inference::checks::heteroscedasticity::unmodeled_repeat_noise(
            &ready.noise,
            rungs.heteroscedasticity,
        );
    found
        .notes
        .extend(unmodeled_repeat_noise.filter(|told| *told != reason));
    if found.verdict == Verdict::Unlisted {
        let described = crate::unlisted::unlisted(study, ready, rungs);
        reason = format!("{reason}; {}", described.told());
        if let Some(correction) = &described.correction {
            crate::unlisted::draw(ready, rungs, correction, &mut found.curves);
        }
        found.unlisted = Some(described);
    }
    found
        .notes
        .extend(decision.named.and_then(crate::effect_numbers::use_note));
    found
        .notes
        .extend(crate::channels::depth_zero::depth_zero_notes(
            study,
            (ready, rungs),
            decision,
        ));
    let open: Vec<String> = found.findings.iter().filter_map(open_note).collect();
    found.notes.extend(open);
    add_notes(study, &mut found, ready);
    ceiling
        .into_iter()
        .for_each(|seen| add_ceiling(&mut found, seen));
    add_friction(study, &mut found);
    add_gain(study, &mut found);
    let is_named = matches!(found.verdict, Verdict::MissingPhysics | Verdict::Instrument);
    found.is_more_than_noise &= !is_named;
    found.sentence = crate::verdict_sentence::sentence(
        (found.verdict, found.is_more_than_noise),
        (&found.findings, found.gain.as_ref()),
        (&found.cannot_tell, &decision.beside, &found.record_next),
        &reason,
    );
    found
}

/// The sets of names kept at 90 % with what the verdict says first: a name, or none. The weights do not know what gates refuse, so that a
/// name which is only suspected may have all of them; it stays as what it may be.
fn with_what_is_said(
    weighed: Vec<Vec<&'static str>>,
    decision: &Decision<'_>,
) -> Vec<Vec<&'static str>> {
    let said = match (decision.verdict, decision.named) {
        (Verdict::InsufficientData, _) => return Vec::new(),
        (_, Some(named)) => named.names(),
        (Verdict::NothingMissing | Verdict::Parameters, None) => Vec::new(),
        _ => return weighed,
    };
    let mut sets = weighed;
    match sets.iter().position(|names| *names == said) {
        Some(known) => sets[..=known].rotate_right(1),
        None => sets.insert(0, said),
    }
    sets
}

/// What a reader should be told besides, and the place that maps show.
fn add_notes(study: &Study, found: &mut Diagnosis, ready: &PreparedStudy) {
    let is_no_better = |g: &Gain| g.log_score <= g.placebo;
    if found.gain.as_ref().is_some_and(is_no_better) {
        found.notes.push(
            "on held-out recordings the finding gains no more than its change on the wrong recordings at the wrong moments does"
                .to_owned(),
        );
    }
    crate::place::add_place(study, found);
    found.notes.push(form_note(&ready.elastic));
    let forces = ready.courses.iter().filter_map(|course| {
        let sample = course.rows.iter().find_map(|row| row.sample)?;
        Some((course.recording, sample - course.samples.0))
    });
    found.notes.extend(ready.noise.wander_note(forces));
    found.notes.extend(ready.noise.zero_note());
    found.notes.extend(ready.noise.hum_note());
    found.notes.extend(coarse_forces_note(&ready.courses));
    found.notes.extend(untested(&ready.courses));
    found.notes.extend(ready.copies.clone());
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gates::decision::{named, silent};
    use crate::synthetic_rungs::rungs_beside;
    use thenar_contact::effects::Effect::{Relaxation, StiffSkin};

    #[test]
    fn sets_begin_with_none_where_a_name_is_only_suspected() {
        let weighed = vec![vec!["stiff_skin"]];
        let of = |decision: &Decision<'_>| with_what_is_said(weighed.clone(), decision);
        let nothing = silent(Verdict::Parameters, "suspected is stiff skin");
        assert_eq!(of(&nothing), [vec![], vec!["stiff_skin"]]);
        assert!(of(&silent(Verdict::InsufficientData, "")).is_empty());
        assert_eq!(of(&silent(Verdict::Unlisted, "")), weighed);
        let second = vec![vec!["stiff_skin"], vec![], vec!["bone"]];
        let sets = with_what_is_said(second, &nothing);
        assert_eq!(sets, [vec![], vec!["stiff_skin"], vec!["bone"]]);
        let rungs = rungs_beside((Relaxation, 100.0), StiffSkin, 0.0);
        let relaxation = named(&rungs.singles[0], "");
        assert_eq!(of(&relaxation), [vec!["relaxation"], vec!["stiff_skin"]]);
    }
}
