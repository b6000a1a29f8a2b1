//! Friction's state: the shear of one press, and the part of it that the next protocol row needs.

use thenar_surface::Vec3;

use super::shear_response::Place;
use super::stick_slip::{SiteFriction, StickSlipStep};

/// Shear of a press, by site in contact.
#[derive(Debug, Clone)]
pub(crate) struct ShearState {
    /// Index into the zone of the press.
    pub at: Vec<usize>,
    /// Where each is.
    pub places: Vec<Place>,
    /// Largest shear force of each, N.
    pub limit: Vec<f64>,
    /// Travel of the product, mm.
    pub travel: Vec3,
    /// Turn of the product about the center of the contact, rad.
    pub turn: Vec3,
    /// The end of the step.
    pub end: StickSlipStep,
}

/// Memory of friction from step to step.
#[derive(Debug, Clone, Default)]
pub(crate) struct FrictionMemory {
    /// Memory of each site that was in contact, ascending by site.
    pub traces: Vec<(u32, SiteFriction)>,
    /// Travel of the product so far, mm.
    pub travel: Vec3,
    /// Its turn about the center of the contact so far, rad.
    pub turn: Vec3,
    /// Motion of the product against each site by a posture that has moved since, mm; empty if it has not.
    pub strays: Vec<Vec3>,
}
