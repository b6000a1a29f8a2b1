//! A handprint: the image of an inked or scanned print, and the share of ink in every cell of a grid over it.
//!
//! Ink says where skin touched, never how hard. Looking at the inked side, columns count from left to right and rows from the lower
//! edge up, so that a print lies on a product as a mat does.

mod cells;
mod image;
mod ink;
mod options;
mod print;

use crate::RecordingError;
use crate::fault::Fault;
use options::cells_along;
use std::path::Path;

pub use options::{Ink, PrintOptions, Scale};
pub use print::Handprint;

/// Most cells of a print.
const MOST_CELLS: usize = 1 << 16;
/// Fewest pixels across a cell: with fewer the edge of the ink is not resolved within it.
const FEWEST_PIXELS: f64 = 3.0;
/// A cell touched if this part of it is inked.
pub const TOUCHED_FROM: f64 = 0.5;

impl Handprint {
    /// Reads a PNG, JPEG or TIFF of any depth, gray or color, with or without transparency, which is no paper.
    ///
    /// # Errors
    /// [`RecordingError`] naming the file and the remedy: no image, too large, a scale, cell or threshold that is none, no ink that stands out.
    pub fn read(file: &Path, options: &PrintOptions) -> Result<Handprint, RecordingError> {
        let here = |fault: Fault| fault.in_file(file);
        let gray = image::read(file)?;
        check(&gray, options).map_err(here)?;
        let parted = ink::part(&gray, options).map_err(here)?;
        Ok(cells::count(&gray, &parted, options))
    }
}

/// What a threshold must be.
pub(crate) const THRESHOLD_REMEDY: &str = "give a brightness, 0 black to 1 white";

fn check(gray: &image::Gray, options: &PrintOptions) -> Result<(), Fault> {
    let mm = options.scale.mm_per_px();
    if !(mm.is_finite() && mm > 0.0) {
        return Err(Fault::file(
            "the image has no scale: its marks lie on one pixel, or their distance is none".into(),
            "give dpi, mm_per_px, or two marks_px that lie apart with marks_mm",
        ));
    }
    // Three pixels of 0.1 mm are a little more than 0.3 mm in binary.
    let is_resolved = options.cell_mm.is_finite() && options.cell_mm / mm >= FEWEST_PIXELS - 1e-9;
    if !is_resolved {
        let problem = format!(
            "a cell of {:.3} mm is {:.1} pixels wide, and {FEWEST_PIXELS} are needed",
            options.cell_mm,
            options.cell_mm / mm
        );
        return Err(Fault::file(
            problem,
            "scan with more dpi, check the scale, or give a larger cell_mm",
        ));
    }
    if let Some(other) = options.threshold.filter(|t| !(0.0..=1.0).contains(t)) {
        return Err(Fault::file(
            format!("the threshold is {other}"),
            THRESHOLD_REMEDY,
        ));
    }
    let [columns, rows] = gray.size.map(|pixels| cells_along(pixels, options) as f64);
    if columns * rows > MOST_CELLS as f64 {
        let problem = format!(
            "the image is {:.0} x {:.0} mm, {columns:.0} x {rows:.0} cells, and {MOST_CELLS} cells are read",
            gray.size[0] as f64 * mm,
            gray.size[1] as f64 * mm
        );
        return Err(Fault::file(
            problem,
            "check the scale, cut the image to the print, or give a larger cell_mm",
        ));
    }
    Ok(())
}
