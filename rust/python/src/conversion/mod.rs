//! Between Python and Rust: arrays, records, errors, calls that can be cancelled, the end of the process.

pub mod arrays;
pub mod ending;
pub mod errors;
pub mod record;
pub mod running;
