//! Soft grips: elastomers and foams bonded to a rigid core, pressed together with the skin.
//!
//! A grip of thickness h yields under pressure as a bonded elastic layer does (Johnson, Contact Mechanics 5.8), along the
//! normal of its surface. The press finds the pressure at which skin and grip, each moved by it, touch: the product's mesh
//! is moved by what the grip yields and pressed again until both agree.

pub mod disc_kernel;
pub mod elastomer;
pub mod fixed_point;
pub mod presets;
pub mod pressed_grip;
pub mod yielding;
