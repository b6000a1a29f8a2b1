//! What a file holds: a text, or a workbook, each of whose sheets is read as the text that it holds.

use crate::detection::{Format, HEAD, Kind, asked, kind_of};
use crate::fault::{Fault, shown};
use crate::recording_file::RecordingFile;
use crate::source::Source;
use crate::tables::curves::Rows;
use crate::tables::mapping::Columns;
use crate::tables::sheet_text::{Book, REMEDY};
use crate::text::lines::Lines;
use crate::{makers, tables};

/// Most sheets that a note names.
const MOST_NAMED: usize = 12;

/// Reads a text; `named` are the columns that a user named, and how strict the rows of a table are taken.
pub(crate) fn read_text(
    lines: &mut Lines,
    format: Format,
    (named, rows): (&Columns, Rows),
) -> Result<RecordingFile, Fault> {
    match format {
        // A curve of AFM Workshop is a table as well: a user may name its columns.
        Format::AfmWorkshop if !named.is_empty() => {
            read_text(lines, Format::CurveTable, (named, rows))
        }
        Format::CurveTable => {
            let curves = tables::curves::read(lines, named, rows)?;
            Ok(RecordingFile::of_curves(format, curves))
        }
        Format::Mach1 => makers::mach1(lines, named),
        _ if !named.is_empty() => {
            let problem = format!("{} names its columns itself", format.name());
            Err(Fault::file(problem, "take the names of columns out"))
        }
        Format::MapTable => tables::maps::read(lines),
        _ => makers::read_text(format, lines),
    }
}

/// Reads every sheet; sheets of results are named and passed over.
pub(crate) fn read_workbook(bytes: Vec<u8>, named: &Columns) -> Result<RecordingFile, Fault> {
    let run = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| read_sheets(bytes, named)));
    // The workbook library panics at some damaged cell references.
    run.unwrap_or_else(|_| {
        let problem = "a cell or its place breaks the rules of workbooks".to_string();
        Err(Fault::file(problem, "save it again as .xlsx, or as CSV"))
    })
}

fn read_sheets(bytes: Vec<u8>, named: &Columns) -> Result<RecordingFile, Fault> {
    let mut book = Book::open(bytes)?;
    let mut file = RecordingFile::of_curves(Format::Workbook, Vec::new());
    let (mut passed, mut faults) = (Vec::new(), Vec::<Fault>::new());
    let mut open = None;
    for name in book.names() {
        let text = book.text(&name)?;
        let head = &text[..text.len().min(HEAD)];
        let Ok(Kind::Text(format)) = kind_of(head, named) else {
            if named.is_empty() {
                open = open.or_else(|| asked(head).map(|fault| fault.in_sheet(&name)));
            }
            if !text.is_empty() {
                passed.push(shown(name.as_bytes()));
            }
            continue;
        };
        let mut lines = Lines::new(text.as_slice());
        match read_text(&mut lines, format, (named, Rows::LeftOut)) {
            Ok(sheet) => take(&mut file, sheet, &name),
            Err(fault) => faults.push(fault.in_sheet(&name)),
        }
    }
    if file.curves.is_empty() && file.maps.is_empty() {
        let first = faults.into_iter().next();
        return Err(first.or(open).unwrap_or_else(|| nothing(named)));
    }
    let left_out = faults
        .iter()
        .map(|fault| format!("{}; the sheet is left out", fault.problem()));
    file.notes.extend(left_out.take(MOST_NAMED));
    if !passed.is_empty() {
        let more = match passed.len().saturating_sub(MOST_NAMED) {
            0 => String::new(),
            more => format!(" and {more} more"),
        };
        passed.truncate(MOST_NAMED);
        file.notes.push(format!(
            "no curve and no mat is in sheet {}{more}",
            passed.join(", ")
        ));
    }
    Ok(file)
}

fn take(file: &mut RecordingFile, sheet: RecordingFile, name: &str) {
    if sheet.format != Format::CurveTable {
        file.format = sheet.format;
    }
    for mut curve in sheet.curves {
        curve.name = match curve.name.as_str() {
            "" => name.to_string(),
            run => format!("{name}, {run}"),
        };
        if curve.source.maker.is_empty() {
            curve.source = Source::of("testing machine", "");
        }
        file.curves.push(curve);
    }
    file.maps.extend(sheet.maps);
}

fn nothing(named: &Columns) -> Fault {
    if !named.is_empty() {
        let problem = format!("no sheet of the workbook has columns {}", named.headers());
        return Fault::file(
            problem,
            "name the columns as the file does, without a unit or with it",
        );
    }
    let problem = "no sheet of the workbook holds columns with units of time, force or length";
    Fault::file(
        problem.to_string(),
        format!(
            "export the curves of the specimens, with their units, or name the columns; else {REMEDY}"
        ),
    )
}
