//! Resultants of a contact: normal force, total force and moment on the product, center of pressure.

use thenar_surface::{Gap, Vec3};

use crate::interface::shear_result::shear_load;
use crate::press::pressed::Pressed;

/// Sums over a contact, in the frame of the posed positions.
pub struct Resultants {
    /// Sum of the normal forces, N.
    pub normal_force: f64,
    /// Force on the product with shear and adhesion, N.
    pub force: Vec3,
    /// Its moment about the origin, N mm.
    pub moment: Vec3,
    /// Force-weighted mean position of the contact, mm; zero without contact.
    pub center_of_pressure: Vec3,
}

/// Sums normal forces (N) and their touches, the product having moved by `shift` (mm).
pub fn resultants(pressed: &Pressed, touches: &[(f64, &Gap)], shift: Vec3) -> Resultants {
    // A sum of nothing is -0.
    let normal_force: f64 = 0.0 + touches.iter().map(|t| t.0).sum::<f64>();
    let force: Vec3 = touches.iter().map(|(f, g)| -g.normal * *f).sum();
    let (shear_force, shear_moment) = shear_load(pressed, shift);
    let moment = |(f, g): &(f64, &Gap)| (g.closest + shift).cross(&(-g.normal * *f));
    let center: Vec3 = touches.iter().map(|(f, g)| (g.closest + shift) * *f).sum();
    Resultants {
        normal_force,
        force: force + shear_force - pressed.adhesion.force(),
        moment: touches.iter().map(moment).sum::<Vec3>()
            + shear_moment
            + pressed.adhesion.moment(shift),
        center_of_pressure: if normal_force > 0.0 {
            center / normal_force
        } else {
            Vec3::zeros()
        },
    }
}
