//! Location of the mismatch that parameters cannot absorb: scan statistics on the projected residual.

pub mod mismatch;
pub mod protocol_cells;
pub mod censored_residuals;
pub mod residual_sums;
pub mod scan_windows;
pub mod model_error;
pub mod scan_statistic;
pub mod place_estimate;
pub mod sentence;
pub mod locate;
