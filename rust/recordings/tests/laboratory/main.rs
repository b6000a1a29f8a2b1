//! Files as laboratories write them; all are made here by code, in the layout of the maker's program.
#![allow(clippy::unwrap_used)]

mod bounds;
mod jpk;
mod makers;
mod sheets;
mod tables;
mod workbooks;
