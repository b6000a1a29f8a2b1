//! A print as shares of ink by cell.

use super::options::Ink;
use crate::pressure_map::{PressureMap, PressureUnit, grid_sensels};
use crate::source::Source;

/// A print as shares of ink.
#[derive(Debug, Clone, PartialEq)]
pub struct Handprint {
    /// Width and height of the image, pixels.
    pub size_px: [usize; 2],
    /// mm per pixel.
    pub mm_per_px: f64,
    /// Brightness between ink and paper, 0 to 1.
    pub threshold: f64,
    /// Which side of it is ink.
    pub ink: Ink,
    /// Rows and columns of cells; row 0 lies at the lower edge of the image.
    pub cells: [usize; 2],
    /// Side of a cell, mm.
    pub cell_mm: f64,
    /// Share of ink by cell, row by row; NaN where less than half of the cell is paper.
    pub inked: Vec<f64>,
    /// Area of the inked pixels, mm2.
    pub inked_mm2: f64,
    /// What cannot be known from it, a sentence each.
    pub unknown: Vec<String>,
    /// What a reader should know, a sentence each.
    pub warnings: Vec<String>,
}

impl Handprint {
    /// The cells as the sensels of a mat, so that a print is laid where a mat would be; their values are shares of ink.
    pub fn as_map(&self) -> PressureMap {
        let area = Some(self.cell_mm * self.cell_mm);
        let sensels = grid_sensels([0, 0], self.cells, area);
        let mut map = PressureMap::new(Source::default(), PressureUnit::NotStated, sensels);
        map.pitch_mm = Some([self.cell_mm; 2]);
        map.values = self.inked.clone();
        map
    }
}
