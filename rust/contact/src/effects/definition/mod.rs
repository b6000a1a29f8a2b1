//! What an effect is: its entry in the catalogue, and one that is switched on.

pub mod active;
pub mod entry;
