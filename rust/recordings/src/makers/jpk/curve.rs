//! One force curve of a JPK archive: segments of whole numbers, big end first, and their conversions to N and m.

use super::archive::{Archive, inside};
use super::properties::Properties;
use crate::curve::{Channel, Curve, Segment};
use crate::fault::Fault;
use crate::source::Source;
use crate::text::fields::MOST_VALUES;
use crate::text::units::Quantity;

/// Channel of the archive, name here. Of the heights that a sensor measured the first counts; older instruments call theirs otherwise.
const CHANNELS: &[(&str, &str, Quantity)] = &[
    ("vDeflection", "force", Quantity::Force),
    ("height", "piezo_height", Quantity::Length),
    ("measuredHeight", "measured_height", Quantity::Length),
    (
        "capacitiveSensorHeight",
        "measured_height",
        Quantity::Length,
    ),
    ("strainGaugeHeight", "measured_height", Quantity::Length),
];

/// What a channel of a segment holds.
enum Samples {
    Known(Vec<f64>),
    /// In a unit that is neither N nor m.
    Uncalibrated(String),
    Missing,
}

/// A channel over the segments read so far; `None` once one of them lacks it.
type Column = Option<Vec<f64>>;

pub(super) fn read(archive: &mut Archive, root: &str, shared: &Properties) -> Result<Curve, Fault> {
    let mut curve = Curve::of(Source::of("JPK", "force curve"));
    let (mut time, mut start_s) = (Vec::new(), 0.0);
    let mut columns: Vec<Column> = vec![Some(Vec::new()); CHANNELS.len()];
    for number in 0.. {
        let folder = format!("{root}segments/{number}/");
        let name = format!("{folder}segment-header.properties");
        if !archive.has(&name) {
            break;
        }
        let header = archive.properties(&name)?;
        if let Some(stiffness) = spring_constant(&header, shared).filter(|_| number == 0) {
            curve.push_fact("spring_constant_n_per_mm", stiffness * 1e-3);
        }
        let points = take_segment(&header, &mut curve, time.len())?;
        let duration = header
            .number("force-segment-header.duration")
            .map_err(|problem| inside(&name, problem))?;
        time.extend((0..points).map(|k| start_s + duration * k as f64 / points.max(1) as f64));
        start_s += duration;
        for ((channel, _, quantity), column) in CHANNELS.iter().zip(&mut columns) {
            let found = match column {
                Some(_) => read_channel(archive, &folder, (channel, *quantity), [&header, shared])?,
                None => Samples::Missing,
            };
            match (found, column.as_mut()) {
                (Samples::Known(values), Some(column)) if values.len() == points => {
                    column.extend(values)
                }
                (Samples::Known(values), Some(_)) => {
                    let problem = format!("{channel} holds {} samples of {points}", values.len());
                    return Err(inside(&name, problem));
                }
                (Samples::Uncalibrated(unit), _) if *quantity == Quantity::Force => {
                    curve.unknown.push(format!(
                        "the force: the deflection is recorded in {unit}, without the stiffness of its cantilever"
                    ));
                    *column = None;
                }
                _ => *column = None,
            }
        }
        if time.len() > MOST_VALUES / 4 {
            return Err(inside(&name, "the recording is too long".into()));
        }
    }
    if time.is_empty() {
        return Err(inside(root, "no segment holds samples".into()));
    }
    curve
        .channels
        .push(Channel::named("time", Quantity::Time, time));
    for ((_, base, quantity), column) in CHANNELS.iter().zip(columns) {
        // Newtons stay, meters become millimeters.
        let factor = if *quantity == Quantity::Length {
            1e3
        } else {
            1.0
        };
        let scaled: Option<Vec<f64>> =
            column.map(|values| values.iter().map(|value| value * factor).collect());
        let channel = scaled.map(|values| Channel::named(base, *quantity, values));
        let is_new = |channel: &Channel| {
            curve
                .channels
                .iter()
                .all(|other| other.name != channel.name)
        };
        if let Some(channel) = channel.filter(is_new) {
            curve.channels.push(channel);
        }
    }
    with_travel(&mut curve);
    Ok(curve)
}

/// Name and length of a segment; facts of the first one that states them.
fn take_segment(header: &Properties, curve: &mut Curve, start: usize) -> Result<usize, Fault> {
    let problem = |problem| inside("segment-header.properties", problem);
    let points = header
        .number("force-segment-header.num-points")
        .map_err(problem)?;
    if !(0.0..=MOST_VALUES as f64).contains(&points) {
        return Err(problem(format!("{points} samples")));
    }
    let name = header
        .text("force-segment-header.settings.segment-settings.style")
        .unwrap_or("segment");
    let end = start + points as usize;
    curve.segments.push(Segment {
        name: name.to_string(),
        start,
        end,
    });
    Ok(points as usize)
}

/// The samples of a channel in N or m.
fn read_channel(
    archive: &mut Archive,
    folder: &str,
    (channel, quantity): (&str, Quantity),
    headers: [&Properties; 2],
) -> Result<Samples, Fault> {
    let [header, shared] = headers;
    let Some(file) = header.text(&format!("channel.{channel}.data.file.name")) else {
        return Ok(Samples::Missing);
    };
    let (scales, root, encoder) = match header.text(&format!("channel.{channel}.lcd-info.*")) {
        Some(number) => (
            shared,
            format!("lcd-info.{number}."),
            format!("lcd-info.{number}.encoder."),
        ),
        None => (
            header,
            format!("channel.{channel}."),
            format!("channel.{channel}.data.encoder."),
        ),
    };
    let (unit, conversions) = conversions(scales, &root);
    let wanted = if quantity == Quantity::Force {
        "N"
    } else {
        "m"
    };
    if unit != wanted {
        return Ok(Samples::Uncalibrated(unit.to_string()));
    }
    let bytes = archive.member(&format!("{folder}{file}"))?;
    let fault = |problem| inside(file, problem);
    let mut values = decode(
        &bytes,
        scales.text(&format!("{encoder}type")).unwrap_or("float"),
    )
    .map_err(fault)?;
    let mut steps = vec![encoder];
    steps.extend(conversions);
    for step in steps {
        let [multiplier, offset] = scales.scaling(&step).map_err(fault)?;
        values
            .iter_mut()
            .for_each(|value| *value = multiplier * *value + offset);
    }
    Ok(Samples::Known(values))
}

/// The unit of a channel and the steps to it from the raw numbers, in the order they apply.
fn conversions<'p>(properties: &'p Properties, root: &str) -> (&'p str, Vec<String>) {
    const NO_UNIT: (&str, Vec<String>) = ("no unit", Vec::new());
    let set = format!("{root}conversion-set.conversion");
    let base = properties.text(&format!("{set}s.base"));
    let last = properties.text(&format!("{set}s.default"));
    let (Some(base), Some(mut name)) = (base, last) else {
        return NO_UNIT;
    };
    // The raw numbers name their unit nowhere but in the name of their slot, `volts`.
    let stated = properties.text(&format!("{set}.{name}.scaling.unit.unit"));
    let Some(unit) = stated.or(Some(base).filter(|base| *base == name)) else {
        return NO_UNIT;
    };
    let mut steps = Vec::new();
    while name != base && steps.len() < 8 {
        steps.push(format!("{set}.{name}."));
        match properties.text(&format!("{set}.{name}.base-calibration-slot")) {
            Some(slot) => name = slot,
            None => return NO_UNIT,
        }
    }
    steps.reverse();
    (unit, steps)
}

/// The cantilever's stiffness, N/m: force over distance of the deflection's last conversion.
fn spring_constant(header: &Properties, shared: &Properties) -> Option<f64> {
    let (scales, root) = match header.text("channel.vDeflection.lcd-info.*") {
        Some(number) => (shared, format!("lcd-info.{number}.")),
        None => (header, "channel.vDeflection.".to_string()),
    };
    let force = format!("{root}conversion-set.conversion.force.");
    scales
        .text(&format!("{force}base-calibration-slot"))
        .filter(|slot| *slot == "distance")?;
    scales.number(&format!("{force}scaling.multiplier")).ok()
}

fn decode(bytes: &[u8], kind: &str) -> Result<Vec<f64>, String> {
    let kind = kind.trim_end_matches("-limited");
    let width = match kind {
        "signedshort" | "unsignedshort" => 2,
        "signedinteger" | "unsignedinteger" | "float" => 4,
        _ => {
            return Err(format!(
                "encoding {} is not known",
                crate::fault::shown(kind.as_bytes())
            ));
        }
    };
    if !bytes.len().is_multiple_of(width) {
        return Err(format!(
            "{} bytes are no whole number of samples",
            bytes.len()
        ));
    }
    let values = bytes
        .chunks_exact(width)
        .map(|sample| match (kind, sample) {
            ("signedshort", &[a, b]) => f64::from(i16::from_be_bytes([a, b])),
            ("unsignedshort", &[a, b]) => f64::from(u16::from_be_bytes([a, b])),
            ("signedinteger", &[a, b, c, d]) => f64::from(i32::from_be_bytes([a, b, c, d])),
            ("unsignedinteger", &[a, b, c, d]) => f64::from(u32::from_be_bytes([a, b, c, d])),
            (_, &[a, b, c, d]) => f64::from(f32::from_be_bytes([a, b, c, d])),
            _ => f64::NAN,
        });
    let values: Vec<f64> = values.collect();
    match values.iter().all(|value| value.is_finite()) {
        true => Ok(values),
        false => Err("a sample is not finite".into()),
    }
}

/// Adds the travel of the tip into the sample: the height falls as the tip goes down, and bends back by force over stiffness.
pub(super) fn with_travel(curve: &mut Curve) {
    curve
        .unknown
        .push("shape and size of the tip: no modulus without assuming one".into());
    curve.unknown.push("where contact begins".into());
    if curve.channel("force_n").is_none()
        && curve
            .unknown
            .iter()
            .all(|text| !text.starts_with("the force"))
    {
        curve
            .unknown
            .push("the force: the file holds no deflection in N".into());
    }
    let stiffness = curve
        .fact("spring_constant_n_per_mm")
        .filter(|stiffness| *stiffness > 0.0);
    let height = curve
        .channel("measured_height_mm")
        .or(curve.channel("piezo_height_mm"));
    if let (Some(force), Some(height), Some(stiffness)) =
        (curve.channel("force_n"), height, stiffness)
    {
        let travel = height
            .iter()
            .zip(force)
            .map(|(height, force)| -height - force / stiffness)
            .collect();
        curve
            .channels
            .push(Channel::named("travel", Quantity::Length, travel));
    }
}
