//! Table of indentations: column names with units, one row per sample, free lines before.

use super::columns::{Column, fields};
use super::head::{Found, Head, Search, is_units};
use super::mapping::Columns;
use super::run::{Run, divided};
use crate::curve::Curve;
use crate::fault::{Fault, shown};
use crate::text::fields::{DAMAGED, MOST_VALUES, value};
use crate::text::lines::{Line, Lines};
use crate::text::units::unit;

/// The line that ends a Tekscan export.
const END: &str = "@@";

/// How strict a table is taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Rows {
    /// Every row must be whole, as in a file that a program wrote.
    Whole,
    /// A row with a bad cell is left out with a note, as in a sheet that people edit.
    LeftOut,
}

pub(crate) fn read(lines: &mut Lines, named: &Columns, rows: Rows) -> Result<Vec<Curve>, Fault> {
    let mut about = Curve::default();
    let head = read_head(lines, named, &mut about)?;
    about.warnings.extend(head.notes.iter().cloned());
    let mut table = Table::new(head, lines.number(), rows)?;
    while let Some(line) = lines.next_filled(&[',', ';'])? {
        if line.text.trim() == END {
            break;
        }
        if !line.text.trim_start().starts_with('#') {
            table.take(&line)?;
        }
    }
    if table.runs.iter().all(|run| run.samples() == 0) {
        return Err(table.left_out.map_or_else(
            || lines.ended("the first row of values"),
            |first| first.fault,
        ));
    }
    table.finish(&about)
}

/// Reads facts of free lines up to the line of column names.
fn read_head(lines: &mut Lines, named: &Columns, about: &mut Curve) -> Result<Head, Fault> {
    let mut search = Search::new(named);
    loop {
        let Some(line) = lines.next_filled(&[',', ';'])? else {
            if let Some(fault) = search.ended() {
                return Err(fault);
            }
            if named.is_empty() {
                return Err(lines.ended("the line of column names"));
            }
            let problem = format!("no line of names holds {}", named.headers());
            return Err(Fault::file(
                problem,
                "name the columns as the file does, without a unit or with it",
            ));
        };
        match search.take(&line) {
            Found::Head(head) => return Ok(head),
            Found::Fault(fault) => return Err(fault),
            Found::Nothing | Found::Map => take_fact(line.text, about),
        }
    }
}

/// `# tip_radius_m=27.5e-6 (sphere)`, `Cylinder Diameter: 50mm;`: a number with its unit, kept under a name; all else is not kept.
fn take_fact(text: &str, curve: &mut Curve) {
    let text = text
        .trim_start_matches(['#', ' '])
        .trim_end_matches([';', ',', ' ']);
    let Some((name, rest)) = text.split_once('=').or_else(|| text.split_once(':')) else {
        return;
    };
    if text.contains("INSTRON") && name.trim().eq_ignore_ascii_case("machine") {
        curve.source.maker = "Instron";
        curve.source.product = rest.trim().to_string();
        return;
    }
    let word = rest.split_whitespace().next().unwrap_or("");
    let digits = word
        .find(|c: char| c.is_alphabetic() && c != 'e' && c != 'E')
        .unwrap_or(word.len());
    let Ok(number) = value(&word[..digits]) else {
        return;
    };
    let mut column = Column::of(name);
    if digits < word.len() {
        column = Column::new(name, &word[digits..]);
    }
    if let Some(unit) = unit(&column.unit_text) {
        curve.push_fact(
            format!("{}_{}", column.base, unit.quantity.suffix()),
            number * unit.factor,
        );
    }
}

/// Rows that were left out.
struct LeftOut {
    fault: Fault,
    line: usize,
    count: usize,
}

/// A table while it is read.
struct Table {
    runs: Vec<Run>,
    separator: crate::text::fields::Separator,
    columns: usize,
    rows: Rows,
    is_first: bool,
    left_out: Option<LeftOut>,
}

impl Table {
    fn new(head: Head, line: usize, rows: Rows) -> Result<Table, Fault> {
        let columns = head.columns.len();
        let runs = divided(head.columns, &head.above);
        if let Some(part) = runs.iter().find(|run| runs.len() > 1 && !run.is_whole()) {
            let what = part.first().to_string();
            let remedy = format!(
                "leave one of them out, or name the one: {what} = \"NAME\" in study.toml, or --column {what}=NAME"
            );
            return Err(Fault::line(
                line,
                format!("two columns hold {what}"),
                remedy,
            ));
        }
        Ok(Table {
            runs,
            separator: head.separator,
            columns,
            rows,
            is_first: true,
            left_out: None,
        })
    }

    fn take(&mut self, line: &Line) -> Result<(), Fault> {
        let row = fields(line, self.separator);
        if std::mem::take(&mut self.is_first) && is_units(&row) {
            return Ok(());
        }
        let padding = row.iter().skip(self.columns).all(|field| field.is_empty());
        let is_strict = self.rows == Rows::Whole;
        let is_short = row.len() < self.columns && self.runs.len() == 1;
        if is_strict && row.len() == 1 && row.len() < self.columns && value(&row[0]).is_err() {
            let problem = format!("the line {} is no sample", shown(row[0].as_bytes()));
            return Err(line.fault(problem, "take the line out of the file"));
        }
        if is_strict && (is_short || !padding) {
            let problem = format!(
                "the row holds {} values, expected {}",
                row.len(),
                self.columns
            );
            return Err(line.fault(problem, DAMAGED));
        }
        let is_only = self.runs.len() == 1 && is_strict;
        for run in &mut self.runs {
            if run.is_past(&row) && !is_only {
                continue;
            }
            match run.take(line, &row) {
                Ok(()) => {}
                Err(fault) if is_strict => return Err(fault),
                Err(fault) => match &mut self.left_out {
                    Some(left_out) => left_out.count += 1,
                    None => {
                        self.left_out = Some(LeftOut {
                            fault,
                            line: line.number,
                            count: 1,
                        });
                    }
                },
            }
        }
        let held: usize = self
            .runs
            .iter()
            .map(|run| run.samples().saturating_mul(run.width()))
            .sum();
        if held > MOST_VALUES {
            return Err(line.fault(
                "the recording holds too many values".into(),
                "export a shorter part of it",
            ));
        }
        Ok(())
    }

    fn finish(self, about: &Curve) -> Result<Vec<Curve>, Fault> {
        let samples: usize = self.runs.iter().map(Run::samples).sum();
        let mut about = about.clone();
        if let Some(left_out) = self.left_out {
            // More bad rows than good ones: this is no curve.
            if left_out.count > samples {
                return Err(left_out.fault);
            }
            about.warnings.push(format!(
                "{} row{} left out, the first is row {}: {}",
                left_out.count,
                if left_out.count == 1 { " is" } else { "s are" },
                left_out.line,
                left_out.fault.problem()
            ));
        }
        let with_samples = self.runs.into_iter().filter(|run| run.samples() > 0);
        Ok(with_samples.map(|run| run.finish(about.clone())).collect())
    }
}
