//! Plots of the pages.

pub mod before_after_plot;
pub mod residual_curves;
pub mod trend_bars;
