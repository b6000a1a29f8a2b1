//! `thenar compare` from outside: files, planted differences, exit codes, and how it stops.

use crate::sheets;

use serde_json::Value;
use sheets::{Folder, refused, sheet, stderr, thenar};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

const G_MPA: f64 = 0.02;
const RADIUS_MM: f64 = 8.0;

/// Hertz: force of a rigid sphere on an incompressible half space, N, with E* = 4 G.
fn hertz_n(depth_mm: f64) -> f64 {
    4.0 / 3.0 * 4.0 * G_MPA * RADIUS_MM.sqrt() * depth_mm.max(0.0).powf(1.5)
}

/// Hertz: pressure at a distance from the axis, kPa.
fn hertz_kpa(depth_mm: f64, distance_mm: f64) -> f64 {
    let share = 1.0 - distance_mm.powi(2) / (RADIUS_MM * depth_mm);
    1e3 * 2.0 * 4.0 * G_MPA / std::f64::consts::PI
        * (depth_mm / RADIUS_MM).sqrt()
        * share.max(0.0).sqrt()
}

/// A sphere pressed into a flat half space twice, and a mat of 49 sensels on it of which the one at row 4, column 3 reads 40 %.
fn study(name: &str, size: usize, spacing: f64) -> Folder {
    let folder = Folder::new(name);
    folder.file("skin.obj", &sheet(size, spacing, 1.0));
    for (number, shift) in [(1, 0.0005), (2, -0.0005)] {
        let mut text = "time_s,depth_mm,force_n\n".to_owned();
        for k in 1..=40 {
            let (time, depth) = (0.05 * f64::from(k), 0.02 * f64::from(k));
            // A known unevenness in place of noise, so that the test needs no random numbers.
            let uneven = shift * if k % 2 == 0 { 1.0 } else { -1.0 };
            text += &format!("{time},{depth},{}\n", hertz_n(depth) + uneven);
        }
        folder.file(&format!("press_{number}.csv"), &text);
    }
    let (mut frames, mut sensels) = (
        "time_s,row,col,pressure_kpa\n".to_owned(),
        "row,col,x_mm,y_mm,z_mm,area_mm2\n".to_owned(),
    );
    let cells = (0..49).map(|k| (k / 7, k % 7));
    for (row, column) in cells.clone() {
        let (x, y) = (f64::from(column) - 3.0, f64::from(row) - 3.0);
        sensels += &format!(
            "{row},{column},{x},{y},{},1\n",
            (x * x + y * y) / (2.0 * RADIUS_MM)
        );
    }
    for frame in 1..=8 {
        let depth = 0.1 * f64::from(frame);
        for (row, column) in cells.clone() {
            let distance = f64::from((column - 3) * (column - 3) + (row - 3) * (row - 3)).sqrt();
            let dull = if (row, column) == (4, 3) { 0.4 } else { 1.0 };
            frames += &format!(
                "{},{row},{column},{:.4}\n",
                0.25 * f64::from(frame),
                dull * hertz_kpa(depth, distance)
            );
        }
    }
    folder.file("mat.csv", &frames);
    folder.file("sensels.csv", &sensels);
    folder.file("study.toml", STUDY);
    folder
}

const STUDY: &str = r#"
[study]
title = "Sphere on a half space"
[skin]
mesh = "skin.obj"
[skin.materials.default]
g0_mpa = 0.03
g_lim_mpa = 0.05
d_lim_mm = 4.0
thickness_mm = "inf"
[indenters.ball]
shape = "sphere"
radius_mm = 8.0
[sites.middle]
point_mm = [0.0, 0.0, 0.0]
direction = [0.0, 0.0, -1.0]
[[recordings]]
name = "press 1"
kind = "indentation"
file = "press_1.csv"
indenter = "ball"
site = "middle"
protocol = "press"
[[recordings]]
name = "press 2"
kind = "indentation"
file = "press_2.csv"
indenter = "ball"
site = "middle"
protocol = "press"
[[recordings]]
name = "mat"
kind = "pressure_map"
file = "mat.csv"
sensels = "sensels.csv"
motion = "press_1.csv"
indenter = "ball"
site = "middle"
protocol = "press with mat"
[instrument]
threshold_kpa = 0.5
"#;

/// Files are written; the dull sensel is the worst place; forces follow Hertz's law within 3 % of the largest.
#[test]
fn a_study_is_compared_and_the_planted_sensel_is_the_worst() {
    let folder = study("compare_hertz", 41, 0.5);
    let words = [
        "compare",
        &folder.path(""),
        "--out",
        &folder.path("out/deep"),
    ];
    let output = thenar(&words);
    assert!(output.status.success(), "{}", stderr(&output));
    assert_eq!(stderr(&output), "", "progress is for terminals");
    assert_eq!(
        folder.names("out/deep"),
        ["comparison.json", "report.html", "residual.csv"]
    );
    let value: Value = serde_json::from_str(&folder.read("out/deep/comparison.json")).unwrap();
    assert_eq!(value["schema"], 1);
    let recordings = value["recordings"].as_array().unwrap();
    let row = |recording: &Value, name: &str| -> Value {
        let rows = recording["measures"].as_array().unwrap();
        rows.iter().find(|row| row["name"] == name).unwrap().clone()
    };
    let left = row(&recordings[0], "force_rms_residual_n")["simulated"]
        .as_f64()
        .unwrap();
    assert!(left < 0.03 * hertz_n(0.8), "{left}");
    let worst = &recordings[2]["worst"][0];
    assert_eq!(
        (&worst["row"], &worst["column"]),
        (&Value::from(4), &Value::from(3)),
        "{worst}"
    );
    assert!(worst["residual"].as_f64().unwrap() < -5.0, "{worst}");
    let residual = folder.read("out/deep/residual.csv");
    assert!(
        residual.starts_with("recording,vertex,residual_kpa\n\"mat\","),
        "{}",
        &residual[..80]
    );
    let said = String::from_utf8(output.stdout).unwrap();
    assert!(
        said.starts_with(value["sentence"].as_str().unwrap()),
        "{said}"
    );
}

#[test]
fn the_same_study_gives_the_same_bytes_with_any_threads() {
    let folder = study("compare_same", 25, 0.8);
    for (out, threads) in [("a", "1"), ("b", "3")] {
        let words = [
            "compare",
            &folder.path(""),
            "--threads",
            threads,
            "--seed",
            "7",
            "--out",
            &folder.path(out),
        ];
        let output = thenar(&words);
        assert!(output.status.success(), "{}", stderr(&output));
    }
    for name in ["comparison.json", "report.html", "residual.csv"] {
        assert_eq!(
            folder.read(&format!("a/{name}")),
            folder.read(&format!("b/{name}")),
            "{name}"
        );
    }
}

#[test]
fn a_bad_study_is_refused_with_one_sentence() {
    let folder = Folder::new("compare_refused");
    let out = folder.path("out");
    refused(
        &["compare", &folder.path("none"), "--out", &out],
        "it is no folder",
    );
    folder.file("study.toml", "[study]\ntitle = 3\n");
    refused(&["compare", &folder.path(""), "--out", &out], "study.toml");
    let scene = study("compare_refused_tool", 13, 1.0);
    scene.file(
        "study.toml",
        &STUDY.replace("indenter = \"ball\"", "indenter = \"bell\""),
    );
    refused(&["compare", &scene.path(""), "--out", &out], "bell");
    refused(&["compare", &scene.path("")], "--out");
}

#[test]
#[cfg(unix)]
fn ctrl_c_stops_and_writes_nothing() {
    let folder = study("compare_ctrl_c", 161, 0.125);
    let words = ["compare", &folder.path(""), "--out", &folder.path("out")];
    let mut child = Command::new(env!("CARGO_BIN_EXE_thenar"))
        .args(words)
        .stderr(Stdio::piped())
        .stdout(Stdio::null())
        .spawn()
        .unwrap();
    std::thread::sleep(Duration::from_millis(500));
    assert!(
        child.try_wait().unwrap().is_none(),
        "it ended before it was stopped; make it longer"
    );
    let asked = Instant::now();
    let told = Command::new("kill")
        .args(["-INT", &child.id().to_string()])
        .status();
    assert!(told.unwrap().success());
    let output = child.wait_with_output().unwrap();
    assert!(
        asked.elapsed() < Duration::from_secs(2),
        "{:?}",
        asked.elapsed()
    );
    assert_eq!(output.status.code(), Some(1));
    assert_eq!(stderr(&output), "thenar: cancelled; nothing was written\n");
    assert!(!folder.0.join("out").exists());
}
