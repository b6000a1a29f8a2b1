//! Tables of elastic presses that the surrogate interpolates, with and without effects that change the response.

pub mod elastic_table;
pub mod table_presses;
pub mod sphere;
pub mod stiff_skin;
pub mod elastic;
