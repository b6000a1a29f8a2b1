//! Comparisons and diagnoses as pages with plots and as JSON; writes no file itself and knows nothing of how numbers were found.
#![doc = include_str!("../README.md")]
#![warn(missing_docs)]

mod svg;
mod colors;
mod ticks;
mod axes;
mod plots;
mod maps;
mod page_style;
mod prints;
mod tables;
mod sections;
mod comparison_page;
mod comparison_json;
mod diagnosis_page;

pub use comparison_json::comparison_json;
pub use comparison_page::comparison_html;
pub use diagnosis_page::diagnosis_html;
