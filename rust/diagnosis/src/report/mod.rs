//! Reports: comparison.json for machines, and HTML pages with plots for people. Writes no file itself.
//!
//! The page is self-contained: style and figures stand in it, and it refers to nothing outside. The same comparison gives the
//! same bytes.

pub(crate) mod svg;
pub(crate) mod colors;
pub(crate) mod ticks;
pub(crate) mod axes;
pub(crate) mod residual_curves;
pub(crate) mod trend_bars;
pub(crate) mod maps;
pub(crate) mod prints;
pub(crate) mod before_after_plot;
pub(crate) mod tables;
pub(crate) mod sections;
pub(crate) mod comparison_page;
pub(crate) mod comparison_json;
pub(crate) mod diagnosis_page;

pub use comparison_json::comparison_json;
pub use comparison_page::comparison_html;
pub use diagnosis_page::diagnosis_html;
