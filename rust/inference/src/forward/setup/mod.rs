//! What the mesh model presses: the study's skin, refined where tools touch, and its indenters as surfaces.

pub(crate) mod study_skin;
pub(crate) mod indenter;
pub(crate) mod skin_rim;
pub mod refinement;
