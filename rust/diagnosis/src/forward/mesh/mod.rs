//! The mesh forward model: every recording's protocol run through the contact model.

pub mod nuisance;
pub mod press_key;
pub mod press_table;
pub mod at_skin;
pub mod mat_reading;
pub mod scan_shapes;
pub mod replay;
pub mod elastic_lookup;
pub mod single_press;
pub mod history_dependent;
pub mod scan_prediction;
pub mod print_press;
pub mod instrument_response;
