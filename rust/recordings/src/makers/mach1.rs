//! Biomomentum Mach-1: blocks of a command and its samples, each with a clock of its own.

use crate::curve::Curve;
use crate::detection::Format;
use crate::fault::Fault;
use crate::recording_file::RecordingFile;
use crate::source::Source;
use crate::tables::columns::{Column, fields, names};
use crate::tables::mapping::Columns;
use crate::tables::run::{Run, divided};
use crate::text::fields::{DAMAGED, MOST_VALUES, Separator};
use crate::text::lines::{Line, Lines};

/// Reads every block as a run; `named` are the columns that a user named.
pub(crate) fn read(lines: &mut Lines, named: &Columns) -> Result<RecordingFile, Fault> {
    let (mut curves, mut held) = (Vec::new(), 0);
    let mut command = String::new();
    while let Some(line) = lines.next_filled(&[])? {
        let text = line.text.trim();
        let Some(tag) = text
            .strip_prefix('<')
            .and_then(|text| text.strip_suffix('>'))
        else {
            continue;
        };
        if ![
            "DATA",
            "INFO",
            "END INFO",
            "END DATA",
            "divider",
            "Mach-1 File",
        ]
        .contains(&tag)
        {
            command = tag.to_string();
        } else if tag == "DATA" {
            let (mut run, is_closed) = read_block(lines, named, &mut held)?;
            if run.samples() == 0 {
                continue;
            }
            run.name = format!("{} {command}", curves.len() + 1).trim().to_string();
            let mut curve = run.finish(Curve::of(Source::of("Biomomentum", "Mach-1")));
            curve.unknown.push(
                "the time between the blocks of the file: each counts from its own start".into(),
            );
            if !is_closed {
                curve.warnings.push(format!(
                    "the file ends at line {} without <END DATA>: more samples may have followed, and a row without line end is left out",
                    lines.number()
                ));
            }
            curves.push(curve);
        }
    }
    if curves.is_empty() {
        return Err(lines.ended("a block <DATA> with samples"));
    }
    Ok(RecordingFile::of_curves(Format::Mach1, curves))
}

/// The samples up to `<END DATA>`, and whether it was there: files of tests that were stopped lack it.
fn read_block(lines: &mut Lines, named: &Columns, held: &mut usize) -> Result<(Run, bool), Fault> {
    let Some(line) = lines.next_filled(&[])? else {
        return Err(lines.ended("the line of column names"));
    };
    let mut columns = names(line.text, Separator::Tab);
    // The vertical force of a multi-axis cell is the one that presses.
    for column in &mut columns {
        if column.base == "fz" {
            column.base = "force".into();
        }
    }
    if !named.apply(&mut columns) {
        let problem = format!("the block's columns are not {}", named.headers());
        return Err(line.fault(problem, "name them as the file does"));
    }
    if let Some(fault) = columns
        .iter()
        .find_map(|column: &Column| column.unit_fault(line.number))
    {
        return Err(fault);
    }
    let width = columns.len();
    let mut runs = divided(columns, &[]);
    let (Some(mut run), true) = (runs.pop(), runs.is_empty()) else {
        return Err(line.fault(
            "two columns of the block hold the same".into(),
            "name the one that is meant",
        ));
    };
    loop {
        let Some(line) = lines.next_filled(&[])? else {
            return Ok((run, false));
        };
        if line.text.trim() == "<END DATA>" {
            return Ok((run, true));
        }
        take(&mut run, &line, width)?;
        *held += width;
        if *held > MOST_VALUES {
            return Err(line.fault(
                "the recording is too long".into(),
                "export a shorter part of it",
            ));
        }
        if !lines.has_end() {
            // Its last number may lack digits.
            run.drop_last();
        }
    }
}

fn take(run: &mut Run, line: &Line, width: usize) -> Result<(), Fault> {
    let row = fields(line, Separator::Tab);
    if row.len() < width {
        let problem = format!("the row holds {} values, expected {width}", row.len());
        return Err(line.fault(problem, DAMAGED));
    }
    run.take(line, &row)
}
