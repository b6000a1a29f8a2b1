//! Tables of elastic presses that the surrogate interpolates, with and without effects that change the response.

pub(crate) mod form_ways;
pub mod elastic_table;
pub(crate) mod table_presses;
pub(crate) mod sphere;
pub mod stiff_skin;
pub mod elastic;
