//! Novel pedar: one line per time step with the sensors of both insoles.

use super::limits::count;
use crate::fault::Fault;
use crate::pressure_map::{PressureMap, PressureUnit, Sensel};
use crate::source::Source;
use crate::text::clock::Clock;
use crate::text::fields::{DAMAGED, ODD, Row, Separator};
use crate::text::lines::Lines;

pub(super) fn read(lines: &mut Lines) -> Result<Vec<PressureMap>, Fault> {
    let header = read_header(lines)?;
    let counts: Vec<usize> = header
        .feet
        .iter()
        .map(|(_, numbers)| numbers.len())
        .collect();
    let shape = Row {
        separator: Separator::Blank,
        columns: 1 + counts.iter().sum::<usize>(),
        missing: None,
    };
    let is_one = counts.len() == 1;
    let feet = header.feet.into_iter();
    let maps = feet.map(|(name, numbers)| {
        let numbered = |number| Sensel {
            number: Some(number),
            ..Sensel::default()
        };
        let source = Source {
            maker: "Novel",
            product: "pedar".into(),
            sensor: header.sensor.clone(),
        };
        let mut map = PressureMap::new(
            source,
            PressureUnit::Kilopascal,
            numbers.into_iter().map(numbered).collect(),
        );
        map.name = name;
        map
    });
    let mut maps: Vec<PressureMap> = maps.collect();
    let (mut clock, mut row) = (Clock::default(), Vec::new());
    while let Some(line) = lines.next_filled(&[])? {
        row.clear();
        shape.read(line, &mut row)?;
        clock.push(line.number, row[0])?;
        let mut at = 1;
        for (map, count) in maps.iter_mut().zip(&counts) {
            map.values.extend_from_slice(&row[at..at + count]);
            at += count;
        }
        if maps[0].values.len() > crate::text::fields::MOST_VALUES {
            return Err(Fault::line(
                lines.number(),
                "the recording is too long".into(),
                "export a shorter part of it",
            ));
        }
    }
    if clock.last().is_none() {
        return Err(lines.ended("the first row of pressures"));
    }
    let times = clock.times();
    for map in &mut maps {
        map.time_s = Some(times.clone());
        map.unknown.push(
            "force: the file holds no sensor areas; the insole's area table is needed".into(),
        );
        map.unknown
            .push("where the sensors lie: the file numbers them only".into());
        map.warnings.push(if is_one {
            "the file holds one insole; whose it is follows the mask, please confirm it".into()
        } else {
            "which insole is which follows the order of the mask; please confirm it".into()
        });
    }
    Ok(maps)
}

struct Header {
    sensor: String,
    /// Name and sensor numbers of one insole or two, in the order of the columns.
    feet: Vec<(String, Vec<u32>)>,
}

fn read_header(lines: &mut Lines) -> Result<Header, Fault> {
    let mut sensor = String::new();
    let mut masks: Vec<(String, usize)> = Vec::new();
    loop {
        let Some(line) = lines.next()? else {
            return Err(lines.ended("the line 'time[secs]'"));
        };
        let text = line.text.trim();
        if let Some(rest) = text.strip_prefix("sensor type:") {
            sensor = rest.trim().to_string();
        } else if text.starts_with("pressure values") && !text.ends_with("kPa") {
            let problem = format!("{} are not in kPa", crate::fault::shown(text.as_bytes()));
            return Err(line.fault(problem, "export the pressures in kPa"));
        } else if let Some((name, mask)) = text
            .split_once(':')
            .filter(|(name, _)| name.ends_with(" insole"))
        {
            let sensors = mask.split(',').filter(|number| !number.trim().is_empty());
            masks.push((name.to_string(), sensors.count()));
        } else if let Some(columns) = text.strip_prefix("time[secs]") {
            let feet = split_feet(columns).map_err(|problem| line.fault(problem, ODD))?;
            let names = names(&masks, &feet).map_err(|problem| line.fault(problem, DAMAGED))?;
            return Ok(Header {
                sensor,
                feet: names.into_iter().zip(feet).collect(),
            });
        }
    }
}

/// What the insoles are called: both by the order of the masks, one by the mask of as many sensors.
fn names(masks: &[(String, usize)], feet: &[Vec<u32>]) -> Result<Vec<String>, String> {
    if feet.len() > 1 {
        let name = |k: usize, otherwise: &str| {
            masks
                .get(k)
                .map_or(otherwise.into(), |(name, _)| name.clone())
        };
        return Ok(vec![name(0, "first insole"), name(1, "second insole")]);
    }
    let sensors = feet.first().map_or(0, Vec::len);
    let fitting: Vec<&String> = masks
        .iter()
        .filter(|(_, count)| *count == sensors)
        .map(|(name, _)| name)
        .collect();
    match fitting[..] {
        [name] => Ok(vec![name.clone()]),
        [] if !masks.is_empty() => {
            let counts: Vec<String> = masks.iter().map(|(_, count)| count.to_string()).collect();
            Err(format!(
                "the columns hold {sensors} sensors of one insole, and the masks name {}",
                counts.join(" and ")
            ))
        }
        _ => Ok(vec!["one insole".into()]),
    }
}

/// The sensor numbers of the column line, which start again with the second insole where there is one.
fn split_feet(columns: &str) -> Result<Vec<Vec<u32>>, String> {
    let mut feet = [Vec::new(), Vec::new()];
    let mut last = 0;
    let mut foot = 0;
    for word in columns.split_whitespace() {
        let number = count(word, "sensors")? as u32;
        if number <= last {
            foot += 1;
        }
        last = number;
        feet.get_mut(foot)
            .ok_or("the sensor numbers start again more than once")?
            .push(number);
    }
    if feet[0].is_empty() {
        return Err("the line names no sensor".into());
    }
    Ok(feet
        .into_iter()
        .filter(|numbers| !numbers.is_empty())
        .collect())
}
