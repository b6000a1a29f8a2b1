//! The tests of `thenar-inference` from outside, in one binary: `cargo test -p thenar-inference --test integration NAME::`.
#![allow(clippy::unwrap_used)]

mod fit_curves;
mod fit_effects;
mod fit_maps;
mod map_normals;
mod model_weights;
#[path = "../scenes/mod.rs"]
mod scenes;
#[path = "../synthetic_rungs/mod.rs"]
mod synthetic_rungs;
