//! A handprint with the solved contact that it is compared with.

use nalgebra::Vector3;

use thenar_inference::observe::measured::Mat;

/// kPa in 1 MPa.
pub(crate) const KPA: f64 = 1e3;

/// A contact as it was solved, in the product's frame; a value per vertex of the skin.
#[derive(Debug, Clone, Copy)]
pub struct Pressed<'a> {
    /// Positions in contact, mm.
    pub positions: &'a [Vector3<f64>],
    /// Area of each vertex, mm2.
    pub areas: &'a [f64],
    /// Normal force, N.
    pub force_n: &'a [f64],
}

impl Pressed<'_> {
    /// Whether skin leaves ink at a vertex: it presses, and with more than that on the mean of its area.
    pub(crate) fn inks(&self, vertex: usize, ink_kpa: f64) -> bool {
        let (force, area) = (self.force_n[vertex], self.areas[vertex]);
        force > 0.0 && KPA * force > ink_kpa * area
    }
}

/// A print and what it is compared with.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PrintCase<'a> {
    /// Its cells as they are said to lie, with rows and columns.
    pub mat: &'a Mat,
    /// Share of ink by cell; NaN where nothing is known.
    pub inked: &'a [f64],
    /// Pressure above which skin leaves ink, kPa.
    pub ink_kpa: f64,
    /// The contact.
    pub pressed: Pressed<'a>,
    /// The contact with the parameters at which a fit began.
    pub before: Option<Pressed<'a>>,
    /// Standard deviation of where the paper lies, mm; None: as laid by hand.
    pub position_mm: Option<f64>,
    /// Region of every vertex, -1 for none, and their names; empty: one region.
    pub regions: (&'a [i32], &'a [String]),
}
