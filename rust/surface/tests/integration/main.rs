//! The tests of `thenar-surface` from outside, in one binary: `cargo test -p thenar-surface --test integration NAME::`.
#![allow(clippy::unwrap_used)]

mod bad_meshes;
mod cut_by_a_rim;
mod invariance;
#[path = "../shapes/mod.rs"]
mod shapes;
mod signed_distance;
mod skin;
mod thin_walls;
mod unions;
