//! A press: skin, product, materials, effects, instrument, protocol, and the contact that comes of it.

pub mod contact;
pub mod contact_records;
pub mod effects;
pub mod instrument;
pub mod material;
pub mod product;
pub mod protocol;
pub mod requests;
pub mod skin;
pub mod walk;
