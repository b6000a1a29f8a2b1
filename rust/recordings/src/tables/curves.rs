//! Table of an indentation: column names with units, one row per sample, free lines before.

use super::columns::{Column, fields, is_curve, names};
use crate::clock::Clock;
use crate::curve::{Channel, Curve, Segment};
use crate::fault::Fault;
use crate::fields::{DAMAGED, MOST_VALUES, Separator, value};
use crate::lines::{Line, Lines};
use crate::recording::RecordingFile;
use crate::units::unit;

/// Columns that must not have an empty cell.
const NEEDED: &[&str] = &["time", "depth", "travel", "force"];

/// A table while it is read.
struct Table {
    columns: Vec<Column>,
    separator: Separator,
    values: Vec<Vec<f64>>,
    /// The column `segment`, which divides the run.
    segment: Option<usize>,
    segments: Vec<Segment>,
    clock: Clock,
}

pub(crate) fn read(lines: &mut Lines) -> Result<RecordingFile, Fault> {
    let mut curve = Curve::default();
    let mut table = read_head(lines, &mut curve)?;
    while let Some(line) = lines.next_filled(&[',', ';'])? {
        if !line.text.trim_start().starts_with('#') {
            table.take(&line)?;
        }
    }
    let samples = table.values.iter().map(Vec::len).max().unwrap_or(0);
    if samples == 0 {
        return Err(lines.ended("the first row of values"));
    }
    table.finish(&mut curve, samples);
    Ok(RecordingFile::of_curves(
        crate::Format::CurveTable,
        vec![curve],
    ))
}

/// Reads facts of free lines up to the line of column names.
fn read_head(lines: &mut Lines, curve: &mut Curve) -> Result<Table, Fault> {
    loop {
        let Some(line) = lines.next_filled(&[',', ';'])? else {
            return Err(lines.ended("the line of column names"));
        };
        let separator = Separator::of(line.text);
        let columns = names(line.text, separator);
        if !is_curve(&columns) {
            take_fact(line.text, curve);
            continue;
        }
        if let Some(fault) = columns
            .iter()
            .find_map(|column| column.unit_fault(line.number))
        {
            return Err(fault);
        }
        for (k, column) in columns.iter().enumerate() {
            if columns[..k]
                .iter()
                .any(|other| other.base == column.base && column.quantity().is_some())
            {
                return Err(line.fault(
                    format!("two columns hold {}", column.base),
                    "leave one of them out",
                ));
            }
        }
        return Ok(Table {
            values: vec![Vec::new(); columns.len()],
            segment: columns.iter().position(|column| column.base == "segment"),
            columns,
            separator,
            segments: Vec::new(),
            clock: Clock::default(),
        });
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

impl Table {
    fn take(&mut self, line: &Line) -> Result<(), Fault> {
        let fields = fields(line, self.separator);
        let padding = fields
            .iter()
            .skip(self.columns.len())
            .all(|field| field.is_empty());
        if fields.len() < self.columns.len() || !padding {
            let problem = format!(
                "the row holds {} values, expected {}",
                fields.len(),
                self.columns.len()
            );
            return Err(line.fault(problem, DAMAGED));
        }
        if let Some(k) = self.segment {
            self.divide(&fields[k]);
        }
        for (k, (column, field)) in self.columns.iter().zip(&fields).enumerate() {
            if Some(k) == self.segment {
                continue;
            }
            let number = if field.is_empty() && !NEEDED.contains(&column.base.as_str()) {
                f64::NAN
            } else {
                let problem = |problem| line.fault(format!("{}: {problem}", column.base), REMEDY);
                value(field).map_err(problem)?
            };
            if column.base == "time" && self.segment.is_none() {
                self.clock.push(line.number, number)?;
            }
            self.values[k].push(number);
        }
        let samples = self.values.iter().map(Vec::len).max().unwrap_or(0);
        if samples.saturating_mul(self.columns.len()) > MOST_VALUES {
            return Err(line.fault(
                "the recording holds too many values".into(),
                "export a shorter part of it",
            ));
        }
        Ok(())
    }

    fn divide(&mut self, name: &str) {
        let at = self
            .values
            .iter()
            .enumerate()
            .find(|(k, _)| Some(*k) != self.segment);
        let at = at.map_or(0, |(_, values)| values.len());
        match self.segments.last_mut() {
            Some(last) if last.name == name => last.end = at + 1,
            _ => self.segments.push(Segment {
                name: name.to_string(),
                start: at,
                end: at + 1,
            }),
        }
    }

    fn finish(self, curve: &mut Curve, samples: usize) {
        for (column, values) in self.columns.iter().zip(self.values) {
            if values.len() != samples {
                continue;
            }
            curve.channels.push(match column.unit {
                Some(unit) => Channel::converted(&column.base, unit, values),
                None => Channel {
                    name: column.base.clone(),
                    unit: column.unit_text.clone(),
                    values,
                },
            });
        }
        curve.segments = self.segments;
        let has = |name: &str| curve.channel(name).is_some();
        let unknown = [
            (
                has("time_s"),
                "the time of the samples: rates and relaxation",
            ),
            (has("force_n"), "the force"),
            (
                has("depth_mm"),
                "where contact begins: no column holds a depth from first touch",
            ),
        ];
        let missing = unknown.iter().filter(|(is_known, _)| !is_known);
        let missing: Vec<String> = missing.map(|(_, what)| what.to_string()).collect();
        curve.unknown.extend(missing);
    }
}

const REMEDY: &str = "give every sample a finite number, or leave the sample out";
