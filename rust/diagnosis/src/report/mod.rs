//! A comparison as files: comparison.json for machines, and a page with plots for people. Writes no file itself.
//!
//! The page is self-contained: style and figures stand in it, and it refers to nothing outside. The same comparison gives the
//! same bytes.

mod colors;
mod svg;
mod ticks;
mod traces;
mod axes;
mod curves;
mod bars;
mod maps;
mod prints;
mod tables;
mod sections;
mod page;
mod json;
mod diagnosis;

pub use diagnosis::diagnosis_html;
pub use json::comparison_json;
pub use page::comparison_html;
