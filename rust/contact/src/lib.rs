//! Gaps, response, contact solve and the fields of a press; knows nothing of files or Blender.
#![doc = include_str!("../README.md")]

pub mod ball;
pub mod parameters;
pub mod effects;
pub mod instrument;

mod contact_state;
mod control;
mod carried;
mod direction;
mod spread;
mod errors;
mod fields;
mod interface;
mod force_control;
mod held;
mod hierarchy;
mod history;
mod linearize;
mod live;
mod material;
mod memory;
mod merged;
mod paper;
mod press;
mod remarks;
mod response;
mod simulate;
mod sites;
mod skin;
mod solve;
mod summary;
mod turned;
mod warning;
mod weld;
mod zone;

pub use control::Control;
pub use effects::ActiveEffect;
pub use errors::ContactError;
pub use history::{Course, Cycle, Demand, Keep, Motion, Protocol, Row, Run, Stand, Step, Walk};
pub use interface::{StickSlip, solve_stick_slip};
pub use material::{Material, Swelling};
pub use press::{
    Contact, Convergence, Drag, ForceTarget, Model, Press, RegionResult, Residual, Shear,
    SkinInput, Start, Unsolved,
};
pub use skin::Skin;
pub use solve::{Solution, solve_dense};
pub use warning::{Grade, Warning};
