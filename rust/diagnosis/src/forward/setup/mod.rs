//! What the mesh model presses: the study's skin, refined where tools touch, and its indenters as surfaces.

pub mod study_skin;
pub mod indenter;
pub mod skin_rim;
pub mod refinement;
