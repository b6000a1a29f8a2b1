//! Which maker's format a file has, from its first bytes.

use crate::fault::Fault;
use crate::makers::AFM_WORKSHOP;
use crate::tables::head::{Found, Search, question};
use crate::tables::mapping::Columns;
use crate::text::fields::{Separator, value};
use crate::text::lines::{Line, Lines};

/// Bytes that are looked at.
pub(crate) const HEAD: usize = 1 << 16;
/// Lines among them.
const LINES: usize = 1000;

/// The formats that can be read.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Format {
    /// Tekscan I-Scan or F-Scan, ASCII movie.
    Tekscan,
    /// Novel pedar, insoles.
    Pedar,
    /// Novel pliance, mats.
    Pliance,
    /// Novel emed, platforms.
    Emed,
    /// XSENSOR, CSV.
    Xsensor,
    /// RSscan footscan, dynamic roll-off.
    Footscan,
    /// Logger of sensor insoles, CSV.
    InsoleLogger,
    /// Biomomentum Mach-1, text.
    Mach1,
    /// Aurora Scientific DMC, `.ddf`.
    Aurora,
    /// Optics11 Chiaro or Piuma, text.
    Optics11,
    /// AFM Workshop force-distance curve, CSV.
    AfmWorkshop,
    /// JPK force curve, exported as text.
    JpkText,
    /// JPK force curve, `.jpk-force`.
    JpkArchive,
    /// Workbook of a testing machine (Zwick testXpert).
    Workbook,
    /// Table of an indentation: plain CSV, or a testing machine's CSV with header lines (Instron).
    CurveTable,
    /// Table of pressures: plain CSV of a study.
    MapTable,
}

impl Format {
    /// Name for people.
    pub fn name(self) -> &'static str {
        match self {
            Format::Tekscan => "Tekscan ASCII",
            Format::Pedar => "Novel pedar",
            Format::Pliance => "Novel pliance",
            Format::Emed => "Novel emed",
            Format::Xsensor => "XSENSOR CSV",
            Format::Footscan => "RSscan footscan",
            Format::InsoleLogger => "insole logger CSV",
            Format::Mach1 => "Mach-1",
            Format::Aurora => "Aurora DMC",
            Format::Optics11 => "Optics11 Chiaro or Piuma",
            Format::AfmWorkshop => "AFM Workshop force-distance curve",
            Format::JpkText => "JPK text",
            Format::JpkArchive => "JPK force curve",
            Format::Workbook => "testing machine workbook",
            Format::CurveTable => "indentation table",
            Format::MapTable => "pressure table",
        }
    }
}

/// How a file is to be opened.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    Text(Format),
    /// A workbook or a JPK archive, which its list of contents says.
    Zip,
    /// A workbook of the old kind.
    OldWorkbook,
}

/// What a file is that begins with `head`; `named` are the columns that a user named.
pub(crate) fn kind_of(head: &[u8], named: &Columns) -> Result<Kind, Fault> {
    if head.is_empty() {
        let problem = "the file is empty".to_string();
        return Err(Fault::line(1, problem, "export the recording again"));
    }
    if head.starts_with(b"PK\x03\x04") {
        return Ok(Kind::Zip);
    }
    if head.starts_with(b"\xD0\xCF\x11\xE0") {
        return Ok(Kind::OldWorkbook);
    }
    if head.starts_with(b"\xFF\xFE") || head.starts_with(b"\xFE\xFF") {
        let problem = "the text is saved as UTF-16".to_string();
        return Err(Fault::line(1, problem, "save it as UTF-8 or Latin-1"));
    }
    if let Some(fault) = foreign(head) {
        return Err(fault);
    }
    // The last line of the head may be cut.
    let whole = match memchr::memrchr2(b'\n', b'\r', head) {
        Some(end) if head.len() == HEAD => &head[..end],
        _ => head,
    };
    let lines = first_lines(whole);
    MARKS
        .iter()
        .find(|(_, is_that)| is_that(&lines))
        .map(|(format, _)| *format)
        .or_else(|| table_format(&lines, named))
        .map(Kind::Text)
        .ok_or_else(|| match named.is_empty() {
            true => statistics(&lines)
                .or_else(|| question(&lines))
                .or_else(|| bare_numbers(&lines))
                .unwrap_or_else(not_known),
            false => not_named(named),
        })
}

/// What is to be asked of a table whose columns have units and names that say nothing.
pub(crate) fn asked(head: &[u8]) -> Option<Fault> {
    question(&first_lines(head))
}

/// First bytes of files that laboratories have and that are not read, what they are, and what to do.
const FOREIGN: &[(&[u8], &str, &str)] = &[
    (b"\x89HDF\r\n", "an HDF5 file", FROM_PROGRAM),
    (
        b"\\*Force file list",
        "a Bruker Nanoscope force file",
        FROM_PROGRAM,
    ),
    (b"\\*EC File list", "a Bruker Nanoscope file", FROM_PROGRAM),
    (b"\\*File list", "a Bruker Nanoscope picture", FROM_PROGRAM),
    (
        b"II*\0",
        "a TIFF picture, as JPK's images are",
        FROM_PROGRAM,
    ),
    (
        b"MM\0*",
        "a TIFF picture, as JPK's images are",
        FROM_PROGRAM,
    ),
    (
        b"\x1F\x8B",
        "packed with gzip, as Zwick's .zs2",
        "unpack it, or export the curves as a workbook or as text",
    ),
    (b"%PDF", "a PDF report", FROM_PROGRAM),
    (
        b"\x89PNG",
        "a picture",
        "a handprint is read as one; a recording is text or a workbook",
    ),
    (
        b"\xFF\xD8\xFF",
        "a picture",
        "a handprint is read as one; a recording is text or a workbook",
    ),
];
const FROM_PROGRAM: &str = "export the curves or frames as text or CSV from the maker's program";

/// The fault of a file whose first bytes say that it is of a kind that is not read.
fn foreign(head: &[u8]) -> Option<Fault> {
    let of = |what: &str, remedy: &'static str| {
        Fault::file(format!("this is {what}, which is not read"), remedy)
    };
    let known = FOREIGN.iter().find(|(mark, ..)| head.starts_with(mark));
    known.map(|(_, what, remedy)| of(what, remedy)).or_else(|| {
        is_igor(head).then(|| of("an Igor binary wave, as Asylum writes it", FROM_PROGRAM))
    })
}

/// Igor's version stands first, and the words of its header sum up to zero (WaveMetrics, Technical Note 3).
fn is_igor(head: &[u8]) -> bool {
    let sums = |length: usize, word: fn([u8; 2]) -> u16, version: u16| {
        let header = head.get(..length).unwrap_or(&[]);
        let words = header.chunks_exact(2).map(|pair| word([pair[0], pair[1]]));
        header.len() == length
            && word([head[0], head[1]]) == version
            && words.fold(0, u16::wrapping_add) == 0
    };
    [u16::from_le_bytes, u16::from_be_bytes]
        .into_iter()
        .any(|word| sums(384, word, 5) || sums(126, word, 2))
}

/// XSENSOR's table with a row for each frame, which holds no pressures.
fn statistics(lines: &[String]) -> Option<Fault> {
    let is_head = |line: &&String| line.starts_with("Frame,") && line.contains("Est. Load");
    lines.iter().find(is_head)?;
    let problem = "this is XSENSOR's table of statistics, a row for each frame, without the pressures of the cells";
    Some(Fault::file(
        problem.into(),
        "export the frames with their sensels as CSV",
    ))
}

/// Rows of numbers that nothing names.
fn bare_numbers(lines: &[String]) -> Option<Fault> {
    let is_row = |text: &String| {
        let mut fields = Separator::of(text).split(text).filter(|f| !f.is_empty());
        let is_number = |field: &str| value(field).is_ok();
        fields.next().is_some_and(is_number) && fields.next().is_some() && fields.all(is_number)
    };
    if lines.len() < 3 || !lines.iter().all(is_row) {
        return None;
    }
    let problem = "its rows hold numbers, and no line names the columns and their units";
    let remedy = "put a line of names before them, such as time_s,travel_mm,force_n";
    Some(Fault::line(1, problem.into(), remedy))
}

fn not_known() -> Fault {
    Fault::line(
        1,
        "this is no recording format that is known (Tekscan, Novel, XSENSOR, footscan, Aurora, Optics11, JPK, AFM Workshop, Mach-1, testing machine, CSV)"
            .into(),
        "export it as text from the maker's program, or as CSV with columns such as time_s, depth_mm, force_n",
    )
}

fn not_named(named: &Columns) -> Fault {
    let problem = format!("no line of names holds {}", named.headers());
    Fault::line(
        1,
        problem,
        "name the columns as the file does, without a unit or with it",
    )
}

type Mark = fn(&[String]) -> bool;

/// Format and what tells it, in the order they are tried.
const MARKS: &[(Format, Mark)] = &[
    (Format::Tekscan, |lines| {
        any(lines, &["ASCII_DATA", "VERSION Tekscan"]) || first(lines).starts_with("DATA_TYPE")
    }),
    (Format::Pliance, |lines| {
        any(lines, &["mat type"]) && any(lines, &["pressure values"])
    }),
    (Format::Pedar, |lines| {
        any(lines, &["mask definition", "left insole", "right insole"])
            && any(lines, &["sensor type", "pressure values"])
    }),
    (Format::Emed, |lines| {
        lines.iter().any(|line| line.contains("Matrix:"))
            && lines.iter().any(|line| line.contains("Sensor area:"))
    }),
    (Format::Xsensor, |lines| {
        let has = |keys: &[&str]| lines.iter().any(|line| keys.contains(&key(line).as_str()));
        has(&["sensor"]) && has(&["units", "frame"]) && has(&["sensels"])
    }),
    (Format::Footscan, |lines| {
        any(
            lines,
            &[
                "Left foot data",
                "Right foot data",
                "Right rectangle",
                "Left rectangle",
            ],
        )
    }),
    (Format::InsoleLogger, |lines| {
        first(lines).starts_with("sole_id") && first(lines).contains("pressure_")
    }),
    (Format::Mach1, |lines| {
        first(lines).starts_with("<Mach-1 File>")
    }),
    (Format::Aurora, |lines| {
        first(lines).starts_with("DMC") && first(lines).contains("Data File")
    }),
    (Format::Optics11, |lines| {
        any(lines, &["Tip radius ("]) && any(lines, &["k (N/m)"])
    }),
    (Format::AfmWorkshop, |lines| first(lines) == AFM_WORKSHOP),
    (Format::JpkText, |lines| {
        any(lines, &["# columns:"]) && any(lines, &["# units:"])
    }),
];

/// The first word of an XSENSOR line, in any style.
fn key(line: &str) -> String {
    let word = line.split([',', '\t']).next().unwrap_or("");
    word.trim().trim_end_matches(':').to_ascii_lowercase()
}

fn any(lines: &[String], starts: &[&str]) -> bool {
    lines
        .iter()
        .any(|line| starts.iter().any(|start| line.starts_with(start)))
}

fn first(lines: &[String]) -> &str {
    lines.first().map_or("", String::as_str)
}

/// The first lines that hold anything, without blanks around them.
fn first_lines(head: &[u8]) -> Vec<String> {
    let mut lines = Lines::new(head);
    let mut found = Vec::new();
    while let Ok(Some(line)) = lines.next_filled(&[',', ';']) {
        found.push(line.text.trim().to_string());
        if found.len() == LINES {
            break;
        }
    }
    found
}

fn table_format(lines: &[String], named: &Columns) -> Option<Format> {
    let mut search = Search::new(named);
    let found = lines
        .iter()
        .find_map(|text| match search.take(&Line { number: 0, text }) {
            Found::Nothing => None,
            Found::Map => Some(Format::MapTable),
            Found::Head(_) | Found::Fault(_) => Some(Format::CurveTable),
        });
    found.or_else(|| search.ended().map(|_| Format::CurveTable))
}
