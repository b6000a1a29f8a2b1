//! Shear fields of a press by vertex of the mesh as given.

use thenar_surface::Vec3;

use crate::fields::result::Shear;
use crate::press::pressed::Pressed;
use crate::skin::prepare::Skin;

/// The shear of a press; None if no product was dragged over skin with friction. `area` by welded vertex, mm2.
pub(crate) fn shear_fields(skin: &Skin, pressed: &Pressed, area: &[f64]) -> Option<Shear> {
    let sheared = pressed.shear.as_ref()?;
    let n = skin.merged.source.len();
    let (mut force, mut slip) = (vec![Vec3::zeros(); n], vec![Vec3::zeros(); n]);
    let (mut traction, mut margin) = (vec![0.0; n], vec![f64::NAN; n]);
    let mut is_sticking = vec![false; n];
    for (i, &k) in sheared.at.iter().enumerate() {
        let vertex = skin.sites.vertex[pressed.solved.zone[k] as usize] as usize;
        let trace = &sheared.end.traces[i];
        (force[vertex], slip[vertex]) = (trace.force, trace.slip);
        traction[vertex] = trace.force.norm() / area[vertex];
        is_sticking[vertex] = sheared.end.is_sticking[i];
        margin[vertex] = if is_sticking[vertex] {
            1.0 - trace.force.norm() / sheared.limit[i]
        } else {
            0.0
        };
    }
    let welded = &skin.merged.merged_of;
    // Merged vertices bear no force: the one that stands for them bears all.
    let mut by_vertex = vec![Vec3::zeros(); skin.vertices()];
    for (&source, force) in skin.merged.source.iter().zip(&force) {
        by_vertex[source as usize] = *force;
    }
    Some(Shear {
        force: by_vertex,
        traction: welded.iter().map(|&w| traction[w as usize]).collect(),
        slip: welded.iter().map(|&w| slip[w as usize]).collect(),
        margin: welded.iter().map(|&w| margin[w as usize]).collect(),
        is_sticking: welded.iter().map(|&w| is_sticking[w as usize]).collect(),
        total: sheared.end.force(),
        travel: sheared.travel,
        turn: sheared.turn,
        dissipated: sheared.end.dissipated,
        stored: sheared.end.stored,
        residual: sheared.end.residual,
    })
}

/// Shear force on the product and its moment about the origin, with the product moved by `shift` (mm).
pub(crate) fn shear_load(pressed: &Pressed, shift: Vec3) -> (Vec3, Vec3) {
    let Some(sheared) = &pressed.shear else {
        return (Vec3::zeros(), Vec3::zeros());
    };
    let (mut force, mut moment) = (Vec3::zeros(), Vec3::zeros());
    for (&k, trace) in sheared.at.iter().zip(&sheared.end.traces) {
        force -= trace.force;
        moment -= (pressed.solved.touch[k].closest + shift).cross(&trace.force);
    }
    (force, moment)
}
