//! A pressure recording: frames of sensels with what the file says about them, and nothing that it does not say.

use crate::check::Check;
use crate::curve::Channel;
use crate::source::Source;

/// What the values of a map are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PressureUnit {
    /// Calibrated pressure, kPa.
    Kilopascal,
    /// Uncalibrated counts: shape and relative size only, never a force.
    RawCounts,
    /// The file does not say; to be treated as counts.
    NotStated,
}

/// One cell of a mat.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Sensel {
    /// Row and column as the file numbers them, from 0 where it does not number them; `None` on a mat without a grid.
    pub place: Option<[u32; 2]>,
    /// The maker's number of the sensel, where it has one.
    pub number: Option<u32>,
    /// Center on the flat mat, mm, where the file says.
    pub center_mm: Option<[f64; 2]>,
    /// Sensing area, mm2, where the file says.
    pub area_mm2: Option<f64>,
}

/// Smallest reading that an instrument passes on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Threshold {
    /// In `unit`, which need not be that of the values.
    pub value: f64,
    /// Unit of the threshold.
    pub unit: PressureUnit,
}

/// Frames of one sensor mat.
#[derive(Debug, Clone, PartialEq)]
pub struct PressureMap {
    /// Which of the file's mats this is, for instance `left insole`; empty if there is one.
    pub name: String,
    /// Instrument and sensor.
    pub source: Source,
    /// What the values are.
    pub unit: PressureUnit,
    /// The cells, in the order of a frame's values.
    pub sensels: Vec<Sensel>,
    /// Time of each frame, s, increasing; `None` if the file does not say.
    pub time_s: Option<Vec<f64>>,
    /// Frame by frame, one value per sensel, in `unit`; NaN where there is no sensel or the cell is empty.
    pub values: Vec<f64>,
    /// Values from here on are clipped: the true ones are at least that. In `unit`.
    pub clipped_from: Option<f64>,
    /// Smallest reading passed on.
    pub threshold: Option<Threshold>,
    /// Distance of neighboring rows and of neighboring columns, mm.
    pub pitch_mm: Option<[f64; 2]>,
    /// Whether rows, and whether columns, were mirrored before export.
    pub is_mirrored: [Option<bool>; 2],
    /// Further numbers per frame, such as the depth of the indentation.
    pub channels: Vec<Channel>,
    /// What the frames belong to (`load`, `hold`, `unload`), one each; empty if the file does not say.
    pub phases: Vec<String>,
    /// The file's own totals against ours.
    pub checks: Vec<Check>,
    /// What cannot be known from this file, a sentence each.
    pub unknown: Vec<String>,
    /// What a reader should be told, a sentence each.
    pub warnings: Vec<String>,
}

impl PressureMap {
    /// A map without frames.
    pub(crate) fn new(source: Source, unit: PressureUnit, sensels: Vec<Sensel>) -> PressureMap {
        PressureMap {
            name: String::new(),
            source,
            unit,
            sensels,
            time_s: None,
            values: Vec::new(),
            clipped_from: None,
            threshold: None,
            pitch_mm: None,
            is_mirrored: [None; 2],
            channels: Vec::new(),
            phases: Vec::new(),
            checks: Vec::new(),
            unknown: Vec::new(),
            warnings: Vec::new(),
        }
    }

    /// Number of frames.
    pub fn frames(&self) -> usize {
        self.values.len() / self.sensels.len().max(1)
    }

    /// Values of one frame, one per sensel.
    pub fn frame(&self, frame: usize) -> &[f64] {
        let sensels = self.sensels.len();
        &self.values[frame * sensels..(frame + 1) * sensels]
    }

    /// Whether a value stands at the instrument's limit.
    pub fn is_clipped(&self, value: f64) -> bool {
        self.clipped_from.is_some_and(|limit| value >= limit)
    }

    /// Values at the instrument's limit, over all frames.
    pub fn clipped_count(&self) -> usize {
        self.values
            .iter()
            .filter(|value| self.is_clipped(**value))
            .count()
    }

    /// Largest value of one frame, in the map's unit; 0 if all its cells are missing.
    pub fn peak(&self, frame: usize) -> f64 {
        self.frame(frame)
            .iter()
            .copied()
            .filter(|value| !value.is_nan())
            .fold(0.0, f64::max)
    }

    /// Sum over the cells of one frame, in the map's unit; missing cells add nothing.
    pub fn sum(&self, frame: usize) -> f64 {
        self.frame(frame)
            .iter()
            .filter(|value| !value.is_nan())
            .sum()
    }

    /// Normal force on the mat in one frame, N: sum of pressure times area. `None` for uncalibrated values and unknown areas.
    pub fn force_n(&self, frame: usize) -> Option<f64> {
        if self.unit != PressureUnit::Kilopascal {
            return None;
        }
        let mut force = 0.0;
        for (value, sensel) in self.frame(frame).iter().zip(&self.sensels) {
            if !value.is_nan() {
                force += value * sensel.area_mm2? * 1e-3;
            }
        }
        Some(force)
    }

    /// Area of the cells of one frame that read more than `above`, mm2. `None` if an area is unknown.
    pub fn contact_area_mm2(&self, frame: usize, above: f64) -> Option<f64> {
        let mut area = 0.0;
        for (value, sensel) in self.frame(frame).iter().zip(&self.sensels) {
            if *value > above {
                area += sensel.area_mm2?;
            }
        }
        Some(area)
    }

    /// Number of rows and columns and the place of the first of them, if the sensels fill a grid row by row.
    pub fn grid(&self) -> Option<Grid> {
        let [first_row, first_column] = self.sensels.first()?.place?;
        let in_first_row = |sensel: &&Sensel| sensel.place.is_some_and(|[row, _]| row == first_row);
        let columns = self.sensels.iter().take_while(in_first_row).count();
        let is_full = self.sensels.len().is_multiple_of(columns)
            && self.sensels.iter().enumerate().all(|(k, sensel)| {
                let row = first_row as usize + k / columns;
                let column = first_column as usize + k % columns;
                sensel.place == Some([row as u32, column as u32])
            });
        is_full.then(|| Grid {
            first: [first_row, first_column],
            rows: self.sensels.len() / columns,
            columns,
        })
    }

    /// Adds a check, and a warning if it fails.
    pub(crate) fn push_check(&mut self, check: Check) {
        if !check.agrees() {
            self.warnings.push(format!(
                "{check}; the file was changed after export or is damaged"
            ));
        }
        self.checks.push(check);
    }
}

/// A full rectangle of sensels.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Grid {
    /// Row and column of the first sensel.
    pub first: [u32; 2],
    /// Number of rows.
    pub rows: usize,
    /// Number of columns.
    pub columns: usize,
}

/// The sensels of a full grid, row by row, each of the same area.
pub(crate) fn grid_sensels(
    first: [u32; 2],
    size: [usize; 2],
    area_mm2: Option<f64>,
) -> Vec<Sensel> {
    let [rows, columns] = size;
    (0..rows * columns)
        .map(|k| Sensel {
            place: Some([
                first[0] + (k / columns) as u32,
                first[1] + (k % columns) as u32,
            ]),
            area_mm2,
            ..Sensel::default()
        })
        .collect()
}
