//! Gaps, response, contact solve and the fields of a press; knows nothing of files or Blender.
#![doc = include_str!("../README.md")]

pub mod effects;
pub mod instrument;
pub mod sphere_indentation;

mod api;
mod control;
mod stage_times;
mod error;
mod skin;
mod workspace;
mod detection;
mod response;
mod far_field;
mod solve;
mod interface;
mod history;
mod press;
mod soft_grip;
mod fields;

pub use api::{Drag, ForceTarget, Model, Press, SkinInput, Start, Unsolved};
pub use control::Control;
pub use effects::ActiveEffect;
pub use error::ContactError;
pub use fields::result::{Contact, Convergence, RegionResult, Residual, Shear};
pub use fields::warnings::{Grade, Warning};
pub use history::{Course, Cycle, Demand, Keep, Motion, Protocol, Row, Run, Stand, Step, Walk};
pub use interface::{StickSlip, solve_stick_slip};
pub use skin::materials::{Material, Swelling};
pub use skin::parameters;
pub use skin::prepare::Skin;
pub use soft_grip::elastomer::{Elastomer, SoftGrip};
pub use soft_grip::presets::{GRIP_PRESETS, GripPreset};
pub use soft_grip::pressed_grip::GripContact;
pub use solve::{Solution, solve_dense};
pub use sphere_indentation as ball;
pub use workspace::warm_start::WarmStart;
pub use workspace::{Pressing, Workspace};
