//! Replicate-based noise model: standard deviation, autocorrelation and between-repeat variance of every channel.

pub(crate) mod channel;
pub mod correlation;
pub(crate) mod scatter;
pub(crate) mod deviations;
pub(crate) mod hum;
pub(crate) mod noise_shape;
pub(crate) mod repeat_alignment;
pub(crate) mod repeat_deviations;
pub(crate) mod restricted_likelihood;
pub mod periodic_component;
pub(crate) mod maps;
pub(crate) mod repeat_scatter;
pub(crate) mod estimate;
pub(crate) mod whitening;
#[cfg(test)]
pub(crate) mod tests;
