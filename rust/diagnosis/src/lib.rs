//! From what the parameters leave to a verdict, its findings, and the next recording; reads no files and knows nothing of Blender.
#![doc = include_str!("../README.md")]
#![warn(missing_docs)]

mod wording;
mod track_record;
mod findings;
mod free_numbers;
mod effect_numbers;
mod channels;
mod gates;
mod findings_content;
mod unlisted_finding;
mod unlisted;
mod next_recording;
mod place;
mod verdict_sentence;
mod findings_json;
mod grasp;
mod by_contact_model;
mod diagnose;
#[cfg(test)]
#[path = "../../inference/tests/synthetic_rungs/mod.rs"]
mod synthetic_rungs;

pub use by_contact_model::is_worse_than_without;
pub use diagnose::{DiagnoseOptions, diagnose};
pub use findings::{
    Curve, Diagnosis, Finding, Number, Rival, Suggestion, Switched, Verdict, When, Where,
};
pub use findings_json::findings_json;
pub use thenar_inference::selection::cross_validation::{ContactModelCheck, Gain, Spread};
pub use track_record::{Confidence, Form, Kind, Record};
pub use unlisted_finding::{Correction, Unlisted};
pub use wording::variable_in_words;
