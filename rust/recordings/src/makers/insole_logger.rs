//! Logger of sensor insoles: one CSV line per sole and time, raw counts without geometry.

use crate::fault::Fault;
use crate::pressure_map::{PressureMap, PressureUnit, Sensel};
use crate::source::Source;
use crate::text::clock::Clock;
use crate::text::fields::{DAMAGED, MOST_VALUES, ODD, Separator, value};
use crate::text::lines::{Line, Lines};

/// Most soles in one file.
const MOST_SOLES: usize = 16;

/// One sole while it is read.
struct Sole {
    map: PressureMap,
    clock: Clock,
}

/// Where the columns stand.
struct Columns {
    count: usize,
    timestamp: usize,
    pressures: Vec<usize>,
}

pub(super) fn read(lines: &mut Lines) -> Result<Vec<PressureMap>, Fault> {
    let Some(line) = lines.next_filled(&[','])? else {
        return Err(lines.ended("the line of column names"));
    };
    let columns = Columns::of(&line)?;
    let (mut soles, mut start, mut held) = (Vec::<Sole>::new(), None, 0);
    while let Some(line) = lines.next_filled(&[','])? {
        let fields: Vec<&str> = Separator::Comma.split(line.text).collect();
        if fields.len() != columns.count {
            let problem = format!(
                "the row holds {} values, expected {}",
                fields.len(),
                columns.count
            );
            return Err(line.fault(problem, DAMAGED));
        }
        let fault = |problem: String| line.fault(problem, ODD);
        let stamp = value(fields[columns.timestamp]).map_err(fault)?;
        let sole = sole_of(&mut soles, fields[0], &columns).map_err(fault)?;
        // Milliseconds since 1970.
        sole.clock
            .push(line.number, (stamp - *start.get_or_insert(stamp)) * 1e-3)?;
        for &column in &columns.pressures {
            let cell = match fields[column] {
                "" => f64::NAN,
                text => value(text).map_err(fault)?,
            };
            sole.map.values.push(cell);
        }
        held += columns.pressures.len();
        if held > MOST_VALUES {
            return Err(fault("the recording holds too many values".into()));
        }
    }
    if soles.is_empty() {
        return Err(lines.ended("the first row of values"));
    }
    Ok(soles
        .into_iter()
        .map(|sole| PressureMap {
            time_s: Some(sole.clock.times()),
            ..sole.map
        })
        .collect())
}

impl Columns {
    fn of(line: &Line) -> Result<Columns, Fault> {
        let names: Vec<&str> = Separator::Comma.split(line.text).collect();
        let Some(timestamp) = names.iter().position(|name| *name == "timestamp") else {
            return Err(line.fault("there is no column 'timestamp'".into(), DAMAGED));
        };
        let pressures: Vec<usize> = (0..names.len())
            .filter(|k| names[*k].starts_with("pressure_"))
            .collect();
        if pressures.is_empty() {
            return Err(line.fault(
                "no column is called 'pressure_01'".into(),
                "export the pressures of the insole too",
            ));
        }
        Ok(Columns {
            count: names.len(),
            timestamp,
            pressures,
        })
    }
}

fn sole_of<'a>(
    soles: &'a mut Vec<Sole>,
    name: &str,
    columns: &Columns,
) -> Result<&'a mut Sole, String> {
    if let Some(k) = soles.iter().position(|sole| sole.map.name == name) {
        return Ok(&mut soles[k]);
    }
    if soles.len() == MOST_SOLES {
        return Err(format!("the file holds more than {MOST_SOLES} soles"));
    }
    let sensels = (1..=columns.pressures.len() as u32).map(|number| Sensel {
        number: Some(number),
        ..Sensel::default()
    });
    let mut map = PressureMap::new(
        Source::default(),
        PressureUnit::RawCounts,
        sensels.collect(),
    );
    map.name = name.to_string();
    map.unknown.push(
        "pressure and force: the values are raw counts and no calibration is in the file".into(),
    );
    map.unknown
        .push("where the sensors lie and their area".into());
    soles.push(Sole {
        map,
        clock: Clock::default(),
    });
    soles.last_mut().ok_or_else(|| "no sole".to_string())
}
