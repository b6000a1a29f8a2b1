//! What each command does.

pub mod compare;
pub mod diagnose;
pub mod press;
pub mod read;
