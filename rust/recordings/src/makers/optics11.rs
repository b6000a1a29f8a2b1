//! Optics11 Chiaro and Piuma: header of keys, then load, cantilever and piezo over time.

use crate::curve::{Channel, Curve};
use crate::fault::Fault;
use crate::source::Source;
use crate::tables::columns::{Column, names};
use crate::text::clock::Clock;
use crate::text::fields::{DAMAGED, MOST_VALUES, ODD, Row, Separator, value};
use crate::text::lines::Lines;
use crate::text::units::{Quantity, unit};

/// Key of the header, name here, factor to the library's unit.
const FACTS: &[(&str, &str, f64)] = &[
    ("k (N/m)", "spring_constant_n_per_mm", 1e-3),
    ("Tip radius (um)", "tip_radius_mm", 1e-3),
    ("Calibration factor", "calibration_factor", 1.0),
    ("Max load (µN)", "max_load_n", 1e-6),
    ("Piezo speed (µm/s)", "piezo_speed_mm_per_s", 1e-3),
    ("P[max] (uN)", "instrument_peak_force_n", 1e-6),
    // The instrument's Hertz fit: E / (1 - nu2), and E for the Poisson ratio in brackets.
    ("E[eff] (Pa)", "instrument_effective_modulus_mpa", 1e-6),
    ("E[v=0.500] (Pa)", "instrument_modulus_mpa", 1e-6),
];

pub(super) fn read(lines: &mut Lines) -> Result<Vec<Curve>, Fault> {
    let mut curve = Curve::of(Source::of("Optics11", ""));
    let columns = read_header(lines, &mut curve)?;
    let shape = Row {
        separator: Separator::Tab,
        columns: columns.len(),
        missing: None,
    };
    let at = |base: &str| columns.iter().position(|column| column.base == base);
    let (Some(time), Some(_), Some(piezo), Some(cantilever)) =
        (at("time"), at("force"), at("piezo"), at("cantilever"))
    else {
        let problem = "the columns hold no Time, Load, Cantilever and Piezo".to_string();
        return Err(Fault::line(lines.number(), problem, DAMAGED));
    };
    let (mut clock, mut row) = (Clock::default(), Vec::new());
    let mut values: Vec<Vec<f64>> = vec![Vec::new(); columns.len()];
    while let Some(line) = lines.next_filled(&[])? {
        row.clear();
        let number = line.number;
        shape.read(line, &mut row)?;
        clock.push(number, row[time])?;
        for (column, cell) in values.iter_mut().zip(&row) {
            column.push(*cell);
        }
        if values[0].len() > MOST_VALUES / (columns.len() + 1) {
            return Err(Fault::line(
                number,
                "the recording is too long".into(),
                "export a shorter part of it",
            ));
        }
    }
    if values[0].is_empty() {
        return Err(lines.ended("the first sample"));
    }
    for (column, values) in columns.iter().zip(values) {
        let base = if column.base == "indentation" {
            "instrument_indentation"
        } else {
            &column.base
        };
        curve.channels.push(match unit(&column.unit_text) {
            Some(unit) => Channel::converted(base, unit, values),
            None => Channel {
                name: column.base.clone(),
                unit: column.unit_text.clone(),
                values,
            },
        });
    }
    let pairs = curve.channels[piezo]
        .values
        .iter()
        .zip(&curve.channels[cantilever].values);
    let travel = pairs
        .map(|(piezo, cantilever)| piezo - cantilever)
        .collect();
    curve
        .channels
        .push(Channel::named("travel", Quantity::Length, travel));
    curve.unknown.push("where contact begins: travel is the piezo's less the cantilever's, from the start of the run".into());
    Ok(vec![curve])
}

/// Reads up to the line of column names.
fn read_header(lines: &mut Lines, curve: &mut Curve) -> Result<Vec<Column>, Fault> {
    loop {
        let Some(line) = lines.next_filled(&[])? else {
            return Err(lines.ended("the line of column names (Time, Load, ...)"));
        };
        let text = line.text.trim();
        if text.starts_with("Time (") && text.contains('\t') {
            let columns = names(text, Separator::Tab);
            if let Some(fault) = columns
                .iter()
                .find_map(|column| column.unit_fault(line.number))
            {
                return Err(fault);
            }
            return Ok(columns);
        }
        let Some((key, rest)) = text.split_once('\t').or_else(|| text.split_once(':')) else {
            continue;
        };
        let (key, rest) = (key.trim().trim_end_matches(':'), rest.trim());
        if key == "Device" {
            curve.source.product = rest.to_string();
        } else if key == "Control mode" {
            curve.protocol.push(rest.to_string());
        } else if let Some((_, name, factor)) = FACTS
            .iter()
            .find(|(known, ..)| *known == key.replace('μ', "µ"))
        {
            // The instrument writes NaN where its own fit found nothing.
            if rest.eq_ignore_ascii_case("nan") {
                curve
                    .unknown
                    .push(format!("{key}: the instrument states NaN"));
                continue;
            }
            let number =
                value(rest).map_err(|problem| line.fault(format!("{key}: {problem}"), ODD))?;
            curve.push_fact(*name, number * factor);
        }
    }
}
