//! The tests of `thenar-contact` from outside, in one binary: `cargo test -p thenar-contact --test integration NAME::`.
#![allow(clippy::unwrap_used)]

mod ball;
mod cycles;
mod effect_all;
mod effect_geometry;
mod far_field;
mod folded_skin;
mod hertz;
mod instrument;
mod live;
mod merged_vertices;
mod press;
mod protocol_rows;
#[path = "../scenes/mod.rs"]
mod scenes;
mod sliding;
mod titles_and_progress;
mod warning_grades;
