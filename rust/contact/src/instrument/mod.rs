//! The measuring set-up: mats of sensels, and the errors of sensors, fixtures and clocks.
//!
//! Instrument effects act on predictions, never on the skin. [`observe()`] applies them in a fixed order: `fixture_compliance`
//! (on the motion), `misregistration`, averaging over each sensel ([`Mat`]), `crosstalk`, `gain`, `offset`, `drift`,
//! `saturation`, `threshold`, `dead_cells`, and `timing` (between the channels). Units: mm, N, s, kPa for maps.

mod mat;
mod channel;
mod signals;
mod observe;
pub(crate) mod fixture_compliance;
pub(crate) mod misregistration;
pub(crate) mod crosstalk;
pub(crate) mod gain;
pub(crate) mod offset;
pub(crate) mod drift;
pub(crate) mod saturation;
pub(crate) mod threshold;
pub(crate) mod dead_cells;
pub(crate) mod timing;

pub use mat::contact_loads::loads;
pub(crate) use mat::contact_loads::loads_of;
pub use mat::placement::{Placement, Spot};
pub use mat::{Mat, MatLayout, PointLoad};
pub use observe::{check, observe};
pub use signals::Signals;
