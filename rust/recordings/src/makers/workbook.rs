//! Workbook of a testing machine (Zwick testXpert): one sheet per specimen, names in the language of the program.

use crate::clock::Clock;
use crate::curve::{Channel, Curve};
use crate::fault::{Fault, shown};
use crate::fields::{MOST_VALUES, value};
use crate::pressure_map::Source;
use crate::tables::columns::Column;
use crate::units::{Quantity, unit};
use calamine::{DataRef, Reader, Xlsx};
use std::io::Cursor;

const REMEDY: &str = "save the workbook again as .xlsx, or the sheet as CSV";
/// Largest size of all sheets together after unpacking, bytes.
const LARGEST_UNPACKED: u64 = 1 << 30;
/// Rows in which the units of a specimen are looked for.
const HEAD_ROWS: u32 = 12;
/// Columns of a sheet that are read.
const MOST_COLUMNS: usize = 64;

pub(super) fn read(bytes: Vec<u8>) -> Result<Vec<Curve>, Fault> {
    if !bytes.starts_with(b"PK") {
        let problem = "this is a workbook of the old kind (.xls)".to_string();
        return Err(Fault::file(problem, "save it as .xlsx"));
    }
    check_size(&bytes)?;
    let mut book: Xlsx<Cursor<Vec<u8>>> = Xlsx::new(Cursor::new(bytes))
        .map_err(|error| Fault::file(format!("the workbook cannot be opened ({error})"), REMEDY))?;
    let (mut curves, mut held) = (Vec::new(), 0);
    for name in book.sheet_names() {
        if let Some(curve) = read_sheet(&mut book, &name, &mut held)? {
            curves.push(curve);
        }
    }
    if curves.is_empty() {
        let problem = "no sheet of the workbook holds columns with units of time, force or length"
            .to_string();
        return Err(Fault::file(
            problem,
            "export the curves of the specimens, with their units",
        ));
    }
    Ok(curves)
}

fn check_size(bytes: &[u8]) -> Result<(), Fault> {
    let fault = |problem: String| Fault::file(problem, REMEDY);
    let mut archive = zip::ZipArchive::new(Cursor::new(bytes))
        .map_err(|error| fault(format!("the workbook cannot be opened ({error})")))?;
    let mut unpacked = 0_u64;
    for k in 0..archive.len() {
        let member = archive
            .by_index_raw(k)
            .map_err(|error| fault(format!("the workbook cannot be opened ({error})")))?;
        unpacked = unpacked.saturating_add(member.size());
    }
    if unpacked > LARGEST_UNPACKED {
        return Err(fault(format!(
            "the workbook unpacks to {unpacked} bytes, more than the {LARGEST_UNPACKED} that are read"
        )));
    }
    Ok(())
}

/// Rows of names before the units, then columns of numbers.
#[derive(Default)]
struct Sheet {
    /// The texts of the row above the one that is being read, by column.
    names: Vec<String>,
    row: Vec<String>,
    at: u32,
    columns: Option<Vec<Column>>,
    values: Vec<Vec<f64>>,
}

/// A specimen's curve; `None` if the sheet holds no columns with units.
fn read_sheet(
    book: &mut Xlsx<Cursor<Vec<u8>>>,
    name: &str,
    held: &mut usize,
) -> Result<Option<Curve>, Fault> {
    let fault = |row: u32, problem: String| {
        let place = format!(
            "sheet {}, row {}: {problem}",
            shown(name.as_bytes()),
            row + 1
        );
        Fault::file(place, REMEDY)
    };
    let unreadable = |error| fault(0, format!("cannot be read ({error})"));
    let mut sheet = Sheet::default();
    let mut cells = book.worksheet_cells_reader(name).map_err(unreadable)?;
    while let Some(cell) = cells.next_cell().map_err(unreadable)? {
        let (row, column) = cell.get_position();
        if column as usize >= MOST_COLUMNS {
            continue;
        }
        *held += 1;
        if *held > MOST_VALUES {
            return Err(fault(row, "the workbook holds too many cells".into()));
        }
        if row != sheet.at {
            sheet.end_row();
            sheet.at = row;
        }
        if sheet.columns.is_none() && row > HEAD_ROWS {
            return Ok(None);
        }
        sheet
            .take(column as usize, cell.get_value())
            .map_err(|problem| fault(row, problem))?;
    }
    sheet.end_row();
    let last = sheet.at;
    sheet.finish(name).map_err(|problem| fault(last, problem))
}

impl Sheet {
    fn take(&mut self, column: usize, cell: &DataRef) -> Result<(), String> {
        if self.columns.is_some() {
            return self.take_number(column, cell);
        }
        let text = match cell {
            DataRef::String(text) => text.trim().to_string(),
            DataRef::SharedString(text) => text.trim().to_string(),
            _ => String::new(),
        };
        if self.row.len() <= column {
            self.row.resize(column + 1, String::new());
        }
        self.row[column] = text;
        Ok(())
    }

    fn take_number(&mut self, column: usize, cell: &DataRef) -> Result<(), String> {
        let number = match cell {
            DataRef::Float(number) => *number,
            DataRef::Int(number) => *number as f64,
            DataRef::Empty => return Ok(()),
            DataRef::String(text) => value(text.trim())?,
            DataRef::SharedString(text) => value(text.trim())?,
            _ => return Err("a cell that is neither number nor text".into()),
        };
        let Some(values) = self.values.get_mut(column) else {
            return Ok(());
        };
        if !number.is_finite() {
            return Err("a number that is not finite".into());
        }
        values.push(number);
        Ok(())
    }

    /// Looks whether the row that ends here holds units, with names above.
    fn end_row(&mut self) {
        if self.columns.is_some() {
            return;
        }
        let row = std::mem::take(&mut self.row);
        if row.iter().filter(|text| unit(text).is_some()).count() >= 2 {
            let name = |k: usize| self.names.get(k).map_or("", String::as_str);
            let columns: Vec<Column> = (0..row.len())
                .map(|k| Column::new(name(k), &row[k]))
                .collect();
            self.values = vec![Vec::new(); columns.len()];
            self.columns = Some(columns);
        }
        self.names = row;
    }

    fn finish(self, name: &str) -> Result<Option<Curve>, String> {
        let Some(columns) = self.columns else {
            return Ok(None);
        };
        let samples = self.values.iter().map(Vec::len).max().unwrap_or(0);
        if samples == 0 {
            return Ok(None);
        }
        let mut curve = Curve::of(Source::of("testing machine", ""));
        curve.name = name.to_string();
        for (column, values) in columns.iter().zip(self.values) {
            let Some(unit) = column
                .unit
                .filter(|_| !column.base.is_empty() && !values.is_empty())
            else {
                continue;
            };
            if values.len() != samples {
                return Err(format!(
                    "column {} holds {} numbers of {samples}",
                    shown(column.base.as_bytes()),
                    values.len()
                ));
            }
            curve
                .channels
                .push(Channel::converted(&column.base, unit, values));
        }
        if let Some(time) = curve.channel("time_s") {
            let mut clock = Clock::default();
            for time in time {
                clock
                    .push(1, *time)
                    .map_err(|_| "time does not increase".to_string())?;
            }
        }
        let gap = curve
            .channel("tool_gap_mm")
            .map(|gap| gap.iter().map(|value| gap[0] - value).collect());
        curve
            .channels
            .extend(gap.map(|travel| Channel::named("travel", Quantity::Length, travel)));
        curve.unknown.push("where contact begins".into());
        Ok(Some(curve))
    }
}
