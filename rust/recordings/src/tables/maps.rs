//! Table of pressures: `time_s,row,col,pressure_kpa`, one cell per line; an empty pressure is a missing cell.

use super::columns::{Column, fields, names};
use crate::curve::Channel;
use crate::fault::{Fault, shown};
use crate::pressure_map::{PressureMap, PressureUnit, Sensel};
use crate::recording_file::RecordingFile;
use crate::source::Source;
use crate::text::clock::Clock;
use crate::text::fields::{MOST_VALUES, Separator, value};
use crate::text::lines::{Line, Lines};
use std::collections::HashMap;

/// Most cells that are listed, 16 bytes each while they are read.
const MOST_CELLS: usize = 1 << 25;
/// Rows and columns are numbered below this.
const HIGHEST_PLACE: f64 = 1e6;
/// Quantities of a frame.
const PER_FRAME: &[&str] = &["time", "depth", "slide"];
const REMEDY: &str = "columns are time_s, row, col, pressure_kpa, with depth_mm, slide_mm, phase beside or instead of time_s";

/// Where the columns stand.
struct Layout {
    separator: Separator,
    columns: Vec<Column>,
    row: usize,
    column: usize,
    pressure: usize,
    phase: Option<usize>,
    /// Index and name of the columns that a frame shares.
    frame: Vec<usize>,
}

/// Cells while they are listed.
#[derive(Default)]
struct Cells {
    /// What the cells of one frame share.
    frames: Vec<(Vec<f64>, String)>,
    clock: Clock,
    places: HashMap<[u32; 2], u32>,
    cells: Vec<(u32, u32, f64)>,
    /// Last frame in which a place was listed.
    seen: Vec<u32>,
}

pub(crate) fn read(lines: &mut Lines) -> Result<RecordingFile, Fault> {
    let layout = read_head(lines)?;
    let mut cells = Cells::default();
    while let Some(line) = lines.next_filled(&[',', ';'])? {
        if !line.text.trim_start().starts_with('#') {
            cells.take(&line, &layout)?;
        }
    }
    if cells.cells.is_empty() {
        return Err(lines.ended("the first cell"));
    }
    let map = cells.finish(&layout)?;
    Ok(RecordingFile::of_maps(crate::Format::MapTable, vec![map]))
}

fn read_head(lines: &mut Lines) -> Result<Layout, Fault> {
    loop {
        let Some(line) = lines.next_filled(&[',', ';'])? else {
            return Err(lines.ended("the line of column names"));
        };
        let separator = Separator::of(line.text);
        let columns = names(line.text, separator);
        if !super::columns::is_map(&columns) {
            continue;
        }
        let find = |name: &str| columns.iter().position(|column| column.base == name);
        let pressure = columns
            .iter()
            .position(|column| column.base.starts_with("pressure"));
        let (Some(row), Some(column), Some(pressure)) = (find("row"), find("column"), pressure)
        else {
            return Err(line.fault(
                "a pressure table needs row, col and a pressure".into(),
                REMEDY,
            ));
        };
        let is_raw = |column: &Column| column.base == "pressure" && column.unit_text == "raw";
        let fault = columns
            .iter()
            .filter(|column| !is_raw(column))
            .find_map(|column| column.unit_fault(line.number));
        if let Some(fault) = fault {
            return Err(fault);
        }
        let frame: Vec<usize> = PER_FRAME.iter().filter_map(|name| find(name)).collect();
        let phase = find("phase");
        return Ok(Layout {
            separator,
            row,
            column,
            pressure,
            phase,
            frame,
            columns,
        });
    }
}

impl Cells {
    fn take(&mut self, line: &Line, layout: &Layout) -> Result<(), Fault> {
        let fields = fields(line, layout.separator);
        if fields.len() < layout.columns.len() {
            let problem = format!(
                "the row holds {} values, expected {}",
                fields.len(),
                layout.columns.len()
            );
            return Err(line.fault(problem, REMEDY));
        }
        let fault = |problem: String| line.fault(problem, REMEDY);
        let place = [
            place(&fields[layout.row]).map_err(fault)?,
            place(&fields[layout.column]).map_err(fault)?,
        ];
        let mut shared = Vec::with_capacity(layout.frame.len());
        for &k in &layout.frame {
            let name = &layout.columns[k].base;
            let factor = layout.columns[k].unit.map_or(1.0, |unit| unit.factor);
            shared.push(
                value(&fields[k]).map_err(|problem| fault(format!("{name}: {problem}")))? * factor,
            );
        }
        let phase = layout.phase.map_or("", |k| &fields[k]);
        let frame = self.frame(line, layout, shared, phase)?;
        let next = self.places.len() as u32;
        let sensel = *self.places.entry(place).or_insert(next);
        if sensel == next {
            self.seen.push(u32::MAX);
        }
        if std::mem::replace(&mut self.seen[sensel as usize], frame) == frame {
            let problem = format!(
                "row {}, column {} stands twice in one frame",
                place[0], place[1]
            );
            return Err(line.fault(problem, "leave one of them out, or give frames a time"));
        }
        let cell = match fields[layout.pressure].as_str() {
            "" => f64::NAN,
            text => value(text).map_err(|problem| fault(format!("pressure: {problem}")))?,
        };
        self.cells.push((frame, sensel, cell));
        if self.cells.len() > MOST_CELLS {
            return Err(fault(format!(
                "the recording lists more than {MOST_CELLS} cells"
            )));
        }
        Ok(())
    }

    /// Number of the frame that a line belongs to; lines of one frame follow each other.
    fn frame(
        &mut self,
        line: &Line,
        layout: &Layout,
        shared: Vec<f64>,
        phase: &str,
    ) -> Result<u32, Fault> {
        if let Some((last, last_phase)) = self.frames.last()
            && *last == shared
            && last_phase == phase
        {
            return Ok(self.frames.len() as u32 - 1);
        }
        let has_time = layout
            .frame
            .first()
            .is_some_and(|k| layout.columns[*k].base == "time");
        if has_time {
            self.clock.push(line.number, shared[0])?;
        }
        self.frames.push((shared, phase.to_string()));
        Ok(self.frames.len() as u32 - 1)
    }

    fn finish(self, layout: &Layout) -> Result<PressureMap, Fault> {
        let mut places: Vec<([u32; 2], u32)> = self.places.into_iter().collect();
        places.sort_unstable();
        let mut order = vec![0; places.len()];
        for (at, (_, sensel)) in places.iter().enumerate() {
            order[*sensel as usize] = at;
        }
        let size = self.frames.len().saturating_mul(places.len());
        if size > MOST_VALUES {
            let problem = format!(
                "{} frames of {} sensels are too many",
                self.frames.len(),
                places.len()
            );
            return Err(Fault::file(problem, "export a shorter part of it"));
        }
        let sensels = places
            .iter()
            .map(|(place, _)| Sensel {
                place: Some(*place),
                ..Sensel::default()
            })
            .collect();
        let column = &layout.columns[layout.pressure];
        let unit = match column.unit {
            Some(_) => PressureUnit::Kilopascal,
            None => PressureUnit::RawCounts,
        };
        let factor = column.unit.map_or(1.0, |unit| unit.factor);
        let mut map = PressureMap::new(Source::default(), unit, sensels);
        map.values = vec![f64::NAN; size];
        for (frame, sensel, cell) in self.cells {
            map.values[frame as usize * order.len() + order[sensel as usize]] = cell * factor;
        }
        for (k, &at) in layout.frame.iter().enumerate() {
            let values: Vec<f64> = self.frames.iter().map(|(shared, _)| shared[k]).collect();
            match layout.columns[at].base.as_str() {
                "time" => map.time_s = Some(values),
                name => map.channels.push(Channel {
                    name: format!("{name}_mm"),
                    unit: "mm".into(),
                    values,
                }),
            }
        }
        if layout.phase.is_some() {
            map.phases = self.frames.into_iter().map(|(_, phase)| phase).collect();
        }
        map.unknown
            .push("threshold and limit of the sensors, their pitch and area".into());
        Ok(map)
    }
}

fn place(text: &str) -> Result<u32, String> {
    match value(text) {
        Ok(number) if number.fract() == 0.0 && (0.0..HIGHEST_PLACE).contains(&number) => {
            Ok(number as u32)
        }
        _ => Err(format!(
            "{} is not a row or column number",
            shown(text.as_bytes())
        )),
    }
}
