//! Soft grips: elastomers and foams bonded to a rigid core, pressed together with the skin.
//!
//! A grip of thickness h yields under pressure as a bonded elastic layer does (Johnson, Contact Mechanics 5.8), along the
//! normal of its surface. Skin and grip bear one pressure at each place, so that their compliances add in one contact problem.

pub mod disc_kernel;
pub mod elastomer;
pub mod joint_compliance;
pub mod presets;
pub mod pressed_grip;
pub mod yielding;
