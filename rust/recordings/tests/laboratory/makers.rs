//! What makers' programs write besides the plain case: other keys, other places, other instruments.

use std::path::Path;
use thenar_recordings::{Format, ReadOptions, RecordingFile, read_bytes, read_bytes_with};

pub fn read(bytes: &[u8]) -> RecordingFile {
    read_bytes(bytes, Path::new("a")).unwrap_or_else(|error| panic!("{error}"))
}

pub fn refused(bytes: &[u8]) -> String {
    read_bytes(bytes, Path::new("a")).unwrap_err().to_string()
}

pub fn near(found: f64, expected: f64) {
    assert!(
        (found - expected).abs() <= 1e-9 * expected.abs().max(1e-9),
        "{found} is not {expected}"
    );
}

/// XSENSOR PRO 7: keys with colons; `cell` writes a number, `pitch` its unit and size.
fn xsensor_pro(cell: impl Fn(f64) -> String, pitch: (&str, &str)) -> String {
    let frame = |number: usize| {
        let row = |cells: [f64; 3]| cells.map(&cell).join(",") + "\n";
        format!(
            "Frame:,{number},,\nDate:, 2024 Mar 03,,\nTime:, 10:00:0{number}.000,,\nSensor:,PX S1,,\nRows:,2,,\nColumns:,3,,\n\
             Sensel Width ({unit}):,{size},,\nSensel Height ({unit}):,{size},,\nPeak Pressure (N/cm2):,{peak},,\nCOP Row:,2,,\nSensels:,,,\n{}{}\n",
            row([0.0, 2.5, 4.0]),
            row([1.0, 10.0, 40.0]),
            unit = pitch.0,
            size = pitch.1,
            peak = cell(40.0),
        )
    };
    format!(
        "File:,\"demo.xsn\",,\nUnits:,N/cm2,,\nThreshold:,{},,\n\n{}{}",
        cell(1.0),
        frame(1),
        frame(2)
    )
}

#[test]
fn xsensor_pro_keys_commas_and_inches() {
    let comma = |number: f64| format!("\"{}\"", format!("{number:.2}").replace('.', ","));
    for text in [
        xsensor_pro(|number| format!("{number:.2}"), ("cm", "1.27")),
        xsensor_pro(comma, ("cm", "\"1,27\"")),
        xsensor_pro(comma, ("in", "\"0,50\"")),
        xsensor_pro(|number| format!("{number:.2}"), ("mm", "12.7")),
    ] {
        let file = read(text.as_bytes());
        let map = &file.maps[0];
        assert_eq!(
            (file.format, map.frames(), map.sensels.len()),
            (Format::Xsensor, 2, 6),
            "{text}"
        );
        near(map.peak(1), 400.0);
        near(map.pitch_mm.unwrap()[0], 12.7);
        // 57.5 N/cm2 on cells of 1.6129 cm2.
        near(map.force_n(0).unwrap(), 57.5 * 1.6129);
        near(map.time_s.as_ref().unwrap()[1], 1.0);
        assert!(map.warnings.is_empty(), "{:?}", map.warnings);
    }
    let rows = xsensor_pro(|number| format!("{number}"), ("cm", "1.27"));
    let rows = rows.lines().map(|line| {
        line.split(',')
            .map(|cell| cell.trim_matches('"').to_string())
            .collect()
    });
    let file = read(&crate::sheets::workbook(&[("Sheet1", rows.collect())]));
    near(file.maps[0].force_n(0).unwrap(), 57.5 * 1.6129);
}

#[test]
fn footscan_numbers_in_the_line_below() {
    let text = "Dynamic Roll off\n\nRight foot data\n\nRight rectangle position\nRectangle bottom\n6\nRectangle left\n40\n\
        Rectangle width\n2\nRectangle height\n2\n\nFrame 0 (0.00 ms)\n0\t1.5\n2\t3\n\nFrame 1 (2.00 ms)\n4\t5\n6\t7\n";
    let map = &read(text.as_bytes()).maps[0];
    assert_eq!(map.frame(0), [0.0, 1.5, 2.0, 3.0]);
    assert_eq!(map.time_s.as_deref(), Some(&[0.0, 0.002][..]));
    assert_eq!(map.sensels[0].place, Some([6, 40]));
    assert!(
        refused(text.replace("\n6\n", "\nsix\n").as_bytes())
            .starts_with("a, line 7: 'six' is no place on the plate")
    );
}

#[test]
fn a_tekscan_graph_is_a_curve() {
    let rows: String = (0..20)
        .map(|k| {
            format!(
                "{}, {:.2}, {:.3}, 100.0, 30.0\n",
                k + 1,
                0.02 * f64::from(k),
                1.5 * f64::from(k)
            )
        })
        .collect();
    let text = format!(
        "DATA_TYPE GRAPH\nVERSION Tekscan Pressure Measurement System 7.60\nSENSOR_TYPE 4256E\nROWS 3\nCOLS 4\nUNITS KPa\nASCII_DATA @@\n\
         Frame(-), Time(s), Force(N), Contact Area(mm2), Peak Pressure(KPa)\n{rows}@@\n"
    );
    let file = read(text.as_bytes());
    let curve = &file.curves[0];
    assert_eq!(
        (file.format, file.maps.len(), curve.samples()),
        (Format::Tekscan, 0, 20)
    );
    near(curve.channel("force_n").unwrap()[19], 28.5);
    near(curve.channel("time_s").unwrap()[19], 0.38);
    assert_eq!(curve.source.sensor, "4256E");
    assert!(
        curve
            .unknown
            .iter()
            .any(|text| text.starts_with("the pressures: the file is a graph"))
    );
}

#[test]
fn one_insole_takes_the_name_of_its_mask() {
    let text = |masks: &str| {
        format!(
            "file name:  t.sol\nsensor type:  y\npressure values in  kPa\n\nmask definition: \n{masks}\ntime[secs]\t1\t2\t3\n\
             0.02\t10.0\t0.0\t2.5\n0.04\t5.0\t0.0\t2.5\n"
        )
    };
    for (masks, name) in [
        ("right insole: 1,2,3\n", "right insole"),
        ("left insole: 1,2\nright insole: 1,2,3\n", "right insole"),
        ("left insole: 1,2,3\nright insole: 1,2,3\n", "one insole"),
    ] {
        let file = read(text(masks).as_bytes());
        assert_eq!((file.maps.len(), file.maps[0].name.as_str()), (1, name));
        assert_eq!(file.maps[0].frame(1), [5.0, 0.0, 2.5]);
    }
}

#[test]
fn a_fit_that_the_instrument_did_not_find_is_not_known() {
    let text = "Date\t01/01/2024\nk (N/m)\t0.019\nTip radius (um)\t27.5\nDevice\tPiuma\nP[max] (uN)\tNaN\nE[eff] (Pa)\tNaN\n\n\
        Time (s)\tLoad (uN)\tIndentation (nm)\tCantilever (nm)\tPiezo (nm)\tAuxiliary\n0\t0\t0\t0\t0\t0\n0.001\t0.029\t1\t2\t10\t0\n";
    let curve = &read(text.as_bytes()).curves[0];
    near(curve.channel("force_n").unwrap()[1], 29e-9);
    assert_eq!(curve.fact("instrument_effective_modulus_mpa"), None);
    assert!(
        curve
            .unknown
            .contains(&"E[eff] (Pa): the instrument states NaN".to_string())
    );
    // A stiffness that is no number is a fault still.
    assert!(
        refused(text.replace("0.019", "soft").as_bytes())
            .starts_with("a, line 2: k (N/m): 'soft' is not a number")
    );
}

/// A Mach-1 file of two blocks with the force in grams.
const MACH1: &str = "<Mach-1 File>\n<INFO>\nTime:\t10:00\n<END INFO>\n<Find Contact>\nStage Velocity, mm/s:\t0.1\n<DATA>\nTime, s\tPosition (z), mm\tFz, gf\n\
    0\t1\t0\n0.5\t2\t10\n<END DATA>\n<INFO>\n<END INFO>\n<Stress Relaxation>\n<DATA>\nTime, s\tPosition (z), mm\tFz, gf\n0\t2\t10\n1\t3\t20\n2\t3\t15\n<END DATA>\n";

#[test]
fn mach1_blocks_are_runs_with_clocks_of_their_own() {
    let file = read(MACH1.as_bytes());
    let names: Vec<&str> = file
        .curves
        .iter()
        .map(|curve| curve.name.as_str())
        .collect();
    assert_eq!(
        (file.format, names),
        (Format::Mach1, vec!["1 Find Contact", "2 Stress Relaxation"])
    );
    // 20 g of force are 0.196133 N.
    near(file.curves[1].channel("force_n").unwrap()[1], 0.196_133);
    assert!(file.curves[1].channel("travel_mm").is_none());
    let mut options = ReadOptions {
        run: Some("2 Stress Relaxation".into()),
        ..ReadOptions::default()
    };
    options.columns.add("travel", "Position (z)").unwrap();
    let named = read_bytes_with(MACH1.as_bytes(), Path::new("a"), &options).unwrap();
    assert_eq!(named.curves.len(), 1);
    assert_eq!(
        named.curves[0].channel("travel_mm").unwrap(),
        [2.0, 3.0, 3.0]
    );
    // Files of tests that were stopped end behind a whole row; what is cut within one is damaged.
    let stopped = read(&MACH1.as_bytes()[..MACH1.len() - "<END DATA>\n".len()]);
    let last = &stopped.curves[1];
    assert_eq!(last.channel("time_s").unwrap(), [0.0, 1.0, 2.0]);
    assert!(
        last.warnings.iter().any(|text| text
            == "the file ends at line 19 without <END DATA>: more samples may have followed, and a row without line end is left out"),
        "{:?}",
        last.warnings
    );
    assert!(stopped.curves[0].warnings.is_empty());
    // 15 gf, cut to 1 gf; 20 gf before it.
    let within = read(&MACH1.as_bytes()[..MACH1.len() - "5\n<END DATA>\n".len()]);
    let last = &within.curves[1];
    assert_eq!(last.channel("time_s").unwrap(), [0.0, 1.0]);
    assert!((last.channel("force_n").unwrap()[1] - 20.0 * 9.80665e-3).abs() < 1e-9);
    let cut = refused(&MACH1.as_bytes()[..MACH1.len() - "\t15\n<END DATA>\n".len()]);
    assert!(
        cut.contains("line 19: the row holds 2 values, expected 3"),
        "{cut}"
    );
}

#[test]
fn a_table_of_statistics_is_called_so() {
    let table = "File:,\"C:\\a.XSN\"\nFrame,Date,Time,Units,Threshold,Sensor,Rows,Columns,Average Pressure,Peak Pressure,Contact Area (cm²),Est. Load (N)\n\
        1,\"2024 Nov 19\",\"12:39:04\",mmHg,\"5,0\",\"LX\",36,36,\"55,53\",\"256,0\",\"1962,9\",\"1453,28\"\n";
    assert_eq!(
        refused(table.as_bytes()),
        "a: this is XSENSOR's table of statistics, a row for each frame, without the pressures of the cells; \
         export the frames with their sensels as CSV"
    );
}
