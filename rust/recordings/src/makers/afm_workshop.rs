//! AFM Workshop force-distance curves: header of keys, then the way in and the way out next to each other, without times.

use crate::curve::{Channel, Curve, Segment};
use crate::fault::Fault;
use crate::source::Source;
use crate::tables::columns::{Column, fields, names};
use crate::text::fields::{DAMAGED, MOST_VALUES, ODD, Separator, value};
use crate::text::lines::Lines;
use crate::text::units::{Quantity, Unit};

/// What the first line of every file is.
pub(crate) const FIRST: &str = "Force-Distance Curve";
/// What stands before the names of the columns, and the segment's name here.
const WAYS: [&str; 2] = ["extend", "retract"];
/// Key of the header, name here, factor to the library's unit.
const FACTS: &[(&str, &str, f64)] = &[
    ("Force Constant, nN/nm", "spring_constant_n_per_mm", 1e-3),
    ("Z Rate, nm/s", "piezo_speed_mm_per_s", 1e-6),
    ("Light Lever Gain, mV/nm", "light_lever_gain_v_per_mm", 1e3),
];

/// One way: where its height and its deflection stand in a row, and their values.
struct Way {
    name: &'static str,
    at: [usize; 2],
    values: [Vec<f64>; 2],
}

pub(super) fn read(lines: &mut Lines) -> Result<Vec<Curve>, Fault> {
    let mut curve = Curve::of(Source::of("AFM Workshop", ""));
    let columns = read_header(lines, &mut curve)?;
    let number = lines.number();
    let mut ways: Vec<Way> = WAYS.iter().filter_map(|name| way(name, &columns)).collect();
    let Some(first) = ways.first() else {
        let problem =
            "no two columns 'Extend Z-Sense(nm)' and 'Extend Force(nN)' or 'Extend T-B(V)'"
                .to_string();
        return Err(Fault::line(number, problem, ODD));
    };
    let height = column_unit(&columns[first.at[0]], Quantity::Length, number)?;
    let load = columns[first.at[1]].clone();
    while let Some(line) = lines.next_filled(&[','])? {
        let row = fields(&line, Separator::Comma);
        for way in &mut ways {
            let cells = way.at.map(|at| row.get(at).map_or("", String::as_str));
            if cells.iter().all(|cell| cell.is_empty()) {
                continue; // the other way has more samples
            }
            for (cell, values) in cells.iter().zip(&mut way.values) {
                let number = value(cell).map_err(|problem| match cell.is_empty() {
                    true => line.fault("the row ends in a sample".into(), DAMAGED),
                    false => line.fault(problem, ODD),
                })?;
                values.push(number);
            }
        }
        let held: usize = ways.iter().map(|way| way.values[0].len()).sum();
        if held > MOST_VALUES / 4 {
            let problem = "the recording is too long".to_string();
            return Err(line.fault(problem, "export a shorter part of it"));
        }
    }
    if ways.iter().all(|way| way.values[0].is_empty()) {
        return Err(lines.ended("the first sample"));
    }
    join(&mut curve, ways, (height, &load), number)?;
    Ok(vec![curve])
}

/// The columns of a way, if both are there.
fn way(name: &'static str, columns: &[Column]) -> Option<Way> {
    let at = |part: &str| {
        let is_that = |column: &Column| {
            let header = column.header.to_ascii_lowercase();
            header.starts_with(name) && header.contains(part)
        };
        columns.iter().position(is_that)
    };
    let at = [at("z-sense")?, at("force").or_else(|| at("t-b"))?];
    Some(Way {
        name,
        at,
        values: [Vec::new(), Vec::new()],
    })
}

fn column_unit(column: &Column, wanted: Quantity, line: usize) -> Result<Unit, Fault> {
    let found = column.unit.filter(|unit| unit.quantity == wanted);
    found.ok_or_else(|| {
        let problem = format!(
            "column '{}' has no unit of {}",
            column.header,
            wanted.unit()
        );
        Fault::line(line, problem, ODD)
    })
}

/// Joins the ways into one curve: first in, then out.
fn join(
    curve: &mut Curve,
    ways: Vec<Way>,
    (height, load): (Unit, &Column),
    line: usize,
) -> Result<(), Fault> {
    let (mut heights, mut loads) = (Vec::new(), Vec::new());
    for way in ways {
        let start = heights.len();
        let [z, deflection] = way.values;
        heights.extend(z);
        loads.extend(deflection);
        curve.segments.push(Segment {
            name: way.name.into(),
            start,
            end: heights.len(),
        });
    }
    let is_force = load.header.to_ascii_lowercase().contains("force");
    let heights = Channel::converted("piezo_height", height, heights);
    if is_force {
        let loads = Channel::converted("force", column_unit(load, Quantity::Force, line)?, loads);
        match curve.fact("spring_constant_n_per_mm") {
            Some(stiffness) if stiffness > 0.0 => {
                let pairs = heights.values.iter().zip(&loads.values);
                let travel = pairs.map(|(z, force)| z - force / stiffness).collect();
                curve.channels.push(Channel::named("travel", Quantity::Length, travel));
            }
            _ => curve.unknown.push(
                "the travel: the height is the piezo's, and the bending of the cantilever is in it, whose stiffness the file does not state".into(),
            ),
        }
        curve.channels.insert(0, loads);
    } else {
        curve.channels.push(Channel {
            name: format!("deflection_as_{}", load.unit_text),
            unit: load.unit_text.clone(),
            values: loads,
        });
        curve.unknown.push(
            "the force: the deflection is recorded in volts; export it as force, with the stiffness of the cantilever".into(),
        );
    }
    curve.channels.push(heights);
    curve.unknown.push("the time: the file holds none".into());
    curve.unknown.push("where contact begins".into());
    curve
        .unknown
        .push("shape and size of the tip: no modulus without assuming one".into());
    Ok(())
}

/// Reads up to the line of column names.
fn read_header(lines: &mut Lines, curve: &mut Curve) -> Result<Vec<Column>, Fault> {
    loop {
        let Some(line) = lines.next_filled(&[])? else {
            return Err(lines.ended("the line of column names (Extend Z-Sense(nm), ...)"));
        };
        let text = line.text.trim();
        let lower = text.to_ascii_lowercase();
        if WAYS.iter().any(|way| lower.starts_with(way)) && text.contains(',') {
            return Ok(names(text, Separator::Comma));
        }
        let Some((key, rest)) = text.split_once('\t') else {
            continue;
        };
        let (key, rest) = (key.trim().trim_end_matches(':'), rest.trim());
        if key == "Software Version" {
            curve.source.product = rest.to_string();
        } else if let Some((_, name, factor)) = FACTS.iter().find(|(known, ..)| *known == key) {
            let number =
                value(rest).map_err(|problem| line.fault(format!("{key}: {problem}"), ODD))?;
            curve.push_fact(*name, number * factor);
        }
    }
}
