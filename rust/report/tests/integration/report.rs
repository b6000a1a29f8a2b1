//! The files of a comparison: whole, self-contained, escaped, the same bytes every time, and true to the numbers.

use crate::made;

use made::{
    Normal, compared, fit_of, flat_mat, indentation, map, modulus, pad_force, ramp_and_hold,
};
use nalgebra::DMatrix;
use serde_json::Value;
use thenar_comparison::Location;
use thenar_comparison::{Compared, Comparison, compare_fit};
use thenar_diagnosis::{Confidence, Diagnosis, Finding, Form, Kind, Verdict};
use thenar_inference::{Fit, Measured, Phase, Target};
use thenar_report::{comparison_html, comparison_json, diagnosis_html};

/// Two presses, one of which relaxes, and a mat on which the simulation sits one row off.
fn study() -> Comparison {
    compared(&loaded())
}

fn loaded() -> Fit {
    relaxing_by(0.22)
}

/// The second press loses this share of its force in time.
fn relaxing_by(share: f64) -> Fit {
    let mut normal = Normal(11);
    let moments = ramp_and_hold(240);
    let simulated: Vec<f64> = moments
        .iter()
        .map(|moment| pad_force(moment.depth_mm))
        .collect();
    let mut press = |relaxed: f64, name: &str| -> (Measured, Vec<f64>) {
        let left = |k: usize| match moments[k].phase {
            Phase::Load => 1.0,
            _ => 1.0 - relaxed * (1.0 - (-(moments[k].time_s - 2.0) / 0.8).exp()),
        };
        let read: Vec<f64> = (0..240)
            .map(|k| simulated[k] * left(k) + 0.03 * normal.next())
            .collect();
        (indentation(name, &read), simulated.clone())
    };
    let recordings = vec![
        press(0.0, "slow press, repeat 1"),
        press(share, "fast press & <hold>"),
        mat_recording(),
    ];
    let mut fit = fit_of(recordings, 0.03, DMatrix::zeros(0, 0));
    fit.sigma[2].iter_mut().for_each(|sigma| *sigma = 2.5);
    fit.projected[2]
        .iter_mut()
        .for_each(|left| *left *= 0.03 / 2.5);
    fit.estimates = vec![modulus("g0_mpa", 0.0062), modulus("g_lim_mpa", 0.087)];
    fit.estimates[1].bounds = (0.001, 0.087);
    fit.estimates[1].is_at_bound = true;
    let mut zero = modulus("contact_zero_mm", 0.03);
    (zero.start, zero.bounds, zero.target) = (
        0.0,
        (-0.5, 0.5),
        Target::Recording("slow press, repeat 1".into()),
    );
    fit.estimates.push(zero);
    fit.lack_of_fit_p = Some(0.0004);
    fit.notes = vec!["Noise is told by 2 repeats of 2 protocols.".into()];
    fit
}

fn mat_recording() -> (Measured, Vec<f64>) {
    let (mat, mut normal) = (flat_mat(14, 12, 4.9), Normal(5));
    let bump = |row: f64, column: f64, height: f64| {
        (0..168).map(move |k| {
            let (r, c) = (f64::from(k / 12) - row, f64::from(k % 12) - column);
            height * (1.0 - (r * r / 26.0 + c * c / 17.0)).max(0.0).sqrt()
        })
    };
    let moments = ramp_and_hold(12);
    let (mut frames, mut simulated) = (Vec::new(), Vec::new());
    for moment in &moments {
        let height = 70.0 * moment.depth_mm;
        let read = bump(6.0, 5.2, height).map(|value| {
            if value > 0.0 {
                (value + 2.5 * normal.next()).max(0.0)
            } else {
                0.0
            }
        });
        frames.push(read.collect());
        simulated.extend(bump(7.0, 5.4, 0.93 * height));
    }
    let mut recording = map("mat, 2 N", &mat, &frames, 3.0);
    recording.unknown = vec!["The file does not say whether rows were mirrored.".into()];
    (recording, simulated)
}

#[test]
fn json_has_schema_units_and_the_numbers() {
    let comparison = study();
    let text = comparison_json(&comparison);
    let value: Value = serde_json::from_str(&text).expect("JSON");
    assert_eq!(value["schema"], 1);
    assert_eq!(value["sentence"], comparison.sentence.as_str());
    let recordings = value["recordings"].as_array().expect("recordings");
    assert_eq!(recordings.len(), 3);
    let series = &recordings[1]["series"][0];
    assert_eq!(series["name"], "force_n");
    let read = series["measured"].as_array().expect("numbers");
    assert_eq!(read.len(), 240);
    assert_eq!(
        read[100].as_f64(),
        Some(comparison.recordings[1].series[0].measured[100])
    );
    let frame = &recordings[2]["frames"][0];
    for name in [
        "measured_kpa",
        "simulated_kpa",
        "simulated_before_kpa",
        "residual_kpa",
        "residual_sigmas",
    ] {
        assert_eq!(frame[name].as_array().map(Vec::len), Some(168), "{name}");
    }
    assert_eq!(
        recordings[2]["mat"]["row"].as_array().map(Vec::len),
        Some(168)
    );
    assert_eq!(
        recordings[2]["residual_kpa"].as_array().map(Vec::len),
        Some(9)
    );
    assert_eq!(recordings[0]["mat"], Value::Null);
    assert_eq!(value["estimates"][1]["is_at_bound"], true);
    assert_eq!(value["estimates"][2]["of"]["kind"], "recording");
}

#[test]
fn the_same_comparison_gives_the_same_bytes() {
    assert_eq!(comparison_json(&study()), comparison_json(&study()));
    assert_eq!(comparison_html(&study()), comparison_html(&study()));
}

/// No script, no reference to anything outside, names escaped, and every element closed in order.
#[test]
fn the_page_is_self_contained_and_well_formed() {
    let html = comparison_html(&study());
    for outside in ["<script", "src=", "url(", "@import", "<link", "<iframe"] {
        assert!(!html.contains(outside), "{outside}");
    }
    assert_eq!(
        html.matches("http").count(),
        html.matches("xmlns='http://www.w3.org/2000/svg'").count()
    );
    assert!(html.contains("fast press &amp; &lt;hold&gt;") && !html.contains("<hold>"));
    assert!(
        !html.contains("NaN") && !html.contains("inf"),
        "a number leaked"
    );
    let mut open = Vec::new();
    for part in html.split('<').skip(1) {
        let tag = part.split('>').next().expect("a tag");
        let name = tag
            .trim_start_matches('/')
            .split([' ', '/'])
            .next()
            .expect("a name");
        let is_void = tag.ends_with('/') || ["!DOCTYPE", "meta", "br"].contains(&name);
        match tag.starts_with('/') {
            true => assert_eq!(open.pop(), Some(name), "closed out of order"),
            false if !is_void => open.push(name),
            false => {}
        }
    }
    assert!(open.is_empty(), "{open:?}");
}

/// The recording that relaxes is the one that the study's sentence names; the bound is told.
#[test]
fn the_first_sentence_names_what_stands_out() {
    let comparison = study();
    assert!(
        comparison.sentence.contains("do not explain"),
        "{}",
        comparison.sentence
    );
    assert!(
        comparison
            .sentence
            .contains("At the end of what is admissible lie"),
        "{}",
        comparison.sentence
    );
    assert!(
        comparison.recordings[0]
            .sentence
            .contains("agree within the noise"),
        "{}",
        comparison.recordings[0].sentence
    );
    assert!(
        comparison.recordings[1]
            .sentence
            .contains("below the simulation"),
        "{}",
        comparison.recordings[1].sentence
    );
    assert!(
        comparison.recordings[2].sentence.contains("overlap by"),
        "{}",
        comparison.recordings[2].sentence
    );
}

/// Eleven gains on their bound are named once, in words; the same of one mat's three coordinates.
#[test]
fn parameters_on_a_bound_are_grouped_in_words() {
    let mut fit = loaded();
    let bound = |name: &str, target: Target| {
        let mut one = modulus(name, 0.9);
        (one.target, one.is_at_bound) = (target, true);
        one
    };
    fit.estimates = (1..=11)
        .map(|k| bound("repeat_gain", Target::Recording(format!("repeat {k}"))))
        .collect();
    for axis in ["pose_x_mm", "pose_y_mm", "pose_turn_rad"] {
        let target = Target::Recording("mat, 2 N".into());
        fit.estimates.push(bound(axis, target));
    }
    let said = compared(&fit).sentence;
    for part in [
        "gain of \u{201c}repeat 1\u{201d}, \u{201c}repeat 2\u{201d} and 9 more",
        "mat's place of \u{201c}mat, 2 N\u{201d}",
    ] {
        assert_eq!(said.matches(part).count(), 1, "{part}: {said}");
    }
    assert!(!said.contains('_'), "a name of the code: {said}");
}

/// A difference below the simulation's own error is sure of the noise alone; a larger one needs no such caution.
#[test]
fn a_small_difference_is_stated_with_the_simulations_error() {
    let caution = "the simulation itself may be off by 8.0 %";
    let large = compared(&loaded()).recordings[1].sentence.clone();
    assert!(
        large.contains("standard errors of the noise") && !large.contains(caution),
        "{large}"
    );
    let small = compared(&relaxing_by(0.06)).recordings[1].sentence.clone();
    assert!(
        small.contains("below the simulation") && small.contains(caution),
        "{small}"
    );
}

/// Without repeats a recording has its own roughness and no noise: no probability is told of it.
#[test]
fn roughness_is_not_called_noise() {
    let mut fit = loaded();
    fit.lack_of_fit_p = None;
    let comparison = compared(&fit);
    let relaxing = &comparison.recordings[1];
    assert!(!relaxing.is_noise_told && relaxing.has_noise);
    for sentence in [&comparison.sentence, &relaxing.sentence] {
        assert!(
            !sentence.contains("p <") && !sentence.contains("standard errors"),
            "{sentence}"
        );
    }
    let told = "times what the recording's own roughness leaves; no repeats tell the noise";
    assert!(relaxing.sentence.contains(told), "{}", relaxing.sentence);
    assert!(
        comparison.recordings[0]
            .sentence
            .contains("no repeats tell the noise")
    );
    assert!(
        study()
            .recordings
            .iter()
            .all(|recording| recording.is_noise_told)
    );
}

/// More than noise is left, but nothing stands out of what the simulation may itself be off by: both are said.
#[test]
fn the_simulations_own_error_is_told_beside_the_noise() {
    let fit = loaded();
    let silent = Location {
        mismatches: Vec::new(),
        p: Some(0.4),
        look_elsewhere_count: 12,
        sentence: String::new(),
        notes: Vec::new(),
    };
    let comparison = compare_fit(&Compared {
        title: "",
        skin: &[],
        sites: &[],
        fit: &fit,
        location: Some(&silent),
        prints: &[],
    });
    let said = &comparison.sentence;
    assert!(
        said.starts_with("Parameters within their bounds, fitted to all 3 recordings, leave more than noise alone does (p < 0.001)"),
        "{said}"
    );
    assert!(
        said.contains("8.0 % of the largest value") && !said.contains("do not explain"),
        "{said}"
    );
}

#[test]
fn page_of_a_diagnosis_shows_which_signs_hold() {
    let sign = |what: &str, holds| (what.to_owned(), holds);
    let finding = Finding {
        effect: "relaxation",
        kind: "tissue",
        channel: "force",
        confidence: Confidence::new(0.9, Kind::Skin(Form::Known)),
        numbers: Vec::new(),
        place: None,
        when: None,
        depends_on: Vec::new(),
        consequences: vec![sign("force < peak", true), sign("loop opens", false)],
    };
    let page = diagnosis_html(&Diagnosis {
        comparison: study(),
        verdict: Verdict::MissingPhysics,
        sentence: String::new(),
        findings: vec![finding],
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
        notes: Vec::new(),
    });
    assert!(page.contains("force &lt; peak</td><td class='left'>seen<"));
    assert!(page.contains("loop opens</td><td class='left'>not seen<"));
}
