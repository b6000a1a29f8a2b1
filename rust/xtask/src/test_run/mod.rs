//! `cargo xtask test`, `prove` and `blenders`: steps, their times and counts.

pub mod lives;
pub mod prove;
pub mod steps;
pub mod tally;
pub mod testing;
