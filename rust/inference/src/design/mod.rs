//! Design of the next recording: candidates, profile likelihood, and expected discrimination between two models.

pub mod candidate_recordings;
pub(crate) mod planned_recording;
pub mod profile_likelihood;
pub mod expected_discrimination;
