//! RSscan footscan, dynamic roll-off: frames of the rectangle that a foot covered. The patient's name is never kept.

use super::limits::count;
use crate::fault::{Fault, shown};
use crate::pressure_map::{PressureMap, PressureUnit, grid_sensels};
use crate::source::Source;
use crate::text::clock::Clock;
use crate::text::fields::{ODD, Row, Separator, value};
use crate::text::lines::Lines;

/// A rectangle of the plate as the file places it.
#[derive(Debug, Default, Clone, Copy)]
struct Rectangle {
    bottom: Option<usize>,
    left: Option<usize>,
    width: Option<usize>,
    height: Option<usize>,
}

/// One foot while it is read.
struct Foot {
    map: PressureMap,
    clock: Clock,
    rows: usize,
    columns: usize,
}

pub(super) fn read(lines: &mut Lines) -> Result<Vec<PressureMap>, Fault> {
    let (mut name, mut rectangle) = (String::new(), Rectangle::default());
    let (mut feet, mut open) = (Vec::new(), None::<Foot>);
    while let Some(line) = lines.next_filled(&[])? {
        let text = line.text.trim();
        let fault = |problem: String| line.fault(problem, ODD);
        if let Some(foot) = text.strip_suffix(" foot data") {
            name = format!("{} foot", foot.to_lowercase());
            rectangle = Rectangle::default();
            feet.extend(open.take().map(Foot::finish));
        } else if let Some(rest) = text.strip_prefix("Rectangle") {
            let mut words = rest
                .split([' ', '\t', ':', ','])
                .filter(|word| !word.is_empty());
            let (side, number) = (words.next().unwrap_or("").to_string(), words.next());
            match number {
                Some(number) => rectangle.take(&side, number).map_err(fault)?,
                // The number stands in the line below.
                None => below(lines, &side, &mut rectangle)?,
            }
        } else if text.starts_with("Frame ") {
            let (frame, time) = frame_line(text).map_err(fault)?;
            let number = line.number;
            let mut foot = match open.take() {
                Some(foot) => foot,
                None => Foot::new(&name, rectangle).map_err(fault)?,
            };
            foot.clock.push(number, time)?;
            foot.read_frame(lines, frame)?;
            open = Some(foot);
        }
    }
    feet.extend(open.map(Foot::finish));
    if feet.is_empty() {
        return Err(lines.ended("a frame"));
    }
    Ok(feet)
}

/// `Frame 1 (2.00 ms)`: number, and time in s.
fn frame_line(text: &str) -> Result<(usize, f64), String> {
    let problem = || {
        format!(
            "{} is not a frame and its time in ms",
            shown(text.as_bytes())
        )
    };
    let (number, rest) = text["Frame ".len()..].split_once('(').ok_or_else(problem)?;
    let time = rest
        .trim_end()
        .strip_suffix(')')
        .and_then(|rest| rest.trim_end().strip_suffix("ms"));
    let number = number.trim().parse().map_err(|_| problem())?;
    Ok((number, value(time.ok_or_else(problem)?.trim())? * 1e-3))
}

/// Takes the number of a side from the next line.
fn below(lines: &mut Lines, side: &str, rectangle: &mut Rectangle) -> Result<(), Fault> {
    let Some(line) = lines.next_filled(&[])? else {
        return Err(lines.ended(&format!("the rectangle's {side}")));
    };
    let number = line.text.trim();
    rectangle
        .take(side, number)
        .map_err(|problem| line.fault(problem, ODD))
}

impl Rectangle {
    fn take(&mut self, side: &str, number: &str) -> Result<(), String> {
        let place = || number.parse().ok().filter(|at| *at < super::limits::WIDEST);
        let problem = || format!("{} is no place on the plate", shown(number.as_bytes()));
        match side {
            "bottom" => self.bottom = Some(place().ok_or_else(problem)?),
            "left" => self.left = Some(place().ok_or_else(problem)?),
            "width" => self.width = Some(count(number, "columns")?),
            "height" => self.height = Some(count(number, "rows")?),
            _ => {}
        }
        Ok(())
    }
}

impl Foot {
    fn new(name: &str, rectangle: Rectangle) -> Result<Foot, String> {
        let (Some(columns), Some(rows)) = (rectangle.width, rectangle.height) else {
            return Err("a frame stands before the width and height of its rectangle".into());
        };
        super::limits::check_cells(rows, columns)?;
        let first = [
            rectangle.bottom.unwrap_or(0) as u32,
            rectangle.left.unwrap_or(0) as u32,
        ];
        let source = Source::of("RSscan", "footscan");
        let mut map = PressureMap::new(
            source,
            PressureUnit::NotStated,
            grid_sensels(first, [rows, columns], None),
        );
        map.name = name.to_string();
        map.unknown
            .push("pressure and force: the file states no unit of its values".into());
        map.unknown.push("pitch and area of the sensors".into());
        map.unknown.push(
            "whether the first row printed is the bottom of the rectangle; it is numbered so"
                .into(),
        );
        Ok(Foot {
            map,
            clock: Clock::default(),
            rows,
            columns,
        })
    }

    fn read_frame(&mut self, lines: &mut Lines, frame: usize) -> Result<(), Fault> {
        for row in 0..self.rows {
            let Some(line) = lines.next_filled(&[])? else {
                return Err(lines.ended(&format!("row {} of frame {frame}", row + 1)));
            };
            let separator = if line.text.contains('\t') {
                Separator::Tab
            } else {
                Separator::Blank
            };
            let shape = Row {
                separator,
                columns: self.columns,
                missing: None,
            };
            shape.read(line, &mut self.map.values)?;
        }
        Ok(())
    }

    fn finish(self) -> PressureMap {
        PressureMap {
            time_s: Some(self.clock.times()),
            ..self.map
        }
    }
}
