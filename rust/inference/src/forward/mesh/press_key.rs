//! Key of a cached press: the materials and effects that it was computed with.

use thenar_contact::{ActiveEffect, Material};

/// What a ladder depends on.
#[derive(Debug, Clone, PartialEq)]
pub struct Key {
    pub materials: Vec<Material>,
    pub effects: Vec<ActiveEffect>,
}
