//! What defines an effect: its catalogue entry, and an effect that is switched on.

pub mod active;
pub mod entry;
