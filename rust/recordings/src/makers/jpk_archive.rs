//! JPK force curve as the instrument saves it: a zip of properties and of integers, big end first.

use super::jpk_properties::Properties;
use crate::curve::{Channel, Curve, Segment};
use crate::fault::Fault;
use crate::fields::MOST_VALUES;
use crate::pressure_map::Source;
use crate::units::Quantity;
use std::io::{Cursor, Read};

/// Largest file inside the archive that is unpacked, bytes.
const LARGEST_MEMBER: u64 = 256 << 20;
const REMEDY: &str =
    "the file is damaged or of a version that is not known; export it as text from JPK's program";
/// Column of the archive, name here.
const CHANNELS: &[(&str, &str, Quantity)] = &[
    ("vDeflection", "force", Quantity::Force),
    ("height", "piezo_height", Quantity::Length),
    ("measuredHeight", "measured_height", Quantity::Length),
];

type Archive = zip::ZipArchive<Cursor<Vec<u8>>>;

pub(super) fn read(bytes: Vec<u8>) -> Result<Vec<Curve>, Fault> {
    let mut archive = Archive::new(Cursor::new(bytes))
        .map_err(|error| Fault::file(format!("the archive cannot be opened ({error})"), REMEDY))?;
    let shared = match archive.index_for_name("shared-data/header.properties") {
        Some(_) => properties(&mut archive, "shared-data/header.properties")?,
        None => Properties::default(),
    };
    let mut curve = Curve::of(Source::of("JPK", "force curve"));
    let (mut time, mut columns, mut start_s) =
        (Vec::new(), vec![Some(Vec::new()); CHANNELS.len()], 0.0);
    for number in 0.. {
        let folder = format!("segments/{number}/");
        let name = format!("{folder}segment-header.properties");
        if archive.index_for_name(&name).is_none() {
            break;
        }
        let header = properties(&mut archive, &name)?;
        if let Some(stiffness) = spring_constant(&header, &shared).filter(|_| number == 0) {
            curve.push_fact("spring_constant_n_per_mm", stiffness * 1e-3);
        }
        let points = take_segment(&header, &mut curve, time.len())?;
        let duration = header
            .number("force-segment-header.duration")
            .map_err(|problem| inside(&name, problem))?;
        time.extend((0..points).map(|k| start_s + duration * k as f64 / points.max(1) as f64));
        start_s += duration;
        for ((channel, ..), column) in CHANNELS.iter().zip(&mut columns) {
            let found = read_channel(&mut archive, &folder, channel, [&header, &shared])?;
            match (found, column.as_mut()) {
                (Some(values), Some(column)) if values.len() == points => column.extend(values),
                (Some(values), Some(_)) => {
                    let problem = format!("{channel} holds {} samples of {points}", values.len());
                    return Err(inside(&name, problem));
                }
                _ => *column = None,
            }
        }
        if time.len() > MOST_VALUES / 4 {
            return Err(inside(&name, "the recording is too long".into()));
        }
    }
    if time.is_empty() {
        return Err(Fault::file(
            "the archive holds no segment with samples".into(),
            REMEDY,
        ));
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
        let scaled = column.map(|values| values.iter().map(|value| value * factor).collect());
        curve
            .channels
            .extend(scaled.map(|values| Channel::named(base, *quantity, values)));
    }
    with_travel(&mut curve);
    Ok(vec![curve])
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

/// The samples of a channel in N or m; `None` if the segment has no such channel, or it is not calibrated.
fn read_channel(
    archive: &mut Archive,
    folder: &str,
    channel: &str,
    headers: [&Properties; 2],
) -> Result<Option<Vec<f64>>, Fault> {
    let [header, shared] = headers;
    let Some(file) = header.text(&format!("channel.{channel}.data.file.name")) else {
        return Ok(None);
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
    let bytes = member(archive, &format!("{folder}{file}"))?;
    let fault = |problem| inside(file, problem);
    let mut values = decode(
        &bytes,
        scales.text(&format!("{encoder}type")).unwrap_or("float"),
    )
    .map_err(fault)?;
    let mut steps = vec![encoder];
    let Some(conversions) = conversions(scales, &root) else {
        return Ok(None);
    };
    steps.extend(conversions);
    for step in steps {
        let [multiplier, offset] = scales.scaling(&step).map_err(fault)?;
        values
            .iter_mut()
            .for_each(|value| *value = multiplier * *value + offset);
    }
    Ok(Some(values))
}

/// The steps from the raw unit to the default one, in the order they apply; `None` if that is not force or a length.
fn conversions(properties: &Properties, root: &str) -> Option<Vec<String>> {
    let set = format!("{root}conversion-set.conversion");
    let base = properties.text(&format!("{set}s.base"))?;
    let mut name = properties.text(&format!("{set}s.default"))?;
    let unit = properties.text(&format!("{set}.{name}.scaling.unit.unit"))?;
    if !["N", "m"].contains(&unit) {
        return None;
    }
    let mut steps = Vec::new();
    while name != base && steps.len() < 8 {
        steps.push(format!("{set}.{name}."));
        name = properties.text(&format!("{set}.{name}.base-calibration-slot"))?;
    }
    steps.reverse();
    Some(steps)
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

fn properties(archive: &mut Archive, name: &str) -> Result<Properties, Fault> {
    let bytes = member(archive, name)?;
    Ok(Properties::of(&String::from_utf8_lossy(&bytes)))
}

/// The bytes of a file inside the archive.
fn member(archive: &mut Archive, name: &str) -> Result<Vec<u8>, Fault> {
    let opened = archive
        .by_name(name)
        .map_err(|error| inside(name, format!("cannot be unpacked ({error})")))?;
    let mut bytes = Vec::new();
    let reading = opened.take(LARGEST_MEMBER + 1).read_to_end(&mut bytes);
    reading.map_err(|error| inside(name, format!("cannot be unpacked ({error})")))?;
    if bytes.len() as u64 > LARGEST_MEMBER {
        return Err(inside(name, format!("more than {LARGEST_MEMBER} bytes")));
    }
    Ok(bytes)
}

fn inside(member: &str, problem: String) -> Fault {
    Fault::file(
        format!(
            "{} in the archive: {problem}",
            crate::fault::shown(member.as_bytes())
        ),
        REMEDY,
    )
}

/// Adds the travel of the tip into the sample: the height falls as the tip goes down, and bends back by force over stiffness.
pub(super) fn with_travel(curve: &mut Curve) {
    curve
        .unknown
        .push("shape and size of the tip: no modulus without assuming one".into());
    curve.unknown.push("where contact begins".into());
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
