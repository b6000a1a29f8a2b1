//! The workspace of a press: warm start, last posture, last linear problem, cache of live presses. All scratch is here.

pub mod live_cache;
pub mod posture;
pub mod warm_start;

use thenar_surface::Vec3;

use crate::far_field::Coupled;
use crate::interface::shear_kernel::ShearTables;
use crate::interface::shear_response::Pairs;
use crate::response::quantized_rows::Rounded;
use crate::solve::row_runs::Rows;
use live_cache::{Held, Nears, Shown};
use posture::Seen;
use warm_start::Trail;

/// What one press leaves for the next.
#[derive(Debug, Clone, Default)]
pub struct Memory {
    /// Zone of the last press.
    pub zone: Vec<u32>,
    /// What was solved last, the zone or what of it was not held, and its coupling.
    pub between: Vec<u32>,
    pub coupling: Rows<f32>,
    /// The compliance of those sites, kept for its storage.
    pub compliance: Rows<f32>,
    /// The rows of live presses.
    pub rounded: Rounded,
    /// What was solved last in a live press, and its near coupling.
    pub near: Nears,
    /// In a large skin, the coupling of those sites, and response weight times direction at each of them.
    pub coupled: Coupled,
    pub along: Vec<Vec3>,
    /// Where the last solve ended.
    pub trail: Trail,
    /// The last posture, and what was measured of it.
    pub seen: Seen,
    /// Where the skin was last carried in a live press, and what it met there.
    pub shown: Shown,
    pub held: Held,
    /// Kernels of shear, once friction has needed them.
    pub shear: Option<ShearTables>,
    /// And what they are between the sites that were last in contact.
    pub pairs: Pairs,
}
