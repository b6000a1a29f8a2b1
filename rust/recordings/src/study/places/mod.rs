//! Where sensels lie on a product.

pub mod charts;
pub mod seat;
pub mod sensels;
