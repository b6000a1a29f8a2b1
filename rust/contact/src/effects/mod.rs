//! The physics that the base model leaves out: effects with an amplitude, shape numbers and a place, one file each.
//!
//! An effect of amplitude 0 leaves the base model as it is, bit for bit. Effects compose in the fixed order of [`Stage`]:
//! geometry, stiffening, history, interface, instrument; within a stage in the order of [`CATALOGUE`]. What acts on the
//! tissue at all times is worked out once by `tissue`; what remembers is kept by the sibling folder `history`.

pub mod entry;
pub mod active;
pub mod catalogue;
pub(crate) mod tissue;
mod bone;
mod compressibility;
mod stiff_skin;
mod region_coupling;
mod inclusion;
pub(crate) mod stiffening_law;
pub(crate) mod relaxation;
pub(crate) mod drainage;
pub(crate) mod cycle_softening;
pub(crate) mod rate_independent_loss;
pub(crate) mod friction;
pub(crate) mod adhesion;

pub use active::ActiveEffect;
pub use catalogue::{CATALOGUE, Effect};
pub use entry::{Choice, Consequence, Entry, ShapeNumber, Sign, Stage};
