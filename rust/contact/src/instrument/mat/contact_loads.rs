//! A solved contact as point loads on a mat, in the product's frame.

use thenar_surface::Vec3;

use super::PointLoad;
use crate::Contact;
use crate::press::pressed::Pressed;
use crate::skin::prepare::Skin;

/// The loads of a contact on a mat that lies on the product as it was given: `posed` are the positions that were pressed
/// (mm, one per vertex), the product having moved by the contact's own offset along its direction.
///
/// A contact solved in a protocol that slides besides needs `posed` less the slide of its row.
pub fn loads(contact: &Contact, posed: &[Vec3]) -> Vec<PointLoad> {
    let shift = contact.direction * contact.offset;
    let load = |(vertex, position): (usize, &Vec3)| {
        let (force, pressure) = (contact.nodal_force[vertex], contact.pressure[vertex]);
        (force > 0.0).then(|| PointLoad {
            position: position + contact.displacement[vertex] - shift,
            force_n: force,
            area_mm2: if pressure > 0.0 {
                force / pressure
            } else {
                0.0
            },
        })
    };
    posed.iter().enumerate().filter_map(load).collect()
}

/// The loads of a press on the product's surface.
pub(crate) fn loads_of(skin: &Skin, pressed: &Pressed) -> Vec<PointLoad> {
    let solved = &pressed.solved;
    let load = |(k, &site): (usize, &u32)| {
        (solved.force[k] > 0.0).then(|| PointLoad {
            position: solved.touch[k].closest,
            force_n: solved.force[k],
            area_mm2: skin.sites.area[site as usize],
        })
    };
    solved.zone.iter().enumerate().filter_map(load).collect()
}
