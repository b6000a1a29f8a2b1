//! Header of a Tekscan ASCII movie: one key and its value per line.

use super::limits::count;
use crate::fault::{Fault, shown};
use crate::pressure_map::PressureUnit;
use crate::source::Source;
use crate::text::fields::{ODD, value};
use crate::text::lines::{Line, Lines};
use crate::text::units::{Quantity, measure, unit};

/// What the header states; nothing else of it is kept, above all no path and no comment.
#[derive(Debug, Default)]
pub(super) struct Header {
    pub version: String,
    pub sensor: String,
    pub rows: Option<usize>,
    pub columns: Option<usize>,
    /// Distance of neighboring rows, of neighboring columns, mm.
    pub spacing_mm: [Option<f64>; 2],
    pub area_mm2: Option<f64>,
    pub threshold_counts: Option<f64>,
    pub seconds_per_frame: Option<f64>,
    pub saturation_kpa: Option<f64>,
    /// First and last frame.
    pub span: [Option<i64>; 2],
    /// The unit of the cells and how many kPa it is; `None` for the factor of raw counts.
    pub unit: Option<(PressureUnit, f64)>,
    pub is_mirrored: [Option<bool>; 2],
    pub calibration_points: usize,
    pub calibration_mode: String,
    /// A graph of totals over time, in place of frames.
    pub is_graph: bool,
}

/// Keys that stand after the comment, which may itself look like a key.
const AFTER_COMMENT: &[&str] = &[
    "START_FRAME",
    "END_FRAME",
    "UNITS",
    "MIRROR_ROW",
    "MIRROR_COL",
];

/// Reads up to `ASCII_DATA`.
pub(super) fn read(lines: &mut Lines) -> Result<Header, Fault> {
    let mut header = Header::default();
    let mut is_comment_over = true;
    loop {
        let Some(line) = lines.next()? else {
            return Err(lines.ended("ASCII_DATA"));
        };
        let text = line
            .text
            .trim_end_matches([',', ' ', '\t', ';'])
            .trim_start();
        let (key, rest) = text.split_once([' ', '\t', ',', ';']).unwrap_or((text, ""));
        match key {
            "ASCII_DATA" => return Ok(header),
            "COMMENTS:" => is_comment_over = false,
            _ if is_comment_over => header.take(key, rest.trim(), &line)?,
            // A comment is never a fault; the keys after it come last, so the last one stands.
            _ if AFTER_COMMENT.contains(&key) => {
                let _ = header.take(key, rest.trim(), &line);
            }
            _ => {}
        }
    }
}

impl Header {
    fn take(&mut self, key: &str, text: &str, line: &Line) -> Result<(), Fault> {
        self.set(key, text)
            .map_err(|problem| line.fault(format!("{key}: {problem}"), ODD))
    }

    fn set(&mut self, key: &str, text: &str) -> Result<(), String> {
        match key {
            "DATA_TYPE" => self.is_graph = text.eq_ignore_ascii_case("GRAPH"),
            "VERSION" => self.version = text.to_string(),
            "SENSOR_TYPE" => self.sensor = text.to_string(),
            "ROWS" => self.rows = Some(count(text, "rows")?),
            "COLS" => self.columns = Some(count(text, "columns")?),
            "ROW_SPACING" => self.spacing_mm[0] = Some(positive(text, Quantity::Length)?),
            "COL_SPACING" => self.spacing_mm[1] = Some(positive(text, Quantity::Length)?),
            "SENSEL_AREA" => self.area_mm2 = Some(positive(text, Quantity::Area)?),
            "NOISE_THRESHOLD" | "NOISE_TRESHOLD" => self.threshold_counts = Some(value(text)?),
            "SECONDS_PER_FRAME" => {
                let step = value(text)?;
                self.seconds_per_frame = (step > 0.0).then_some(step);
            }
            "SATURATION_PRESSURE" => {
                self.saturation_kpa = Some(positive(text, Quantity::Pressure)?)
            }
            "START_FRAME" => self.span[0] = Some(frame(text)?),
            "END_FRAME" => self.span[1] = Some(frame(text)?),
            "UNITS" => self.unit = Some(cell_unit(text)?),
            "MIRROR_ROW" => self.is_mirrored[0] = Some(text != "0"),
            "MIRROR_COL" => self.is_mirrored[1] = Some(text != "0"),
            "CALIBRATION_POINT_1" | "CALIBRATION_POINT_2" => self.calibration_points += 1,
            "CALIBRATION_MODE_1" => self.calibration_mode = text.to_string(),
            _ => {}
        }
        Ok(())
    }

    pub fn source(&self) -> Source {
        Source {
            maker: "Tekscan",
            product: self.version.clone(),
            sensor: self.sensor.clone(),
        }
    }
}

fn positive(text: &str, quantity: Quantity) -> Result<f64, String> {
    measure(text, quantity).and_then(|value| {
        (value > 0.0)
            .then_some(value)
            .ok_or_else(|| format!("{value} is not positive"))
    })
}

fn frame(text: &str) -> Result<i64, String> {
    text.parse()
        .map_err(|_| format!("{} is not a frame number", shown(text.as_bytes())))
}

fn cell_unit(text: &str) -> Result<(PressureUnit, f64), String> {
    if text.eq_ignore_ascii_case("raw") {
        return Ok((PressureUnit::RawCounts, 1.0));
    }
    match unit(text) {
        Some(unit) if unit.quantity == Quantity::Pressure => {
            Ok((PressureUnit::Kilopascal, unit.factor))
        }
        _ => Err(format!(
            "{} is not a unit of pressure",
            shown(text.as_bytes())
        )),
    }
}
