//! Damaged exports: one clear sentence with file, place and remedy each.

use crate::exports;

use exports::*;

/// The message for `text` with `from` replaced by `to` begins so; `LINE` is the line where `from` stands.
fn refused(text: &str, from: &str, to: &str, expected: &str) {
    let at = text
        .find(from)
        .unwrap_or_else(|| panic!("{from:?} is not in the sample"));
    let line = 1 + text[..at].matches('\n').count();
    let expected = &expected.replace("LINE", &line.to_string());
    let message = export(text.replacen(from, to, 1).as_bytes()).unwrap_err();
    assert!(
        message.starts_with(expected) && message.contains("; "),
        "{to:?} gave {message:?}"
    );
}

#[test]
fn tekscan_faults_are_placed() {
    for (from, to, expected) in [
        (
            "ROWS 2",
            "ROWS two",
            "a.txt, line 5: ROWS: 'two' is not a number of rows; this maker's exports",
        ),
        (
            "ROWS 2",
            "ROWS 99999",
            "a.txt, line 5: ROWS: 99999 rows, expected 1 to 4096",
        ),
        (
            "COLS 3\n",
            "",
            "a.txt, line 19: the header does not state COLS",
        ),
        (
            "COLS 3",
            "COLS 4",
            "a.txt, line 23: the row holds 3 values, expected 4",
        ),
        (
            "ROWS 2",
            "ROWS 1",
            "a.txt, line 24: '0,0,5' stands where a frame should begin; the rows do not fit",
        ),
        (
            "0.4 centimeters",
            "0.4 furlongs",
            "a.txt, line 7: ROW_SPACING: 'furlongs' is not a unit of what stands in mm here",
        ),
        (
            "UNITS KPa",
            "UNITS bananas",
            "a.txt, line 20: the header does not state UNITS",
        ),
        (
            "END_FRAME 4",
            "END_FRAME 9",
            "a.txt, line 29: the header counts 7 frames, the file holds 2; it is cut short",
        ),
        (
            "B,345,20\n",
            "B,34x,20\n",
            "a.txt, line 27: '34x' is not a number",
        ),
        (
            "B,345,20\n",
            "B,nan,20\n",
            "a.txt, line 27: 'nan' is not a finite number",
        ),
        (
            "B,345,20\n1,0,5\n@@\n",
            "B,345,20\n",
            "a.txt, line 27: the file ends where row 2 of frame 4 should follow; it is cut short",
        ),
        (
            "Frame 4",
            "Frame 3",
            "a.txt, line 26: time does not increase: 0 s follows 0 s",
        ),
        (
            "Frame 4",
            "Frame four",
            "a.txt, line 26: 'four' is not a frame number",
        ),
    ] {
        refused(TEKSCAN, from, to, expected);
    }
}

#[test]
fn novel_faults_are_placed() {
    refused(
        PEDAR,
        "in  kPa",
        "in  counts",
        "a.txt, line 4: 'pressure values in  coun...' are not in kPa; export the pressures in kPa",
    );
    refused(
        PEDAR,
        "20.000\t",
        "",
        "a.txt, line 11: the row holds 5 values, expected 6",
    );
    refused(
        PEDAR,
        "0.04000",
        "0.02000",
        "a.txt, line 12: time does not increase: 0.02 s follows 0.02 s",
    );
    refused(
        PEDAR,
        "2\t3\t1\t2",
        "2\t3\t4\t5",
        "a.txt, line 10: the columns hold 5 sensors of one insole, and the masks name 3 and 2",
    );
    refused(
        PLIANCE,
        "40.000   0.000\n",
        "40.000\n",
        "a.txt, line 10: the row holds 2 values, expected 3",
    );
    refused(
        PLIANCE,
        "area   1.0000   2.0000\n",
        "",
        "a.txt, line 26: the file ends where the rows x[c], y[c] and area of the sensors",
    );
    refused(
        PLIANCE,
        "sensor        7        9",
        "sensor        7        8",
        "a.txt, line 27: sensor 9 is not in the table of sensors",
    );
    let cut = &PLIANCE[..PLIANCE.find("sensor        7").unwrap()];
    let message = export(cut.as_bytes()).unwrap_err();
    assert!(
        message.contains("the file ends where the table of sensors should follow"),
        "{message}"
    );
    let page = String::from_utf8_lossy(&emed()).replace('\u{fffd}', "2");
    refused(
        &page,
        "30\t10.00\t20.00\t0.75\n",
        "30\t10.00\t0.75\n",
        "a.txt, line LINE: the row holds 3 values, expected 4",
    );
    refused(
        &page,
        "31\t0.00\t40.00\t1.00",
        "32\t0.00\t40.00\t1.00",
        "a.txt, line LINE: row number 32 where 31 should follow",
    );
    refused(
        &page,
        "Pict-No.: 2",
        "Pict-No.: 1",
        "a.txt, line 28: picture 1 does not follow the one before it; export the pictures in order",
    );
    let cut = &page[..page.rfind("Force\t0.00\t0.50").unwrap()];
    let message = export(cut.as_bytes()).unwrap_err();
    assert!(
        message.contains("the file ends where the row 'Force' of picture 2 should follow"),
        "{message}"
    );
}

#[test]
fn other_mats_faults_are_placed() {
    refused(
        XSENSOR,
        "Units:,mmHg",
        "Units:,hats",
        "a.txt, line 3: Units: 'hats' is not a unit of pressure",
    );
    refused(
        XSENSOR,
        "Rows,2",
        "Rows,0",
        "a.txt, line LINE: Rows: 0 rows, expected 1 to 4096",
    );
    refused(
        XSENSOR,
        "0,40,25,,\n",
        "",
        "a.txt, line 36: 'GROUP' is not a number",
    );
    refused(
        XSENSOR,
        "23:59:59.500",
        "noon",
        "a.txt, line LINE: Time 'noon' is not a number",
    );
    let cut = &XSENSOR[..XSENSOR.rfind("SENSOR,DEMO").unwrap()];
    let message = export(cut.as_bytes()).unwrap_err();
    assert!(
        message.contains("the file ends where a sensor (SENSOR) of the last frame should follow"),
        "{message}"
    );
    refused(
        FOOTSCAN,
        "Rectangle width\t2",
        "Rectangle width\t3",
        "a.txt, line 15: the row holds 2 values, expected 3",
    );
    refused(
        FOOTSCAN,
        "(2.00 ms)",
        "(2.00 h)",
        "a.txt, line LINE: 'Frame 1 (2.00 h)' is not a frame and its time in ms",
    );
    refused(
        LOGGER,
        "0.2,9,",
        "0.2",
        "a.txt, line 4: the row holds 3 values, expected 5",
    );
}

#[test]
fn indenter_faults_are_placed() {
    refused(
        AURORA,
        "1\t1.0\t0.2",
        "2\t1.0\t0.2",
        "a.txt, line LINE: sample 2 where 1 should follow",
    );
    refused(
        AURORA,
        "Units\tmm\tmN",
        "Units\tmm\tmood",
        "a.txt, line 17: 'mood' is not a unit that is known",
    );
    refused(
        AURORA,
        "Sample Frequency",
        "Sampling",
        "a.txt, line 17: the header does not state a sample frequency",
    );
    let sphere = String::from_utf8_lossy(&optics11()).replace('\u{fffd}', "u");
    refused(
        &sphere,
        "Load (uN)\tInd",
        "Load (pints)\tInd",
        "a.txt, line LINE: 'pints' is not a unit of force; name the column force_n",
    );
    refused(
        &sphere,
        "0.001\t0.1",
        "0.000\t0.1",
        "a.txt, line LINE: time does not increase",
    );
    refused(
        JPK_TEXT,
        "recorded-num-points: 2",
        "recorded-num-points: 3",
        "a.txt, line 12: segment 'extend' states 3 samples and holds 2",
    );
    refused(
        JPK_TEXT,
        "# units: m N s s",
        "# units: m N s",
        "a.txt, line 12: samples follow 4 column names and 3 units",
    );
    refused(
        CURVE,
        "depth_mm",
        "depth_hands",
        "a.txt, line 1: 'hands' is not a unit of depth; name the column depth_mm",
    );
    refused(
        CURVE,
        "0.5,1,2000",
        "0.5,,2000",
        "a.txt, line 3: depth: '' is not a number; give every sample a finite number",
    );
    refused(
        CURVE,
        "0.5,1,2000",
        "0.5,1,NaN",
        "a.txt, line 3: force: 'NaN' is not a finite number",
    );
    refused(
        CURVE,
        "0.5,1",
        "0,1",
        "a.txt, line 3: time does not increase: 0 s follows 0 s; sort the rows by time",
    );
    refused(
        CURVE,
        "12.5",
        "12.5,7",
        "a.txt, line 3: the row holds 5 values, expected 4",
    );
    refused(
        MAP,
        "0,0,1,4",
        "0,1,1,4",
        "a.txt, line 3: row 1, column 1 stands twice in one frame",
    );
    refused(
        MAP,
        "0,0,1,4",
        "0,0,-1,4",
        "a.txt, line 3: '-1' is not a row or column number",
    );
    refused(
        MAP,
        "pressure_kpa",
        "pressure_hat",
        "a.txt, line 1: 'hat' is not a unit of pressure; name the column pressure_kpa",
    );
}

/// Found by damaged files at random: names and texts of a file stood in messages as they were.
#[test]
fn messages_are_one_line_without_escape_codes_whatever_the_file_says() {
    let xsensor = XSENSOR.replace("Contact Area (cm²),8", "Contact Area (cm\u{1b}[31m²),");
    let message = export(xsensor.as_bytes()).unwrap_err();
    assert!(
        message.contains("Contact Area (cm?[31m²)") && !message.contains('\u{1b}'),
        "{message}"
    );
    let theme = format!("<a:b>\n{}</a:\u{1b}c>", "<a:d>\n".repeat(2_000));
    let book = zipped(&[
        ("xl/workbook.xml", theme.as_bytes()),
        ("xl/_rels/workbook.xml.rels", theme.as_bytes()),
    ]);
    let message = export(&book).unwrap_err();
    assert!(
        message.len() < 1_000 && !message.contains(char::is_control),
        "{message}"
    );
}

#[test]
fn insole_loggers_without_a_column_of_pressures_are_refused() {
    let text = LOGGER.replace("accel_x,pressure_01,pressure_02", "accel_x,x pressure_,y");
    assert_eq!(
        export(text.as_bytes()).unwrap_err(),
        "a.txt, line 1: no column is called 'pressure_01'; export the pressures of the insole too"
    );
}
