//! The tests of `thenar-diagnosis` from outside, in one binary: `cargo test -p thenar-diagnosis --test integration NAME::`.
#![allow(clippy::unwrap_used)]

mod diagnose;
#[path = "../../../inference/tests/scenes/mod.rs"]
mod scenes;
mod shared_recordings;
