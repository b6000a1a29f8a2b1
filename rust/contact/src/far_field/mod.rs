//! Hierarchical (H2) response of a large skin: near blocks exact, far blocks by skeletons.
//!
//! A nested-basis hierarchical matrix (H2; Hackbusch & Boerm 2002) whose bases are rows of the response itself (skeletons;
//! Cheng et al. 2005), so that any kernel of model layer serves: several thicknesses, cuts, a stiff skin. What is left out of a
//! row is at most `hierarchy::TOLERANCE` of the largest; a direct sum on a sample of sites measures the error.

pub mod hierarchy;
mod cluster_tree;
mod skeletons;
mod cluster_bases;
pub(crate) mod block_kernels;
mod blocks;
mod zone_coupling;
mod preconditioner;
mod matrix_vector;
mod directional;
mod displacement;
#[cfg(test)]
mod tests;

pub use cluster_bases::Clusters;
pub use directional::DirectionalCoupling;
pub use displacement::FarFieldDisplacement;
pub use zone_coupling::{MOST_GIB, ZoneCoupling};
