//! Physics beyond the base model: effects with an amplitude, shape numbers and a place, one file each.
//!
//! An effect of amplitude 0 leaves the base model as it is, bit for bit. Effects compose in the fixed order of [`Stage`]:
//! geometry, stiffening, history, interface, instrument; within a stage in the order of [`CATALOGUE`]. What acts on the
//! tissue at all times is composed once by `skin::tissue`; memory of earlier steps is kept by `history`.

pub mod definition;
pub mod catalogue;
pub(crate) mod bone;
pub(crate) mod compressibility;
pub(crate) mod stiff_skin;
pub(crate) mod region_coupling;
pub(crate) mod inclusion;
pub(crate) mod stiffening_law;
pub(crate) mod relaxation;
pub(crate) mod drainage;
pub mod layer_drainage;
pub(crate) mod cycle_softening;
pub(crate) mod rate_independent_loss;
pub(crate) mod friction;
pub(crate) mod adhesion;

pub use catalogue::CATALOGUE;
pub use definition::active::ActiveEffect;
pub use definition::entry::Effect;
pub use definition::entry::{Choice, Consequence, Entry, ShapeNumber, Sign, Stage};
