//! Conducts the diagnosis of grasps: from what explains them to a verdict, its findings and its sentence.

use thenar_comparison::{Compared, Comparison, compare_fit};
use thenar_contact::Control;
use thenar_inference::errors::InferenceError;
use thenar_inference::grasp::as_fit::{as_fit, force_course};
use thenar_inference::grasp::explain::{Explained, explain};
use thenar_recordings::Study;

use crate::findings::{Curve, Diagnosis, Finding, Rival, Verdict};
use crate::grasp::grasp_findings::{cause_finding, cell_findings, switched};
use crate::grasp::notes;

/// Holds shorter than this show no course, s.
const SHORTEST_S: f64 = 4.0;
/// Squared residual over the number of rows from which something is there that no cause explains.
const UNEXPLAINED: f64 = 1.5;
/// Rivals that are listed.
const MOST_RIVALS: usize = 12;

/// Says what the grasps of a study show that the model leaves out.
///
/// # Errors
/// [`InferenceError`]: skin, product or mats that cannot be used, presses that fail, recordings of other kinds, or `Cancelled`.
pub(crate) fn diagnose_grasps(
    study: &Study,
    control: &Control<'_>,
) -> Result<Diagnosis, InferenceError> {
    let others = study.recordings.iter().filter(|r| !r.site.is_empty());
    if let Some(other) = others.map(|r| &r.name).next() {
        return Err(InferenceError::Grasps {
            problem: format!(
                "'{other}' is no grasp; a study holds grasps or presses of a tool: make a study of each"
            ),
        });
    }
    let explained = explain(study, control)?;
    let mut found = begun(study, &explained);
    found.findings = cell_findings(&explained);
    for (number, named) in explained.chosen.named.iter().enumerate() {
        let probability = probability(&explained, number);
        let rivals = &explained.chosen.alike[number];
        found
            .findings
            .push(cause_finding(&explained, named, probability));
        for rival in rivals {
            let pair = [named.cause.name(), rival.cause.name()];
            if !found.cannot_tell.contains(&pair) {
                found.cannot_tell.push(pair);
            }
        }
    }
    found.verdict = verdict(&explained, &found);
    found.is_more_than_noise = matches!(found.verdict, Verdict::CannotTell | Verdict::Unlisted);
    found.names_90 = names_90(&found);
    found.record_next = notes::next(&explained, &found);
    found.sentence = notes::sentence(&explained, &found);
    Ok(found)
}

/// All that does not depend on the verdict.
fn begun(study: &Study, explained: &Explained) -> Diagnosis {
    let named = &explained.chosen.named;
    Diagnosis {
        comparison: comparison(study, explained),
        verdict: Verdict::NothingMissing,
        sentence: String::new(),
        findings: Vec::new(),
        unlisted: None,
        names_90: Vec::new(),
        cannot_tell: Vec::new(),
        suspected: Vec::new(),
        is_more_than_noise: false,
        gain: None,
        smallest_seen: notes::smallest(explained),
        record_next: Vec::new(),
        materials: notes::materials(explained),
        effects: named
            .iter()
            .filter_map(|each| switched(explained, each))
            .collect(),
        rivals: rivals(explained),
        curves: curves(explained),
        evidence: evidence(explained),
        notes: notes::notes(study, explained),
    }
}

fn comparison(study: &Study, explained: &Explained) -> Comparison {
    let mut fit = as_fit(explained, notes::of_comparison());
    for (measured, hold) in fit.measured.iter_mut().zip(&explained.holds) {
        let recording = &study.recordings[hold.recording];
        measured.indenter.clone_from(&recording.indenter);
        if !recording.protocol.is_empty() {
            measured.protocol.clone_from(&recording.protocol);
        }
    }
    compare_fit(&Compared {
        title: &study.title,
        skin: &study.skin.mesh.positions,
        sites: &[],
        fit: &fit,
        location: None,
        prints: &[],
    })
}

/// The weight of a named cause among all causes of its round that could be in its place.
fn probability(explained: &Explained, number: usize) -> f64 {
    let own = explained.chosen.named[number].net;
    let alike = explained.chosen.alike[number]
        .iter()
        .map(|r| (r.net - own).exp());
    let weight = 1.0 / (1.0 + (-own).exp() + alike.sum::<f64>());
    weight.min(0.99)
}

fn verdict(explained: &Explained, found: &Diagnosis) -> Verdict {
    let longest = explained
        .holds
        .iter()
        .map(|hold| hold.length_s())
        .fold(0.0, f64::max);
    let has_trace = explained.holds.iter().any(|hold| hold.force_n.is_some());
    let is_of = |kind: &str| found.findings.iter().any(|f| f.kind == kind);
    let is_tissue = |f: &Finding| f.kind == "tissue" && f.effect != "region_stiffness";
    if !found.cannot_tell.is_empty() {
        return Verdict::CannotTell;
    }
    match (found.findings.iter().any(is_tissue), is_of("instrument")) {
        (true, _) => Verdict::MissingPhysics,
        (false, true) => Verdict::Instrument,
        (false, false) if is_of("tissue") => Verdict::Parameters,
        _ if longest < SHORTEST_S || (explained.holds.len() < 2 && !has_trace) => {
            Verdict::InsufficientData
        }
        _ => {
            let (squared, rows) = explained.chosen.left;
            match squared <= UNEXPLAINED * rows as f64 {
                true => Verdict::NothingMissing,
                false => Verdict::Unlisted,
            }
        }
    }
}

fn names_90(found: &Diagnosis) -> Vec<Vec<&'static str>> {
    if found.findings.is_empty() {
        return match found.verdict {
            Verdict::NothingMissing => vec![Vec::new()],
            _ => Vec::new(),
        };
    }
    let mut own: Vec<&'static str> = found.findings.iter().map(|f| f.effect).collect();
    own.dedup();
    let instead = found.cannot_tell.iter().map(|[named, rival]| {
        let swapped = own
            .iter()
            .map(|name| if name == named { *rival } else { *name });
        swapped.collect()
    });
    let instead: Vec<Vec<&'static str>> = instead.collect();
    std::iter::once(own.clone()).chain(instead).collect()
}

fn rivals(explained: &Explained) -> Vec<Rival> {
    let all = &explained.chosen.rivals;
    let most = all.iter().map(|r| r.net).fold(0.0, f64::max);
    let whole: f64 = (-most).exp() + all.iter().map(|r| (r.net - most).exp()).sum::<f64>();
    // Of time constants, forms and regions the best stands for its name.
    let is_first = |k: usize| {
        let mut earlier = all[..k].iter();
        earlier.all(|r| r.cause.name() != all[k].cause.name())
    };
    let best = (0..all.len()).filter(|k| is_first(*k)).map(|k| &all[k]);
    let each = best.take(MOST_RIVALS).map(|r| Rival {
        effects: vec![r.cause.name()],
        evidence: r.net,
        probability: (r.net - most).exp() / whole,
        left: f64::NAN,
        ledger: [f64::NAN; 4],
    });
    each.collect()
}

fn curves(explained: &Explained) -> Vec<Curve> {
    let curve = |(number, hold): (usize, &thenar_inference::grasp::hold::Hold)| {
        let course = force_course(explained, number);
        Curve {
            recording: hold.name.clone(),
            depth_mm: vec![0.0; course.time_s.len()],
            time_s: course.time_s,
            measured_n: course.measured_n,
            before_n: course.before_n,
            after_n: course.after_n,
        }
    };
    explained.holds.iter().enumerate().map(curve).collect()
}

fn evidence(explained: &Explained) -> Vec<(&'static str, f64)> {
    let (squared, rows) = explained.chosen.left;
    let best = explained.chosen.rivals.first();
    let held_out = explained
        .chosen
        .named
        .first()
        .and_then(|named| named.held_out);
    vec![
        ("holds", explained.holds.len() as f64),
        (
            "regions",
            explained.fits.first().map_or(0, |fit| fit.active.len()) as f64,
        ),
        ("squared_residual_per_row", squared / rows.max(1) as f64),
        ("evidence_of_best_nats", best.map_or(0.0, |best| best.net)),
        ("held_out_gain_nats", held_out.unwrap_or(f64::NAN)),
    ]
}
