//! The page: what a designer reads first on top, then numbers, then one section for each recording.

use crate::svg::escaped;
use crate::{page_style, sections, tables};
use thenar_comparison::Comparison;

/// A self-contained page, UTF-8.
pub fn comparison_html(comparison: &Comparison) -> String {
    page(comparison, (&comparison.sentence, ""))
}

/// The page with its first sentence and what stands before the comparison.
pub fn page(comparison: &Comparison, (sentence, before): (&str, &str)) -> String {
    let title = match comparison.title.is_empty() {
        true => "Recordings and simulation",
        false => comparison.title.as_str(),
    };
    let title = escaped(title);
    let recordings: String = (0..comparison.recordings.len())
        .map(|number| sections::recording(number, comparison))
        .collect();
    let body = format!(
        "{before}{}{}{}{recordings}{}",
        tables::overview(comparison),
        sections::location(comparison),
        fitted(comparison),
        sections::method(comparison),
    );
    page_style::framed(&title, sentence, &body)
}

/// Estimates, notes and noise.
fn fitted(comparison: &Comparison) -> String {
    let mut html = String::new();
    if !comparison.estimates.is_empty() {
        html += &format!(
            "<section><h2>Fitted numbers</h2>{}<p class='meta'>Line: what is admissible. Bar: 90 % interval. Tick: estimate. Ring: where the fit began.</p></section>\n",
            tables::estimates(&comparison.estimates)
        );
    }
    html += &format!("<section><h2>Noise</h2>{}", tables::noise(comparison));
    html += &sections::list("What a reader should know", &comparison.notes);
    html + "</section>\n"
}
