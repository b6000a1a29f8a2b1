//! Scans of a study: point clouds in any table, and the moment they were taken at.

use crate::folders;

use folders::{Folder, STUDY};
use std::path::Path;
use thenar_recordings::Study;
use thenar_recordings::meshes::read_points;
use thenar_recordings::study::Data;

const SCAN: &str = "mesh = \"skin.obj\"\nat_time_s = 3.2";

fn refusal(folder: &Folder) -> String {
    Study::load(folder.path()).unwrap_err().to_string()
}

#[test]
fn clouds_hold_the_same_points_however_they_are_written() {
    let folder = Folder::new();
    let wanted = [[0.0, 1.0, 2.0], [-3.5, 4.25, 1e-3]];
    for (name, text) in [
        ("a.xyz", "0 1 2 255 10 10\n-3.5\t4.25 1e-3 0 0 0\n"),
        (
            "b.csv",
            "\u{feff}x_mm,y_mm,z_mm\r\n0,1,2\r\n\r\n-3.5,4.25,0.001\r\n",
        ),
        ("c.csv", "z_mm;note;x_mm;y_mm\n2;a;0;1\n0.001;b;-3.5;4.25"),
        ("d.txt", "# a scanner\n0, 1, 2\n-3.5, 4.25, 0.001\n"),
        ("e.obj", "v 0 1 2\nv -3.5 4.25 0.001\n"),
        (
            "f.ply",
            "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\nend_header\n0 1 2\n-3.5 4.25 0.001\n",
        ),
    ] {
        folder.write(name, text);
        let found = read_points(&folder.path().join(name)).unwrap();
        let points: Vec<[f64; 3]> = found.positions.iter().map(|p| (*p).into()).collect();
        assert_eq!(points.len(), 2, "{name}");
        for (point, wanted) in points.iter().flatten().zip(wanted.iter().flatten()) {
            assert!((point - wanted).abs() < 1e-9, "{name}: {points:?}");
        }
        assert!(found.triangles.is_empty(), "{name}");
    }
}

#[test]
fn clouds_that_are_none_are_refused_by_line() {
    let folder = Folder::new();
    for (name, text, wanted) in [
        (
            "a.csv",
            "x,y,z\n0,1,2\n",
            "a.csv, line 1: there is no column x_mm; the first is 'x'; name the columns",
        ),
        (
            "b.csv",
            "x_mm,y_mm,z_mm\n0,1\n",
            "b.csv, line 2: '' is not a number",
        ),
        (
            "c.xyz",
            "0 1 2\n0 nan 2\n",
            "c.xyz, line 2: 'nan' is not a finite number",
        ),
        (
            "d.xyz",
            "0 1\n",
            "d.xyz, line 1: a point with 2 coordinates, expected 3",
        ),
        ("e.xyz", "\n# nothing\n", "e.xyz: it holds no vertices"),
        (
            "f.las",
            "",
            "f.las: not a mesh format that is known (.las); save it as .ply, .obj, .stl, .csv or .xyz",
        ),
    ] {
        folder.write(name, text);
        let said = read_points(&folder.path().join(name))
            .unwrap_err()
            .to_string();
        assert!(said.contains(wanted), "{said}");
    }
    // A skin needs faces: there a cloud is still refused.
    folder.write("skin.obj", "v 0 0 0\nv 2 0 0\nv 0 2 0\n");
    assert!(refusal(&folder).contains("it holds no faces"));
    let missing = read_points(Path::new("nowhere.ply"))
        .unwrap_err()
        .to_string();
    assert!(missing.contains("nowhere.ply"), "{missing}");
}

#[test]
fn a_scan_knows_its_moment_by_depth_or_by_the_indentation_it_belongs_to() {
    let folder = Folder::new();
    folder.write(
        "study.toml",
        STUDY.replace(SCAN, "mesh = \"skin.obj\"\ndepth_mm = 0"),
    );
    let study = Study::load(folder.path()).unwrap();
    let scan = &study.recording("scan").unwrap().data;
    assert!(matches!(
        scan,
        Data::Scan {
            depth_mm: Some(0.0),
            motion: None,
            ..
        }
    ));
    let with = |rest: &str| {
        STUDY.replace(
            SCAN,
            &format!("mesh = \"skin.obj\"\nmotion = \"slow.csv\"\n{rest}"),
        )
    };
    folder.write("study.toml", with("at_time_s = 0.25"));
    let study = Study::load(folder.path()).unwrap();
    let Data::Scan {
        motion: Some(curve),
        ..
    } = &study.recording("scan").unwrap().data
    else {
        panic!()
    };
    assert_eq!(curve.channel("depth_mm"), Some(&[0.0, 1.0][..]));
    folder.write("study.toml", with("at_time_s = 3.2"));
    let said = refusal(&folder);
    assert!(said.contains("recording 'scan' was taken at 3.2 s, and its motion lasts from 0 to 0.5 s; count at_time_s"), "{said}");
    folder.write("study.toml", with(""));
    let said = refusal(&folder);
    assert!(
        said.contains("recording 'scan' has no at_time_s; give the time of the scan"),
        "{said}"
    );
}
