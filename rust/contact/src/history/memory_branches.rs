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
    /// In units of the clock.
    pub period: f64,
    /// What makes it fade.
    pub clock: Clock,
    /// Part of what its effect makes fade.
    weight: f64,
    /// Number of its effect among those of [`Branches`].
    of: usize,
}

/// What an effect makes fade of the force that those before it leave.
#[derive(Debug, Clone, PartialEq)]
struct Fading {
    /// Share, by region; of a layer that drains, over the share of all its load.
    share: Vec<f64>,
    layer: Option<LayerDrainage>,
}

/// The branches of all effects, and what they have of the force.
#[derive(Debug, Clone, PartialEq)]
pub struct Branches {
    /// Each one.
    pub all: Vec<Branch>,
    effects: Vec<Fading>,
    regions: usize,
}

/// What fades and what lasts of the elastic force.
#[derive(Debug, Clone, PartialEq)]
pub struct Shares {
    /// By branch and region.
    pub fading: Vec<Vec<f64>>,
    /// What never fades, by region.
    pub lasting: Vec<f64>,
}

impl Branches {
    /// Those of `effects` on tissue of that thickness by region, mm.
    pub fn new(effects: &[ActiveEffect], thickness: &[f64]) -> Branches {
        let regions = thickness.len();
        let mut branches = Branches {
            all: Vec::new(),
            effects: Vec::new(),
            regions,
        };
        for effect in in_order(effects) {
            let layer = LayerDrainage::of(effect, thickness);
            let timed = |clock: Clock| move |(weight, period)| (weight, period, clock.clone());
            let (most, parts): (f64, Vec<(f64, f64, Clock)>) = match (effect.effect, &layer) {
                (Effect::Relaxation, _) => {
                    let parts = relaxation::branches(effect).into_iter();
                    (1.0, parts.map(timed(Clock::Time)).collect())
                }
                (Effect::Drainage, Some(layer)) => {
                    let parts = layer.branches().into_iter();
                    let timed = |(weight, z)| (weight, 1.0, Clock::Layer(layer.clone(), z));
                    (1.0, parts.map(timed).collect())
                }
                (Effect::Drainage, None) => {
                    let parts = drainage::branches().into_iter();
                    let clock = Clock::Drainage(effect.clone());
                    (drainage::drop(effect), parts.map(timed(clock)).collect())
                }
                (Effect::RateIndependentLoss, _) => {
                    let length = rate_independent_loss::length(effect);
                    (1.0, vec![(1.0, length, Clock::Travel)])
                }
                _ => continue,
            };
            let of = branches.effects.len();
            let branch = |(weight, period, clock)| Branch {
                period,
                clock,
                weight,
                of,
            };
            branches.all.extend(parts.into_iter().map(branch));
            let share = (0..regions).map(|region| most * effect.amplitude_on(region as u32));
            branches.effects.push(Fading {
                share: share.collect(),
                layer,
            });
        }
        branches
    }

    /// True if what fades depends on the contact's size.
    pub fn is_sized(&self) -> bool {
        self.effects.iter().any(|effect| effect.layer.is_some())
    }

    /// What fades and what lasts under contacts of that radius by region, mm.
    ///
    /// Effects act one after the other in the catalogue's order, each on what those before it leave for good, so that the
    /// shares sum to 1 for any amplitudes.
    pub fn shares(&self, radius: &[f64]) -> Shares {
        let mut lasting = vec![1.0; self.regions];
        let mut fading = Vec::with_capacity(self.all.len());
        for (number, effect) in self.effects.iter().enumerate() {
            let drop = |(region, share): (usize, &f64)| match &effect.layer {
                Some(layer) => share * layer.drop(region, radius[region]),
                None => *share,
            };
            let fades: Vec<f64> = effect.share.iter().enumerate().map(drop).collect();
            for branch in self.all.iter().filter(|branch| branch.of == number) {
                let both = lasting.iter().zip(&fades);
                fading.push(both.map(|(l, f)| l * f * branch.weight).collect());
            }
            let both = lasting.iter_mut().zip(&fades);
            both.for_each(|(l, f)| *l *= 1.0 - f);
        }
        Shares { fading, lasting }
    }
}
