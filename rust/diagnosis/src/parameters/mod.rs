//! Parameters of the mesh model's fit: bounds, priors, and how they enter the model.

pub mod target;
pub mod estimate;
pub mod parameter;
pub mod bounds_and_priors;
pub mod surrogate_parameter;
pub mod surrogate_priors;
pub mod effect_parameters;
pub mod form_error;
pub mod sensor_pose;
pub mod model_inputs;
