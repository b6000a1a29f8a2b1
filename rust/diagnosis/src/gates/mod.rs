//! Gates of the verdict: what must be seen, beaten and predicted before a name is given, and what could have been seen at all.

pub mod decision;
pub mod pair_gates;
pub mod held_out_gate;
pub mod form_gate;
pub mod size_gate;
pub mod first_touch_gate;
pub mod adequacy_gate;
mod waves_gate;
mod curve_gate;
pub mod detection_limits;
