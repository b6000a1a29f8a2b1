//! `thenar press` refuses bad usage and bad files in one sentence, with exit code 2, and writes nothing.

use crate::sheets;

use sheets::{refused, scene, thenar};

#[test]
fn bad_usage_is_refused() {
    let (folder, hand, product) = scene("usage");
    let out = folder.path("out");
    refused(&[], "subcommand");
    refused(&["squeeze"], "unrecognized subcommand 'squeeze'");
    refused(&["press", &hand, &product], "--out <DIR>");
    refused(
        &["press", &hand, &product, "--out", &out, "--model", "fem"],
        "invalid value 'fem' for '--model",
    );
    refused(
        &["press", &hand, &product, "--out", &out, "--unit", "inch"],
        "invalid value 'inch'",
    );
    refused(
        &["press", &hand, &product, "--out", &out, "--threads", "0"],
        "invalid value '0'",
    );
    refused(
        &["press", &hand, &product, "--out", &out, "--force", "much"],
        "invalid value 'much'",
    );
    refused(
        &["press", &hand, &product, "--out", &out, "--force", "-2"],
        "-2 N",
    );
    refused(
        &["press", &hand, &product, "--out", &out, "--force", "nan"],
        "NaN",
    );
    refused(
        &[
            "press",
            &hand,
            &product,
            "--out",
            &out,
            "--direction",
            "0,0,-1",
        ],
        "--force",
    );
    refused(
        &[
            "press",
            &hand,
            &product,
            "--out",
            &out,
            "--force",
            "1",
            "--direction",
            "0,1",
        ],
        "three numbers",
    );
    let help = thenar(&["press", "--help"]);
    assert!(
        help.status.success()
            && help.stderr.is_empty()
            && String::from_utf8_lossy(&help.stdout).contains("--materials")
    );
    assert!(thenar(&["--version"]).status.success());
}

#[test]
fn bad_files_are_refused_by_name_and_line() {
    let (folder, hand, product) = scene("files");
    let out = folder.path("out");
    refused(
        &["press", &folder.path("none.obj"), &product, "--out", &out],
        "none.obj: cannot be read (No such file",
    );
    let bad = folder.file("bad.obj", "v 0 0 0\nv 1 0 nan\n");
    refused(
        &["press", &hand, &bad, "--out", &out],
        "bad.obj, line 2: 'nan' is not a finite number",
    );
    let flat = folder.file("flat.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n");
    refused(
        &["press", &hand, &flat, "--out", &out],
        "flat.obj: all 1 triangles have zero area",
    );
}

#[test]
fn bad_regions_are_refused_by_line() {
    let (folder, hand, product) = scene("bad_regions");
    let cases = [
        (
            "vertex;region\n0;1\n",
            "R.csv, line 1: the first line must name the columns vertex,region",
        ),
        (
            "vertex,region\n0,1\n999,1\n",
            "R.csv, line 3: there is no vertex \"999\"; the hand has 169",
        ),
        (
            "vertex,region\n0,1\n0,1\n",
            "R.csv, line 3: vertex 0 already has a region",
        ),
        (
            "vertex,region\n0,1\n1,9999\n",
            "R.csv, line 3: region 9999 is not from 0 to 4095",
        ),
        ("vertex,region\n0,1\n", "R.csv: vertex 1 has no region"),
        ("vertex,region\n0,1,2\n", "R.csv: "),
    ];
    for (text, words) in cases {
        let regions = folder.file("R.csv", text);
        refused(
            &[
                "press",
                &hand,
                &product,
                "--regions",
                &regions,
                "--out",
                &folder.path("out"),
            ],
            words,
        );
    }
    let missing = folder.path("missing.csv");
    refused(
        &[
            "press",
            &hand,
            &product,
            "--regions",
            &missing,
            "--out",
            &folder.path("out"),
        ],
        "missing.csv: ",
    );
}

#[test]
fn bad_materials_are_refused_by_line() {
    let (folder, hand, product) = scene("bad_materials");
    let cases = [
        (
            "[default]\ng0 = 1\n",
            "M.toml, line 2: there is no material number \"g0\"; there are g0_mpa, ",
        ),
        (
            "[default]\n\ng0_mpa = -1\n",
            "M.toml, line 3: material default: g0_mpa is -1",
        ),
        (
            "[default]\ng0_mpa = \"soft\"\n",
            "M.toml, line 2: g0_mpa must be a number",
        ),
        (
            "[default]\nd_lim_mm = nan\n",
            "M.toml, line 2: material default: d_lim_mm is NaN",
        ),
        (
            "[default]\nswelling = [1, 2]\n",
            "M.toml, line 2: swelling must be three numbers",
        ),
        (
            "g0_mpa = 1\n",
            "M.toml, line 1: g0_mpa stands outside a table",
        ),
        (
            "[default]\n[palm]\n",
            "M.toml, line 2: there is no region \"palm\"; use 0 or default",
        ),
        ("[default]\ng0_mpa = \n", "M.toml, line 2: "),
        (
            "[default]\ng0_mpa = 1\ng0_mpa = 2\n",
            "M.toml, line 3: duplicate key",
        ),
        (
            "",
            "M.toml: region 0 has no material; add a table [0] or [default]",
        ),
    ];
    for (text, words) in cases {
        let materials = folder.file("M.toml", text);
        refused(
            &[
                "press",
                &hand,
                &product,
                "--materials",
                &materials,
                "--out",
                &folder.path("out"),
            ],
            words,
        );
    }
}

/// `/dev/full` takes nothing: each write to it fails.
#[test]
fn exit_code_of_a_refusal_stays_where_standard_error_is_full() {
    let full = std::fs::OpenOptions::new().write(true).open("/dev/full");
    let end = std::process::Command::new(env!("CARGO_BIN_EXE_thenar"))
        .args(["read", "/there/is/no/such/file"])
        .stderr(full.unwrap())
        .status();
    assert_eq!(end.unwrap().code(), Some(2));
}
