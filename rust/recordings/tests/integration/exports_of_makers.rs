//! Each maker's export gives what it says, in the library's units, and nothing that it does not say.

use crate::exports;

use exports::*;
use thenar_recordings::{Format, PressureUnit, RecordingFile};

const MMHG: f64 = 0.133_322_387_415;

fn read(bytes: &[u8], format: Format) -> RecordingFile {
    let file = export(bytes).unwrap();
    assert_eq!(file.format, format);
    file
}

/// Equal to a relative 1e-12, NaN where NaN is expected.
fn equal(found: &[f64], expected: &[f64]) {
    let same = |(a, b): (&f64, &f64)| {
        (a.is_nan() && b.is_nan()) || (a - b).abs() <= 1e-12 * b.abs().max(1e-12)
    };
    assert!(
        found.len() == expected.len() && found.iter().zip(expected).all(same),
        "{found:?} is not {expected:?}"
    );
}

#[test]
fn tekscan_keeps_missing_clipped_and_mirrored() {
    let file = read(TEKSCAN.as_bytes(), Format::Tekscan);
    let map = &file.maps[0];
    equal(
        &map.values,
        &[
            f64::NAN,
            10.0,
            20.0,
            0.0,
            0.0,
            5.0,
            f64::NAN,
            345.0,
            20.0,
            1.0,
            0.0,
            5.0,
        ],
    );
    equal(map.time_s.as_ref().unwrap(), &[0.0, 0.5]);
    assert_eq!(
        (map.unit, map.clipped_count()),
        (PressureUnit::Kilopascal, 1)
    );
    assert_eq!(
        (map.pitch_mm, map.is_mirrored),
        (Some([4.0, 5.0]), [Some(false), Some(true)])
    );
    // 390 kPa on 20 mm2 cells: 371 kPa x 20 mm2 = 7.42 N.
    equal(
        &[
            map.force_n(1).unwrap(),
            map.contact_area_mm2(1, 0.0).unwrap(),
        ],
        &[7.42, 80.0],
    );
    assert_eq!(map.sensels[5].place, Some([1, 2]));
    assert_eq!(map.source.sensor, "4256E");
}

#[test]
fn raw_counts_stay_counts_and_their_sums_are_checked() {
    let file = read(ISCAN.as_bytes(), Format::Tekscan);
    let map = &file.maps[0];
    assert_eq!(
        (map.unit, map.force_n(0), map.clipped_count()),
        (PressureUnit::RawCounts, None, 1)
    );
    assert!(map.checks[0].agrees() && map.checks[0].compared == 2 && map.warnings.is_empty());
    let changed = export(ISCAN.replace("Raw Sum=,,35", "Raw Sum=,,36").as_bytes()).unwrap();
    assert!(!changed.maps[0].checks[0].agrees());
    assert_eq!(
        changed.maps[0].warnings,
        [
            "raw sum of 2 frames disagrees with the file's own: 1.000 counts apart at most (frame 0), 0 counts allowed; the file was \
          changed after export or is damaged"
        ]
    );
}

#[test]
fn pedar_gives_both_insoles_and_asks_which_is_which() {
    let file = read(PEDAR.as_bytes(), Format::Pedar);
    let [left, right] = &file.maps[..] else {
        panic!()
    };
    assert_eq!(
        (left.name.as_str(), right.name.as_str()),
        ("left insole", "right insole")
    );
    equal(&left.values, &[15.0, 20.0, 2.5, 17.5, 22.5, 0.0]);
    equal(&right.values, &[0.0, 7.5, 2.5, 5.0]);
    equal(right.time_s.as_ref().unwrap(), &[0.02, 0.04]);
    assert_eq!((left.force_n(0), left.sensels[2].number), (None, Some(3)));
    assert!(left.warnings[0].contains("confirm"));
}

#[test]
fn pliance_skips_summaries_and_uses_its_geometry() {
    let file = read(PLIANCE.as_bytes(), Format::Pliance);
    let map = &file.maps[0];
    equal(&map.values, &[20.0, 5.0, 40.0, 0.0]);
    assert_eq!(map.sensels[1].center_mm, Some([20.0, 5.0]));
    assert_eq!(map.sensels[1].area_mm2, Some(200.0));
    // 20 kPa on 1 cm2 and 5 kPa on 2 cm2 are 3 N.
    equal(
        &[map.force_n(0).unwrap(), map.force_n(1).unwrap()],
        &[3.0, 4.0],
    );
    assert_eq!((map.checks[0].compared, map.checks[0].agrees()), (2, true));
}

#[test]
fn emed_places_its_window_and_skips_summaries() {
    let file = read(&emed(), Format::Emed);
    let map = &file.maps[0];
    equal(&map.values, &[10.0, 20.0, 0.0, 40.0, 0.0, 20.0, 0.0, 0.0]);
    assert_eq!(
        (map.sensels[0].place, map.sensels[3].place),
        (Some([30, 26]), Some([31, 27]))
    );
    equal(map.time_s.as_ref().unwrap(), &[0.0, 0.02]);
    assert_eq!(
        (map.pitch_mm, map.checks[0].agrees()),
        (Some([4.0, 5.0]), true)
    );
    equal(&[map.force_n(0).unwrap()], &[1.75]);
}

#[test]
fn xsensor_groups_are_no_sensors_and_midnight_passes() {
    let file = read(XSENSOR.as_bytes(), Format::Xsensor);
    assert_eq!(file.maps.len(), 1);
    let map = &file.maps[0];
    equal(
        map.frame(0),
        &[0.0, 20.0 * MMHG, 15.0 * MMHG, 0.0, 40.0 * MMHG, 25.0 * MMHG],
    );
    equal(map.time_s.as_ref().unwrap(), &[0.0, 0.5]);
    assert_eq!((map.pitch_mm, map.checks.len()), (Some([20.0, 10.0]), 3));
    assert!(map.checks.iter().all(|check| check.agrees()) && map.warnings.is_empty());
    assert!(map.unknown.iter().any(|text| text.contains("outline")));
}

#[test]
fn footscan_has_a_frame_for_each_foot_and_states_no_unit() {
    let file = read(FOOTSCAN.as_bytes(), Format::Footscan);
    let [left, right] = &file.maps[..] else {
        panic!()
    };
    assert_eq!(
        (left.name.as_str(), left.unit),
        ("left foot", PressureUnit::NotStated)
    );
    equal(right.frame(1), &[5.0, 6.0, 7.0, 8.0]);
    assert_eq!(
        (right.sensels[0].place, right.time_s.clone()),
        (Some([4, 9]), Some(vec![0.0, 0.002]))
    );
}

#[test]
fn logger_soles_are_apart_and_empty_cells_missing() {
    let file = read(LOGGER.as_bytes(), Format::InsoleLogger);
    let [left, right] = &file.maps[..] else {
        panic!()
    };
    equal(&left.values, &[5.0, 6.0, 9.0, f64::NAN]);
    equal(left.time_s.as_ref().unwrap(), &[0.0, 0.01]);
    equal(right.time_s.as_ref().unwrap(), &[0.004]);
    assert_eq!(left.unit, PressureUnit::RawCounts);
}

#[test]
fn aurora_volts_become_length_and_force() {
    let file = read(AURORA.as_bytes(), Format::Aurora);
    let curve = &file.curves[0];
    equal(curve.channel("travel_mm").unwrap(), &[0.0, 1.0]);
    equal(curve.channel("force_n").unwrap(), &[0.05, 0.1]);
    equal(curve.channel("force_command_n").unwrap(), &[0.1, 0.1]);
    equal(curve.channel("time_s").unwrap(), &[0.0, 0.001]);
    assert_eq!(curve.protocol, ["0.2 | Ramp | Force Out | 400, 0.05"]);
    assert!(curve.channel("depth_mm").is_none() && curve.channels.len() == 4);
}

#[test]
fn optics11_travel_is_piezo_less_cantilever() {
    let file = read(&optics11(), Format::Optics11);
    let curve = &file.curves[0];
    equal(curve.channel("travel_mm").unwrap(), &[1e-4, 1e-3]);
    equal(curve.channel("force_n").unwrap(), &[0.0, 1e-7]);
    let facts = [
        "tip_radius_mm",
        "spring_constant_n_per_mm",
        "max_load_n",
        "instrument_effective_modulus_mpa",
    ];
    equal(
        &facts.map(|name| curve.fact(name).unwrap()),
        &[0.025, 5e-4, 5e-8, 156.009e-6],
    );
    assert_eq!(curve.source.product, "Chiaro");
}

#[test]
fn jpk_text_and_archive_give_force_travel_and_segments() {
    let file = read(JPK_TEXT.as_bytes(), Format::JpkText);
    let curve = &file.curves[0];
    equal(curve.channel("force_n").unwrap(), &[0.0, 1e-9, 1e-9]);
    equal(curve.channel("time_s").unwrap(), &[0.0, 0.1, 0.2]);
    // Down by 1 um, less 1 nN / 0.05 N/m = 20 nm of bending.
    equal(
        curve.channel("travel_mm").unwrap(),
        &[-5e-3, -4.02e-3, -4.02e-3],
    );
    let segments: Vec<_> = curve
        .segments
        .iter()
        .map(|part| (part.name.as_str(), part.start, part.end))
        .collect();
    assert_eq!(segments, [("extend", 0, 2), ("retract", 2, 3)]);

    let file = read(&jpk_archive(), Format::JpkArchive);
    let curve = &file.curves[0];
    // (0.1 x 10 + 1) V x 2e-8 m/V x 0.5 N/m.
    equal(curve.channel("force_n").unwrap(), &[1e-8, 2e-8]);
    equal(curve.channel("piezo_height_mm").unwrap(), &[9e-3, -2e-3]);
    equal(curve.channel("time_s").unwrap(), &[0.0, 0.1]);
    equal(&[curve.fact("spring_constant_n_per_mm").unwrap()], &[5e-4]);
}

#[test]
fn workbook_sheets_of_specimens_are_curves() {
    let file = read(&workbook(), Format::Workbook);
    assert_eq!(file.curves.len(), 1);
    let curve = &file.curves[0];
    assert_eq!(curve.name, "Eprouvette 1");
    equal(curve.channel("time_s").unwrap(), &[0.0, 0.5]);
    equal(curve.channel("force_n").unwrap(), &[0.1, 2.5]);
    equal(curve.channel("travel_mm").unwrap(), &[0.0, 1.0]);
}

#[test]
fn tables_convert_units_and_keep_empty_cells_missing() {
    let file = read(INSTRON.as_bytes(), Format::CurveTable);
    let curve = &file.curves[0];
    equal(curve.channel("depth_mm").unwrap(), &[0.0, 0.25]);
    equal(curve.channel("force_n").unwrap(), &[-0.01, 1.5]);
    equal(&[curve.fact("cylinder_diameter_mm").unwrap()], &[50.0]);
    assert_eq!(curve.source.maker, "Instron");
    let curve = &read(CURVE.as_bytes(), Format::CurveTable).curves[0];
    equal(curve.channel("force_n").unwrap(), &[0.0, 2.0]);
    equal(curve.channel("area_mm2").unwrap(), &[f64::NAN, 12.5]);

    let map = &read(MAP.as_bytes(), Format::MapTable).maps[0];
    let places: Vec<_> = map
        .sensels
        .iter()
        .map(|sensel| sensel.place.unwrap())
        .collect();
    assert_eq!(places, [[0, 0], [0, 1], [1, 1]]);
    equal(&map.values, &[3.0, 4.0, 0.0, f64::NAN, f64::NAN, 9.0]);
    assert_eq!(
        (map.phases.clone(), map.grid()),
        (vec!["load".to_string(), "hold".to_string()], None)
    );
}

#[test]
fn nobody_is_named() {
    let archives = [jpk_archive(), workbook()];
    for bytes in texts().into_iter().map(|(_, bytes)| bytes).chain(archives) {
        let text = format!("{:?}", export(&bytes).unwrap());
        assert!(!text.contains("Doe") && !text.contains("people"), "{text}");
    }
}

#[test]
fn line_ends_marks_and_decimal_commas_change_nothing() {
    for (name, bytes) in texts() {
        let expected = format!("{:?}", export(&bytes).unwrap());
        let plain: Vec<u8> = bytes
            .iter()
            .copied()
            .filter(|byte| *byte != b'\r')
            .collect();
        for end in [&b"\r\n"[..], b"\n\r", b"\r\r\n", b"\r"] {
            let changed = plain
                .split(|byte| *byte == b'\n')
                .collect::<Vec<_>>()
                .join(end);
            assert_eq!(
                format!("{:?}", export(&changed).unwrap()),
                expected,
                "{name} with {end:?}"
            );
        }
    }
    for (text, tabs) in [(PEDAR, " 15.000"), (PLIANCE, "20.000")] {
        let changed = text.replace(tabs, &tabs.replace('.', ","));
        assert_eq!(
            format!("{:?}", export(changed.as_bytes())),
            format!("{:?}", export(text.as_bytes()))
        );
    }
}
