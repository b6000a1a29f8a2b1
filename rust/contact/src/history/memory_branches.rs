//! Memory branches of the tissue (generalized Maxwell), each with its clock: time, drainage or travel.

use crate::effects::definition::active::in_order;
use crate::effects::layer_drainage::LayerDrainage;
use crate::effects::{ActiveEffect, Effect, drainage, rate_independent_loss, relaxation};

/// What makes a branch fade.
#[derive(Debug, Clone, PartialEq)]
pub enum Clock {
    /// Time, s.
    Time,
    /// D t / a^2 of the region's contact.
    Drainage(ActiveEffect),
    /// Drainage of a layer, at a time so many standard deviations from its middle.
    Layer(LayerDrainage, f64),
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

/// The branches of `effects` on tissue of that thickness by region (mm), and by region the share of the force that never fades.
///
/// Effects act one after the other in the catalogue's order, each on what those before it leave for good, so that the
/// shares sum to 1 for any amplitudes.
pub fn branches(effects: &[ActiveEffect], thickness: &[f64]) -> (Vec<Branch>, Vec<f64>) {
    let regions = thickness.len();
    let mut lasting = vec![1.0; regions];
    let mut branches = Vec::new();
    for effect in in_order(effects) {
        let of_layer = LayerDrainage::of(effect, thickness);
        let timed = |clock: Clock| move |(weight, period)| (weight, period, clock.clone());
        let parts: Vec<(f64, f64, Clock)> = match (effect.effect, &of_layer) {
            (Effect::Relaxation, _) => {
                let parts = relaxation::branches(effect).into_iter();
                parts.map(timed(Clock::Time)).collect()
            }
            (Effect::Drainage, Some(layer)) => {
                let parts = layer.branches().into_iter();
                let timed = |(weight, z)| (weight, 1.0, Clock::Layer(layer.clone(), z));
                parts.map(timed).collect()
            }
            (Effect::Drainage, None) => {
                let parts = drainage::branches().into_iter();
                parts.map(timed(Clock::Drainage(effect.clone()))).collect()
            }
            (Effect::RateIndependentLoss, _) => {
                let length = rate_independent_loss::length(effect);
                vec![(1.0, length, Clock::Travel)]
            }
            _ => continue,
        };
        let most = |region: usize| match (effect.effect, &of_layer) {
            (Effect::Drainage, Some(layer)) => layer.drop(region),
            (Effect::Drainage, None) => drainage::drop(effect),
            _ => 1.0,
        };
        let fading: Vec<f64> = (0..regions)
            .map(|region| most(region) * effect.amplitude_on(region as u32))
            .collect();
        for (weight, period, clock) in parts {
            let share = lasting
                .iter()
                .zip(&fading)
                .map(|(l, f)| l * f * weight)
                .collect();
            branches.push(Branch {
                share,
                period,
                clock,
            });
        }
        lasting
            .iter_mut()
            .zip(&fading)
            .for_each(|(l, f)| *l *= 1.0 - f);
    }
    (branches, lasting)
}
