//! The result of a protocol: force, area and pressure against time.

use thenar_surface::Vec3;

use crate::Contact;
use crate::instrument::PointLoad;

/// What to keep of every step besides its totals.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Keep {
    /// Nothing more.
    Totals,
    /// Pressure of the vertices in contact.
    Pressure,
    /// Loads on the product, for a mat that lies on it.
    Loads,
}

/// One step.
#[derive(Debug, Clone, PartialEq)]
pub struct Step {
    /// Time, s.
    pub time_s: f64,
    /// Travel of the product along the direction from where it was given, mm.
    pub offset: f64,
    /// Normal force on the skin along the direction, N.
    pub force: f64,
    /// Force on the product, N, with that of friction. The skin bears the opposite.
    pub total_force: Vec3,
    /// Shear force on the skin, N.
    pub shear: Vec3,
    /// Energy that slip has turned into heat since the first row, N mm.
    pub slip_loss: f64,
    /// Contact area, mm2.
    pub area: f64,
    /// Largest vertex pressure, MPa.
    pub peak_pressure: f64,
    /// Normal force by region, N.
    pub region_force: Vec<f64>,
    /// Work done on the skin since the first row, N mm.
    pub work: f64,
    /// Pressure (MPa) by vertex where there is contact; empty unless it was to be kept.
    pub pressure: Vec<(u32, f64)>,
    /// What presses on the product, in its own frame; empty unless it was to be kept.
    pub loads: Vec<PointLoad>,
    /// True if the solve converged, and adhesion with it.
    pub has_converged: bool,
}

/// The result of a protocol.
#[derive(Debug, Clone, PartialEq)]
pub struct Course {
    /// One step a row.
    pub steps: Vec<Step>,
    /// Unit direction of travel.
    pub direction: Vec3,
    /// Travel at which the product first touches the skin, mm; None where the protocol did not need it.
    pub touch_offset: Option<f64>,
    /// The contact at the last row, in full.
    pub last: Contact,
}

impl Course {
    /// Forces along the direction, N.
    pub fn forces(&self) -> Vec<f64> {
        self.steps.iter().map(|step| step.force).collect()
    }
}
