//! Parameters of the mesh model's fit: bounds, priors, and how they enter the model.

pub mod target;
pub mod estimate;
pub(crate) mod priors;
pub(crate) mod parameter;
pub(crate) mod bounds_and_priors;
pub mod surrogate_parameter;
pub mod surrogate_priors;
pub(crate) mod effect_parameters;
pub(crate) mod form_error;
pub(crate) mod sensor_pose;
pub(crate) mod model_inputs;
