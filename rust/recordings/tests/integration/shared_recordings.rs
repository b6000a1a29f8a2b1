//! The real recordings beside the repository: each is read, and its own totals are met.

use std::path::{Path, PathBuf};
use thenar_recordings::{Curve, Format, PressureMap, PressureUnit, RecordingFile, read};

/// Where the recordings lie, or `None` with a line that says so.
fn folder() -> Option<PathBuf> {
    let beside = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/recordings");
    let folder = std::env::var_os("THENAR_RECORDINGS").map_or(beside, PathBuf::from);
    if folder.is_dir() {
        return Some(folder);
    }
    println!(
        "skipped: no recordings in {} (set THENAR_RECORDINGS)",
        folder.display()
    );
    None
}

fn file(name: &str) -> Option<RecordingFile> {
    let recording = read(&folder()?.join(name)).unwrap_or_else(|error| panic!("{error}"));
    Some(recording)
}

fn map(name: &str) -> Option<PressureMap> {
    let mut maps = file(name)?.maps;
    assert_eq!(maps.len(), 1, "{name}");
    maps.pop()
}

fn curve(name: &str) -> Option<Curve> {
    let mut curves = file(name)?.curves;
    assert_eq!(curves.len(), 1, "{name}");
    curves.pop()
}

fn close(found: f64, expected: f64, tolerance: f64) {
    assert!(
        (found - expected).abs() <= tolerance,
        "{found} is not {expected} within {tolerance}"
    );
}

/// The one check of a name, which must cover all frames and agree.
fn agrees(map: &PressureMap, what: &str, tolerance: f64) {
    let check = map.checks.iter().find(|check| check.what == what).unwrap();
    println!("{check}");
    assert_eq!(check.compared, map.frames());
    assert!(check.tolerance <= tolerance && check.agrees(), "{check}");
}

fn largest(map: &PressureMap, of: impl Fn(usize) -> f64) -> f64 {
    (0..map.frames()).map(of).fold(0.0, f64::max)
}

#[test]
fn every_file_is_read() {
    let Some(folder) = folder() else { return };
    let (mut count, mut pending) = (0, vec![folder]);
    while let Some(folder) = pending.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                pending.push(path);
                continue;
            }
            let name = path.file_name().unwrap().to_str().unwrap().to_string();
            if ["SOURCE.md", "LICENSE.txt", "published_fit_parameters.json"]
                .contains(&name.as_str())
            {
                continue;
            }
            let file = read(&path).unwrap_or_else(|error| panic!("{error}"));
            let samples: usize = file.curves.iter().map(Curve::samples).sum();
            let frames: usize = file.maps.iter().map(PressureMap::frames).sum();
            assert!(
                samples + frames > 100,
                "{name}: {samples} samples, {frames} frames"
            );
            println!(
                "{name}: {}, {samples} samples, {frames} frames",
                file.format.name()
            );
            count += 1;
        }
    }
    assert_eq!(count, 29);
}

#[test]
fn iscan_raw_sums_are_met_exactly_and_counts_are_no_pressure() {
    let Some(map) = map("finger_pressure_iscan/iscan_test.csv") else {
        return;
    };
    agrees(&map, "raw sum", 0.0);
    assert_eq!(
        (map.frames(), map.sensels.len(), map.unit),
        (309, 784, PressureUnit::RawCounts)
    );
    assert_eq!(
        map.frame(0).iter().filter(|value| value.is_nan()).count(),
        300
    );
    assert_eq!(
        (map.pitch_mm, map.sensels[0].area_mm2),
        (Some([1.27, 1.27]), Some(1.6129))
    );
    assert_eq!(map.force_n(0), None);
    close(map.time_s.as_ref().unwrap()[308], 31.1, 1e-9);
    // Peaks of the eleven presses, as its SOURCE.md counts them.
    let sums: Vec<f64> = (0..309).map(|frame| map.sum(frame)).collect();
    for peak in [
        813.0, 823.0, 838.0, 763.0, 787.0, 798.0, 782.0, 749.0, 745.0, 741.0, 609.0,
    ] {
        assert!(sums.contains(&peak), "{peak}");
    }
    // A cell that reads about 5 in every frame.
    assert!((0..309).all(|frame| map.frame(frame)[3 * 28 + 12] > 0.0));
}

#[test]
fn emed_totals_are_met() {
    let Some(map) = map("plantar_pressure_exports/emed_test.lst") else {
        return;
    };
    agrees(&map, "total force", 0.005);
    assert_eq!(map.frames(), 106);
    assert_eq!(map.grid().unwrap().first, [30, 26]);
    close(largest(&map, |frame| map.peak(frame)), 370.0, 0.5);
    close(map.time_s.as_ref().unwrap()[105], 1.05, 1e-9);
}

#[test]
fn pliance_totals_are_met() {
    let Some(map) = map("plantar_pressure_exports/pliance_test.asc") else {
        return;
    };
    agrees(&map, "total force", 0.01);
    assert_eq!((map.frames(), map.sensels.len()), (281, 812));
    close(
        largest(&map, |frame| map.force_n(frame).unwrap()),
        230.6,
        0.05,
    );
    close(largest(&map, |frame| map.peak(frame)), 140.0, 0.5);
    assert_eq!(map.sensels[0].number, Some(4));
    close(map.sensels[0].center_mm.unwrap()[1], 292.98, 1e-9);
}

#[test]
fn xsensor_totals_are_met_and_groups_are_no_sensors() {
    let Some(file) = file("plantar_pressure_exports/xsensor_data.csv") else {
        return;
    };
    assert_eq!((file.format, file.maps.len()), (Format::Xsensor, 2));
    for map in &file.maps {
        agrees(map, "estimated load", 1.0);
        agrees(map, "peak pressure", 0.001);
        agrees(map, "contact area", 1.2);
        assert_eq!((map.frames(), map.sensels.len()), (101, 341));
        close(map.threshold.unwrap().value, 51.72 * 0.133322, 1e-4);
    }
}

#[test]
fn fscan_is_calibrated_and_its_limits_are_said() {
    let Some(map) = map("plantar_pressure_exports/fscan_testL.asf") else {
        return;
    };
    assert_eq!(
        (map.frames(), map.sensels.len(), map.unit),
        (205, 1260, PressureUnit::Kilopascal)
    );
    close(largest(&map, |frame| map.peak(frame)), 760.0, 0.5);
    close(
        largest(&map, |frame| map.force_n(frame).unwrap()),
        924.4,
        0.05,
    );
    close(map.clipped_from.unwrap(), 1514.73, 0.5);
    assert_eq!(map.clipped_count(), 0);
    assert_eq!(map.threshold.unwrap().unit, PressureUnit::RawCounts);
}

#[test]
fn aurora_samples_agree_with_their_conversion() {
    for target in ["0100", "0400", "0800", "1000"] {
        let name = |ending| format!("skin_indent_force_ramp/target_{target}mN.{ending}");
        let (Some(ours), Some(converted)) = (curve(&name("ddf")), curve(&name("csv"))) else {
            return;
        };
        assert_eq!(ours.samples(), converted.samples());
        for (channel, tolerance) in [
            ("time_s", 1e-9),
            ("travel_mm", 1e-6),
            ("force_n", 1e-6),
            ("force_command_n", 1e-6),
        ] {
            let pairs = ours
                .channel(channel)
                .unwrap()
                .iter()
                .zip(converted.channel(channel).unwrap());
            pairs.for_each(|(ours, theirs)| close(*ours, *theirs, tolerance));
        }
        assert_eq!(ours.protocol.len(), 5);
    }
}

#[test]
fn chiaro_and_jpk_agree_with_their_conversions() {
    let sphere = "afm_gel_and_soft_matrix/chiaro_sphere_indentation";
    let (Some(ours), Some(converted)) = (
        curve(&format!("{sphere}.txt")),
        curve(&format!("{sphere}.csv")),
    ) else {
        return;
    };
    close(ours.fact("tip_radius_mm").unwrap(), 0.0275, 1e-12);
    close(
        ours.fact("spring_constant_n_per_mm").unwrap(),
        1.9e-5,
        1e-15,
    );
    close(
        ours.fact("instrument_effective_modulus_mpa").unwrap(),
        156.009e-6,
        1e-12,
    );
    close(converted.fact("tip_radius_mm").unwrap(), 0.0275, 1e-12);
    close(
        converted.fact("spring_constant_n_per_mm").unwrap(),
        1.9e-5,
        1e-15,
    );
    // The conversion keeps every second sample.
    let every_second = ours.channel("force_n").unwrap().iter().step_by(2);
    every_second
        .zip(converted.channel("force_n").unwrap())
        .for_each(|(ours, theirs)| close(*ours, *theirs, 1e-12));

    let gel = "afm_gel_and_soft_matrix/polymer_gel_creep";
    let (Some(ours), Some(converted)) = (
        curve(&format!("{gel}.jpk-force")),
        curve(&format!("{gel}.csv")),
    ) else {
        return;
    };
    close(
        ours.fact("spring_constant_n_per_mm").unwrap(),
        6.1e-5,
        1e-12,
    );
    assert_eq!(
        (
            ours.samples(),
            ours.segments.len(),
            converted.segments.len()
        ),
        (9000, 3, 3)
    );
    // The conversion calls the measured height the piezo's.
    for (channel, theirs, tolerance) in [
        ("force_n", "force_n", 1e-14),
        ("measured_height_mm", "piezo_height_mm", 1e-9),
        ("time_s", "time_s", 1e-6),
    ] {
        let ours = ours.channel(channel).unwrap().iter();
        let pairs = ours.zip(converted.channel(theirs).unwrap());
        pairs.for_each(|(ours, theirs)| close(*ours, *theirs, tolerance));
    }
}

#[test]
fn silicone_is_read_with_its_size() {
    let Some(curve) = curve("silicone_compression/EF10_0T_A1.csv") else {
        return;
    };
    close(
        *curve.channel("depth_mm").unwrap().last().unwrap(),
        20.0,
        1e-3,
    );
    close(
        *curve.channel("force_n").unwrap().last().unwrap(),
        499.32315,
        1e-9,
    );
    close(curve.fact("cylinder_diameter_mm").unwrap(), 50.0, 0.0);
    close(curve.fact("cylinder_height_mm").unwrap(), 30.0, 0.0);
}
