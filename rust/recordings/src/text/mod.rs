//! Lines, fields, units and times of a text file.

pub mod clock;
pub mod fields;
pub mod lines;
pub mod units;
