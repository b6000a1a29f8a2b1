//! The tests of `thenar-comparison` from outside, in one binary: `cargo test -p thenar-comparison --test integration NAME::`.
#![allow(clippy::unwrap_used)]

#[path = "../cells/mod.rs"]
mod cells;
mod comparison;
mod location;
mod location_nulls;
#[path = "../made/mod.rs"]
mod made;
mod print_poses;
#[path = "../../../inference/tests/scenes/mod.rs"]
mod scenes;
mod still;
#[path = "../../../inference/tests/synthetic/mod.rs"]
mod synthetic;
