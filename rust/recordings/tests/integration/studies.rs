//! A study is loaded whole, or refused with file, line and remedy.

use crate::folders;

use folders::{Folder, STUDY};
use thenar_recordings::PressureUnit;
use thenar_recordings::study::{Data, Shape, Study};

fn load(folder: &Folder) -> Result<Study, String> {
    Study::load(folder.path()).map_err(|error| {
        error
            .to_string()
            .replace(&format!("{}/", folder.path().display()), "")
    })
}

/// The message for a study in which `from` became `to`; `LINE` is the line where `from` stands.
fn refused(from: &str, to: &str, expected: &str) {
    let folder = Folder::new();
    let at = STUDY
        .find(from)
        .unwrap_or_else(|| panic!("{from:?} is not in the sample"));
    let line = 1 + STUDY[..at].matches('\n').count();
    folder.write("study.toml", STUDY.replacen(from, to, 1));
    let message = load(&folder).unwrap_err();
    let expected = expected.replace("LINE", &line.to_string());
    assert!(
        message.starts_with(&expected) && message.contains("; "),
        "{to:?} gave {message:?}"
    );
}

/// The message for a study in which a file has another text.
fn refused_file(name: &str, text: &str, expected: &str) {
    let folder = Folder::new();
    folder.write(name, text);
    let message = load(&folder).unwrap_err();
    assert!(
        message.starts_with(expected) && message.contains("; "),
        "{text:?} gave {message:?}"
    );
}

#[test]
fn everything_in_it_is_loaded() {
    let study = load(&Folder::new()).unwrap();
    assert_eq!(
        (study.title.as_str(), study.warnings.len()),
        ("Index fingertip, subject 3", 0)
    );
    assert_eq!(
        (study.skin.regions, study.skin.region_names),
        (vec![0, 1, -1], vec!["pad".to_string(), "tip".into()])
    );
    let [default, pad] = &study.skin.materials[..] else {
        panic!()
    };
    assert_eq!(
        (default.g0_mpa, default.d_lim_mm, default.thickness_mm),
        (Some(0.005), Some(4.0), Some(f64::INFINITY))
    );
    assert_eq!(default.fit, ["g0_mpa", "g_lim_mpa"]);
    assert_eq!(
        (pad.region.as_str(), pad.g_lim_mpa, &pad.fit[..]),
        (
            "pad",
            None,
            &["g0_mpa".to_string(), "thickness_mm".into()][..]
        )
    );
    assert_eq!(
        study.indenters[1].shape,
        Shape::Cylinder {
            radius_mm: 24.0,
            axis: [0.0, 1.0, 0.0]
        }
    );
    assert_eq!(study.sites[0].direction, [0.0, 0.0, -1.0]);
    // The skin is the plane z = 0, the site 0.1 mm above it.
    assert!((study.sites[0].distance_mm - 0.1).abs() < 1e-12);
    assert_eq!(study.instrument.unwrap().pitch_mm, Some(1.27));
    assert_eq!(study.recordings.len(), 3);
}

#[test]
fn recordings_hold_their_data() {
    let study = load(&Folder::new()).unwrap();
    let Data::Indentation(curve) = &study.recording("slow press").unwrap().data else {
        panic!()
    };
    assert_eq!(
        (curve.channel("depth_mm"), curve.channel("force_n")),
        (Some(&[0.0, 1.0][..]), Some(&[0.0, 2.0][..]))
    );
    let mat = study.recording("mat").unwrap();
    let Data::PressureMap {
        map,
        sensels,
        motion,
    } = &mat.data
    else {
        panic!()
    };
    assert_eq!(
        (map.unit, map.values[0], map.values[2].is_nan()),
        (PressureUnit::Kilopascal, 3.0, true)
    );
    // In the map's order, not that of the file of places.
    let places: Vec<_> = sensels
        .as_ref()
        .unwrap()
        .iter()
        .map(|place| place.unwrap().center_mm[0])
        .collect();
    assert_eq!((places, motion.is_some()), (vec![0.0, 1.27], true));
    let scan = &study.recording("scan").unwrap().data;
    assert!(
        matches!(scan, Data::Scan { mesh, at_time_s: Some(3.2), .. } if mesh.positions.len() == 3)
    );
    assert_eq!(study.recordings[0].temperature_c, Some(23.5));
}

#[test]
fn unknown_keys_are_refused_with_the_nearest_known_one() {
    for (from, to, expected) in [
        (
            "title =",
            "titel =",
            "study.toml, line LINE: 'titel' is no key of [study]; did you mean 'title'?",
        ),
        (
            "[indenters.plate]",
            "[indentors.plate]",
            "study.toml, line LINE: 'indentors' is no key of the file; did you mean 'indenters'?",
        ),
        (
            "[instrument]",
            "[instruments]",
            "study.toml, line LINE: 'instruments' is no key of the file; did you mean 'instrument'?",
        ),
        (
            "g_lim_mpa = 0.09",
            "glim_mpa = 0.09",
            "study.toml, line LINE: 'glim_mpa' is no key of [skin.materials.default]; did you mean 'g_lim_mpa'?",
        ),
        (
            "radius_mm = 24.0",
            "radius_mm = 24.0\nradius = 2",
            "study.toml, line 22: 'radius' is no key of [indenters.rod]; did you mean 'radius_mm'?",
        ),
        (
            "shape = \"plane\"",
            "shape = \"plane\"\nradius_mm = 3",
            "study.toml, line 19: 'radius_mm' is no key of [indenters.plate]; use one of shape",
        ),
        (
            "temperature_c",
            "temperature_f",
            "study.toml, line LINE: 'temperature_f' is no key of recording 'slow press'; did you mean 'temperature_c'?",
        ),
        (
            "at_time_s",
            "at_time",
            "study.toml, line LINE: 'at_time' is no key of recording 'scan'; did you mean 'at_time_s'?",
        ),
        (
            "shape = \"cylinder\"",
            "shape = \"cilinder\"",
            "study.toml, line LINE: shape 'cilinder' is not known; did you mean 'cylinder'?",
        ),
        (
            "kind = \"scan\"",
            "kind = \"scam\"",
            "study.toml, line LINE: kind 'scam' is not known; did you mean 'scan'?",
        ),
        (
            "[\"g0_mpa\", \"thickness_mm\"]",
            "[\"g0_mpa\", \"thickness\"]",
            "study.toml, line LINE: fit: 'thickness' is no parameter that can be fitted; did you mean 'thickness_mm'?",
        ),
        (
            "[skin.materials.pad]",
            "[skin.materials.pat]",
            "study.toml, line LINE: there is no region 'pat'; did you mean 'pad'?",
        ),
    ] {
        refused(from, to, expected);
    }
}

#[test]
fn values_of_the_wrong_kind_are_refused() {
    for (from, to, expected) in [
        (
            "radius_mm = 24.0",
            "radius_mm = \"24 mm\"",
            "study.toml, line LINE: radius_mm is no number; give a number, without quotes or unit",
        ),
        (
            "radius_mm = 24.0",
            "radius_mm = nan",
            "study.toml, line LINE: radius_mm is NaN",
        ),
        (
            "radius_mm = 24.0",
            "radius_mm = -1",
            "study.toml, line LINE: radius_mm is -1; give a number above zero",
        ),
        (
            "radius_mm = 24.0\n",
            "",
            "study.toml, line 19: [indenters.rod] has no radius_mm; give its radius in mm",
        ),
        (
            "axis = [0.0, 2.0, 0.0]",
            "axis = [0.0, 2.0]",
            "study.toml, line LINE: axis is no list of three numbers",
        ),
        (
            "axis = [0.0, 2.0, 0.0]",
            "axis = [0, 0, 0]",
            "study.toml, line 19: [indenters.rod] has the axis [0.0, 0.0, 0.0], which points nowhere",
        ),
        (
            "thickness_mm = 7.0",
            "thickness_mm = \"thick\"",
            "study.toml, line LINE: thickness_mm is no number",
        ),
        (
            "title = \"Index fingertip, subject 3\"",
            "title = 3",
            "study.toml, line LINE: title is no plain text",
        ),
        (
            "point_mm = [0.5, 0.25, 0.1]",
            "point_mm = [0.5, 0.25, 5]",
            "study.toml, line 24: [sites.pad] lies 5.0 mm off the skin, whose nearest point is [0.50, 0.25, 0.00]",
        ),
        (
            "indenter = \"rod\"",
            "indenter = \"rood\"",
            "study.toml, line LINE: indenter 'rood' is not defined; did you mean 'rod'?",
        ),
        (
            "site = \"pad\"",
            "site = \"thumb\"",
            "study.toml, line LINE: site 'thumb' is not defined; use one of pad",
        ),
        (
            "name = \"mat\"",
            "name = \"scan\"",
            "study.toml, line 47: recording 'scan' stands twice; give each recording a name of its own",
        ),
        ("title =", "title", "study.toml, line LINE: "),
    ] {
        refused(from, to, expected);
    }
}

#[test]
fn files_outside_the_folder_or_not_there_are_refused() {
    let missing =
        "study.toml, line LINE: file 'slo.csv' is not in the study's folder; check the name";
    refused("file = \"slow.csv\"", "file = \"slo.csv\"", missing);
    for outside in ["/etc/hosts", "../slow.csv", "maps/../../slow.csv"] {
        let expected = format!(
            "study.toml, line LINE: file '{outside}' leaves the study's folder; copy the file into"
        );
        refused(
            "file = \"slow.csv\"",
            &format!("file = \"{outside}\""),
            &expected,
        );
    }
    refused(
        "file = \"slow.csv\"",
        "file = 'maps\\slow.csv'",
        "study.toml, line LINE: file 'maps\\slow.csv' is no file name",
    );
    let folder = Folder::new();
    std::fs::remove_file(folder.path().join("slow.csv")).unwrap();
    std::os::unix::fs::symlink("/etc/hosts", folder.path().join("slow.csv")).unwrap();
    let message = load(&folder).unwrap_err();
    assert!(
        message.contains("line 31: file 'slow.csv' is a link that leaves the study's folder"),
        "{message}"
    );
    let message = Study::load(std::path::Path::new("/nowhere"))
        .unwrap_err()
        .to_string();
    assert_eq!(
        message,
        "/nowhere: it is no folder; name the folder that holds study.toml"
    );
}

#[test]
fn faults_in_files_name_the_file_and_the_line() {
    for (name, text, expected) in [
        (
            "slow.csv",
            "time_s,depth_mm,force_n\n0,0,0\n0,1,2\n",
            "slow.csv, line 3: time does not increase: 0 s follows 0 s",
        ),
        (
            "slow.csv",
            "time_s,depth_mm,force_n\n0,NaN,0\n",
            "slow.csv, line 2: depth: 'NaN' is not a finite number",
        ),
        (
            "slow.csv",
            "time_s,depth_furlong,force_n\n0,0,0\n",
            "slow.csv, line 1: 'furlong' is not a unit of depth; name the column depth_mm",
        ),
        (
            "slow.csv",
            "time_s,force_n\n0,0\n",
            "slow.csv, line 1: the indentation has no depth; add a column depth_mm",
        ),
        ("slow.csv", "", "slow.csv, line 1: the file is empty"),
        (
            "slow.csv",
            "time_s,row,col,pressure_kpa\n0,0,0,3\n",
            "slow.csv, line 1: the file holds 0 indentations, expected one",
        ),
        (
            "regions.csv",
            "vertex,region\n0,pad\n1,pad\n",
            "regions.csv: vertex 2 has no region; add it",
        ),
        (
            "regions.csv",
            "vertex,region\n0,pad\n7,pad\n",
            "regions.csv, line 3: '7' is no vertex, the mesh has 3",
        ),
        (
            "regions.csv",
            "vertex,region\n0,pad\n0,pad\n",
            "regions.csv, line 3: vertex 0 stands twice",
        ),
        (
            "sensels.csv",
            "row,col,x_mm,y_mm,z_mm,area_mm2\n0,0,0,0,0,1\n",
            "sensels.csv: row 0, column 1 of the recording has no place",
        ),
        (
            "sensels.csv",
            "row,col,x_mm,y_mm,z_mm,area_mm2\n0,0,0,0,0,0\n",
            "sensels.csv, line 2: the area is 0 mm2",
        ),
        (
            "sensels.csv",
            "row,col,x,y,z,area\n0,0,0,0,0,1\n",
            "sensels.csv, line 1: x, y, z or area is not there, or without its unit",
        ),
        (
            "maps/mat.csv",
            "time_s,row,col,pressure_raw\n0,0,0,3\n0,0,1,3\n",
            "study.toml, line 38: recording 'mat' holds raw counts, or states no unit; declare it",
        ),
        ("skin.obj", "v 0 0 0\n", "skin.obj: it holds no faces"),
    ] {
        refused_file(name, text, expected);
    }
}

#[test]
fn raw_counts_are_taken_when_declared() {
    let folder = Folder::new();
    folder.write(
        "maps/mat.csv",
        "time_s,row,col,pressure_raw\n0,0,0,3\n0,0,1,3\n",
    );
    folder.write(
        "study.toml",
        STUDY.replace("motion =", "calibrated = false\nmotion ="),
    );
    let study = load(&folder).unwrap();
    let Data::PressureMap { map, .. } = &study.recording("mat").unwrap().data else {
        panic!()
    };
    assert_eq!(map.unit, PressureUnit::RawCounts);
    assert_eq!(
        study.warnings,
        ["mat: not calibrated: only shape and relative size are used"]
    );
    folder.write(
        "study.toml",
        STUDY.replace("motion =", "calibrated = true\nmotion ="),
    );
    let message = load(&folder).unwrap_err();
    assert!(
        message
            .starts_with("study.toml, line 43: calibrated is true, but the file holds raw counts"),
        "{message}"
    );
}
