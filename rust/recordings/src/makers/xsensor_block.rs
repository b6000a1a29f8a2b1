//! One sensor block of an XSENSOR export: what it states of itself, and its cells.

use super::limits::count;
use crate::fault::{Fault, shown};
use crate::tables::columns::fields;
use crate::text::fields::{DAMAGED, ODD, Row, Separator, value};
use crate::text::lines::{Line, Lines};
use crate::text::units::{Quantity, unit};

/// Cells and statistics of one sensor in one frame, in the file's unit of pressure and in mm.
#[derive(Debug, Clone, Default)]
pub(super) struct Block {
    pub name: String,
    pub rows: usize,
    pub columns: usize,
    /// Height and width of a cell, mm.
    pub cell_mm: [Option<f64>; 2],
    pub peak: Option<f64>,
    pub contact_area_mm2: Option<f64>,
    pub total_area_mm2: Option<f64>,
    pub load_n: Option<f64>,
    pub values: Vec<f64>,
}

/// Key and value of a line `KEY,value,,,` or `Key:,value`; tabs part them in a workbook's sheet.
pub(super) fn pair<'a>(line: &Line<'a>) -> (&'a str, &'a str) {
    let text = line.text.trim();
    let (key, rest) = text.split_once([',', '\t']).unwrap_or((text, ""));
    (
        key.trim().trim_matches('"'),
        rest.trim_matches([',', ' ', '\t', '"']),
    )
}

/// A key in small letters, without the colon that some versions write.
pub(super) fn lower(key: &str) -> String {
    key.trim_end_matches(':').trim().to_lowercase()
}

impl Block {
    /// Reads the rest of a block whose line `SENSOR,<name>` has been read.
    pub fn read(lines: &mut Lines, name: String) -> Result<Block, Fault> {
        let mut block = Block {
            name,
            ..Block::default()
        };
        loop {
            let Some(line) = lines.next_filled(&[','])? else {
                return Err(lines.ended("the cells (SENSELS) of a sensor"));
            };
            let (name, text) = pair(&line);
            let lower = lower(name);
            let key = lower.as_str();
            if key == "sensels" {
                break;
            }
            if ["sensor", "frame", "group"].contains(&key) {
                return Err(line.fault(
                    format!("{name} stands before the cells of the sensor above it"),
                    DAMAGED,
                ));
            }
            block.take(key, text).map_err(|problem| {
                line.fault(
                    format!("{}: {problem}", name.trim_end_matches(':')),
                    DAMAGED,
                )
            })?;
        }
        if block.rows == 0 || block.columns == 0 {
            let problem = "the sensor above does not state its Rows and Columns".to_string();
            return Err(Fault::line(lines.number(), problem, DAMAGED));
        }
        super::limits::check_cells(block.rows, block.columns)
            .map_err(|problem| Fault::line(lines.number(), problem, ODD))?;
        for row in 0..block.rows {
            let Some(line) = lines.next_filled(&[','])? else {
                return Err(lines.ended(&format!("row {} of {} of a sensor", row + 1, block.rows)));
            };
            read_row(line, block.columns, &mut block.values)?;
        }
        Ok(block)
    }

    fn take(&mut self, key: &str, text: &str) -> Result<(), String> {
        // `sensel width (cm)`: the unit is the file's choice.
        let (name, unit) = key.split_once(" (").unwrap_or((key, ""));
        let unit = unit.trim_end_matches(')');
        match name {
            "rows" => self.rows = count(text, "rows")?,
            "columns" => self.columns = count(text, "columns")?,
            "sensel height" => {
                self.cell_mm[0] = Some(positive(text)? * factor(unit, Quantity::Length)?)
            }
            "sensel width" => {
                self.cell_mm[1] = Some(positive(text)? * factor(unit, Quantity::Length)?)
            }
            "contact area" => {
                self.contact_area_mm2 = Some(value(text)? * factor(unit, Quantity::Area)?)
            }
            "total area" => {
                self.total_area_mm2 = Some(value(text)? * factor(unit, Quantity::Area)?)
            }
            "est. load" => self.load_n = Some(value(text)? * factor(unit, Quantity::Force)?),
            "peak pressure" => self.peak = Some(value(text)?),
            _ => {}
        }
        Ok(())
    }
}

/// One of the library's units in the unit that stands in brackets.
fn factor(text: &str, quantity: Quantity) -> Result<f64, String> {
    match unit(text) {
        Some(unit) if unit.quantity == quantity => Ok(unit.factor),
        _ => Err(format!(
            "{} is not a unit of what stands in {} here",
            shown(text.as_bytes()),
            quantity.unit()
        )),
    }
}

/// The cells of one row; decimal commas stand in quotes.
fn read_row(line: Line, columns: usize, into: &mut Vec<f64>) -> Result<(), Fault> {
    let separator = match line.text.contains('\t') {
        true => Separator::Tab,
        false => Separator::Comma,
    };
    if separator == Separator::Tab || !line.text.contains('"') {
        let shape = Row {
            separator,
            columns,
            missing: None,
        };
        return shape.read(line, into);
    }
    let row = fields(&line, separator);
    let count = row.iter().position(String::is_empty).unwrap_or(row.len());
    if count != columns {
        let problem = format!("the row holds {count} values, expected {columns}");
        return Err(line.fault(problem, DAMAGED));
    }
    for field in &row[..count] {
        into.push(value(field).map_err(|problem| line.fault(problem, ODD))?);
    }
    Ok(())
}

fn positive(text: &str) -> Result<f64, String> {
    value(text).and_then(|value| {
        let problem = || format!("{} is not positive", shown(text.as_bytes()));
        (value > 0.0).then_some(value).ok_or_else(problem)
    })
}
