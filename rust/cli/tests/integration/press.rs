//! `thenar press` from outside: what it writes, that it writes the same, and how it stops.

use crate::sheets;

use serde_json::Value;
use sheets::{Folder, block, column, refused, scene, sheet, stderr, thenar};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

const OUTPUTS: [&str; 3] = ["product.csv", "summary.json", "vertices.csv"];

fn summary(folder: &Folder, out: &str) -> Value {
    serde_json::from_str(&folder.read(&format!("{out}/summary.json"))).unwrap()
}

#[test]
fn a_press_writes_three_files_that_agree() {
    let (folder, hand, product) = scene("three_files");
    let output = thenar(&["press", &hand, &product, "--out", &folder.path("out/deep")]);
    assert!(output.status.success(), "{}", stderr(&output));
    assert_eq!(folder.names("out/deep"), OUTPUTS);
    let vertices = folder.read("out/deep/vertices.csv");
    assert!(vertices.starts_with("index,dx_mm,dy_mm,dz_mm,pressure_kpa,force_n,in_contact\n0,"));
    let force = column(&vertices, "force_n");
    assert_eq!(force.len(), 169);
    let touches = column(&vertices, "in_contact");
    assert!(
        force
            .iter()
            .zip(&touches)
            .all(|(force, touches)| (*force > 0.0) == (*touches == 1.0))
    );
    let summary = summary(&folder, "out/deep");
    let total: f64 = force.iter().sum();
    assert!(total > 0.0 && (summary["force_n"].as_f64().unwrap() - total).abs() < 1e-12 * total);
    let peak = column(&vertices, "pressure_kpa")
        .into_iter()
        .fold(0.0, f64::max);
    assert!((summary["peak_pressure_mpa"].as_f64().unwrap() * 1e3 - peak).abs() < 1e-9);
    assert_eq!(
        column(&folder.read("out/deep/product.csv"), "pressure_kpa").len(),
        8
    );
    let told = summary["warnings"].to_string();
    assert!(told.contains("preset finger_layer"), "{told}");
    // Pressed down: the skin under the block moves to where the block is.
    let deepest = column(&vertices, "dz_mm").into_iter().fold(0.0, f64::min);
    assert!((-0.45..-0.35).contains(&deepest), "{deepest}");
}

#[test]
fn the_same_input_gives_the_same_bytes_with_any_threads() {
    let (folder, hand, product) = scene("same_bytes");
    for (out, threads) in [("a", "1"), ("b", "1"), ("c", "3")] {
        let output = thenar(&[
            "press",
            &hand,
            &product,
            "--threads",
            threads,
            "--out",
            &folder.path(out),
        ]);
        assert!(output.status.success(), "{}", stderr(&output));
    }
    for name in OUTPUTS {
        let first = folder.read(&format!("a/{name}"));
        assert_eq!(first, folder.read(&format!("b/{name}")));
        assert_eq!(first, folder.read(&format!("c/{name}")));
    }
}

#[test]
fn meters_are_a_thousand_millimeters() {
    let (folder, hand, product) = scene("meters");
    let hand_m = folder.file("hand_m.obj", &sheet(13, 1.0, 1e-3));
    let product_m = folder.file("block_m.ply", &block(-0.4, 1e-3));
    assert!(
        thenar(&["press", &hand, &product, "--out", &folder.path("mm")])
            .status
            .success()
    );
    assert!(
        thenar(&[
            "press",
            &hand_m,
            &product_m,
            "--unit",
            "m",
            "--out",
            &folder.path("m")
        ])
        .status
        .success()
    );
    let force = |out: &str| summary(&folder, out)["force_n"].as_f64().unwrap();
    assert!((force("mm") / force("m") - 1.0).abs() < 1e-9);
}

#[test]
fn force_control_reaches_its_force_along_its_direction() {
    let (folder, hand, product) = scene("force");
    let out = folder.path("out");
    let output = thenar(&[
        "press",
        &hand,
        &product,
        "--force",
        "0.3",
        "--direction",
        "0,0,-1",
        "--out",
        &out,
    ]);
    assert!(output.status.success(), "{}", stderr(&output));
    let summary = summary(&folder, "out");
    assert!((summary["total_force_n"][2].as_f64().unwrap().abs() - 0.3).abs() < 1e-3);
    assert_eq!(
        summary["run"]["direction"],
        serde_json::json!([0.0, 0.0, -1.0])
    );
}

#[test]
fn a_posture_moves_the_skin_to_the_product() {
    let (folder, hand, _) = scene("posture");
    let away = folder.file("away.ply", &block(49.6, 1.0));
    let posed = folder.file("posed.obj", &sheet(13, 1.0, 1.0).replace(" 0\n", " 50\n"));
    let force = |out: &str| summary(&folder, out)["force_n"].as_f64().unwrap();
    assert!(
        thenar(&["press", &hand, &away, "--out", &folder.path("rest")])
            .status
            .success()
    );
    assert!(
        thenar(&[
            "press",
            &hand,
            &away,
            "--posed",
            &posed,
            "--out",
            &folder.path("posed")
        ])
        .status
        .success()
    );
    assert_eq!(force("rest"), 0.0);
    assert!(force("posed") > 0.0);
    let short = folder.file("short.obj", &sheet(12, 1.0, 1.0));
    refused(
        &[
            "press",
            &hand,
            &away,
            "--posed",
            &short,
            "--out",
            &folder.path("no"),
        ],
        "144 vertices",
    );
}

/// vertex,region for the 13 by 13 sheet: the left half in `left`, the right half in `right`.
fn halves(left: &str, right: &str) -> String {
    let rows =
        (0..169).map(|vertex| format!("{vertex},{}\n", if vertex < 78 { left } else { right }));
    "vertex,region\n".to_owned() + &rows.collect::<String>()
}

#[test]
fn regions_and_materials_go_by_number_or_name() {
    let (folder, hand, product) = scene("regions");
    let numbers = folder.file("numbers.csv", &halves("0", "1"));
    let names = folder.file("names.csv", &halves("thumb", "palm"));
    let soft = "g0_mpa = 0.004\nthickness_mm = inf\nswelling = [2, 8.0, 2.0]\n";
    let by_number = folder.file(
        "n.toml",
        &format!("[0]\n{soft}[1]\ng0_mpa = 0.04\ng_lim_mpa = 0.04\n"),
    );
    let by_name = folder.file(
        "m.toml",
        &format!("[default]\n{soft}[palm]\ng0_mpa = 0.04\ng_lim_mpa = 4e-2\n"),
    );
    let run = |regions: &str, materials: &str, out: &str| {
        let words = [
            "press",
            &hand,
            &product,
            "--regions",
            regions,
            "--materials",
            materials,
            "--out",
            &folder.path(out),
        ];
        let output = thenar(&words);
        assert!(output.status.success(), "{}", stderr(&output));
    };
    run(&numbers, &by_number, "a");
    run(&names, &by_name, "b");
    assert_eq!(folder.read("a/vertices.csv"), folder.read("b/vertices.csv"));
    let rows = summary(&folder, "b")["regions"].clone();
    assert_eq!(
        (rows[0]["name"].as_str(), rows[1]["name"].as_str()),
        (Some("thumb"), Some("palm"))
    );
    assert_eq!(rows[1]["g_mpa"].as_f64(), Some(0.04));
    let none = folder.file("none.csv", &halves("-1", "0"));
    assert!(
        thenar(&[
            "press",
            &hand,
            &product,
            "--regions",
            &none,
            "--out",
            &folder.path("c")
        ])
        .status
        .success()
    );
    assert!(
        column(&folder.read("c/vertices.csv"), "in_contact")[..78]
            .iter()
            .all(|touches| *touches == 0.0)
    );
}

#[test]
fn a_folder_that_cannot_be_written_is_no_bad_input() {
    let (folder, hand, product) = scene("no_folder");
    let file = folder.file("taken", "");
    let output = thenar(&["press", &hand, &product, "--out", &file]);
    assert_eq!(output.status.code(), Some(1));
    assert!(
        stderr(&output).contains("taken: cannot be written"),
        "{}",
        stderr(&output)
    );
    std::fs::create_dir_all(folder.path("half/summary.json/in_the_way")).unwrap();
    let output = thenar(&["press", &hand, &product, "--out", &folder.path("half")]);
    assert_eq!(output.status.code(), Some(1));
    assert!(
        folder
            .names("half")
            .iter()
            .all(|name| !name.starts_with('.')),
        "{:?}",
        folder.names("half")
    );
}

#[test]
fn a_reader_that_goes_away_is_no_fault() {
    let (folder, hand, product) = scene("reader");
    let words = ["press", &hand, &product, "--out", &folder.path("out")];
    let mut command = Command::new(env!("CARGO_BIN_EXE_thenar"));
    let mut child = command.args(words).stdout(Stdio::piped()).spawn().unwrap();
    drop(child.stdout.take());
    assert!(child.wait().unwrap().success());
    assert_eq!(folder.names("out"), OUTPUTS);
}

#[test]
#[cfg(unix)]
fn ctrl_c_stops_and_writes_nothing() {
    let folder = Folder::new("ctrl_c");
    let hand = folder.file("hand.obj", &sheet(300, 0.1, 1.0));
    let product = folder.file("block.ply", &block(-0.4, 1.0));
    let words = ["press", &hand, &product, "--out", &folder.path("out")];
    let mut child = Command::new(env!("CARGO_BIN_EXE_thenar"))
        .args(words)
        .stderr(Stdio::piped())
        .stdout(Stdio::null())
        .spawn()
        .unwrap();
    std::thread::sleep(Duration::from_millis(700));
    assert!(
        child.try_wait().unwrap().is_none(),
        "the press ended before it was stopped; make it longer"
    );
    let asked = Instant::now();
    assert!(
        Command::new("kill")
            .args(["-INT", &child.id().to_string()])
            .status()
            .unwrap()
            .success()
    );
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
