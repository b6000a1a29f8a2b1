//! One sensor block of an XSENSOR export: what it states of itself, and its cells.

use super::count;
use crate::fault::{Fault, shown};
use crate::fields::{DAMAGED, Row, Separator, value};
use crate::lines::{Line, Lines};

/// Cells and statistics of one sensor in one frame, in the file's unit and in cm.
#[derive(Debug, Clone, Default)]
pub(super) struct Block {
    pub name: String,
    pub rows: usize,
    pub columns: usize,
    /// Height and width of a cell, cm.
    pub cell_cm: [Option<f64>; 2],
    pub peak: Option<f64>,
    pub contact_area_cm2: Option<f64>,
    pub total_area_cm2: Option<f64>,
    pub load_n: Option<f64>,
    pub values: Vec<f64>,
}

/// Key and value of a line `KEY,value,,,`.
pub(super) fn pair<'a>(line: &Line<'a>) -> (&'a str, &'a str) {
    let text = line.text.trim();
    let (key, rest) = text.split_once(',').unwrap_or((text, ""));
    (key.trim(), rest.trim_matches([',', ' ', '\t', '"']))
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
            let (key, text) = pair(&line);
            if key == "SENSELS" {
                break;
            }
            if ["SENSOR", "FRAME", "GROUP"].contains(&key) {
                return Err(line.fault(
                    format!("{key} stands before the cells of the sensor above it"),
                    DAMAGED,
                ));
            }
            block
                .take(key, text)
                .map_err(|problem| line.fault(format!("{key}: {problem}"), DAMAGED))?;
        }
        if block.rows == 0 || block.columns == 0 {
            let problem = "the sensor above does not state its Rows and Columns".to_string();
            return Err(Fault::line(lines.number(), problem, DAMAGED));
        }
        super::check_cells(block.rows, block.columns)
            .map_err(|problem| Fault::line(lines.number(), problem, DAMAGED))?;
        let shape = Row {
            separator: Separator::Comma,
            columns: block.columns,
            missing: None,
        };
        for row in 0..block.rows {
            match lines.next_filled(&[','])? {
                Some(line) => shape.read(line, &mut block.values)?,
                None => {
                    return Err(lines.ended(&format!(
                        "row {} of {} of a sensor",
                        row + 1,
                        block.rows
                    )));
                }
            }
        }
        Ok(block)
    }

    fn take(&mut self, key: &str, text: &str) -> Result<(), String> {
        match key {
            "Rows" => self.rows = count(text, "rows")?,
            "Columns" => self.columns = count(text, "columns")?,
            "Sensel Height (cm)" => self.cell_cm[0] = Some(positive(text)?),
            "Sensel Width (cm)" => self.cell_cm[1] = Some(positive(text)?),
            "Contact Area (cm²)" => self.contact_area_cm2 = Some(value(text)?),
            "Total Area (cm²)" => self.total_area_cm2 = Some(value(text)?),
            "Est. Load (N)" => self.load_n = Some(value(text)?),
            _ if key.starts_with("Peak Pressure") => self.peak = Some(value(text)?),
            _ => {}
        }
        Ok(())
    }
}

fn positive(text: &str) -> Result<f64, String> {
    value(text).and_then(|value| {
        let problem = || format!("{} is not positive", shown(text.as_bytes()));
        (value > 0.0).then_some(value).ok_or_else(problem)
    })
}
