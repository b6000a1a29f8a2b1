//! Protocols and tissue memory: presses that follow one another in time.
//!
//! The force on a site is `f = g * d f_e` (quasi-linear viscoelasticity, Fung 1993, 7.6) with f_e the force an elastic tissue
//! would bear and `u = R f_e`. Over one step, with f_e a ramp, `f = a f_e + b`: a and b follow from the branches. With the
//! unknown `x = f / a` that reads `u = R x - R b / a`, `x >= 0`: the base model's own contact problem, in a posture that is
//! displaced by `-R b / a`, whose forces are then scaled by a. Detection, linearization and solver need know nothing of it.

pub(crate) mod memory_branches;
pub(crate) mod tissue_memory;
pub(crate) mod displaced_posture;
mod protocol;
mod protocol_result;
mod load_cycles;
mod first_touch;
mod row_posture;
mod row_stepper;
mod run_protocol;

pub use load_cycles::Cycle;
pub use protocol::{Demand, Protocol, Row};
pub use protocol_result::{Course, Keep, Step};
pub use row_posture::{Motion, Stand};
pub use row_stepper::Walk;
pub use run_protocol::Run;
