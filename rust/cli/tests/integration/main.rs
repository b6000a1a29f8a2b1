//! The tests of `thenar-cli` from outside, in one binary: `cargo test -p thenar-cli --test integration NAME::`.
#![allow(clippy::unwrap_used)]

mod compare;
mod press;
mod prints;
mod protocol;
mod read;
mod refusals;
#[path = "../sheets/mod.rs"]
mod sheets;
