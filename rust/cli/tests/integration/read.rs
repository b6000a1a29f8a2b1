//! `thenar read` tells what a recording or a study holds, shows its checks, and refuses what it cannot read.

use crate::sheets;

use sheets::{Folder, refused, thenar};

const COUNTS: &str = "DATA_TYPE MOVIE\nVERSION I-Scan\nSENSOR_TYPE 6900\nROWS 2\nCOLS 2\nSECONDS_PER_FRAME 0.1\nUNITS raw\nASCII_DATA @@\n\n\
    Frame 1, 0,,,,,Raw Sum=,,30\nB,10\n20,0\n\nFrame 2, 0.1,,,,,Raw Sum=,,256\nB,255\n0,0\n@@\n";

fn said(file: &str) -> String {
    let output = thenar(&["read", file]);
    assert!(output.status.success(), "{output:?}");
    String::from_utf8(output.stdout).unwrap()
}

#[test]
fn a_mat_is_told_with_its_check_and_what_is_not_known() {
    let folder = Folder::new("read_mat");
    let text = said(&folder.file("mat.csv", COUNTS));
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
    let text = said(folder.0.to_str().unwrap());
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
    let text = said(&folder.file("curve.csv", table));
    assert!(
        text.contains("    force_n: -1.71270e-8 to 4.91900e-8\n"),
        "{text}"
    );
    assert!(text.contains("    depth_mm: 0 to 0.02\n"), "{text}");
}

/// A GB of bytes at random, of text at random, and of text after a maker's own header: refused at one of its first lines, with
/// 400 MB of address space in all.
#[test]
fn a_gigabyte_of_noise_is_refused_in_little_memory() {
    let folder = Folder::new("read_noise");
    let mut state = 1_u64;
    let mut next = || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        (state >> 33) as u8
    };
    let bytes: Vec<u8> = (0..1 << 20).map(|_| next()).collect();
    let letters = b"0123456789,.;-+ \teE@Frame\n";
    let text: Vec<u8> = (0..1 << 20)
        .map(|_| letters[usize::from(next()) % letters.len()])
        .collect();
    for (name, head, noise) in [
        ("bytes.csv", "", &bytes),
        ("text.csv", "", &text),
        ("movie.asf", COUNTS.trim_end_matches("@@\n"), &text),
    ] {
        let path = folder.path(name);
        let mut file = std::io::BufWriter::new(std::fs::File::create(&path).unwrap());
        std::io::Write::write_all(&mut file, head.as_bytes()).unwrap();
        for _ in 0..1 << 10 {
            std::io::Write::write_all(&mut file, noise).unwrap();
        }
        drop(file);
        let limited = format!(
            "ulimit -v 400000; exec '{}' read '{path}'",
            env!("CARGO_BIN_EXE_thenar")
        );
        let output = std::process::Command::new("sh")
            .args(["-c", &limited])
            .output()
            .unwrap();
        std::fs::remove_file(&path).unwrap();
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        println!("{name}: {said}");
        assert_eq!(output.status.code(), Some(2), "{said}");
        assert!(said.contains("; "), "{said}");
        let (_, after) = said.split_once(&format!("{name}, line ")).unwrap();
        let digits: String = after.chars().take_while(char::is_ascii_digit).collect();
        let line: usize = digits.parse().unwrap();
        assert!(line < 1000, "it read on to line {line}: {said}");
    }
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

const STRANGE: &str = "\"t\",\"Extension\",\"Load\"\n\"(s)\",\"(mm)\",\"(N)\"\n0,0,0\n1,-1,2\n";

#[test]
fn a_column_is_named_on_the_command_line() {
    let folder = Folder::new("read_columns");
    let file = folder.file("press.csv", STRANGE);
    assert!(said(&file).contains("not known: the travel: which of 'Extension' is it?"));
    let output = thenar(&["read", &file, "--column", "travel=-Extension"]);
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(text.contains("    travel_mm: 0 to 1\n"), "{text}");
    refused(
        &["read", &file, "--column", "travel"],
        "--column travel: no name of a column; write --column travel_mm=NAME",
    );
    refused(
        &["read", &file, "--column", "speed=Load"],
        "--column speed=Load: 'speed' is nothing that a column can hold; use time, depth",
    );
    refused(
        &["read", &file, "--column", "force=Kraft"],
        "press.csv, line 1: no line of names holds 'Kraft'",
    );
}

#[test]
fn a_study_names_columns_and_runs() {
    let folder = Folder::new("read_named");
    folder.file("skin.obj", "v 0 0 0\nv 2 0 0\nv 0 2 0\nf 1 2 3\n");
    folder.file("press.csv", STRANGE);
    let study = |more: &str| {
        folder.file(
            "study.toml",
            &format!(
                "[study]\ntitle = \"Finger\"\n[skin]\nmesh = \"skin.obj\"\n[indenters.plate]\nshape = \"plane\"\n[sites.pad]\n\
                 point_mm = [0.5, 0.5, 0]\ndirection = [0, 0, -1]\n[[recordings]]\nname = \"press\"\nkind = \"indentation\"\nfile = \"press.csv\"\n\
                 indenter = \"plate\"\nsite = \"pad\"\n{more}"
            ),
        );
    };
    study("[recordings.columns]\ntravel_mm = \"-Extension\"\n");
    assert!(said(folder.0.to_str().unwrap()).contains("    travel_mm: 0 to 1\n"));
    study("");
    refused(
        &["read", folder.0.to_str().unwrap()],
        "press.csv, line 1: the indentation has no depth: which of 'Extension' is it; name it: travel = \"Extension\" under [recordings.columns]",
    );
    study("[recordings.columns]\nspeed = \"Load\"\n");
    refused(
        &["read", folder.0.to_str().unwrap()],
        "study.toml, line 17: 'speed' is nothing that a column can hold; use time",
    );
    study("run = \"Probe 2\"\n");
    refused(
        &["read", folder.0.to_str().unwrap()],
        "press.csv: 0 of its runs are called 'Probe 2'; take run out: its run has no name",
    );
}

#[test]
fn names_out_of_files_do_not_steer_the_terminal() {
    let folder = Folder::new("read_escapes");
    let text = said(&folder.file(
        "mat.csv",
        &COUNTS.replace("6900", "69\u{1b}]0;title\u{7}00"),
    ));
    assert!(
        text.contains("I-Scan, 69?]0;title?00)") && !text.contains('\u{1b}'),
        "{text}"
    );
}
