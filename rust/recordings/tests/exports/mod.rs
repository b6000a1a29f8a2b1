//! Small made-up exports of every format, each as its maker writes it.
#![allow(clippy::unwrap_used, dead_code)]

use std::io::Write;
use std::path::Path;
use thenar_recordings::{RecordingFile, read_bytes};

pub fn export(bytes: &[u8]) -> Result<RecordingFile, String> {
    read_bytes(bytes, Path::new("a.txt")).map_err(|error| error.to_string())
}

/// Two frames of 2 x 3 cells, one without sensel, one clipped; a comment that looks like a key.
pub const TEKSCAN: &str = "DATA_TYPE MOVIE\nVERSION Tekscan Pressure Measurement System 7.0\nFILENAME C:\\people\\Jo Doe\\grip.fsx\n\
    SENSOR_TYPE 4256E\nROWS 2\nCOLS 3\nROW_SPACING 0.4 centimeters\nCOL_SPACING 5 mm\nSENSEL_AREA 20 mm2\nNOISE_THRESHOLD 3\n\
    SECONDS_PER_FRAME 0.5\nSATURATION_PRESSURE 50 PSI \nCOMMENTS:\nROWS 9 were planned, UNITS unclear\nSTART_FRAME 3\nEND_FRAME 4\n\
    UNITS KPa\nMIRROR_ROW 0\nMIRROR_COL 1\nASCII_DATA @@\n\nFrame 3\nB,10,20\n0,0,5\n\nFrame 4\nB,345,20\n1,0,5\n@@\n";

/// The same as counts with raw sums and clock.
pub const ISCAN: &str = "DATA_TYPE MOVIE,,\nROWS 2,,\nCOLS 3,,\nSECONDS_PER_FRAME 0.1,,\nUNITS raw,,\nASCII_DATA @@,,\n,,\n\
    Frame 1, 0,, 1/2/2024 6:21:52.34PM,,,Raw Sum=,,35\nB,10,20\n0,0,5\n\nFrame 2, 0.1,, 1/2/2024 6:21:52.44PM,,,Raw Sum=,,281\n\
    B,255,20\n1,0,5\n@@\n";

/// Three sensors left, two right.
pub const PEDAR: &str = "file name:  Jo Doe.sol\tdate/time  01.02.24 10.00\nsensor type:  insole_w\n\
    total time [secs]:  0.040\ttime per frame [secs]:  0.02000\tscanning rate [Hz]:   50\npressure values in  kPa\n\n\
    mask definition: \nleft insole: 1,2,3,\nright insole: 1,2,\n\ntime[secs]\t1\t2\t3\t1\t2\t\n\
    0.02000\t 15.000\t 20.000\t  2.500\t  0.000\t  7.500\t\n    0.04000\t 17.500\t 22.500\t  0.000\t  2.500\t  5.000\t\n";

/// Two sensors of 1 and 2 cm2, cut out of a longer recording.
pub const PLIANCE: &str = "file name: Jo Doe.mat date/time 01.02.24 10.00\nmat type h2013\n\
    total times [secs]: 0.125 time per frame [secs]: 0.04167 scanning rate [Hz]: 24\npressure values in kPa\n\n\nelectrical:\n\
    time[secs]       7       9\n    0.08333  20.000   5.000\n    0.12500  40.000   0.000\n        MPP  40.000   5.000\n\
    MVP  30.000   2.500\n\n\n time[secs] force[N]   x[cm]   y[cm]\n\n    0.04167    0.000       -       -\n\
    0.08333    3.000   0.700   0.500\n    0.12500    4.000   0.500   0.500\n\n\nsensor        7        9\ncorner[cm]\n\
    x[0]   0.0000   1.0000\nx[c]   0.5000   2.0000\ny[c]   0.5000   0.5000\narea   1.0000   2.0000\n";

/// Two pictures, a window of 2 x 2 cells, a summary page; Latin-1.
pub fn emed() -> Vec<u8> {
    let head = |page: u8, what: &str| {
        format!(
            "\n\t\t\t\tPage {page}\n\n\tFile: C:\\Jo Doe\\2.dat \tMatrix: 64x95 \n\tSensor area: 0.25 cm²\tTime/picture:20.0 ms \n\
             \tMV over frames\n\tSensor size: 0.500x0.400 cm\n\tmaker\n\t{what}  Force[N]=sum*sensor_area in row/column\n\n"
        )
    };
    let first = "\t26\t27\tForce\n30\t10.00\t20.00\t0.75\n31\t0.00\t40.00\t1.00\nForce\t0.25\t1.50\t1.75\n\u{c}";
    let second = "\t26\t27\tForce\n30\t0.00\t20.00\t0.50\n31\t0.00\t0.00\t0.00\nForce\t0.00\t0.50\t0.50\n\u{c}";
    let text =
        head(1, "Pict-No.: 1") + first + &head(2, "Pict-No.: 2") + second + &head(3, "MPP") + first;
    encoding_of_the_maker(&text)
}

fn encoding_of_the_maker(text: &str) -> Vec<u8> {
    text.chars()
        .map(|c| u8::try_from(u32::from(c)).unwrap())
        .collect()
}

/// One frame of a 2 x 3 sensor and of a group that is none; a second frame after midnight.
pub const XSENSOR: &str = "\u{feff}File:,\"C:\\Jo Doe\\demo.XSN\",,,\n,,,,\nUnits:,mmHg,,,\n,,,,\nThreshold:,10,,,\n,,,,\n\
    FRAME,1,,,\n,,,,\nDate, 2024 Feb 01,,,\n,,,,\nTime, 23:59:59.500,,,\n,,,,\nSENSOR,DEMO S0001,,,\n,,,,\nRows,2,,,\n,,,,\nColumns,3,,,\n,,,,\n\
    Sensel Width (cm),1,,,\n,,,,\nSensel Height (cm),2,,,\n,,,,\nPeak Pressure (mmHg),40,,,\n,,,,\nContact Area (cm²),8,,,\n,,,,\n\
    Total Area (cm²),10,,,\n,,,,\nEst. Load (N),2.67,,,\n,,,,\nSENSELS,,,,\n,,,,\n0,20,15,,\n,,,,\n0,40,25,,\n,,,,\n\
    GROUP,1,,,\n,,,,\nName,Heel,,,\n,,,,\nCells,1,,,\n,,,,\nSENSELS,,,,\n,,,,\n40,,,,\n,,,,\n\
    FRAME,2,,,\n,,,,\nTime, 00:00:00.000,,,\n,,,,\nSENSOR,DEMO S0001,,,\n,,,,\nRows,2,,,\n,,,,\nColumns,3,,,\n,,,,\n\
    SENSELS,,,,\n,,,,\n0,0,0,,\n,,,,\n0,0,0,,\n";

/// One frame of the left and two of the right foot.
pub const FOOTSCAN: &str = "Dynamic Roll off\nPatient name: Jo Doe\nMeasurement done on 01-02-2024\n\
    Scanning speed; for the left foot: 500.00 Hertz, for the right foot: 500.00 Hertz\n\nLeft foot data\n\nLeft rectangle position\n\
    Rectangle bottom\t4\nRectangle left\t7\nRectangle width\t2\nRectangle height\t1\n\nFrame 0 (0.00 ms)\n1\t2\n\n\
    Right foot data\n\nRight rectangle position\nRectangle bottom\t4\nRectangle left\t9\nRectangle width\t2\nRectangle height\t2\n\n\
    Frame 0 (0.00 ms)\n1\t2\n3\t4\n\nFrame 1 (2.00 ms)\n5\t6\n7\t8\n";

/// Two soles in turn.
pub const LOGGER: &str = "sole_id,timestamp,accel_x,pressure_01,pressure_02\nL,1700000000000,0.1,5,6\nR,1700000000004,0.1,7,8\n\
    L,1700000000010,0.2,9,\n";

/// Length and force, with an offset; a third channel is not in use.
pub const AURORA: &str = "DMCv5.3 Data File\nSample Frequency (Hz): 1000\nReference Area: NaN sq. mm\nCalibration Data:\n\
    Channel\tAI0\tAI1\tAI2\tAO1\nUnits\tmm\tmN\t\tmN\nScale (units/V)\t2.000000\t500.000000\t0.000000\t500.000000\n\
    Offset (volts)\t0.500000\t0.000000\t0.000000\t0.000000\nTest Comments:\nJo Doe\nProtocol Array:\n\n0.2\tRamp\tForce Out\t400, 0.05\t\n\n\
    Test Data in Volts:\n\nSample\tAI0\tAI1\tAI2\tAO1\tStim\n0\t0.5\t0.1\t9\t0.2\t0\n1\t1.0\t0.2\t9\t0.2\t0\n";

/// Latin-1 micro, a line end LF CR, and one sample more than nothing.
/// Three samples in, two out; the cantilever's stiffness stands in the header.
pub const AFM_WORKSHOP: &str = "Force-Distance Curve\r\nFile Format:\t3\r\n\r\nDate:\tFriday, March 1, 2024\r\nMode:\tSingle\r\n\
    X, um:\t25.000000\r\nForce Constant, nN/nm:\t2.000000\r\nZ Rate, nm/s:\t500.000000\r\n\r\n\
    Extend Z-Sense(nm),Extend Force(nN),Retract Z-Sense(nm),Retract Force(nN)\r\n\
    1000.0,4.0,1200.0,40.0\r\n1100.0,4.0,1100.0,0.0\r\n1200.0,44.0,,\r\n";

pub fn optics11() -> Vec<u8> {
    let text = "Date\t12/05/2024\tTime\t11:20:38\tStatus\tOK\r\nJo Doe\r\nX (#)\t1\n\rX-position (um)\t1\r\nk (N/m)\t0.5\r\n\
        Tip radius (um)\t25.000\r\nDevice:\tChiaro\r\nControl mode: Peak Load Poking\nMax load (µN)\t0.050\r\nPiezo speed (µm/s)\t7.000\n\
        E[eff] (Pa)\t156.009\r\n\r\nTime (s)\tLoad (uN)\tIndentation (nm)\tCantilever (nm)\tPiezo (nm)\tAuxiliary\r\n\
        0.000\t0.0\t0\t0\t100\t1\r\n0.001\t0.1\t50\t200\t1200\t1\r\n";
    encoding_of_the_maker(text)
}

/// Two segments, the second with a column more.
pub const JPK_TEXT: &str = "# xPosition: 1.0E-4\n# user-name: Jo Doe\n#\n# segmentIndex: 0\n# recorded-num-points: 2\n# segment: extend\n\
    # columns: height vDeflection seriesTime time\n# fancyNames: \"Height\" \"Vertical Deflection\" \"Series Time\" \"Segment Time\"\n\
    # springConstant: 0.05\n# units: m N s s\n#\n5E-6 0 0.0 0.0\n4E-6 1E-9 0.1 0.1\n\n# segmentIndex: 1\n# recorded-num-points: 1\n\
    # segment: retract\n# columns: height vDeflection lateral seriesTime time\n# springConstant: 0.05\n# units: m N V s s\n#\n\
    4E-6 1E-9 0.3 0.2 0.0\n";

/// Comma decimals and semicolons, free lines before.
pub const INSTRON: &str = "sample_1\nCompression test;\nCylinder Diameter: 50mm;\nCylinder Height: 30mm;\nMachine: INSTRON 5900;\n\
    Time (s);Compression (mm);Load (N);Engineering Strain [-]\n0,0;0,0;-0,01;0\n0,1;0,25;1,5;0,0083\n";

pub const CURVE: &str = "time_s,depth_mm,force_mN,area_mm2\n0,0,0,\n0.5,1,2000,12.5\n";

/// Two frames, the second without a cell and with an empty one.
pub const MAP: &str = "time_s,row,col,pressure_kpa,phase\n0,1,1,0,load\n0,0,1,4,load\n0,0,0,3,load\n0.5,0,0,,hold\n0.5,1,1,9,hold\n";

/// A segment of two samples of force (volts to meters to newtons) and height.
pub fn jpk_archive() -> Vec<u8> {
    let header = "force-segment-header.duration=0.2\nforce-segment-header.num-points=2\n\
        force-segment-header.settings.segment-settings.style=extend\nchannel.vDeflection.lcd-info.*=0\n\
        channel.vDeflection.data.file.name=channels/vDeflection.dat\nchannel.height.lcd-info.*=1\nchannel.height.data.file.name=channels/height.dat\n";
    let shared = "lcd-info.0.conversion-set.conversions.base=volts\nlcd-info.0.conversion-set.conversions.default=force\n\
        lcd-info.0.conversion-set.conversion.distance.base-calibration-slot=volts\nlcd-info.0.conversion-set.conversion.distance.scaling.type=linear\n\
        lcd-info.0.conversion-set.conversion.distance.scaling.offset=0\nlcd-info.0.conversion-set.conversion.distance.scaling.multiplier=2E-8\n\
        lcd-info.0.conversion-set.conversion.force.base-calibration-slot=distance\nlcd-info.0.conversion-set.conversion.force.scaling.type=linear\n\
        lcd-info.0.conversion-set.conversion.force.scaling.offset=0\nlcd-info.0.conversion-set.conversion.force.scaling.multiplier=0.5\n\
        lcd-info.0.conversion-set.conversion.force.scaling.unit.unit=N\nlcd-info.0.encoder.type=signedinteger\nlcd-info.0.encoder.scaling.type=linear\n\
        lcd-info.0.encoder.scaling.offset=1\nlcd-info.0.encoder.scaling.multiplier=0.1\n\
        lcd-info.1.conversion-set.conversions.base=absolute\nlcd-info.1.conversion-set.conversions.default=nominal\n\
        lcd-info.1.conversion-set.conversion.nominal.base-calibration-slot=absolute\nlcd-info.1.conversion-set.conversion.nominal.scaling.type=linear\n\
        lcd-info.1.conversion-set.conversion.nominal.scaling.offset=0\nlcd-info.1.conversion-set.conversion.nominal.scaling.multiplier=1E-6\n\
        lcd-info.1.conversion-set.conversion.nominal.scaling.unit.unit=m\nlcd-info.1.encoder.type=signedshort\n";
    zipped(&[
        (
            "header.properties",
            b"file-format-version=2.0\nuser-name=Jo Doe\n",
        ),
        ("segments/0/segment-header.properties", header.as_bytes()),
        (
            "segments/0/channels/vDeflection.dat",
            &[0, 0, 0, 0, 0, 0, 0, 10],
        ),
        ("segments/0/channels/height.dat", &[0, 9, 255, 254]),
        ("shared-data/header.properties", shared.as_bytes()),
    ])
}

/// A French workbook: a sheet of parameters, and one specimen.
pub fn workbook() -> Vec<u8> {
    let strings = [
        "Opérateur Jo Doe",
        "Eprouvette 1",
        "Temps d'essai",
        "Force standard",
        "Ecartement entre outils",
        "s",
        "N",
        "mm",
    ];
    let texts: String = strings
        .iter()
        .map(|text| format!("<si><t>{text}</t></si>"))
        .collect();
    let row =
        |number: usize, cells: &[String]| format!("<row r=\"{number}\">{}</row>", cells.concat());
    let text = |at: &str, k: usize| format!("<c r=\"{at}\" t=\"s\"><v>{k}</v></c>");
    let number = |at: &str, value: f64| format!("<c r=\"{at}\"><v>{value}</v></c>");
    let sheet = |rows: String| {
        format!(
            "<?xml version=\"1.0\"?><worksheet xmlns=\"{MAIN}\"><sheetData>{rows}</sheetData></worksheet>"
        )
    };
    let first = sheet(row(1, &[text("A1", 0)]));
    let second = sheet(
        row(1, &[text("A1", 1)])
            + &row(2, &[text("A2", 2), text("B2", 3), text("C2", 4)])
            + &row(3, &[text("A3", 5), text("B3", 6), text("C3", 7)])
            + &row(
                4,
                &[number("A4", 0.0), number("B4", 0.1), number("C4", 30.0)],
            )
            + &row(
                5,
                &[number("A5", 0.5), number("B5", 2.5), number("C5", 29.0)],
            ),
    );
    let book = format!(
        "<?xml version=\"1.0\"?><workbook xmlns=\"{MAIN}\" xmlns:r=\"{OFFICE}\"><sheets><sheet name=\"Paramètres\" sheetId=\"1\" r:id=\"rId1\"/>\
         <sheet name=\"Eprouvette 1\" sheetId=\"2\" r:id=\"rId2\"/></sheets></workbook>"
    );
    let relation = |id: usize, kind: &str, target: &str| {
        format!("<Relationship Id=\"rId{id}\" Type=\"{OFFICE}/{kind}\" Target=\"{target}\"/>")
    };
    let relations = format!(
        "<?xml version=\"1.0\"?><Relationships xmlns=\"{PACKAGE}\">{}{}{}</Relationships>",
        relation(1, "worksheet", "worksheets/sheet1.xml"),
        relation(2, "worksheet", "worksheets/sheet2.xml"),
        relation(3, "sharedStrings", "sharedStrings.xml")
    );
    let strings = format!("<?xml version=\"1.0\"?><sst xmlns=\"{MAIN}\">{texts}</sst>");
    let root = format!(
        "<?xml version=\"1.0\"?><Relationships xmlns=\"{PACKAGE}\">{}</Relationships>",
        relation(1, "officeDocument", "xl/workbook.xml")
    );
    zipped(&[
        ("_rels/.rels", root.as_bytes()),
        ("xl/workbook.xml", book.as_bytes()),
        ("xl/_rels/workbook.xml.rels", relations.as_bytes()),
        ("xl/sharedStrings.xml", strings.as_bytes()),
        ("xl/worksheets/sheet1.xml", first.as_bytes()),
        ("xl/worksheets/sheet2.xml", second.as_bytes()),
    ])
}

const MAIN: &str = "http://schemas.openxmlformats.org/spreadsheetml/2006/main";
const OFFICE: &str = "http://schemas.openxmlformats.org/officeDocument/2006/relationships";
const PACKAGE: &str = "http://schemas.openxmlformats.org/package/2006/relationships";

/// A zip without compression, so that damage reaches the contents.
pub fn zipped(members: &[(&str, &[u8])]) -> Vec<u8> {
    let mut archive = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
    let options =
        zip::write::SimpleFileOptions::default().compression_method(zip::CompressionMethod::Stored);
    for (name, bytes) in members {
        archive.start_file(*name, options).unwrap();
        archive.write_all(bytes).unwrap();
    }
    archive.finish().unwrap().into_inner()
}

/// Every text, with its name.
pub fn texts() -> Vec<(&'static str, Vec<u8>)> {
    let fixed = [
        ("tekscan", TEKSCAN),
        ("iscan", ISCAN),
        ("pedar", PEDAR),
        ("pliance", PLIANCE),
        ("xsensor", XSENSOR),
        ("footscan", FOOTSCAN),
        ("logger", LOGGER),
        ("aurora", AURORA),
        ("jpk text", JPK_TEXT),
        ("instron", INSTRON),
        ("curve", CURVE),
        ("map", MAP),
    ];
    let mut all: Vec<_> = fixed
        .map(|(name, text)| (name, text.as_bytes().to_vec()))
        .into();
    all.extend([
        ("emed", emed()),
        ("optics11", optics11()),
        ("afm_workshop", AFM_WORKSHOP.into()),
    ]);
    all
}
