//! Memory branches of the tissue (generalized Maxwell), each with its clock: time, drainage or travel.

use crate::effects::definition::active::in_order;
use crate::effects::{ActiveEffect, Effect, drainage, rate_independent_loss, relaxation};

/// What makes a branch fade.
#[derive(Debug, Clone, PartialEq)]
pub enum Clock {
    /// Time, s.
    Time,
    /// D t / a^2 of the region's contact.
    Drainage(ActiveEffect),
    /// Travel of the region's largest depth, mm.
    Travel,
}

/// Force that fades as `exp(-clock / period)`.
#[derive(Debug, Clone, PartialEq)]
pub struct Branch {
    /// Share of the elastic force, by region.
    pub share: Vec<f64>,
    /// In units of the clock.
    pub period: f64,
    /// What makes it fade.
    pub clock: Clock,
}

/// The branches of `effects`, and by region the share of the force that never fades.
///
/// Effects act one after the other in the catalogue's order, each on what those before it leave for good, so that the
/// shares sum to 1 for any amplitudes.
pub fn branches(effects: &[ActiveEffect], regions: usize) -> (Vec<Branch>, Vec<f64>) {
    let mut lasting = vec![1.0; regions];
    let mut branches = Vec::new();
    for effect in in_order(effects) {
        let (clock, most, parts) = match effect.effect {
            Effect::Relaxation => (Clock::Time, 1.0, relaxation::branches(effect)),
            Effect::Drainage => {
                let drop = drainage::drop(effect);
                (Clock::Drainage(effect.clone()), drop, drainage::branches())
            }
            Effect::RateIndependentLoss => {
                let length = rate_independent_loss::length(effect);
                (Clock::Travel, 1.0, vec![(1.0, length)])
            }
            _ => continue,
        };
        let fading: Vec<f64> = (0..regions)
            .map(|region| most * effect.amplitude_on(region as u32))
            .collect();
        for (weight, period) in parts {
            let share = lasting
                .iter()
                .zip(&fading)
                .map(|(l, f)| l * f * weight)
                .collect();
            branches.push(Branch {
                share,
                period,
                clock: clock.clone(),
            });
        }
        lasting
            .iter_mut()
            .zip(&fading)
            .for_each(|(l, f)| *l *= 1.0 - f);
    }
    (branches, lasting)
}
