//! Result of comparing a handprint with a contact, cell by cell and vertex by vertex.

use thenar_recordings::handprint::TOUCHED_FROM;

use crate::comparison::quantities::WorstPlace;
use crate::prints::contact_areas::residual;
use crate::prints::print_region::PrintRegion;

/// One number of the paper's pose with its 90 % interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PosePart {
    /// mm or rad.
    pub value: f64,
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

/// A print beside its simulation; lists have a value per cell.
#[derive(Debug, Clone, PartialEq)]
pub struct Printed {
    /// Share of ink; NaN where nothing is known.
    pub recorded: Vec<f64>,
    /// Share in simulated contact, the paper in its fitted pose.
    pub simulated: Vec<f64>,
    /// The same with the paper as it is said to lie.
    pub as_laid: Vec<f64>,
    /// Pressure above which skin leaves ink, kPa.
    pub ink_kpa: f64,
    /// How far the paper lies along its columns and its rows from where it is said to (mm), and how it is turned about the middle of the ink
    /// (rad, from columns to rows).
    pub pose: [PosePart; 3],
    /// Overlap in the best pose of the print seen from behind.
    pub mirrored_overlap: f64,
    /// True if that is much better: the image then shows the print from behind.
    pub is_mirrored: bool,
    /// By region of the skin, where there are several.
    pub regions: Vec<PrintRegion>,
    /// Residual by vertex of the skin: 1 inked alone, -1 simulated alone, 0 both or neither, NaN where nothing is known.
    pub on_skin: Vec<f64>,
    /// Part of the simulated force that presses beside the paper.
    pub beside: f64,
    /// True if the pose lies at the end of what is sought: the paper may lie farther off.
    pub is_at_end: bool,
    /// Patches on which only one of the two touches, the largest first.
    pub worst: Vec<WorstPlace>,
}

impl Printed {
    /// Residual by cell, as by vertex: 1 inked alone, -1 simulated alone, 0 both or neither, NaN where nothing is known.
    pub fn by_cell(&self) -> Vec<f64> {
        let cells = self.recorded.iter().zip(&self.simulated);
        let one = |(recorded, simulated): (&f64, &f64)| match recorded.is_nan() {
            true => f64::NAN,
            false => residual([recorded, simulated].map(|share| *share >= TOUCHED_FROM)),
        };
        cells.map(one).collect()
    }
}
