//! The tests of `thenar-report` from outside, in one binary: `cargo test -p thenar-report --test integration NAME::`.
#![allow(clippy::unwrap_used)]

#[path = "../../../comparison/tests/cells/mod.rs"]
mod cells;
#[path = "../../../comparison/tests/made/mod.rs"]
mod made;
mod print_patches;
mod prints;
mod report;
mod scans;
#[path = "../../../inference/tests/scenes/mod.rs"]
mod scenes;
