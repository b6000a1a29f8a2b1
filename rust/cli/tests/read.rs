//! `thenar read` tells what a recording or a study holds, shows its checks, and refuses what it cannot read.
#![allow(clippy::unwrap_used)]

mod sheets;

use sheets::{Folder, refused, thenar};

const COUNTS: &str = "DATA_TYPE MOVIE\nVERSION I-Scan\nSENSOR_TYPE 6900\nROWS 2\nCOLS 2\nSECONDS_PER_FRAME 0.1\nUNITS raw\nASCII_DATA @@\n\n\
    Frame 1, 0,,,,,Raw Sum=,,30\nB,10\n20,0\n\nFrame 2, 0.1,,,,,Raw Sum=,,256\nB,255\n0,0\n@@\n";

fn told(file: &str) -> String {
    let output = thenar(&["read", file]);
    assert!(output.status.success(), "{output:?}");
    String::from_utf8(output.stdout).unwrap()
}

#[test]
fn a_mat_is_told_with_its_check_and_what_is_not_known() {
    let folder = Folder::new("read_mat");
    let text = told(&folder.file("mat.csv", COUNTS));
    for line in [
        "mat.csv: Tekscan ASCII\n",
        "  mat (Tekscan, I-Scan, 6900)\n",
        "  2 frames of 3 sensels in raw counts, a grid of 2 x 2 with 1 cells missing, 0.000 to 0.100 s\n",
        "  largest value 255.0, 1 clipped\n",
        "  check: raw sum of 2 frames disagrees with the file's own: 1.000 counts apart at most (frame 1), 0 counts allowed\n",
        "  not known: pressure and force: the cells are raw counts and no calibration is in the file\n",
        "  warning: raw sum of 2 frames disagrees",
    ] {
        assert!(text.contains(line), "{line:?} is not in {text}");
    }
}

#[test]
fn a_study_is_told_recording_by_recording() {
    let folder = Folder::new("read_study");
    folder.file("skin.obj", "v 0 0 0\nv 2 0 0\nv 0 2 0\nf 1 2 3\n");
    folder.file(
        "press.csv",
        "time_s,depth_mm,force_mN\n0,0,0\n0.25,0.5,0.0125\n0.5,1,2000.5\n",
    );
    folder.file(
        "study.toml",
        "[study]\ntitle = \"Finger\"\n[skin]\nmesh = \"skin.obj\"\n[indenters.plate]\nshape = \"plane\"\n[sites.pad]\n\
         point_mm = [0.5, 0.5, 0]\ndirection = [0, 0, -1]\n[[recordings]]\nname = \"press\"\nkind = \"indentation\"\nfile = \"press.csv\"\n\
         indenter = \"plate\"\nsite = \"pad\"\n",
    );
    let text = told(folder.0.to_str().unwrap());
    for line in [
        ": Finger\nskin: 3 vertices, 1 triangles, 1 regions\n",
        "\npress (plate at pad)\n",
        "    time_s: 0 to 0.5\n",
        "    force_n: 0 to 2.0005\n",
    ] {
        assert!(text.contains(line), "{line:?} is not in {text}");
    }
}

/// Forces of nanonewtons are not told as zeros.
#[test]
fn small_numbers_keep_their_digits() {
    let folder = Folder::new("read_small");
    let table = "time_s,depth_mm,force_n\n0,0,0\n1,0.01,4.919e-8\n2,0.02,-1.7127e-8\n";
    let text = told(&folder.file("curve.csv", table));
    assert!(
        text.contains("    force_n: -1.71270e-8 to 4.91900e-8\n"),
        "{text}"
    );
    assert!(text.contains("    depth_mm: 0 to 0.02\n"), "{text}");
}

#[test]
fn what_cannot_be_read_is_refused_with_file_and_line() {
    let folder = Folder::new("read_refused");
    refused(
        &["read", &folder.file("a.csv", "hello\n")],
        "a.csv, line 1: this is no recording format that is known",
    );
    refused(
        &["read", &folder.file("b.csv", &COUNTS.replace("20,0", "20"))],
        "b.csv, line 12: the row holds 1 values, expected 2",
    );
    refused(
        &["read", &folder.path("c.csv")],
        "c.csv: cannot be read (No such file",
    );
    refused(
        &["read", folder.0.to_str().unwrap()],
        "study.toml: cannot be read (No such file",
    );
    refused(&["read"], "<FILE>");
}
