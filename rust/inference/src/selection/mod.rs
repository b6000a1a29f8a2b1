//! Model selection: candidate effects, the ladder of fits, Akaike weights, cross-validation and its negative control.

pub mod scored;
pub mod candidates;
pub(crate) mod candidate_fits;
pub mod ladder;
pub mod form_check;
pub(crate) mod profile_ends;
pub mod profile_interval;
pub mod model_weights;
pub mod cross_validation;
pub mod contact_model_check;
pub(crate) mod contact_model_refit;
pub(crate) mod contact_model_tasks;
pub(crate) mod negative_control;
pub mod empirical_factor;
