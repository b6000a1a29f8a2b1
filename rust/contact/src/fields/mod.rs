//! Stage 5: fields, totals and warnings of a solved contact.

mod between_vertices;
pub mod contact_area;
pub mod patch_peak;
pub mod merged_vertices;
pub mod product_pressure;
pub mod result;
pub mod resultants;
pub mod summary;
pub mod warning_rules;
pub mod warnings;
