//! XSENSOR CSV: frames of one or more sensors; the groups of cells behind them are no sensors.

use super::xsensor_block::{Block, lower, pair};
use crate::check::Check;
use crate::fault::{Fault, shown};
use crate::pressure_map::{PressureMap, PressureUnit, Threshold, grid_sensels};
use crate::source::Source;
use crate::text::clock::Clock;
use crate::text::fields::{DAMAGED, MOST_VALUES, ODD, value};
use crate::text::lines::{Line, Lines};
use crate::text::units::{Quantity, unit};

/// Rounding of the stated loads: cells of 0.01 mmHg, areas and pitch of two digits.
const LOAD_TOLERANCE: f64 = 1.0;
/// Rounding of the pitch to 0.01 cm: twice 0.005 cm of 0.86 cm, in percent of the area.
const AREA_TOLERANCE: f64 = 1.2;
/// Rounding of the cells, in the file's unit.
const PEAK_TOLERANCE: f64 = 0.006;
const DAY: f64 = 86_400.0;

/// A sensor over all frames.
struct Mat {
    map: PressureMap,
    /// Rows and columns.
    size: [usize; 2],
    frames: usize,
    load: Check,
    peak: Check,
    area: Check,
}

pub(super) fn read(lines: &mut Lines) -> Result<Vec<PressureMap>, Fault> {
    let (mut factor, mut threshold) = (None, 0.0);
    let (mut mats, mut clock, mut frames) = (Vec::<Mat>::new(), Clock::default(), 0);
    let mut held = 0;
    while let Some(line) = lines.next_filled(&[','])? {
        let (name, text) = pair(&line);
        let fault = |problem: String| line.fault(format!("{name} {problem}"), ODD);
        match lower(name).as_str() {
            "units" => factor = Some(pressure_factor(text).map_err(fault)?),
            "threshold" => threshold = value(text).map_err(fault)?,
            "frame" => {
                check_frame(&mats, frames, &line)?;
                frames += 1;
            }
            "time" if frames > 0 => {
                let time = since_start(clock_time(text).map_err(fault)?, &clock);
                clock.push(line.number, time)?;
            }
            "sensor" => {
                let number = line.number;
                let Some(factor) = factor else {
                    return Err(
                        line.fault("the file does not state its Units before".into(), DAMAGED)
                    );
                };
                let name = text.to_string();
                let block = Block::read(lines, name)?;
                held += block.values.len();
                if held > MOST_VALUES {
                    return Err(Fault::line(
                        number,
                        "the recording is too long".into(),
                        "export a shorter part of it",
                    ));
                }
                take(&mut mats, &block, [factor, threshold], frames)
                    .map_err(|problem| Fault::line(number, problem, ODD))?;
            }
            _ => {}
        }
    }
    check_last(&mats, frames, lines)?;
    let mut times = clock.times();
    if let Some(start) = times.first().copied() {
        times.iter_mut().for_each(|time| *time -= start);
    }
    Ok(mats.into_iter().map(|mat| finish(mat, &times)).collect())
}

/// kPa in one of the file's units.
fn pressure_factor(text: &str) -> Result<f64, String> {
    match unit(text) {
        Some(unit) if unit.quantity == Quantity::Pressure => Ok(unit.factor),
        _ => Err(format!(
            "{} is not a unit of pressure",
            shown(text.as_bytes())
        )),
    }
}

/// `08:21:17.982` as seconds of the day.
fn clock_time(text: &str) -> Result<f64, String> {
    let parts: Result<Vec<f64>, String> = text.split(':').map(|part| value(part.trim())).collect();
    match parts?[..] {
        // A workbook keeps the time of day as part of a day.
        [part] if (0.0..1.0).contains(&part) => Ok(DAY * part),
        [hours, minutes, seconds] => Ok(3600.0 * hours + 60.0 * minutes + seconds),
        _ => Err(format!("{} is not a time of day", shown(text.as_bytes()))),
    }
}

/// A recording that runs past midnight goes on counting.
fn since_start(time: f64, clock: &Clock) -> f64 {
    match clock.last() {
        Some(last) if time < last.rem_euclid(DAY) - 0.5 * DAY => {
            (last / DAY).floor() * DAY + DAY + time
        }
        Some(last) => (last / DAY).floor() * DAY + time,
        None => time,
    }
}

/// Every frame so far must hold every sensor.
fn check_frame(mats: &[Mat], frames: usize, line: &Line) -> Result<(), Fault> {
    match mats.iter().find(|mat| mat.frames != frames) {
        Some(mat) => {
            let problem = format!(
                "frame {frames} lacks sensor {}",
                shown(mat.map.source.sensor.as_bytes())
            );
            Err(line.fault(problem, DAMAGED))
        }
        None => Ok(()),
    }
}

fn check_last(mats: &[Mat], frames: usize, lines: &Lines) -> Result<(), Fault> {
    if mats.is_empty() || mats.iter().any(|mat| mat.frames != frames) {
        return Err(lines.ended("a sensor (SENSOR) of the last frame"));
    }
    Ok(())
}

/// Adds a block to the mat of its name; `scale` is kPa per unit and the threshold in that unit.
fn take(mats: &mut Vec<Mat>, block: &Block, scale: [f64; 2], frames: usize) -> Result<(), String> {
    let [factor, threshold] = scale;
    let k = match mats
        .iter()
        .position(|mat| mat.map.source.sensor == block.name)
    {
        Some(k) => k,
        None if frames == 1 => {
            mats.push(Mat::new(block, factor, threshold));
            mats.len() - 1
        }
        None => {
            return Err(format!(
                "sensor {} was not in the first frame",
                shown(block.name.as_bytes())
            ));
        }
    };
    let mat = &mut mats[k];
    if mat.size != [block.rows, block.columns] {
        return Err("the sensor changes its size".into());
    }
    if mat.frames + 1 != frames {
        return Err("the sensor stands twice in the frame, or before it".into());
    }
    mat.frames += 1;
    mat.map
        .values
        .extend(block.values.iter().map(|value| value * factor));
    mat.compare(block, factor);
    Ok(())
}

impl Mat {
    fn new(block: &Block, factor: f64, threshold: f64) -> Mat {
        let area = match block.cell_mm {
            [Some(height), Some(width)] => Some(height * width),
            _ => None,
        };
        let source = Source {
            maker: "XSENSOR",
            product: String::new(),
            sensor: block.name.clone(),
        };
        let sensels = grid_sensels([0, 0], [block.rows, block.columns], area);
        let mut map = PressureMap::new(source, PressureUnit::Kilopascal, sensels);
        map.name.clone_from(&block.name);
        if let [Some(height), Some(width)] = block.cell_mm {
            map.pitch_mm = Some([height, width]);
        }
        map.threshold = Some(Threshold {
            value: threshold * factor,
            unit: PressureUnit::Kilopascal,
        });
        map.unknown.push("at which pressure cells clip".into());
        if block
            .total_area_mm2
            .zip(area)
            .is_some_and(|(total, area)| total < 0.999 * area * (block.rows * block.columns) as f64)
        {
            map.unknown.push("which cells lie outside the sensor's outline: they are written as 0 like unloaded ones".into());
        }
        Mat {
            map,
            size: [block.rows, block.columns],
            frames: 0,
            load: Check::new("estimated load", "N", LOAD_TOLERANCE),
            peak: Check::new("peak pressure", "kPa", PEAK_TOLERANCE * factor),
            area: Check::new("contact area", "%", AREA_TOLERANCE),
        }
    }

    fn compare(&mut self, block: &Block, factor: f64) {
        let frame = self.frames - 1;
        if let (Some(stated), Some(ours)) = (block.load_n, self.map.force_n(frame)) {
            self.load.compare(frame, stated, ours);
        }
        if let Some(stated) = block.peak {
            self.peak
                .compare(frame, stated * factor, self.map.peak(frame));
        }
        if let (Some(stated), Some(ours)) = (
            block.contact_area_mm2,
            self.map.contact_area_mm2(frame, 0.0),
        ) {
            let per_cent = if stated > 0.0 {
                100.0 * ours / stated
            } else {
                100.0 + ours
            };
            self.area.compare(frame, 100.0, per_cent);
        }
    }
}

fn finish(mat: Mat, times: &[f64]) -> PressureMap {
    let mut map = mat.map;
    if times.len() == mat.frames {
        map.time_s = Some(times.to_vec());
    } else {
        map.unknown.push("the time of the frames".into());
    }
    for check in [mat.load, mat.peak, mat.area] {
        if check.compared > 0 {
            map.push_check(check);
        }
    }
    map
}
