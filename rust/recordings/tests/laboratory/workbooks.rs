//! Which sheets of a workbook hold curves, and what a bad cell costs.

use crate::sheets::{Rows, row, samples, workbook};
use crate::tables::{read, refused, span, text, under, with};
use thenar_recordings::{Columns, Curve, Format};

fn specimen(name: &str) -> Rows {
    under(&[
        &[name, name, name, name],
        &[
            "Prüfzeit",
            "Standardkraft",
            "Standardweg",
            "Werkzeugabstand",
        ],
        &["s", "N", "mm", "mm"],
    ])
}

#[test]
fn sheets_of_results_are_named_and_passed_over() {
    let results: Rows = vec![
        row(&["Nr.", "Bezeichnung", "Fmax", "dL(Fmax)"]),
        row(&["", "", "N", "mm"]),
        row(&["1", "Probe 1", "0.9", "1.9"]),
        row(&["2", "Probe 2", "0.8", "1.8"]),
    ];
    let parameters: Rows = (0..60)
        .map(|k| row(&["Titel", "", &format!("Wert {k}")]))
        .collect();
    // A head of 150 rows before the names.
    let mut long: Rows = (0..150)
        .map(|_| row(&["Kommentar", "Eindruckversuch"]))
        .collect();
    long.extend(specimen("Probe 2"));
    let book = workbook(&[
        ("Parameter", parameters),
        ("Ergebnisse", results),
        ("Probe 1", specimen("Probe 1")),
        ("Probe 2", long),
    ]);
    let file = read(&book);
    assert_eq!(file.format, Format::Workbook);
    let names: Vec<&str> = file
        .curves
        .iter()
        .map(|curve| curve.name.as_str())
        .collect();
    assert_eq!(names, ["Probe 1", "Probe 2"]);
    for curve in &file.curves {
        span(curve, "force_n", 0.0, 0.95);
        span(curve, "travel_mm", 0.0, 1.9);
    }
    assert_eq!(
        file.notes,
        ["no curve and no mat is in sheet 'Parameter', 'Ergebnisse'"]
    );
    let one = with(&book, &[], Some("Probe 2")).unwrap();
    assert_eq!(
        (one.curves.len(), one.curves[0].name.as_str()),
        (1, "Probe 2")
    );
    assert_eq!(
        with(&book, &[], Some("Probe 3")).unwrap_err(),
        "a.csv: 0 of its runs are called 'Probe 3'; give run as one of 'Probe 1', 'Probe 2'"
    );
}

#[test]
fn specimens_next_to_each_other_are_runs() {
    let mut rows: Rows = vec![
        row(&["Probe 1", "", "", "Probe 2", "", ""]),
        row(&[
            "Prüfzeit",
            "Kraft",
            "Distance",
            "Prüfzeit",
            "Kraft",
            "Distance",
        ]),
        row(&["s", "N", "mm", "s", "N", "mm"]),
    ];
    for (k, cells) in samples().into_iter().enumerate() {
        let mut line = cells[..3].to_vec();
        // The second run is shorter.
        line.extend(if k < 10 {
            cells[..3].to_vec()
        } else {
            row(&["", "", ""])
        });
        rows.push(line);
    }
    for file in [
        read(&workbook(&[("Alle", rows.clone())])),
        read(text(&rows, ";", false).as_bytes()),
    ] {
        let lengths: Vec<usize> = file.curves.iter().map(Curve::samples).collect();
        assert_eq!(lengths, [20, 10]);
        assert!(
            file.curves[0].name.ends_with("Probe 1") && file.curves[1].name.ends_with("Probe 2")
        );
        span(&file.curves[0], "force_n", 0.0, 0.95);
        assert!((file.curves[1].channel("force_n").unwrap()[9] - 0.45).abs() < 1e-12);
    }
    let twice = "time_s,force_n,travel_mm,displacement_mm\n0,0,0,0\n";
    assert!(refused(twice.as_bytes()).starts_with(
        "a.csv, line 1: two columns hold travel; leave one of them out, or name the one"
    ));
}

#[test]
fn a_bad_cell_costs_its_row_and_a_bad_sheet_itself() {
    let mut bad = specimen("Probe 1");
    bad[10][1] = "#DIV/0!".into();
    let none: Rows = specimen("Probe 2")
        .into_iter()
        .enumerate()
        .map(|(k, mut cells)| {
            if k > 2 {
                cells[1] = "n/a".into();
            }
            cells
        })
        .collect();
    let file = read(&workbook(&[("Probe 1", bad), ("Probe 2", none.clone())]));
    assert_eq!((file.curves.len(), file.curves[0].samples()), (1, 19));
    assert!(
        file.curves[0].warnings[0].starts_with("1 row is left out, the first is row 11: force: "),
        "{:?}",
        file.curves[0].warnings
    );
    assert_eq!(
        file.notes,
        ["sheet 'Probe 2', row 4: force: 'n/a' is not a number; the sheet is left out"]
    );
    let only = refused(&workbook(&[("Probe 2", none)]));
    assert!(
        only.starts_with("a.csv: sheet 'Probe 2', row 4: force: 'n/a' is not a number; "),
        "{only}"
    );
}

#[test]
fn a_mat_in_a_workbook_is_read_as_its_text() {
    let export = "Dynamic Roll off\nPatient name: NA\n\nRight foot data\n\nRight rectangle position\nRectangle bottom\t6\nRectangle left\t40\n\
        Rectangle width\t2\nRectangle height\t2\n\nFrame 0 (0.00 ms)\n0\t1\n2\t3\n\nFrame 1 (2.00 ms)\n4\t5\n6\t7\n";
    let rows: Rows = export
        .lines()
        .map(|line| row(&line.split('\t').collect::<Vec<_>>()))
        .collect();
    let file = read(&workbook(&[("Sheet1", rows)]));
    assert_eq!(file.format, Format::Footscan);
    assert_eq!(file.maps[0].frame(1), [4.0, 5.0, 6.0, 7.0]);
}

#[test]
fn a_number_beyond_all_measures_is_refused() {
    let message = refused(b"time_s,depth_mm,force_n\n0,0,0\n1,1e300,1\n");
    assert!(
        message.starts_with("a.csv, line 3: depth: '1e300' is out of range"),
        "{message}"
    );
}

#[test]
fn what_a_program_writes_for_nothing_costs_no_row() {
    // Nanoindenters write the largest number there is where a hardness was not computed, and group the thousands of a force.
    let mut rows = under(&[
        &[
            "Time On Sample",
            "Load On Sample",
            "Displacement Into Surface",
            "HARDNESS",
        ],
        &["s", "mN", "nm", "GPa"],
    ]);
    for row in &mut rows[2..] {
        row[1] = format!("1,000.{}", &row[1].replace('.', "0"));
        row[3] = "1.7976931348623157e308".into();
    }
    let curve = &read(text(&rows, "\t", false).as_bytes()).curves[0];
    assert_eq!(curve.samples(), 20);
    assert!(
        curve
            .channel("force_n")
            .unwrap()
            .iter()
            .all(|force| (1.0..1.001).contains(force))
    );
    span(curve, "depth_mm", 0.0, 1.9e-6);
    assert!(
        curve.channel("hardness_kpa").is_none() && curve.warnings.is_empty(),
        "{:?}",
        curve.warnings
    );
}

#[test]
fn a_table_of_settings_is_no_curve() {
    let settings: Rows = vec![
        row(&["Test", "Peak Hold Time", "Maximum Load", "Time To Load"]),
        row(&["", "s", "mN", "s"]),
        row(&["1", "5", "500", "10"]),
        row(&["2", "5", "500", "10"]),
    ];
    let file = read(&workbook(&[
        ("Required Inputs", settings),
        ("Probe 1", specimen("Probe 1")),
    ]));
    assert_eq!(file.curves.len(), 1);
    assert_eq!(
        file.notes,
        ["no curve and no mat is in sheet 'Required Inputs'"]
    );
}

#[test]
fn columns_may_be_given_once_and_named_at_all() {
    let mut columns = Columns::default();
    assert!(columns.is_empty());
    columns.add("force_n", "F").unwrap();
    assert!(!columns.is_empty() && columns.add("force", "G").is_err());
}

#[test]
fn notes_that_people_keep_to_the_right_of_a_table_cost_nothing() {
    let mut rows = specimen("Probe 1");
    rows[1].extend(row(&["", "20", "80"]));
    rows[2].extend(row(&["", "5.9", "107.2"]));
    rows[4].extend(row(&["", "2.3", "5.9"]));
    let file = read(&workbook(&[("Probe 1", rows)]));
    let curve = &file.curves[0];
    assert_eq!(curve.samples(), 20);
    span(curve, "force_n", 0.0, 0.95);
    assert!(
        curve.warnings.contains(
            &"cells to the right of column 'Werkzeugabstand' stand under no unit and are not read"
                .to_string()
        ),
        "{:?}",
        curve.warnings
    );
}

#[test]
fn columns_of_a_sheet_whose_names_say_nothing_are_asked_for() {
    let sheet = under(&[&["t (s)", "Z (mm)", "P (N)", "Q (N)"]]);
    let notes: Rows = vec![row(&["Operator", "J. D."])];
    let book = workbook(&[("Notes", notes.clone()), ("Data", sheet)]);
    let message = refused(&book);
    assert!(
        message.contains("sheet 'Data'")
            && message.contains("which of its columns")
            && message.contains("'P (N)'"),
        "{message}"
    );
    let file = with(
        &book,
        &[("force", "P"), ("travel", "Z"), ("time", "t")],
        None,
    )
    .unwrap();
    assert_eq!(file.curves[0].samples(), 20);
    // A sheet without units leaves nothing to ask for.
    assert!(
        refused(&workbook(&[("Notes", notes)])).contains("no sheet of the workbook holds columns")
    );
}
