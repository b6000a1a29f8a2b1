//! From the field to triangles: extraction near the skin, then an isotropic remesh projected back onto the field.

mod edit;
mod extract;
mod polish;
mod remesh;
mod soup;
mod topology;

pub(crate) use extract::extract;
pub(crate) use remesh::remesh;
pub(crate) use soup::Soup;
