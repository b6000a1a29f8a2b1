//! The tests of `thenar-recordings` from outside, in one binary: `cargo test -p thenar-recordings --test integration NAME::`.
#![allow(clippy::unwrap_used)]

mod damaged_exports;
#[path = "../exports/mod.rs"]
mod exports;
mod exports_of_makers;
#[path = "../folders/mod.rs"]
mod folders;
mod fuzz;
mod handprints;
#[path = "../inked/mod.rs"]
mod inked;
mod mats_by_uv;
mod meshes;
mod placed_mats;
mod placed_prints;
#[path = "../promises/mod.rs"]
mod promises;
#[path = "../random/mod.rs"]
mod random;
#[path = "../samples/mod.rs"]
mod samples;
mod scans;
mod shared_recordings;
mod studies;
mod study_skin;
mod unreadable_files;
