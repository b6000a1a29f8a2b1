//! The tests of `thenar-hand` from outside, in one binary: `cargo test -p thenar-hand --test integration NAME::`.

mod hunt;
#[path = "../measuring/mod.rs"]
mod measuring;
mod rig;
mod sizes;
mod skin;
