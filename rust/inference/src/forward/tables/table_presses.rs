//! Presses of the mesh model that fill the tables, and the ratio of two tables.

use crate::forward::mesh::replay::Replay;
use thenar_contact::{ActiveEffect, Control, Material};

use crate::errors::InferenceError;
use crate::forward::mesh::press_table::PressTable;
use crate::interpolation::Table;

/// The tools of these places pressed with effects, materials and a number of depths.
///
/// # Errors
/// What the contact model says of a press, or `Cancelled`.
pub fn tables(
    replay: &mut Replay,
    (effects, materials, rungs): (&[ActiveEffect], &[Material], usize),
    (places, control): (&[usize], &Control<'_>),
) -> Result<Vec<PressTable>, InferenceError> {
    replay.set_effects(effects, control)?;
    places
        .iter()
        .map(|&at| {
            control.check().map_err(|_| InferenceError::Cancelled)?;
            replay.ladder((at, rungs), materials, control)
        })
        .collect()
}

/// Logarithm of one table's force over another's at the latter's rungs; at first touch, where both vanish, as at the first rung.
pub(crate) fn ratios(with: &PressTable, without: &PressTable) -> Vec<f64> {
    let stride = (without.roots.len() - 1) / (with.roots.len() - 1);
    let one = |(k, a): (usize, &f64)| {
        let b = without.force[k * stride];
        if *a > 0.0 && b > 0.0 {
            libm::log(a / b)
        } else {
            f64::NAN
        }
    };
    let mut few: Vec<f64> = with.force.iter().enumerate().map(one).collect();
    for k in (0..few.len()).rev() {
        if few[k].is_nan() {
            few[k] = few.get(k + 1).copied().unwrap_or(0.0);
        }
    }
    let smooth = Table::new(&with.roots, few);
    without.roots.iter().map(|root| smooth.at(*root)).collect()
}
