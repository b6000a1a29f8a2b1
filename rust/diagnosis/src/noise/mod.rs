//! Replicate-based noise model: standard deviation, autocorrelation and between-repeat variance of every channel.

pub mod channel;
pub mod scatter;
pub mod deviations;
pub mod repeat_alignment;
pub mod repeat_deviations;
pub mod restricted_likelihood;
pub mod periodic_component;
pub mod mat_noise;
pub mod scan_noise;
pub mod repeat_scatter;
pub mod mat_smoothing;
pub mod estimate;
pub mod whitening;
#[cfg(test)]
pub mod tests;
