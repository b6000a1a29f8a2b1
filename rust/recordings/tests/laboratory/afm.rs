//! Force-distance curves of AFM Workshop, and files of other makers that are named though they are not read.

use crate::makers::{near, read, refused};
use thenar_recordings::Format;

/// A curve with these columns of the deflection and these lines of the header.
fn curve(header: &str, deflection: &str, rows: &str) -> String {
    format!(
        "Force-Distance Curve\r\nFile Format:\t3\r\n\r\nMode:\tSingle\r\nX, um:\t25.000000\r\n{header}\r\n\
         Extend Z-Sense(nm),Extend {deflection},Retract Z-Sense(nm),Retract {deflection}\r\n{rows}"
    )
}

const ROWS: &str = "1000.0,4.0,1200.0,40.0\r\n1100.0,4.0,1100.0,0.0\r\n1200.0,44.0,,\r\n";

#[test]
fn afm_workshop_ways_are_one_curve_and_the_cantilever_is_taken_off() {
    let header = "Force Constant, nN/nm:\t2.000000\r\nZ Rate, nm/s:\t500.000000\r\n";
    let file = read(curve(header, "Force(nN)", ROWS).as_bytes());
    let found = &file.curves[0];
    assert_eq!((file.format, found.samples()), (Format::AfmWorkshop, 5));
    let ways: Vec<_> = found
        .segments
        .iter()
        .map(|way| (way.name.as_str(), way.start, way.end))
        .collect();
    assert_eq!(ways, [("extend", 0, 3), ("retract", 3, 5)]);
    // 2 nN/nm: 44 nN bend the cantilever by 22 nm, so that the tip has gone 1,178 nm.
    for (name, at, expected) in [
        ("force_n", 2, 44e-9),
        ("piezo_height_mm", 2, 1200e-6),
        ("travel_mm", 0, 998e-6),
        ("travel_mm", 2, 1178e-6),
        ("travel_mm", 3, 1180e-6),
    ] {
        near(found.channel(name).unwrap()[at], expected);
    }
    near(found.fact("spring_constant_n_per_mm").unwrap(), 2e-3);
    near(found.fact("piezo_speed_mm_per_s").unwrap(), 500e-6);
    assert!(found.channel("time_s").is_none());
}

#[test]
fn afm_workshop_without_stiffness_has_no_travel_and_in_volts_no_force() {
    let found = &read(curve("", "Force(nN)", ROWS).as_bytes()).curves[0];
    assert!(found.channel("travel_mm").is_none());
    near(found.channel("force_n").unwrap()[2], 44e-9);
    assert!(
        found
            .unknown
            .iter()
            .any(|text| text.starts_with("the travel: the height is the piezo's"))
    );
    let found =
        &read(curve("Force Constant, nN/nm:\t1.000000\r\n", "T-B(V)", ROWS).as_bytes()).curves[0];
    assert!(found.channel("force_n").is_none() && found.channel("travel_mm").is_none());
    near(found.channel("deflection_as_V").unwrap()[2], 44.0);
    assert!(
        found
            .unknown
            .iter()
            .any(|text| text.starts_with("the force: the deflection is recorded in volts"))
    );
}

#[test]
fn afm_workshop_faults_name_their_line() {
    let bad = [
        (
            "1000.0,4.0,1200.0,40.0\r\n1100.0,x,1100.0,0.0\r\n",
            "line 9: 'x' is not a number",
        ),
        (
            "1000.0,4.0,1200.0,40.0\r\n1100.0,,1100.0,0.0\r\n",
            "line 9: the row ends in a sample",
        ),
        ("", "the first sample"),
    ];
    for (rows, words) in bad {
        let message = refused(curve("", "Force(nN)", rows).as_bytes());
        assert!(message.contains(words), "{message}");
    }
    let message = refused(curve("", "Sum(V)", ROWS).as_bytes());
    assert!(
        message.contains("no two columns 'Extend Z-Sense(nm)'"),
        "{message}"
    );
}

/// A header of Igor's version 5 in either order of bytes, whose words sum up to zero.
fn igor(is_little: bool) -> Vec<u8> {
    let word = |number: u16| {
        if is_little {
            number.to_le_bytes()
        } else {
            number.to_be_bytes()
        }
    };
    let mut bytes = vec![0; 500];
    bytes[..2].copy_from_slice(&word(5));
    bytes[10..12].copy_from_slice(&word(1234));
    bytes[2..4].copy_from_slice(&word(0u16.wrapping_sub(5 + 1234)));
    bytes
}

#[test]
fn files_of_other_makers_are_named() {
    let mut broken = igor(true);
    broken[100] = 1;
    for (bytes, words) in [
        (igor(true), "an Igor binary wave"),
        (igor(false), "an Igor binary wave"),
        (broken, "no recording format that is known"),
        (b"\x89HDF\r\n\x1a\n...".to_vec(), "an HDF5 file"),
        (
            b"\\*Force file list\r\n\\Version: 0x09".to_vec(),
            "a Bruker Nanoscope force file",
        ),
        (b"II*\0....".to_vec(), "a TIFF picture"),
        (b"\x1f\x8b\x08....".to_vec(), "packed with gzip"),
        (b"%PDF-1.4".to_vec(), "a PDF report"),
    ] {
        let message = refused(&bytes);
        assert!(
            message.contains(words) && !message.contains("damaged"),
            "{message}"
        );
    }
}

#[test]
fn a_line_of_text_among_the_samples_is_no_damage() {
    let table = "Depth (nm)\tLoad (uN)\tTime (s)\n1\t2\t0\neoh\n2\t3\t1\n";
    assert_eq!(
        refused(table.as_bytes()),
        "a, line 3: the line 'eoh' is no sample; take the line out of the file"
    );
    let cut = "Depth (nm)\tLoad (uN)\tTime (s)\n1\t2\t0\n2\t3\n";
    assert!(refused(cut.as_bytes()).contains("damaged or cut short"));
}
