//! A product: its triangles turned outward, the boundary of the union of its parts, inside and outside.

pub(crate) mod gap;
pub(crate) mod orientation;
pub(crate) mod cells;
pub(crate) mod union;
pub(crate) mod plain_faces;
pub(crate) mod sign;
pub(crate) mod interior;
pub(crate) mod product;
