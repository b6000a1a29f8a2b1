//! Novel pliance: one line per time step, then the maker's own forces and the geometry of the mat.

use super::limits::count;
use crate::check::Check;
use crate::fault::{Fault, shown};
use crate::pressure_map::{PressureMap, PressureUnit, Sensel};
use crate::source::Source;
use crate::text::clock::Clock;
use crate::text::fields::{DAMAGED, ODD, Row, Separator, value};
use crate::text::lines::{Line, Lines};

/// Rounding of the forces and pressures of an export, N.
const FORCE_TOLERANCE: f64 = 0.01;
/// Times are printed with five digits after the point.
const TIME_TOLERANCE: f64 = 2e-5;

pub(super) fn read(lines: &mut Lines) -> Result<Vec<PressureMap>, Fault> {
    let (product, numbers) = read_header(lines)?;
    let numbered = |&number| Sensel {
        number: Some(number),
        ..Sensel::default()
    };
    let source = Source {
        maker: "Novel",
        product: "pliance".into(),
        sensor: product,
    };
    let sensels: Vec<Sensel> = numbers.iter().map(numbered).collect();
    let mut map = PressureMap::new(source, PressureUnit::Kilopascal, sensels);
    read_frames(lines, &mut map)?;
    let forces = read_forces(lines)?;
    if forces.is_empty() && lines.next_filled(&[])?.is_none() {
        map.unknown
            .push("force and place: the file ends before its table of sensors".into());
        return Ok(vec![map]);
    }
    if forces.is_empty() {
        lines.hold();
    }
    read_geometry(lines, &mut map)?;
    compare(&mut map, &forces);
    map.unknown
        .push("threshold and limit of the sensors".into());
    Ok(vec![map])
}

/// Mat type and the numbers of the exported sensors.
fn read_header(lines: &mut Lines) -> Result<(String, Vec<u32>), Fault> {
    let mut product = String::new();
    loop {
        let Some(line) = lines.next()? else {
            return Err(lines.ended("the line 'time[secs]'"));
        };
        let text = line.text.trim();
        if let Some(rest) = text.strip_prefix("mat type") {
            product = rest.trim().to_string();
        } else if text.starts_with("pressure values") && !text.ends_with("kPa") {
            let problem = format!("{} are not in kPa", shown(text.as_bytes()));
            return Err(line.fault(problem, "export the pressures in kPa"));
        } else if let Some(columns) = text.strip_prefix("time[secs]") {
            return sensor_numbers(columns, &line).map(|numbers| (product, numbers));
        }
    }
}

fn sensor_numbers(columns: &str, line: &Line) -> Result<Vec<u32>, Fault> {
    let numbers: Result<Vec<u32>, String> = columns
        .split_whitespace()
        .map(|word| count(word, "sensors").map(|number| number as u32))
        .collect();
    let numbers = numbers.map_err(|problem| line.fault(problem, ODD))?;
    if numbers.is_empty() {
        return Err(line.fault("no sensor is named".into(), DAMAGED));
    }
    Ok(numbers)
}

/// Rows of time and pressures; the summaries `MPP` and `MVP` are not frames.
fn read_frames(lines: &mut Lines, map: &mut PressureMap) -> Result<(), Fault> {
    let shape = Row {
        separator: Separator::Blank,
        columns: map.sensels.len() + 1,
        missing: None,
    };
    let (mut clock, mut row) = (Clock::default(), Vec::new());
    while let Some(line) = lines.next_filled(&[])? {
        let text = line.text.trim_start();
        if text.starts_with("MPP") || text.starts_with("MVP") {
            continue;
        }
        if text.starts_with(|c: char| c.is_alphabetic()) {
            lines.hold();
            break;
        }
        row.clear();
        shape.read(line, &mut row)?;
        clock.push(line.number, row[0])?;
        map.values.extend_from_slice(&row[1..]);
        if map.values.len() > crate::text::fields::MOST_VALUES {
            let problem = "the recording holds too many values".into();
            return Err(Fault::line(
                lines.number(),
                problem,
                "export a shorter part of it",
            ));
        }
    }
    if clock.last().is_none() {
        return Err(lines.ended("the first row of pressures"));
    }
    map.time_s = Some(clock.times());
    Ok(())
}

/// Time, s, and force, N, of the whole recording.
fn read_forces(lines: &mut Lines) -> Result<Vec<[f64; 2]>, Fault> {
    let mut forces = Vec::new();
    let Some(line) = lines.next_filled(&[])? else {
        return Ok(forces);
    };
    if !line.text.contains("force[N]") {
        lines.hold();
        return Ok(forces);
    }
    while let Some(line) = lines.next_filled(&[])? {
        if line.text.trim_start().starts_with("sensor") {
            lines.hold();
            break;
        }
        let mut words = line.text.split_whitespace();
        let mut next = || value(words.next().unwrap_or(""));
        let pair = next().and_then(|time| Ok([time, next()?]));
        forces.push(pair.map_err(|problem| line.fault(problem, ODD))?);
        if forces.len() > crate::text::fields::MOST_VALUES / 2 {
            return Err(line.fault(
                "the table of forces is too long".into(),
                "export a shorter part",
            ));
        }
    }
    Ok(forces)
}

/// Centers and areas by sensor number; every exported sensor needs both.
fn read_geometry(lines: &mut Lines, map: &mut PressureMap) -> Result<(), Fault> {
    let Some(line) = lines.next_filled(&[])? else {
        return Err(lines.ended("the table of sensors"));
    };
    let Some(columns) = line.text.trim_start().strip_prefix("sensor") else {
        let problem = format!(
            "{} stands where the table of sensors should",
            shown(line.text.trim().as_bytes())
        );
        return Err(line.fault(problem, DAMAGED));
    };
    let numbers = sensor_numbers(columns, &line)?;
    let mut rows: [Option<Vec<f64>>; 3] = [None, None, None];
    let (shape, mut row) = (
        Row {
            separator: Separator::Blank,
            columns: numbers.len(),
            missing: None,
        },
        Vec::new(),
    );
    while let Some(line) = lines.next_filled(&[])? {
        let text = line.text.trim_start();
        let Some(which) = ["x[c]", "y[c]", "area"]
            .iter()
            .position(|name| text.starts_with(name))
        else {
            continue;
        };
        row.clear();
        shape.read(
            Line {
                number: line.number,
                text: &text[4..],
            },
            &mut row,
        )?;
        rows[which] = Some(row.clone());
    }
    let [Some(x), Some(y), Some(area)] = rows else {
        return Err(lines.ended("the rows x[c], y[c] and area of the sensors"));
    };
    for sensel in &mut map.sensels {
        let Some(k) = numbers
            .iter()
            .position(|number| Some(*number) == sensel.number)
        else {
            let problem = format!(
                "sensor {} is not in the table of sensors",
                sensel.number.unwrap_or(0)
            );
            return Err(Fault::line(lines.number(), problem, DAMAGED));
        };
        // Centimeters.
        sensel.center_mm = Some([10.0 * x[k], 10.0 * y[k]]);
        sensel.area_mm2 = Some(100.0 * area[k]);
    }
    Ok(())
}

/// Our force of each frame against the maker's at the same time.
fn compare(map: &mut PressureMap, forces: &[[f64; 2]]) {
    let mut check = Check::new("total force", "N", FORCE_TOLERANCE);
    let times = map.time_s.clone().unwrap_or_default();
    let mut at = 0;
    for (frame, time) in times.iter().enumerate() {
        while forces
            .get(at)
            .is_some_and(|[stated, _]| *stated < time - TIME_TOLERANCE)
        {
            at += 1;
        }
        let stated = forces
            .get(at)
            .filter(|[stated, _]| (stated - time).abs() <= TIME_TOLERANCE);
        if let (Some([_, stated]), Some(ours)) = (stated, map.force_n(frame)) {
            check.compare(frame, *stated, ours);
        }
    }
    if check.compared > 0 {
        map.push_check(check);
    }
}
