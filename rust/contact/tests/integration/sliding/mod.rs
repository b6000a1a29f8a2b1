//! Tangential force and adhesion: friction, its path, closed cycles without a gain of energy.

mod adhesion;
mod friction;
mod friction_path;
mod passivity;
