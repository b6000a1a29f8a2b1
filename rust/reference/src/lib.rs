//! Reference solve of a press: soft tissue between skin and bone as a solid at finite strain.
#![doc = include_str!("../README.md")]
#![warn(missing_docs)]
// Tensors are arrays over axes; an index over several of them reads better than zipped iterators.
#![allow(clippy::needless_range_loop)]

mod bone;
mod cut;
mod error;
mod factor;
mod matrix3;
mod newton;
mod obstacle;
mod pattern;
mod press;
mod prism_energy;
mod prisms;
mod refine;
mod strain_energy;
mod result;
mod tissue;

pub use bone::{RestHand, Segment, bone_points};
pub use error::ReferenceError;
pub use press::{Progress, Settings, press};
pub use result::ReferenceContact;
pub use tissue::Tissue;
