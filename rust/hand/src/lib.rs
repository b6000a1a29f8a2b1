//! A parametric hand made from published measurements; knows nothing of forces.
#![doc = include_str!("../README.md")]

mod anatomy;
mod armature;
mod build;
mod error;
mod flesh;
mod pose;
mod proportions;
mod regions;
mod size;
mod skeleton;
mod skin;
mod weights;

pub use armature::{Bone, Limits};
pub use build::Hand;
pub use error::HandError;
pub use pose::JointTurn;
pub use regions::{
    FINGER_THICKNESS_MM, NO_REGION, PALM_THICKNESS_MM, REGION_NAMES, RegionKind, region_kinds,
};
pub use size::{HandShape, Sex, Side, Survey, hand_breadth, hand_length};
pub use weights::VertexWeights;
