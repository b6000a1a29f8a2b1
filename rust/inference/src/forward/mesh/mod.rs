//! The mesh forward model: every recording's protocol run through the contact model.

pub(crate) mod nuisance;
pub(crate) mod press_key;
pub(crate) mod press_table;
pub(crate) mod at_skin;
pub(crate) mod mat_reading;
pub(crate) mod scan_shapes;
pub mod replay;
pub(crate) mod elastic_lookup;
pub(crate) mod corrected_base;
pub(crate) mod single_press;
pub(crate) mod history_dependent;
pub(crate) mod scan_prediction;
pub mod print_press;
pub(crate) mod instrument_response;
