//! Parameter vector to model inputs: materials by region, and nuisance parameters by recording.

use thenar_contact::Material;

use crate::forward::mesh::nuisance::Nuisance;
use crate::forward::mesh::replay::Replay;
use crate::parameters::parameter::{Kind, Parameter};

/// The model's own form of a vector of parameters: materials by region, and what belongs to each recording.
pub fn setting(
    replay: &Replay,
    (parameters, at): (&[Parameter], &[f64]),
) -> (Vec<Material>, Vec<Nuisance>) {
    let mut materials = replay.tissue.materials.clone();
    let mut nuisances = vec![Nuisance::none(); replay.place_of.len()];
    for (parameter, at) in parameters.iter().zip(at) {
        match parameter.kind {
            Kind::Tissue(region, number) => *number.of(&mut materials[region]) = libm::exp(*at),
            Kind::Zero(r) => nuisances[r].zero_mm += at,
            Kind::Touch(place) => {
                let of_place = nuisances.iter_mut().zip(&replay.place_of);
                of_place
                    .filter(|(_, p)| **p == place)
                    .for_each(|(n, _)| n.zero_mm += at);
            }
            Kind::Gain(r) => nuisances[r].log_gain += at,
            Kind::InstrumentGain => nuisances.iter_mut().for_each(|n| n.log_gain += at),
            Kind::Pose(r, 2) => nuisances[r].placement.turn_rad = *at,
            Kind::Pose(r, axis) => nuisances[r].placement.shift_mm[axis] = *at,
            Kind::Scan(r, axis) => nuisances[r].scan[axis] = *at,
            Kind::Counts(r) => nuisances[r].log_counts = *at,
            Kind::Effect(..) => {}
            Kind::Form(place, knot) => {
                let of_place = nuisances.iter_mut().zip(&replay.place_of);
                of_place
                    .filter(|(_, p)| **p == place)
                    .for_each(|(n, _)| n.form[knot] = *at);
            }
            Kind::ForceZero(r) => nuisances[r].force_zero_n = *at,
        }
    }
    (materials, nuisances)
}
