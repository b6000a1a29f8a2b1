//! A handprint: the image of an inked or scanned print, and the share of ink in every cell of a grid over it.
//!
//! Ink says where skin touched, never how hard. Looking at the inked side, columns count from left to right and rows from the lower
//! edge up, so that a print lies on a product as a mat does.

mod image;
mod ink;
mod cells;

use crate::RecordingError;
use crate::fault::Fault;
use crate::pressure_map::{PressureMap, PressureUnit, Source, grid_sensels};
use std::path::Path;

/// Most cells of a print.
const MOST_CELLS: usize = 1 << 16;
/// Length of an inch, mm.
const INCH: f64 = 25.4;
/// Fewest pixels across a cell: with fewer the edge of the ink is not resolved within it.
const FEWEST_PIXELS: f64 = 3.0;
/// A cell is known if this part of it is paper.
const KNOWN_FROM: f64 = 0.5;
/// A cell touched if this part of it is inked.
pub const TOUCHED_FROM: f64 = 0.5;

/// How long a pixel is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Scale {
    /// Dots per inch.
    Dpi(f64),
    /// mm per pixel.
    MmPerPixel(f64),
    /// Two marks in the image, columns and rows of pixels from its upper left corner, and their distance in mm.
    Marks([[f64; 2]; 2], f64),
}

impl Scale {
    /// mm per pixel.
    pub fn mm_per_px(self) -> f64 {
        match self {
            Scale::Dpi(dpi) => INCH / dpi,
            Scale::MmPerPixel(length) => length,
            Scale::Marks([a, b], distance) => distance / (b[0] - a[0]).hypot(b[1] - a[1]),
        }
    }
}

/// Whether ink is darker or lighter than the paper.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ink {
    /// Dark on light paper.
    Dark,
    /// Light on dark ground, as dust or paint.
    Light,
}

impl Ink {
    /// The words for them.
    pub const NAMES: [&'static str; 2] = ["dark", "light"];

    /// "dark" or "light".
    pub fn name(self) -> &'static str {
        Ink::NAMES[self as usize]
    }

    /// The one of that name.
    pub fn named(name: &str) -> Option<Ink> {
        [Ink::Dark, Ink::Light]
            .into_iter()
            .find(|ink| ink.name() == name)
    }
}

/// How an image is to be read.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PrintOptions {
    /// How long a pixel is.
    pub scale: Scale,
    /// Side of a cell, mm.
    pub cell_mm: f64,
    /// Brightness between ink and paper, 0 black to 1 white; None: Otsu's.
    pub threshold: Option<f64>,
    /// None: the paper is what most of its edge is.
    pub ink: Option<Ink>,
    /// The paper in the image: left, top, right and bottom in pixels from the upper left corner; None: all of it.
    pub paper_px: Option<[f64; 4]>,
    /// True for an image that shows the print from behind, as through glass or after a transfer.
    pub is_mirrored: bool,
}

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
    /// What a reader should be told, a sentence each.
    pub warnings: Vec<String>,
}

impl Handprint {
    /// Reads a PNG, JPEG or TIFF of any depth, gray or color, with or without transparency, which is no paper.
    ///
    /// # Errors
    /// [`RecordingError`] naming the file and the remedy: no image, too large, a scale, cell or threshold that is none, no ink that stands out.
    pub fn read(file: &Path, options: &PrintOptions) -> Result<Handprint, RecordingError> {
        let here = |fault: Fault| fault.in_file(file);
        let gray = image::read(file)?;
        check(&gray, options).map_err(here)?;
        let told = ink::tell(&gray, options).map_err(here)?;
        Ok(cells::count(&gray, &told, options))
    }

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

/// What a threshold must be.
pub(crate) const THRESHOLD_REMEDY: &str = "give a brightness, 0 black to 1 white";

/// Number of cells along a side of the image.
fn cells_along(pixels: usize, options: &PrintOptions) -> usize {
    let cells = pixels as f64 * options.scale.mm_per_px() / options.cell_mm;
    cells.ceil().max(1.0) as usize
}

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
