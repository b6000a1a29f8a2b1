//! The ladder's plumbing on studies that the model itself makes: these say that each rung is reached, not that names are right; that
//! is told by the finite elements of `tests/trial`.

use crate::scenes;

use scenes::laboratory::{Laboratory, USUAL, clean, clean_of, measured, planned, planned_on};
use scenes::pad;
use serde_json::Value;
use thenar_contact::{ActiveEffect, Control};
use thenar_diagnosis::Verdict;
use thenar_diagnosis::{DiagnoseOptions, Diagnosis, diagnose, findings_json};
use thenar_inference::{Fitting, InferenceError};
use thenar_recordings::Study;
use thenar_recordings::meshes::MeshFile;
use thenar_recordings::study::{Indenter, Shape};

fn diagnosed(study: &Study) -> Diagnosis {
    diagnose(study, &DiagnoseOptions::default(), &Control::none()).unwrap()
}

/// Moduli that are off, gain and first touch that differ from repeat to repeat, outliers: only the parameters were off.
#[test]
fn a_study_without_anything_missing_blames_nobody_and_says_what_it_would_have_seen() {
    let study = measured(&clean(), &USUAL, 5);
    let found = diagnosed(&study);
    assert_eq!(found.verdict, Verdict::Parameters, "{}", found.sentence);
    assert!(found.findings.is_empty() && found.cannot_tell.is_empty());
    let seen: Vec<&str> = found.smallest_seen.iter().map(|s| s.0).collect();
    assert!(
        seen.contains(&"relaxation") && seen.contains(&"cycle_softening"),
        "{seen:?}"
    );
    let sizes = || found.smallest_seen.iter().filter_map(|(_, size, _)| *size);
    assert!(sizes().all(|size| size.is_finite() && size > 0.0));
    let fades = found.smallest_seen.iter().find(|s| s.0 == "relaxation");
    assert!(
        fades.is_some_and(|s| s.1.is_some_and(|share| share < 0.5)),
        "{fades:?}: half of the force is less than presses with holds would show"
    );
    assert_eq!(
        findings_json(&found),
        findings_json(&diagnosed(&study)),
        "the same seed gives the same bytes"
    );
}

/// Three times the noise hides larger effects, and no effect is seen from a smaller size.
#[test]
fn what_would_have_been_seen_grows_with_the_noise() {
    let seen = |noise: f64| {
        let laboratory = Laboratory { noise, ..USUAL };
        diagnosed(&measured(&clean(), &laboratory, 5)).smallest_seen
    };
    let (quiet, loud) = (seen(0.01), seen(0.03));
    let mut larger = 0;
    for ((name, less, _), (other, more, _)) in quiet.iter().zip(&loud) {
        assert_eq!(name, other);
        let (less, more) = (less.unwrap_or(f64::INFINITY), more.unwrap_or(f64::INFINITY));
        assert!(more >= 0.9 * less, "{name}: {less} to {more}");
        larger += usize::from(more > 1.5 * less);
    }
    assert!(2 * larger > quiet.len(), "{quiet:?} {loud:?}");
    let skin = quiet.iter().find(|s| s.0 == "stiff_skin").unwrap();
    assert!(skin.1.is_some_and(|ratio| ratio > 1.0), "{skin:?}");
}

/// Round skin is pressed on its mesh, whatever the tool; on flat skin a ball is not, and the reader is told.
#[test]
fn how_well_the_elastic_answer_is_known_is_told() {
    let note = |study: &Study| {
        let notes = diagnosed(study).notes;
        let found = notes
            .into_iter()
            .find(|note| note.contains("mesh") || note.contains("the simulated forces"));
        found.unwrap()
    };
    let round = note(&measured(&clean(), &USUAL, 5));
    assert!(
        round.starts_with(
            "the width of the bone is not stated: over a narrow bone the simulated forces may be off by 10 %"
        ),
        "{round}"
    );
    assert!(
        round.contains("State it (bone_half_width_mm") && round.ends_with("then it is 5 %"),
        "{round}"
    );
    let flat = clean_of(planned_on(pad(f64::INFINITY, 12.0, 0.7)));
    let flat = note(&measured(&flat, &USUAL, 5));
    assert!(flat.contains("known to 0.6 %"), "{flat}");
    assert!(
        flat.ends_with("that of 1 of 2 tools, pressed on the mesh, to 1 %"),
        "{flat}"
    );
}

/// Relaxation that the contact model follows on its mesh is named by the screening's springs, a model of another kind.
#[test]
fn relaxation_of_the_contact_model_is_named_and_predicts_what_was_held_out() {
    let effect = ActiveEffect::named("relaxation", 0.5).unwrap();
    let study = planned();
    let mut fitting = Fitting::new(&study, &Control::none()).unwrap();
    let forces = fitting.simulate(&[effect], &Control::none()).unwrap();
    let study = measured(&(study, forces), &USUAL, 11);
    let shares = std::sync::Mutex::new(Vec::new());
    let watched = Control {
        cancelled: &|| false,
        progress: &|stage, share| {
            if stage == "asking the contact model" {
                shares.lock().unwrap().push(share);
            }
        },
    };
    let found = diagnose(&study, &DiagnoseOptions::default(), &watched).unwrap();
    let shares = shares.into_inner().unwrap();
    let is_within = |share: &f64| (0.8..1.0).contains(share);
    assert!(
        shares.len() > 2 && shares.iter().all(is_within),
        "{shares:?}"
    );
    let names: Vec<&str> = found.findings.iter().map(|f| f.effect).collect();
    assert_eq!(names, ["relaxation"], "{}", found.sentence);
    assert_eq!(found.verdict, Verdict::MissingPhysics);
    let signs = &found.findings[0].consequences;
    assert!(
        signs.len() >= 2 && signs.iter().all(|(_, holds)| *holds),
        "a force that fades falls in a hold and opens the loop: {signs:?}"
    );
    let gain = found.gain.as_ref().unwrap();
    assert!(
        gain.after.rms < gain.before.rms && gain.removed > 0.75,
        "{gain:?}"
    );
    assert!(gain.log_score > 2.0 * gain.placebo.max(5.0), "{gain:?}");
    let json: Value = serde_json::from_str(&findings_json(&found)).unwrap();
    assert_eq!(json["schema"], 1);
    assert_eq!(json["findings"][0]["kind"], "tissue");
    let when = &json["findings"][0]["when"];
    assert!(when["recordings"].as_array().is_some_and(|r| !r.is_empty()));
    assert!(
        json["fit"]["reducible_error_removed"]["value"]
            .as_f64()
            .unwrap()
            > 0.75
    );
    assert_eq!(json["model"]["effects"][0]["name"], "relaxation");
    let switched = &found.effects[0];
    let mut active = ActiveEffect::named(switched.name, switched.amplitude).unwrap();
    for (name, value) in &switched.numbers {
        active = active.with(name, *value).unwrap();
    }
    assert!(
        fitting.simulate(&[active], &Control::none()).is_ok(),
        "the model takes what was found"
    );
}

/// A study of one tool on skin whose force fades with one time, as that of a layer that drains nearly does.
fn pressed_with(tool: &str, amplitude: f64) -> Study {
    let mut study = planned();
    study.recordings.retain(|r| r.indenter == tool);
    let mut fitting = Fitting::new(&study, &Control::none()).unwrap();
    let mut effect = ActiveEffect::named("relaxation", amplitude).unwrap();
    for (name, value) in [("weight_1", 0.0), ("weight_2", 0.0), ("weight_3", 1.0)] {
        effect = effect.with(name, value).unwrap();
    }
    let forces = fitting.simulate(&[effect], &Control::none()).unwrap();
    measured(&(study, forces), &USUAL, 11)
}

/// One tool alone tells no clock that is fixed from one that grows with the contact: another tool of the study is asked for, or the
/// same again, and not one of which nothing can be made.
#[test]
fn what_is_recorded_next_settles_what_one_tool_cannot() {
    let mut study = pressed_with("ball", 0.3);
    let of_nothing = Shape::Mesh(MeshFile::default());
    for (name, shape) in [
        ("nothing", of_nothing),
        ("large ball", Shape::Sphere { radius_mm: 20.0 }),
    ] {
        let name = name.to_owned();
        study.indenters.push(Indenter { name, shape });
    }
    let found = diagnosed(&study);
    assert_eq!(found.verdict, Verdict::CannotTell, "{}", found.sentence);
    assert!(
        found.cannot_tell.contains(&["relaxation", "drainage"]),
        "{:?}",
        found.cannot_tell
    );
    let next = &found.record_next[0];
    let asked = next.indenter.as_deref();
    assert!(
        asked.is_some_and(|name| ["plate", "large ball"].contains(&name)),
        "{next:?}"
    );
    assert!(
        next.in_turn_with
            .as_deref()
            .is_none_or(|name| name == "ball")
    );
    let share = next.probability.unwrap();
    assert!(share > 0.0 && share <= 1.0 && next.presses >= 2 && next.minutes > 4.0);
    assert!(found.sentence.contains("% of cases"), "{}", found.sentence);
}

/// Where nothing but a plate was pressed, a sphere that touches less is asked for: the study has no round tool to go by.
#[test]
fn where_only_a_plate_was_pressed_a_sphere_is_asked_for() {
    let mut study = pressed_with("plate", 0.1);
    study.indenters.retain(|i| i.name == "plate");
    let found = diagnosed(&study);
    assert_eq!(found.verdict, Verdict::CannotTell, "{}", found.sentence);
    let next = &found.record_next[0];
    assert_eq!(next.indenter, None, "{next:?}");
    let radius = next.radius_mm.unwrap();
    assert!(radius >= 2.0 * next.depth_mm - 1e-9, "{next:?}");
    assert!(next.text.contains("a sphere of radius"), "{}", next.text);
}

/// One recording of each protocol: noise is not known, and nothing is named whatever the curve looks like.
#[test]
fn without_repeats_nothing_is_named() {
    let mut study = measured(&clean(), &USUAL, 5);
    study.recordings.truncate(1);
    let found = diagnosed(&study);
    assert_eq!(
        found.verdict,
        Verdict::InsufficientData,
        "{}",
        found.sentence
    );
    assert!(found.findings.is_empty() && found.names_90.is_empty());
}

#[test]
fn a_diagnosis_can_be_cancelled_at_any_time_and_its_progress_never_falls() {
    let study = measured(&clean(), &USUAL, 5);
    let told = std::sync::Mutex::new(Vec::new());
    let watched = Control {
        cancelled: &|| false,
        progress: &|_, share| told.lock().unwrap().push(share),
    };
    diagnose(&study, &DiagnoseOptions::default(), &watched).unwrap();
    let told = told.into_inner().unwrap();
    assert!(told.windows(2).all(|w| w[0] <= w[1]) && told.last() == Some(&1.0));
    let calls = std::sync::atomic::AtomicUsize::new(0);
    for after in [0, 40, 400] {
        calls.store(0, std::sync::atomic::Ordering::Relaxed);
        let stops = Control {
            cancelled: &|| calls.fetch_add(1, std::sync::atomic::Ordering::Relaxed) >= after,
            progress: &|_, _| {},
        };
        let ended = diagnose(&study, &DiagnoseOptions::default(), &stops);
        assert_eq!(
            ended.err(),
            Some(InferenceError::Cancelled),
            "after {after}"
        );
    }
}
