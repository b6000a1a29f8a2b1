//! The workspace of presses: all scratch that one press leaves for the next. Dropping it changes no fresh result.

pub mod live_cache;
pub mod posture;
pub mod problem;
pub mod warm_start;

use crate::interface::shear_kernel::ShearTables;
use crate::interface::shear_response::Pairs;
use crate::response::quantized_rows::QuantizedRows;
use live_cache::{LiveContact, LiveField, NearFields};
use posture::PostureCache;
use problem::ZoneProblem;
use warm_start::WarmStart;

/// Scratch of the presses of one skin.
#[derive(Debug, Clone, Default)]
pub struct Workspace {
    /// The last active zone and its linear problem.
    pub problem: ZoneProblem,
    /// Response rows of live presses.
    pub quantized: QuantizedRows,
    /// Near-field couplings of the last live press.
    pub near: NearFields,
    /// Where the last solve ended.
    pub warm_start: WarmStart,
    /// The last posture, and what was measured of it.
    pub posture: PostureCache,
    /// Displacement field of the last live press.
    pub live_field: LiveField,
    /// Solution of the last live press by site.
    pub live_contact: LiveContact,
    /// Kernels of shear, once friction has needed them.
    pub shear: Option<ShearTables>,
    /// And what they are between the sites that were last in contact.
    pub pairs: Pairs,
}
