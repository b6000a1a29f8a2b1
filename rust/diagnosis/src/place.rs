//! Localized findings of maps: a place that stays with the skin (inclusion) or with the sensor.

use thenar_recordings::study::Data;
use thenar_recordings::{PressureMap, Study};

use crate::findings::{Diagnosis, Finding, Verdict, When, Where};
use crate::track_record::{Confidence, Kind};
use thenar_comparison::Comparison;
use thenar_comparison::{Carrier, Mismatch, Shown};
use thenar_inference::observe::measured::Phase;

/// Adds the place that a comparison of maps located, where nothing stronger is said.
pub fn add_place(study: &Study, found: &mut Diagnosis) {
    let Some(mismatch) = placed(&found.comparison).cloned() else {
        return;
    };
    let is_silent = matches!(found.verdict, Verdict::NothingMissing | Verdict::Parameters);
    if found.verdict == Verdict::MissingPhysics && is_spot(study, &mismatch) {
        found.findings.push(inclusion(study, &mismatch));
        found
            .names_90
            .iter_mut()
            .for_each(|names| names.push("inclusion"));
    }
    if !is_silent {
        found.notes.push(mismatch.sentence);
        return;
    }
    let carrier = mismatch.place.as_ref().map(|p| p.carrier);
    match carrier {
        Some(Carrier::Skin) => {
            found.verdict = Verdict::MissingPhysics;
            found.findings = vec![inclusion(study, &mismatch)];
            found.names_90 = vec![vec!["inclusion"]];
        }
        Some(Carrier::Sensor) => {
            found.verdict = Verdict::Instrument;
            found
                .notes
                .push("what stands out stays with the sensels".into());
            found.names_90 = vec![vec!["misregistration"], vec!["crosstalk"]];
        }
        _ => {
            found.verdict = Verdict::CannotTell;
            found.cannot_tell = vec![["inclusion", "misregistration"]];
            found.names_90 = vec![vec!["inclusion"], vec!["misregistration"]];
        }
    }
    found.notes.push(mismatch.sentence);
}

/// Part of a frame's largest reading by which a place must differ, in the mean over frames, where other physics is missing too: stiff and
/// soft spots change the pressure over them by 20 to 95 % of it (`tests/trial/studies.py`), what else is missing by less.
const SPOT: f64 = 0.2;

/// Whether a place that stays with the skin stands out as far as a stiff or soft spot does.
fn is_spot(study: &Study, mismatch: &Mismatch) -> bool {
    let is_shown = |name: &String| mismatch.when.recordings.contains(name);
    let shown = study.recordings.iter().filter(|r| is_shown(&r.name));
    let maps = shown.filter_map(|r| match &r.data {
        Data::PressureMap { map, .. } => Some(&**map),
        _ => None,
    });
    let largest: Vec<f64> = maps.flat_map(largest_by_frame).collect();
    let mean = largest.iter().sum::<f64>() / largest.len().max(1) as f64;
    let stays = mismatch
        .place
        .as_ref()
        .is_some_and(|p| p.carrier == Carrier::Skin);
    stays && mismatch.shown == Shown::Pressure && mismatch.size.abs() > SPOT * mean
}

/// Largest reading of each frame that holds one above 0, in the map's unit. A mismatch's size is a mean over frames, shallow ones too, so
/// that the study's largest reading is no measure for it.
fn largest_by_frame(map: &PressureMap) -> impl Iterator<Item = f64> {
    let frames = map.values.chunks(map.sensels.len().max(1));
    let largest = |frame: &[f64]| {
        let known = frame.iter().filter(|v| v.is_finite());
        known.fold(0.0, |most, v| f64::max(most, *v))
    };
    frames.map(largest).filter(|most| *most > 0.0)
}

/// The strongest mismatch with a place.
fn placed(comparison: &Comparison) -> Option<&Mismatch> {
    let location = comparison.location.as_ref()?;
    location.mismatches.iter().find(|m| m.place.is_some())
}

fn inclusion(study: &Study, mismatch: &Mismatch) -> Finding {
    let place = mismatch.place.as_ref();
    let center = place.and_then(|p| p.on_skin_mm).map(Into::into);
    let when = &mismatch.when;
    let phase = match when.phases.first() {
        Some(Phase::Hold) => "hold",
        Some(Phase::Unload) => "unload",
        Some(Phase::Slide) => "slide",
        Some(Phase::Apart) => "rest",
        _ => "load",
    };
    Finding {
        effect: "inclusion",
        kind: "tissue",
        channel: "map",
        confidence: Confidence::new((1.0 - mismatch.p).clamp(0.5, 0.99), Kind::Place),
        numbers: Vec::new(),
        place: Some(Where {
            site: study
                .recordings
                .first()
                .map_or_else(String::new, |r| r.site.clone()),
            region: None,
            center_mm: center.or(place.map(|p| p.center_mm.into())),
            radius_mm: place.map(|p| p.radius_mm),
            area_90_mm2: place.map(|p| p.area_90_mm2),
            vertices: place.map_or_else(Vec::new, |p| p.vertices.clone()),
        }),
        when: Some(When {
            recordings: when.recordings.clone(),
            phase,
            time_s: when.time_s.unwrap_or([0.0, 0.0]),
            depth_mm: when.depth_mm.unwrap_or([0.0, 0.0]),
            cycles: when.cycles,
        }),
        depends_on: vec!["skin_position"],
        consequences: Vec::new(),
    }
}

/// A diagnosis of a study that holds no force over depth.
pub fn without_curves(study: &Study, comparison: Comparison) -> Diagnosis {
    let reason = "no recording gives force over depth, from which effects are told";
    let mut found = Diagnosis {
        comparison,
        verdict: Verdict::InsufficientData,
        sentence: format!("Too little was recorded to say what is missing: {reason}."),
        findings: Vec::new(),
        unlisted: None,
        names_90: Vec::new(),
        cannot_tell: Vec::new(),
        suspected: Vec::new(),
        is_more_than_noise: false,
        gain: None,
        smallest_seen: Vec::new(),
        record_next: Vec::new(),
        materials: Vec::new(),
        effects: Vec::new(),
        rivals: Vec::new(),
        curves: Vec::new(),
        evidence: Vec::new(),
        notes: vec![reason.to_owned()],
    };
    if let Some(mismatch) = placed(&found.comparison)
        && mismatch
            .place
            .as_ref()
            .is_some_and(|p| p.carrier == Carrier::Skin)
    {
        let finding = inclusion(study, mismatch);
        found.sentence = mismatch.sentence.clone();
        found.findings = vec![finding];
        found.verdict = Verdict::MissingPhysics;
        found.names_90 = vec![vec!["inclusion"]];
    }
    found
}
