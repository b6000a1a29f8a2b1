//! Tekscan I-Scan and F-Scan ASCII movies: frames of a grid, `B` where there is no sensel.

use super::tekscan_header::{self, Header};
use crate::check::Check;
use crate::detection::Format;
use crate::fault::{Fault, shown};
use crate::pressure_map::{PressureMap, PressureUnit, Threshold, grid_sensels};
use crate::recording_file::RecordingFile;
use crate::tables;
use crate::tables::curves::Rows;
use crate::tables::mapping::Columns;
use crate::text::clock::Clock;
use crate::text::fields::{DAMAGED, ODD, Row, Separator, value};
use crate::text::lines::{Line, Lines};

/// Counts go from 0 to 255; a count of 255 is clipped.
const LARGEST_COUNT: f64 = 255.0;

/// What a frame line states.
#[derive(Debug, Clone, Copy)]
struct FrameLine {
    number: i64,
    seconds: Option<f64>,
    raw_sum: Option<f64>,
}

pub(super) fn read(lines: &mut Lines) -> Result<RecordingFile, Fault> {
    let header = tekscan_header::read(lines)?;
    if header.is_graph {
        return read_graph(lines, &header);
    }
    let maps = read_movie(lines, header)?;
    Ok(RecordingFile::of_maps(Format::Tekscan, maps))
}

/// A graph: totals of the mat by frame, as columns.
fn read_graph(lines: &mut Lines, header: &Header) -> Result<RecordingFile, Fault> {
    let mut curves = tables::curves::read(lines, &Columns::default(), Rows::Whole)?;
    for curve in &mut curves {
        curve.source = header.source();
        curve.unknown.push(
            "the pressures: the file is a graph of the mat's totals; export the movie for them"
                .into(),
        );
    }
    Ok(RecordingFile::of_curves(Format::Tekscan, curves))
}

fn read_movie(lines: &mut Lines, header: Header) -> Result<Vec<PressureMap>, Fault> {
    let header_end = lines.number();
    let needed = |what: &str| {
        let problem = format!("the header does not state {what}");
        Fault::line(header_end, problem, DAMAGED)
    };
    let rows = header.rows.ok_or_else(|| needed("ROWS"))?;
    let columns = header.columns.ok_or_else(|| needed("COLS"))?;
    super::limits::check_cells(rows, columns)
        .map_err(|problem| Fault::line(header_end, problem, ODD))?;
    let (unit, factor) = header.unit.ok_or_else(|| needed("UNITS"))?;
    let sensels = grid_sensels([0, 0], [rows, columns], header.area_mm2);
    let mut map = PressureMap::new(header.source(), unit, sensels);
    let shape = Row {
        separator: Separator::Comma,
        columns,
        missing: Some("B"),
    };
    let (mut clock, mut frames) = (Clock::default(), Vec::new());
    while let Some(frame) = next_frame(lines)? {
        let line = lines.number();
        if let Some(time) = time_of(&header, &frame, frames.first()) {
            clock.push(line, time)?;
        }
        frames.push(frame);
        for row in 0..rows {
            let Some(line) = lines.next()? else {
                return Err(lines.ended(&format!("row {} of frame {}", row + 1, frame.number)));
            };
            shape.read(line, &mut map.values)?;
        }
    }
    check_count(&header, &frames, lines.number())?;
    let times = clock.times();
    map.time_s = (times.len() == frames.len()).then_some(times);
    let has_fractions = map.values.iter().any(|value| value.fract().abs() > 0.0);
    if factor != 1.0 {
        map.values.iter_mut().for_each(|value| *value *= factor);
    }
    describe(
        &mut map,
        &header,
        if has_fractions { 0.0 } else { 0.5 * factor },
    );
    compare_sums(&mut map, &frames);
    Ok(vec![map])
}

/// The next frame line; `None` at the end mark or the end of the file.
fn next_frame(lines: &mut Lines) -> Result<Option<FrameLine>, Fault> {
    let Some(line) = lines.next_filled(&[',', ';'])? else {
        return Ok(None);
    };
    let text = line.text.trim();
    if text.starts_with("@@") {
        return Ok(None);
    }
    let Some(rest) = text.strip_prefix("Frame") else {
        let problem = format!(
            "{} stands where a frame should begin",
            shown(text.as_bytes())
        );
        return Err(line.fault(
            problem,
            "the rows do not fit ROWS in the header; export it again",
        ));
    };
    frame_line(rest, &line).map(Some)
}

/// `12` or `12, 1.1,, 12/2/2019 6:21:53.54PM,,,Raw Sum=,,307`.
fn frame_line(rest: &str, line: &Line) -> Result<FrameLine, Fault> {
    let mut fields = Separator::Comma.split(rest);
    let number = fields.next().unwrap_or("");
    let Ok(number) = number.parse() else {
        let problem = format!("{} is not a frame number", shown(number.as_bytes()));
        return Err(line.fault(problem, DAMAGED));
    };
    let fault = |problem| line.fault(problem, ODD);
    let seconds = match fields.next() {
        Some(text) if !text.is_empty() => Some(value(text).map_err(fault)?),
        _ => None,
    };
    let mut sums = fields
        .skip_while(|field| !field.starts_with("Raw Sum"))
        .skip(1);
    let raw_sum = match sums.find(|field| !field.is_empty()) {
        Some(text) => Some(value(text).map_err(fault)?),
        None => None,
    };
    Ok(FrameLine {
        number,
        seconds,
        raw_sum,
    })
}

/// Time of a frame, s: as its line states, or by its number.
fn time_of(header: &Header, frame: &FrameLine, first: Option<&FrameLine>) -> Option<f64> {
    let has_clock = first.unwrap_or(frame).seconds.is_some();
    if has_clock {
        return frame.seconds;
    }
    let start = first.unwrap_or(frame).number;
    Some((frame.number.checked_sub(start)?) as f64 * header.seconds_per_frame?)
}

fn check_count(header: &Header, frames: &[FrameLine], line: usize) -> Result<(), Fault> {
    let stated = match header.span {
        [Some(start), Some(end)] => end.checked_sub(start).and_then(|span| span.checked_add(1)),
        _ => None,
    };
    if stated.is_some_and(|stated| stated != frames.len() as i64) || frames.is_empty() {
        let problem = match stated {
            Some(stated) => format!(
                "the header counts {stated} frames, the file holds {}",
                frames.len()
            ),
            None => "the file holds no frame".to_string(),
        };
        return Err(Fault::line(
            line.max(1),
            problem,
            "it is cut short; export the whole recording again",
        ));
    }
    Ok(())
}

fn describe(map: &mut PressureMap, header: &Header, half_step: f64) {
    map.is_mirrored = header.is_mirrored;
    if let [Some(rows), Some(columns)] = header.spacing_mm {
        map.pitch_mm = Some([rows, columns]);
    }
    map.threshold = header.threshold_counts.map(|value| Threshold {
        value,
        unit: PressureUnit::RawCounts,
    });
    match map.unit {
        PressureUnit::Kilopascal => {
            map.clipped_from = header.saturation_kpa.map(|limit| limit - half_step);
            if header.saturation_kpa.is_none() {
                map.unknown.push("the pressure at which cells clip".into());
            }
            map.unknown
                .push("the threshold in kPa: the file states it in counts".into());
            if header.calibration_points == 1 {
                let mode = &header.calibration_mode;
                map.warnings.push(format!(
                    "calibrated with one point (mode '{mode}'): a straight line through zero, off by up to 24 % of the range"
                ));
            }
        }
        _ => {
            map.clipped_from = Some(LARGEST_COUNT);
            map.unknown.push(
                "pressure and force: the cells are raw counts and no calibration is in the file"
                    .into(),
            );
        }
    }
    if let (Some(times), Some(step)) = (&map.time_s, header.seconds_per_frame) {
        let lasted = times[times.len() - 1] - times[0];
        let expected = (times.len() - 1) as f64 * step;
        if (lasted - expected).abs() > step {
            map.warnings.push(format!(
                "by the header {} frames take {expected:.3} s, by their own lines {lasted:.3} s: frames were lost, or the rate is \
                 not what the header says; the frames' own times are used",
                times.len()
            ));
        }
    }
    if map.time_s.is_none() {
        map.unknown.push("the time of the frames".into());
    }
    if header.area_mm2.is_none() {
        map.unknown.push("the area of a sensel".into());
    }
}

/// The stated raw sums, where the cells are counts too.
fn compare_sums(map: &mut PressureMap, frames: &[FrameLine]) {
    if map.unit != PressureUnit::RawCounts {
        return;
    }
    let mut check = Check::new("raw sum", "counts", 0.0);
    for (k, frame) in frames.iter().enumerate() {
        if let Some(stated) = frame.raw_sum {
            check.compare(k, stated, map.sum(k));
        }
    }
    if check.compared > 0 {
        map.push_check(check);
    }
}
