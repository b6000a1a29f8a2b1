//! Where units and names are in a table, and which column is what.

use crate::sheets::{Rows, row, samples};
use std::path::Path;
use thenar_recordings::{Curve, ReadOptions, RecordingFile, read_bytes, read_bytes_with};

pub fn read(bytes: &[u8]) -> RecordingFile {
    read_bytes(bytes, Path::new("a.csv")).unwrap_or_else(|error| panic!("{error}"))
}

pub fn refused(bytes: &[u8]) -> String {
    read_bytes(bytes, Path::new("a.csv"))
        .unwrap_err()
        .to_string()
}

pub fn with(
    bytes: &[u8],
    columns: &[(&str, &str)],
    run: Option<&str>,
) -> Result<RecordingFile, String> {
    let mut options = ReadOptions {
        run: run.map(String::from),
        ..ReadOptions::default()
    };
    for (key, header) in columns {
        options.columns.add(key, header).unwrap();
    }
    read_bytes_with(bytes, Path::new("a.csv"), &options).map_err(|error| error.to_string())
}

/// From the first to the last value of a channel that runs evenly.
pub fn span(curve: &Curve, name: &str, from: f64, to: f64) {
    let values = curve
        .channel(name)
        .unwrap_or_else(|| panic!("no {name} in {:?}", curve.channels));
    assert_eq!(values.len(), 20);
    for (k, value) in values.iter().enumerate() {
        let expected = from + (to - from) * k as f64 / 19.0;
        assert!(
            (value - expected).abs() < 1e-9,
            "{name}[{k}] is {value}, not {expected}"
        );
    }
}

pub fn text(rows: &Rows, separator: &str, is_quoted: bool) -> String {
    let cell = |cell: &String| {
        if is_quoted {
            format!("\"{cell}\"")
        } else {
            cell.clone()
        }
    };
    let line = |row: &Vec<String>| row.iter().map(cell).collect::<Vec<_>>().join(separator) + "\n";
    rows.iter().map(line).collect()
}

/// A head above the samples.
pub fn under(head: &[&[&str]]) -> Rows {
    head.iter()
        .map(|cells| row(cells))
        .chain(samples())
        .collect()
}

#[test]
fn units_may_be_in_brackets_bare_or_in_the_name_in_one_row_or_two() {
    let heads: &[&[&[&str]]] = &[
        &[
            &["Time", "Load", "Displacement", "Tool separation"],
            &["(s)", "(N)", "(mm)", "(mm)"],
        ],
        &[
            &["Time", "Load", "Displacement", "Tool separation"],
            &["s", "N", "mm", "mm"],
        ],
        &[
            &["Time", "Load", "Displacement", "Tool separation"],
            &["[s]", "[N]", "[mm]", "[mm]"],
        ],
        &[&[
            "Prüfzeit in s",
            "Standardkraft in N",
            "Distance in mm",
            "Werkzeugabstand in mm",
        ]],
        &[&[
            "Time / s",
            "Load / N",
            "Displacement / mm",
            "Tool separation / mm",
        ]],
        &[
            &[
                "Time (s)",
                "Load (N)",
                "Displacement (mm)",
                "Tool separation (mm)",
            ],
            &["(s)", "(N)", "(mm)", "(mm)"],
        ],
    ];
    for head in heads {
        for (separator, is_quoted) in [(",", true), (",", false), ("\t", false), (";", true)] {
            let curve = &read(text(&under(head), separator, is_quoted).as_bytes()).curves[0];
            span(curve, "time_s", 0.0, 1.9);
            span(curve, "force_n", 0.0, 0.95);
            span(curve, "travel_mm", 0.0, 1.9);
            span(curve, "tool_gap_mm", 10.0, 8.1);
        }
    }
    // Volts of a sensor next to what they mean.
    let volts = text(
        &under(&[&["Time (s)", "Load (N)", "Depth (mm)", "Load (V)"]]),
        "\t",
        false,
    );
    let curve = &read(volts.as_bytes()).curves[0];
    span(curve, "force_n", 0.0, 0.95);
    span(curve, "depth_mm", 0.0, 1.9);
    // Other units are converted: 1 g of force is 9.80665 mN.
    let grams = text(
        &under(&[&["Time", "Force", "Distance", "x"], &["ms", "g", "in", ""]]),
        ",",
        false,
    );
    let curve = &read(grams.as_bytes()).curves[0];
    span(curve, "time_s", 0.0, 1.9e-3);
    span(curve, "force_n", 0.0, 0.95 * 9.80665e-3);
    span(curve, "travel_mm", 0.0, 1.9 * 25.4);
}

#[test]
fn names_without_units_are_refused_with_the_remedy() {
    let bare = text(
        &under(&[&["Time", "Load", "Displacement", "x"]]),
        ",",
        false,
    );
    assert_eq!(
        refused(bare.as_bytes()),
        "a.csv, line 1: column 'time' has no unit; name the column time_s"
    );
    let odd = text(
        &under(&[
            &["Time", "Load", "Displacement", "x"],
            &["s", "furlong", "mm", ""],
        ]),
        ",",
        false,
    );
    assert_eq!(
        refused(odd.as_bytes()),
        "a.csv, line 2: 'furlong' is not a unit of force; name the column force_n"
    );
}

#[test]
fn a_length_of_unknown_direction_is_asked_for_and_answered() {
    let table = text(
        &under(&[
            &["Time", "Load", "Extension", "Position"],
            &["(s)", "(N)", "(mm)", "(mm)"],
        ]),
        ",",
        true,
    );
    let curve = &read(table.as_bytes()).curves[0];
    assert!(curve.channel("travel_mm").is_none() && curve.channel("depth_mm").is_none());
    span(curve, "extension_mm", 0.0, 1.9);
    let question =
        "the travel: which of 'Extension', 'Position' is it? Name it: travel = \"Extension\"";
    assert!(
        curve.unknown.iter().any(|text| text.starts_with(question)),
        "{:?}",
        curve.unknown
    );
    let named = with(table.as_bytes(), &[("travel", "extension")], None).unwrap();
    span(&named.curves[0], "travel_mm", 0.0, 1.9);
    assert!(named.curves[0].warnings.is_empty());
    // The other column counts down: a minus turns it, and without one a warning says that the sign looks wrong.
    let turned = with(table.as_bytes(), &[("depth_mm", "-Position")], None).unwrap();
    span(&turned.curves[0], "depth_mm", -10.0, -8.1);
    assert!(turned.curves[0].warnings.is_empty());
    let falling = with(table.as_bytes(), &[("depth_mm", "Position")], None).unwrap();
    assert!(falling.curves[0].warnings[0].starts_with("the depth falls where the force grows"));
    let missing = with(table.as_bytes(), &[("travel", "Weg")], None).unwrap_err();
    assert_eq!(
        missing,
        "a.csv, line 1: no line of names holds 'Weg'; name the columns as the file does, without a unit or with it"
    );
}

#[test]
fn names_that_say_nothing_are_read_where_the_user_says_what_they_are() {
    let table = text(&under(&[&["A", "B", "C", "D"]]), ",", false);
    assert!(refused(table.as_bytes()).contains("no recording format that is known"));
    let named = with(
        table.as_bytes(),
        &[("time_ms", "A"), ("force_mN", "B"), ("travel_mm", "C")],
        None,
    )
    .unwrap();
    span(&named.curves[0], "time_s", 0.0, 1.9e-3);
    span(&named.curves[0], "force_n", 0.0, 0.95e-3);
    span(&named.curves[0], "travel_mm", 0.0, 1.9);
    let pedar = "file name: a\nsensor type: x\nmask definition:\nleft insole: 1,\n\ntime[secs]\t1\n0.1\t2.5\n";
    let refused = with(pedar.as_bytes(), &[("force", "B")], None).unwrap_err();
    assert_eq!(
        refused,
        "a.csv: Novel pedar names its columns itself; take the names of columns out"
    );
}

#[test]
fn a_negative_force_is_said() {
    let table = "time_s,travel_mm,Load (N)\n0,0,0\n1,1,-1\n2,2,-2\n";
    let read = read(table.as_bytes());
    assert!(read.curves[0].warnings[0].starts_with("the force is negative where it is largest"));
    let turned = with(table.as_bytes(), &[("force", "-Load")], None).unwrap();
    assert_eq!(
        turned.curves[0].channel("force_n").unwrap(),
        [0.0, 1.0, 2.0]
    );
}

#[test]
fn names_of_a_language_that_is_not_known_are_read_by_their_units() {
    let head: &[&[&str]] = &[&["Idő", "Erő", "Út", "x"], &["s", "N", "mm", "mm"]];
    let curve = &read(text(&under(head), ";", false).as_bytes()).curves[0];
    span(curve, "force_n", 0.0, 0.95);
    assert_eq!(
        curve.warnings,
        [
            "column 'Idő' is taken as the time: no other is in s",
            "column 'Erő' is taken as the force: no other is in N"
        ]
    );
}

#[test]
fn a_table_of_sensels_stays_a_map_with_times_and_depths_in_it() {
    let text = "time_s,row,col,pressure_kpa,depth_mm\n0.3,0,0,1,0.1\n0.3,0,1,2,0.1\n0.4,0,0,3,0.2\n0.4,0,1,4,0.2\n";
    let file = read(text.as_bytes());
    assert!(file.curves.is_empty());
    assert_eq!(file.maps.len(), 1);
}

#[test]
fn one_time_and_one_force_make_a_curve_whatever_they_are_called() {
    let head: &[&[&str]] = &[&[
        "Zeit 1 - Messrate [s]",
        "Kraftaufnehmer 2 [N]",
        "Wegaufnehmer [mm]",
        "Geber [V]",
    ]];
    let curve = &read(text(&under(head), "\t", false).as_bytes()).curves[0];
    span(curve, "time_s", 0.0, 1.9);
    span(curve, "force_n", 0.0, 0.95);
    assert_eq!(
        curve.warnings,
        [
            "column 'Zeit 1 - Messrate [s]' is taken as the time: no other is in s",
            "column 'Kraftaufnehmer 2 [N]' is taken as the force: no other is in N"
        ]
    );
}

/// Two runs side by side under the same names: what a column is called holds in both.
#[test]
fn a_named_column_is_named_in_every_run() {
    let text = "Time (s),Way (mm),Load (N),Time (s),Way (mm),Load (N)\n0,0,0,0,0,0\n0.1,0.2,1,0.1,0.4,3\n0.2,0.4,2,0.2,0.8,6\n";
    for (run, reach, most) in [("run 1", 0.4, 2.0), ("run 2", 0.8, 6.0)] {
        let file = with(
            text.as_bytes(),
            &[("travel", "Way"), ("force", "Load (N)")],
            Some(run),
        );
        let curve = &file.unwrap().curves[0];
        assert_eq!(curve.channel("travel_mm").unwrap()[2], reach);
        assert_eq!(curve.channel("force_n").unwrap()[2], most);
    }
}

#[test]
fn results_above_a_curve_are_no_head() {
    let text = "Test duration (s),Peak load (N)\n12.3,4.5\nTime (s),Load (N),Extension (mm)\n0,0,0\n0.1,1,0.2\n0.2,2,0.4\n";
    let curve = &read(text.as_bytes()).curves[0];
    assert_eq!(curve.channel("time_s").unwrap(), [0.0, 0.1, 0.2]);
    assert_eq!(curve.channel("force_n").unwrap(), [0.0, 1.0, 2.0]);
}

/// A column in the unit 1 is a column: what is right of it is no note.
#[test]
fn a_number_between_units_is_no_note() {
    let text = "Time;Load;Ratio;Extension\ns;N;1;mm\n0;0;0;0\n0.1;1;0;0.2\n";
    let message = refused(text.as_bytes());
    assert!(message.contains("unit"), "{message}");
    assert!(!message.contains("damaged"), "{message}");
}

#[test]
fn columns_of_force_and_length_under_other_names_are_asked_for() {
    let table = "Approach and retreat\nX, um:\t25\n\nExtend Z-Sense(nm),Extend Force(nN),Retract Z-Sense(nm),Retract Force(nN)\n\
        4129,0.5,5345,0.7\n4130,0.6,5344,0.6\n4131,0.8,5343,0.5\n";
    assert_eq!(
        refused(table.as_bytes()),
        "a.csv: which of its columns 'Extend Z-Sense(nm)', 'Extend Force(nN)', 'Retract Z-Sense(nm)', 'Retract Force(nN)' is the force, and which the depth or travel?; \
         name them: force = \"Extend Force\" and travel = \"Extend Z-Sense\" under [recordings.columns] in study.toml, \
         or --column \"force=Extend Force\" --column \"travel=Extend Z-Sense\""
    );
    let answers = [("force", "Extend Force"), ("travel", "Extend Z-Sense")];
    let named = with(table.as_bytes(), &answers, None).unwrap();
    let force = named.curves[0].channel("force_n").unwrap();
    assert!((force[2] - 0.8e-9).abs() < 1e-20);
    let travel = named.curves[0].channel("travel_mm").unwrap();
    assert!((travel[0] - 4.129e-3).abs() < 1e-12 && (travel[2] - 4.131e-3).abs() < 1e-12);
    let afm = table.replace("Approach and retreat", "Force-Distance Curve");
    let named = with(afm.as_bytes(), &answers, None).unwrap();
    assert_eq!(
        named.curves[0].channel("travel_mm").unwrap(),
        travel,
        "AFM Workshop's own file"
    );
}

#[test]
fn an_elongation_in_percent_is_kept_and_costs_nothing() {
    let head: &[&[&str]] = &[
        &["Temps d'essai", "Force standard", "Allongement", "Course"],
        &["s", "N", "%", "mm"],
    ];
    let curve = &read(text(&under(head), ";", false).as_bytes()).curves[0];
    span(curve, "force_n", 0.0, 0.95);
    assert!(curve.channel("elongation_mm").is_none());
    assert!(
        curve
            .channels
            .iter()
            .any(|channel| channel.name == "elongation_as_%"),
        "{:?}",
        curve.channels.iter().map(|c| &c.name).collect::<Vec<_>>()
    );
}
