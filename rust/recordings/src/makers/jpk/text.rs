//! JPK force curve exported as text: `# key: value` lines before each segment, then its samples.

use super::curve::with_travel;
use crate::curve::{Channel, Curve, Segment};
use crate::fault::{Fault, shown};
use crate::source::Source;
use crate::text::fields::{DAMAGED, MOST_VALUES, ODD, Row, Separator, value};
use crate::text::lines::{Line, Lines};
use crate::text::units::{Unit, unit};

/// Most columns of a segment.
const MOST_COLUMNS: usize = 64;

/// What stands before the samples of a segment.
#[derive(Debug, Default, Clone)]
struct Head {
    name: String,
    columns: Vec<String>,
    units: Vec<String>,
    stated: Option<usize>,
}

/// A segment: its head, its line, and its columns of samples.
struct Block {
    head: Head,
    line: usize,
    values: Vec<Vec<f64>>,
}

pub(crate) fn read(lines: &mut Lines) -> Result<Vec<Curve>, Fault> {
    let mut curve = Curve::of(Source::of("JPK", "force curve, exported as text"));
    let (mut head, mut blocks, mut held) = (Head::default(), Vec::<Block>::new(), 0);
    let (mut row, mut is_open) = (Vec::new(), false);
    while let Some(line) = lines.next_filled(&[])? {
        if let Some(comment) = line.text.trim().strip_prefix('#') {
            is_open = false;
            let fault = |problem: String| line.fault(problem, ODD);
            head.take(comment.trim(), &mut curve).map_err(fault)?;
            continue;
        }
        if !is_open {
            blocks.push(Block::open(&head, &line)?);
            (head.stated, is_open) = (None, true);
        }
        let Some(block) = blocks.last_mut() else {
            continue;
        };
        let shape = Row {
            separator: Separator::Blank,
            columns: block.values.len(),
            missing: None,
        };
        row.clear();
        shape.read(line, &mut row)?;
        block
            .values
            .iter_mut()
            .zip(&row)
            .for_each(|(column, cell)| column.push(*cell));
        held += row.len();
        if held > MOST_VALUES {
            return Err(Fault::line(
                lines.number(),
                "the recording is too long".into(),
                "export a shorter part of it",
            ));
        }
    }
    if blocks.is_empty() {
        return Err(lines.ended("the first sample"));
    }
    for block in &blocks {
        let found = block.values[0].len();
        if let Some(stated) = block.head.stated.filter(|stated| *stated != found) {
            let problem = format!(
                "segment {} states {stated} samples and holds {found}",
                shown(block.head.name.as_bytes())
            );
            return Err(Fault::line(
                block.line,
                problem,
                "the file is cut short; export it again",
            ));
        }
    }
    join(&blocks, &mut curve);
    with_travel(&mut curve);
    Ok(vec![curve])
}

impl Head {
    fn take(&mut self, comment: &str, curve: &mut Curve) -> Result<(), String> {
        let Some((key, rest)) = comment.split_once(':') else {
            return Ok(());
        };
        let words = || {
            rest.split_whitespace()
                .take(MOST_COLUMNS)
                .map(String::from)
                .collect()
        };
        match key.trim() {
            "segment" => self.name = rest.trim().to_string(),
            "columns" => self.columns = words(),
            "units" => self.units = words(),
            "recorded-num-points" => self.stated = rest.trim().parse().ok(),
            "springConstant" if curve.fact("spring_constant_n_per_mm").is_none() => {
                curve.push_fact("spring_constant_n_per_mm", value(rest.trim())? * 1e-3);
            }
            _ => {}
        }
        Ok(())
    }
}

impl Block {
    fn open(head: &Head, line: &Line) -> Result<Block, Fault> {
        if head.columns.is_empty() || head.columns.len() != head.units.len() {
            let counts = (head.columns.len(), head.units.len());
            let problem = format!(
                "samples follow {} column names and {} units",
                counts.0, counts.1
            );
            return Err(line.fault(problem, DAMAGED));
        }
        Ok(Block {
            head: head.clone(),
            line: line.number,
            values: vec![Vec::new(); head.columns.len()],
        })
    }

    fn column(&self, name: &str) -> Option<(Option<Unit>, &[f64])> {
        let k = self.head.columns.iter().position(|column| column == name)?;
        Some((unit(&self.head.units[k]), &self.values[k]))
    }
}

/// Joins the columns that all segments have, with one unit.
fn join(blocks: &[Block], curve: &mut Curve) {
    let mut start = 0;
    for block in blocks {
        let end = start + block.values[0].len();
        curve.segments.push(Segment {
            name: block.head.name.clone(),
            start,
            end,
        });
        start = end;
    }
    for name in &blocks[0].head.columns {
        let parts: Option<Vec<(Unit, &[f64])>> = blocks
            .iter()
            .map(|block| {
                block
                    .column(name)
                    .and_then(|(unit, values)| Some((unit?, values)))
            })
            .collect();
        let Some(parts) = parts.filter(|parts| parts.iter().all(|(unit, _)| *unit == parts[0].0))
        else {
            continue;
        };
        let base = base(name, parts[0].0);
        let values = parts
            .iter()
            .flat_map(|(_, values)| values.iter().copied())
            .collect();
        if curve
            .channels
            .iter()
            .all(|channel| !channel.name.starts_with(&base))
        {
            curve
                .channels
                .push(Channel::converted(&base, parts[0].0, values));
        }
    }
}

/// Name here of a JPK column. `time` starts again with each segment, `seriesTime` does not.
fn base(name: &str, unit: Unit) -> String {
    use crate::text::units::Quantity::{Force, Time};
    match (name, unit.quantity) {
        ("vDeflection", Force) => "force".into(),
        ("seriesTime", Time) => "time".into(),
        ("time", Time) => "segment_time".into(),
        ("height", _) => "piezo_height".into(),
        (
            "measuredHeight"
            | "capacitiveSensorHeight"
            | "strainGaugeHeight"
            | "smoothedMeasuredHeight"
            | "smoothedCapacitiveSensorHeight"
            | "smoothedStrainGaugeHeight",
            _,
        ) => "measured_height".into(),
        ("verticalTipPosition", _) => "tip_height".into(),
        _ => name.to_string(),
    }
}
