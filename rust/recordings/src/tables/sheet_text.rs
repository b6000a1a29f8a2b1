//! The sheets of a workbook as tab-separated text, a line per row, so that whatever reads texts reads sheets too.

use crate::fault::{Fault, shown};
use calamine::{Data, DataRef, Reader, Xls, Xlsx};
use std::fmt::Write;
use std::io::Cursor;

/// What to do about a workbook that cannot be read.
pub(crate) const REMEDY: &str = "save the workbook again as .xlsx, or the sheet as CSV";
/// Largest size of all sheets together after unpacking, bytes; they are read in pieces.
const LARGEST_UNPACKED: u64 = 1 << 29;
/// Largest list of texts after unpacking, bytes; it is held, at several times its size.
const LARGEST_TEXTS: u64 = 64 << 20;
/// Most cells of a workbook.
const MOST_CELLS: usize = 1 << 24;
/// Most bytes of one sheet as text.
const LARGEST_SHEET: usize = 256 << 20;
/// Rows of a sheet, as the formats of workbooks bound them.
const MOST_ROWS: usize = 1 << 20;
/// Columns of a sheet that are read.
const MOST_COLUMNS: usize = 512;

/// An opened workbook.
pub(crate) struct Book {
    kind: Kind,
    held: usize,
}

enum Kind {
    New(Box<Xlsx<Cursor<Vec<u8>>>>),
    Old(Box<Xls<Cursor<Vec<u8>>>>),
}

impl Book {
    /// Opens a workbook of either kind.
    pub fn open(bytes: Vec<u8>) -> Result<Book, Fault> {
        let fault =
            |error: String| Fault::file(format!("the workbook cannot be opened ({error})"), REMEDY);
        let kind = if bytes.starts_with(b"PK") {
            check_size(&bytes)?;
            let book = Xlsx::new(Cursor::new(bytes)).map_err(|error| fault(error.to_string()))?;
            Kind::New(Box::new(book))
        } else {
            let book = Xls::new(Cursor::new(bytes)).map_err(|error| fault(error.to_string()))?;
            Kind::Old(Box::new(book))
        };
        Ok(Book { kind, held: 0 })
    }

    /// Names of the sheets, in order.
    pub fn names(&self) -> Vec<String> {
        match &self.kind {
            Kind::New(book) => book.sheet_names(),
            Kind::Old(book) => book.sheet_names(),
        }
    }

    /// A sheet as text.
    pub fn text(&mut self, name: &str) -> Result<Vec<u8>, Fault> {
        let mut text = Text::new(name, &mut self.held);
        let unreadable = |error: String| {
            Fault::file(
                format!("sheet {} cannot be read ({error})", shown(name.as_bytes())),
                REMEDY,
            )
        };
        match &mut self.kind {
            Kind::New(book) => {
                let mut cells = book
                    .worksheet_cells_reader(name)
                    .map_err(|error| unreadable(error.to_string()))?;
                while let Some(cell) = cells
                    .next_cell()
                    .map_err(|error| unreadable(error.to_string()))?
                {
                    let (row, column) = cell.get_position();
                    text.push([row as usize, column as usize], cell.get_value())?;
                }
            }
            Kind::Old(book) => {
                let range = book
                    .worksheet_range(name)
                    .map_err(|error| unreadable(error.to_string()))?;
                let (first_row, first_column) = range.start().unwrap_or((0, 0));
                for (row, column, cell) in range.used_cells() {
                    let place = [first_row as usize + row, first_column as usize + column];
                    text.push(place, &borrowed(cell))?;
                }
            }
        }
        Ok(text.written.into_bytes())
    }
}

/// An old workbook's cell as those of a new one.
fn borrowed(cell: &Data) -> DataRef<'_> {
    match cell {
        Data::Float(number) => DataRef::Float(*number),
        Data::Int(number) => DataRef::Int(*number),
        Data::String(text) => DataRef::SharedString(text),
        Data::Empty => DataRef::Empty,
        other => DataRef::String(other.to_string()),
    }
}

/// A sheet while it is written.
struct Text<'b> {
    name: &'b str,
    held: &'b mut usize,
    written: String,
    /// Where the next cell would stand.
    at: [usize; 2],
}

impl<'b> Text<'b> {
    fn new(name: &'b str, held: &'b mut usize) -> Text<'b> {
        Text {
            name,
            held,
            written: String::new(),
            at: [0, 0],
        }
    }

    fn push(&mut self, [row, column]: [usize; 2], cell: &DataRef) -> Result<(), Fault> {
        if column >= MOST_COLUMNS || row < self.at[0] {
            return Ok(());
        }
        if row >= MOST_ROWS {
            let problem = format!(
                "sheet {}: a cell claims row {}, and a sheet has {MOST_ROWS}",
                shown(self.name.as_bytes()),
                row + 1
            );
            return Err(Fault::file(problem, REMEDY));
        }
        *self.held += 1;
        if *self.held > MOST_CELLS || self.written.len() > LARGEST_SHEET {
            let problem = format!(
                "sheet {}, row {}: the workbook holds too many cells",
                shown(self.name.as_bytes()),
                row + 1
            );
            return Err(Fault::file(
                problem,
                "export fewer samples, or one sheet as CSV",
            ));
        }
        while self.at[0] < row {
            self.written.push('\n');
            self.at = [self.at[0] + 1, 0];
        }
        while self.at[1] < column {
            self.written.push('\t');
            self.at[1] += 1;
        }
        // Writing to a text cannot fail.
        let _ = match cell {
            DataRef::Empty => Ok(()),
            DataRef::Float(number) => write!(self.written, "{number}"),
            DataRef::Int(number) => write!(self.written, "{number}"),
            DataRef::String(text) => self.write_text(text),
            DataRef::SharedString(text) => self.write_text(text),
            DataRef::DateTime(moment) => write!(self.written, "{moment}"),
            other => write!(self.written, "{other:?}"),
        };
        Ok(())
    }

    /// A text on one line, without the letters that part cells.
    fn write_text(&mut self, text: &str) -> std::fmt::Result {
        let one_line = text
            .trim()
            .chars()
            .map(|c| if c.is_control() { ' ' } else { c });
        self.written.extend(one_line);
        Ok(())
    }
}

fn check_size(bytes: &[u8]) -> Result<(), Fault> {
    let fault = |problem: String| Fault::file(problem, REMEDY);
    let unopened = |error| fault(format!("the workbook cannot be opened ({error})"));
    let mut archive = zip::ZipArchive::new(Cursor::new(bytes)).map_err(unopened)?;
    let (mut unpacked, mut texts) = (0_u64, 0_u64);
    for k in 0..archive.len() {
        let member = archive.by_index_raw(k).map_err(unopened)?;
        unpacked = unpacked.saturating_add(member.size());
        if !member.name().is_ok_and(|name| name.contains("worksheets/")) {
            texts = texts.saturating_add(member.size());
        }
    }
    for (what, size, largest) in [
        ("the workbook unpacks", unpacked, LARGEST_UNPACKED),
        (
            "all of the workbook but its sheets unpacks",
            texts,
            LARGEST_TEXTS,
        ),
    ] {
        if size > largest {
            let problem = format!("{what} to {size} bytes, more than the {largest} that are read");
            return Err(fault(problem));
        }
    }
    Ok(())
}
