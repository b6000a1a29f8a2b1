//! `thenar compare` and `thenar read` of a handprint: files written, overlap told, refusals.

use crate::sheets;

use serde_json::Value;
use sheets::{Folder, refused, sheet, stderr, thenar};

const SIDE: u32 = 200;

const STUDY: &str = r#"
[skin]
mesh = "skin.obj"
[skin.materials.default]
g0_mpa = 0.01
g_lim_mpa = 0.01
thickness_mm = "inf"
[indenters.ball]
shape = "sphere"
radius_mm = 20
[sites.middle]
point_mm = [0, 0, 0]
direction = [0, 0, -1]
[[recordings]]
name = "inked"
kind = "handprint"
file = "print.tif"
mm_per_px = 0.1
cell_mm = 0.5
depth_mm = 1
indenter = "ball"
site = "middle"
[recordings.placing]
on = "plane"
origin_mm = [-10, -10, 0]
columns = [1, 0, 0]
rows = [0, 1, 0]
"#;

/// One strip of 8-bit gray (TIFF 6.0, section 4): dark within `radius` mm of the middle of 20 x 20 mm.
fn tiff(radius: f64) -> Vec<u8> {
    const LONG: u16 = 4;
    const SHORT: u16 = 3;
    let entries = [
        (256, LONG, SIDE),
        (257, LONG, SIDE),
        (258, SHORT, 8),
        (259, SHORT, 1),
        (262, SHORT, 1),
        (273, LONG, 8 + 2 + 9 * 12 + 4),
        (277, SHORT, 1),
        (278, LONG, SIDE),
        (279, LONG, SIDE * SIDE),
    ];
    let mut bytes = b"II*\0\x08\0\0\0\x09\0".to_vec();
    for (tag, kind, value) in entries {
        bytes.extend(u16::to_le_bytes(tag));
        bytes.extend(kind.to_le_bytes());
        bytes.extend(1u32.to_le_bytes());
        bytes.extend(value.to_le_bytes());
    }
    bytes.extend([0; 4]);
    for pixel in 0..SIDE * SIDE {
        let at = |number: u32| 0.1 * (f64::from(number) + 0.5) - 10.0;
        let is_ink = at(pixel % SIDE).hypot(at(pixel / SIDE)) < radius;
        bytes.push(if is_ink { 30 } else { 225 });
    }
    bytes
}

fn study(name: &str, radius: f64) -> Folder {
    let folder = Folder::new(name);
    folder.file("skin.obj", &sheet(41, 0.5, 1.0));
    folder.file("study.toml", STUDY);
    std::fs::write(folder.path("print.tif"), tiff(radius)).unwrap();
    folder
}

#[test]
fn a_print_is_compared_and_written() {
    let folder = study("inked", 20f64.sqrt());
    let done = thenar(&["compare", &folder.path(""), "--out", &folder.path("out")]);
    assert!(done.status.success(), "{}", stderr(&done));
    let told = String::from_utf8_lossy(&done.stdout).into_owned();
    let overlap = "The handprint \u{201c}inked\u{201d} overlaps with simulated contact by 9";
    assert!(told.contains(overlap), "{told}");
    let names = ["comparison.json", "prints.csv", "report.html"];
    assert_eq!(folder.names("out"), names);
    let json: Value = serde_json::from_str(&folder.read("out/comparison.json")).unwrap();
    let print = &json["recordings"][0]["print"];
    assert_eq!(print["is_mirrored"], false);
    for list in ["recorded_share", "simulated_share"] {
        assert_eq!(print[list].as_array().unwrap().len(), 1600);
    }
    let rows = folder.read("out/prints.csv");
    assert!(rows.starts_with("recording,vertex,print_residual\n\"inked\","));
    assert!(
        folder
            .read("out/report.html")
            .contains("orange: inked alone")
    );
    let read = thenar(&["read", &folder.path("")]);
    let told = String::from_utf8_lossy(&read.stdout).into_owned();
    assert!(told.contains("ink in 40 x 40 cells of 0.50 mm"), "{told}");
    assert!(told.contains("1600 cells placed"), "{told}");
}

#[test]
fn a_file_that_is_no_image_is_refused() {
    let folder = study("no_image", 4.0);
    folder.file("print.tif", "time_s,force_n\n");
    refused(
        &["compare", &folder.path(""), "--out", &folder.path("out")],
        "print.tif: it is no image that can be read; save the print as PNG, JPEG or TIFF",
    );
}
