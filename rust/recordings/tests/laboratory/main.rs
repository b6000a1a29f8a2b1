//! Files as laboratories write them; all are made here by code, in the layout of the maker's program.
#![allow(clippy::unwrap_used)]

mod afm;
mod bounds;
mod grasps;
mod jpk;
mod makers;
mod ply;
mod sheets;
mod tables;
mod workbooks;
