//! The head of a table: names with their units in one row, or names in one and units in the next, behind free lines.

use super::columns::{Column, bare_unit, fields, is_curve, is_map, names};
use super::mapping::Columns;
use crate::fault::{Fault, shown};
use crate::text::fields::{Separator, value};
use crate::text::lines::Line;
use crate::text::units::{Quantity, unit};

/// Longest line that may be a head, bytes.
const LONGEST: usize = 1 << 14;
/// Most columns that a question names.
const MOST_ASKED: usize = 8;
/// Words in the names of results.
const RESULTS: [&str; 7] = [
    "duration", "peak", "max", "mean", "average", "break", "dauer",
];
/// Quantities that make a curve.
const OF_CURVES: [Quantity; 3] = [Quantity::Time, Quantity::Force, Quantity::Length];

/// The columns of a table.
#[derive(Debug, Clone)]
pub(crate) struct Head {
    pub columns: Vec<Column>,
    pub separator: Separator,
    /// The row above the names, which may name the runs of a table that holds several side by side.
    pub above: Vec<String>,
    /// What a reader should know, a sentence each.
    pub notes: Vec<String>,
}

/// What a line is.
pub(crate) enum Found {
    /// A free line, or names whose units may follow.
    Nothing,
    Head(Head),
    /// The line of names of a pressure table.
    Map,
    Fault(Fault),
}

/// Looks for the head, line by line.
pub(crate) struct Search<'m> {
    named: &'m Columns,
    above: Vec<String>,
    previous: Vec<String>,
    /// Names of a curve that lack units, and their fault if no units follow.
    open: Option<Fault>,
    /// Cells stand to the right of the table.
    has_more: bool,
}

impl<'m> Search<'m> {
    pub fn new(named: &'m Columns) -> Search<'m> {
        Search {
            named,
            above: Vec::new(),
            previous: Vec::new(),
            open: None,
            has_more: false,
        }
    }

    /// What the next filled line is.
    pub fn take(&mut self, line: &Line) -> Found {
        let separator = Separator::of(line.text);
        if separator == Separator::Blank || line.text.starts_with('#') || line.text.len() > LONGEST
        {
            return match self.open.take() {
                Some(fault) => Found::Fault(fault),
                None => Found::Nothing,
            };
        }
        let row = fields(line, separator);
        let found = self.look(&row, line);
        self.above = std::mem::replace(&mut self.previous, row);
        match found {
            // A map may hold depths and times as well.
            _ if self.is_map() => Found::Map,
            Ok(Some(columns)) => Found::Head(self.head(columns, separator)),
            Ok(None) => Found::Nothing,
            Err(fault) => Found::Fault(fault),
        }
    }

    fn is_map(&self) -> bool {
        let columns: Vec<Column> = self.previous.iter().map(|name| Column::of(name)).collect();
        is_map(&columns)
    }

    /// The columns, if `row` ends a head.
    fn look(&mut self, row: &[String], line: &Line) -> Result<Option<Vec<Column>>, Fault> {
        let under_names = before_notes(row);
        if is_units(under_names) && !self.previous.is_empty() {
            let (row, full) = (under_names, row.len());
            let mut columns: Vec<Column> = (0..row.len())
                .map(|k| with_unit(self.previous.get(k).map_or("", String::as_str), &row[k]))
                .collect();
            if self.named.apply(&mut columns) && holds_curve(&columns, self.named) {
                self.open = None;
                self.has_more = under_names.len() < full;
                // The names stand one row higher.
                std::mem::swap(&mut self.above, &mut self.previous);
                return sound(columns, line.number).map(Some);
            }
        }
        if let Some(fault) = self.open.take() {
            return Err(fault);
        }
        let mut columns: Vec<Column> = row.iter().map(|name| Column::of(name)).collect();
        if !self.named.apply(&mut columns) {
            return Ok(None);
        }
        let is_head = is_curve(&columns)
            || (is_one_time_and_force(&columns) && !are_results(&columns))
            || (!self.named.is_empty() && known(&columns) >= 2);
        if !is_head || row.iter().filter(|text| value(text).is_ok()).count() > row.len() / 2 {
            return Ok(None);
        }
        match sound(columns, line.number) {
            Ok(columns) => Ok(Some(columns)),
            Err(fault) => {
                self.open = Some(fault);
                Ok(None)
            }
        }
    }

    /// The fault of names that no units followed, at the end of the file.
    pub fn ended(&mut self) -> Option<Fault> {
        self.open.take()
    }

    fn head(&mut self, mut columns: Vec<Column>, separator: Separator) -> Head {
        let mut notes = Vec::new();
        if let (true, Some(last)) = (self.has_more, columns.last()) {
            notes.push(format!(
                "cells to the right of column '{}' stand under no unit and are not read",
                last.header
            ));
        }
        for (what, quantity) in [("time", Quantity::Time), ("force", Quantity::Force)] {
            let of_kind =
                |column: &&mut Column| column.unit.is_some_and(|unit| unit.quantity == quantity);
            let mut all = columns.iter_mut().filter(of_kind);
            if let (Some(only), None) = (all.next(), all.next())
                && only.quantity().is_none()
            {
                notes.push(format!(
                    "column '{}' is taken as the {what}: no other is in {}",
                    only.header, only.unit_text
                ));
                only.base = what.to_string();
            }
        }
        Head {
            columns,
            separator,
            above: std::mem::take(&mut self.above),
            notes,
        }
    }
}

/// A row of units without what stands from its first number on: notes that people keep to the right of a table. A number with a unit to
/// its right is no note: it stands for a column without unit, or in a row of numbers.
fn before_notes(row: &[String]) -> &[String] {
    let Some(notes) = row.iter().position(|text| value(text).is_ok()) else {
        return row;
    };
    if row[notes..].iter().any(|text| unit(text).is_some()) {
        return row;
    }
    let last = row[..notes].iter().rposition(|text| !text.is_empty());
    &row[..last.map_or(0, |last| last + 1)]
}

/// Whether a row holds units and no number.
pub(crate) fn is_units(row: &[String]) -> bool {
    let units = row
        .iter()
        .filter(|text| unit(bare_unit(text)).is_some())
        .count();
    units >= 2 && row.iter().all(|text| value(text).is_err())
}

/// A name with the unit of the row below it; a unit in the name itself holds.
fn with_unit(name: &str, below: &str) -> Column {
    let own = Column::of(name);
    if own.unit.is_some() {
        return own;
    }
    Column::new(name, below)
}

fn known(columns: &[Column]) -> usize {
    columns
        .iter()
        .filter(|column| column.quantity().is_some())
        .count()
}

/// Whether names above units are those of a curve: two known ones, one known one and two quantities, or, under names of another
/// language, one time and one force.
fn holds_curve(columns: &[Column], named: &Columns) -> bool {
    let has = |quantity: Quantity| {
        columns.iter().any(|column| {
            !column.base.is_empty() && column.unit.is_some_and(|unit| unit.quantity == quantity)
        })
    };
    let quantities = OF_CURVES.iter().filter(|quantity| has(**quantity)).count();
    is_curve(columns)
        || (known(columns) >= 1 && quantities >= 2)
        || is_one_time_and_force(columns)
        || (!named.is_empty() && known(columns) >= 2)
}

/// Whether one column is in a unit of time and one in a unit of force, whatever they are called.
fn is_one_time_and_force(columns: &[Column]) -> bool {
    [Quantity::Time, Quantity::Force].iter().all(|quantity| {
        let of_kind = |column: &&Column| column.unit.is_some_and(|unit| unit.quantity == *quantity);
        columns.iter().filter(of_kind).count() == 1
    })
}

/// Whether the columns are results of a test, one row of which may stand above its curve.
fn are_results(columns: &[Column]) -> bool {
    let is_result = |column: &Column| {
        let header = column.header.to_lowercase();
        RESULTS.iter().any(|word| header.contains(word))
    };
    columns.iter().any(is_result)
}

/// The question which columns are meant, where names in units of force and length are not known, and nothing else is.
pub(crate) fn question(lines: &[String]) -> Option<Fault> {
    let has = |columns: &[Column], quantity: Quantity| {
        let found = columns
            .iter()
            .find(|column| column.unit.is_some_and(|unit| unit.quantity == quantity));
        found.map(|column| column.header.clone())
    };
    let (columns, force, length) = lines.iter().find_map(|text| {
        let columns = names(text, Separator::of(text));
        let force = has(&columns, Quantity::Force)?;
        let length = has(&columns, Quantity::Length)?;
        Some((columns, force, length))
    })?;
    let headers: Vec<String> = columns
        .iter()
        .take(MOST_ASKED)
        .map(|column| shown(column.header.as_bytes()))
        .collect();
    let problem = format!(
        "which of its columns {} is the force, and which the depth or travel?",
        headers.join(", ")
    );
    let remedy = format!(
        "name them: force = \"{0}\" and travel = \"{1}\" under [recordings.columns] in study.toml, or --column \"force={0}\" --column \"travel={1}\"",
        plain(&force),
        plain(&length)
    );
    Some(Fault::file(problem, remedy))
}

/// A column's name without its unit, as a user writes it.
fn plain(header: &str) -> String {
    let name = header.split(['(', '[']).next().unwrap_or(header).trim();
    shown(name.as_bytes()).trim_matches('\'').to_string()
}

/// The columns, if every known quantity has a unit of its kind; the sensor's volts next to a depth in nm are kept under a name of their own.
fn sound(mut columns: Vec<Column>, line: usize) -> Result<Vec<Column>, Fault> {
    let known: Vec<String> = columns
        .iter()
        .filter(|column| column.quantity().is_some() && column.is_sound())
        .map(|column| column.base.clone())
        .collect();
    for column in &mut columns {
        // An elongation may be a strain in %: it is kept, and no depth.
        let is_spare = known.contains(&column.base) || column.base == "elongation";
        if !column.is_sound() && is_spare && !column.unit_text.is_empty() {
            column.base = format!("{}_as_{}", column.base, column.unit_text);
        }
    }
    match columns.iter().find_map(|column| column.unit_fault(line)) {
        Some(fault) => Err(fault),
        None => Ok(columns),
    }
}
