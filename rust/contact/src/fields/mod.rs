//! Stage 5: what a designer reads from the solution.

pub mod contact_area;
pub mod patch_peak;
pub mod product_side;
