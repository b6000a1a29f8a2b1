//! How an image is to be read.

/// Length of an inch, mm.
const INCH: f64 = 25.4;

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

/// Number of cells along a side of the image.
pub(super) fn cells_along(pixels: usize, options: &PrintOptions) -> usize {
    let cells = pixels as f64 * options.scale.mm_per_px() / options.cell_mm;
    cells.ceil().max(1.0) as usize
}
