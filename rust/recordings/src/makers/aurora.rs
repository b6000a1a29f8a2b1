//! Aurora Scientific DMC: samples in volts with a scale and an offset per channel.

use crate::curve::{Channel, Curve};
use crate::fault::{Fault, shown};
use crate::source::Source;
use crate::text::fields::{DAMAGED, MOST_VALUES, ODD, Row, Separator, value};
use crate::text::lines::{Line, Lines};
use crate::text::units::{Quantity, Unit, unit};

/// Most channels of a table.
const MOST_CHANNELS: usize = 64;
/// Steps of a protocol that are kept.
const MOST_STEPS: usize = 1000;

/// Calibration of the channels, in the order of the file.
#[derive(Debug, Default)]
struct Calibration {
    names: Vec<String>,
    units: Vec<String>,
    scale: Vec<f64>,
    offset_v: Vec<f64>,
}

pub(super) fn read(lines: &mut Lines) -> Result<Vec<Curve>, Fault> {
    let mut curve = Curve::default();
    let (mut calibration, mut frequency) = (Calibration::default(), None);
    let mut is_protocol = false;
    let first = match lines.next_filled(&[])? {
        Some(line) => line
            .text
            .trim()
            .trim_end_matches("Data File")
            .trim()
            .to_string(),
        None => return Err(lines.ended("the header")),
    };
    curve.source = Source::of("Aurora Scientific", &first);
    let columns = loop {
        let Some(line) = lines.next_filled(&[])? else {
            return Err(lines.ended("the line 'Sample' of the test data"));
        };
        let text = line.text.trim_end();
        let fault = |problem: String| line.fault(problem, ODD);
        if let Some(rest) = text.strip_prefix("Sample Frequency (Hz):") {
            frequency = Some(value(rest.trim()).map_err(fault)?).filter(|rate| *rate > 0.0);
        } else if text.starts_with("Protocol Array:") {
            is_protocol = true;
        } else if text.starts_with("Test Data") {
            is_protocol = false;
        } else if text.starts_with("Sample\t") {
            break text
                .split('\t')
                .map(|name| name.trim().to_string())
                .collect::<Vec<_>>();
        } else if is_protocol && curve.protocol.len() < MOST_STEPS {
            curve.protocol.push(step(text));
        } else {
            calibration.take(text).map_err(fault)?;
        }
    };
    let Some(frequency) = frequency else {
        let problem = "the header does not state a sample frequency".to_string();
        return Err(Fault::line(lines.number(), problem, DAMAGED));
    };
    let used = calibration
        .used(&columns)
        .map_err(|problem| Fault::line(lines.number(), problem, ODD))?;
    curve.push_fact("sample_frequency_hz", frequency);
    read_samples(lines, &columns, &used, (&mut curve, frequency))?;
    curve
        .unknown
        .push("where contact begins: the length is that of the lever".into());
    curve
        .unknown
        .push("shape and size of the tip, thickness and support of the sample".into());
    Ok(vec![curve])
}

/// `0.200000<TAB>Ramp<TAB>Force Out<TAB>400, 0.05`: wait, kind, channel, target and duration.
fn step(text: &str) -> String {
    text.split('\t')
        .map(str::trim)
        .filter(|part| !part.is_empty())
        .collect::<Vec<_>>()
        .join(" | ")
}

/// A channel in use: its column, its name here, and value = (volts - offset) x scale.
struct Used {
    column: usize,
    base: String,
    unit: Unit,
    scale: f64,
    offset_v: f64,
}

impl Calibration {
    fn take(&mut self, text: &str) -> Result<(), String> {
        let Some((name, rest)) = text.split_once('\t') else {
            return Ok(());
        };
        let words = || rest.split('\t').map(str::trim).take(MOST_CHANNELS);
        let numbers = || words().map(value).collect::<Result<Vec<f64>, String>>();
        match name.trim() {
            "Channel" => self.names = words().map(String::from).collect(),
            "Units" => self.units = words().map(String::from).collect(),
            "Scale (units/V)" => self.scale = numbers()?,
            "Offset (volts)" => self.offset_v = numbers()?,
            _ => {}
        }
        Ok(())
    }

    /// The channels with a unit and a scale.
    fn used(&self, columns: &[String]) -> Result<Vec<Used>, String> {
        let mut used = Vec::new();
        for (k, name) in self.names.iter().enumerate() {
            let text = self.units.get(k).map_or("", String::as_str);
            let (Some(&scale), Some(&offset_v)) = (self.scale.get(k), self.offset_v.get(k)) else {
                return Err(format!(
                    "channel {} has no scale or no offset",
                    shown(name.as_bytes())
                ));
            };
            if text.is_empty() || scale == 0.0 {
                continue;
            }
            let Some(unit) = unit(text) else {
                return Err(format!(
                    "{} is not a unit that is known",
                    shown(text.as_bytes())
                ));
            };
            let Some(column) = columns.iter().position(|column| column == name) else {
                return Err(format!(
                    "the data hold no channel {}",
                    shown(name.as_bytes())
                ));
            };
            let quantity = if unit.quantity == Quantity::Length {
                "travel"
            } else {
                "force"
            };
            let base = if name.starts_with("AO") {
                format!("{quantity}_command")
            } else {
                quantity.to_string()
            };
            used.push(Used {
                column,
                base,
                unit,
                scale,
                offset_v,
            });
        }
        if !used.iter().any(|channel| channel.base == "force") {
            return Err("no input channel has a unit of force".into());
        }
        Ok(used)
    }
}

fn read_samples(
    lines: &mut Lines,
    columns: &[String],
    used: &[Used],
    into: (&mut Curve, f64),
) -> Result<(), Fault> {
    let (curve, frequency) = into;
    let shape = Row {
        separator: Separator::Tab,
        columns: columns.len(),
        missing: None,
    };
    let (mut row, mut time) = (Vec::new(), Vec::new());
    let mut channels: Vec<Vec<f64>> = vec![Vec::new(); used.len()];
    let mut next = None;
    while let Some(line) = lines.next_filled(&[])? {
        row.clear();
        let number = line.number;
        shape.read(
            Line {
                number,
                text: line.text.trim_end(),
            },
            &mut row,
        )?;
        if next.is_some_and(|next: f64| row[0] != next) {
            let problem = format!(
                "sample {} where {} should follow",
                row[0],
                next.unwrap_or(0.0)
            );
            return Err(Fault::line(number, problem, DAMAGED));
        }
        next = Some(row[0] + 1.0);
        time.push(row[0] / frequency);
        for (channel, values) in used.iter().zip(&mut channels) {
            values.push((row[channel.column] - channel.offset_v) * channel.scale);
        }
        if time.len() > MOST_VALUES / (used.len() + 1) {
            return Err(Fault::line(
                number,
                "the recording is too long".into(),
                "export a shorter part of it",
            ));
        }
    }
    if time.is_empty() {
        return Err(lines.ended("the first sample"));
    }
    curve
        .channels
        .push(Channel::named("time", Quantity::Time, time));
    for (channel, values) in used.iter().zip(channels) {
        curve
            .channels
            .push(Channel::converted(&channel.base, channel.unit, values));
    }
    Ok(())
}
