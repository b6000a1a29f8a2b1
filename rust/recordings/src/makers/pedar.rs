//! Novel pedar: one line per time step with the sensors of both insoles.

use super::count;
use crate::clock::Clock;
use crate::fault::Fault;
use crate::fields::{DAMAGED, Row, Separator};
use crate::lines::Lines;
use crate::pressure_map::{PressureMap, PressureUnit, Sensel, Source};

pub(super) fn read(lines: &mut Lines) -> Result<Vec<PressureMap>, Fault> {
    let header = read_header(lines)?;
    let counts = [header.feet[0].1.len(), header.feet[1].1.len()];
    let shape = Row {
        separator: Separator::Blank,
        columns: 1 + counts[0] + counts[1],
        missing: None,
    };
    let mut maps = header.feet.map(|(name, numbers)| {
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
    let (mut clock, mut row) = (Clock::default(), Vec::new());
    while let Some(line) = lines.next_filled(&[])? {
        row.clear();
        shape.read(line, &mut row)?;
        clock.push(line.number, row[0])?;
        maps[0].values.extend_from_slice(&row[1..=counts[0]]);
        maps[1].values.extend_from_slice(&row[1 + counts[0]..]);
        if maps[0].values.len() > crate::fields::MOST_VALUES {
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
        map.warnings
            .push("which insole is which follows the order of the mask; please confirm it".into());
    }
    Ok(maps.into())
}

struct Header {
    sensor: String,
    /// Name and sensor numbers, in the order of the columns.
    feet: [(String, Vec<u32>); 2],
}

fn read_header(lines: &mut Lines) -> Result<Header, Fault> {
    let mut sensor = String::new();
    let mut names: Vec<String> = Vec::new();
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
        } else if let Some((name, _)) = text
            .split_once(':')
            .filter(|(name, _)| name.ends_with(" insole"))
        {
            names.push(name.to_string());
        } else if let Some(columns) = text.strip_prefix("time[secs]") {
            let feet = split_feet(columns).map_err(|problem| line.fault(problem, DAMAGED))?;
            let mut names = names.into_iter();
            let mut name = |otherwise: &str| names.next().unwrap_or_else(|| otherwise.to_string());
            let [first, second] = feet;
            return Ok(Header {
                sensor,
                feet: [
                    (name("first insole"), first),
                    (name("second insole"), second),
                ],
            });
        }
    }
}

/// The sensor numbers of the column line, which start again with the second insole.
fn split_feet(columns: &str) -> Result<[Vec<u32>; 2], String> {
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
    if feet[1].is_empty() {
        return Err("the columns hold the sensors of one insole, expected two".into());
    }
    Ok(feet)
}
