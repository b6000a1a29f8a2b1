//! Drainage of a layer over bone: how much drains, how fast, and over how wide a range of times, by contact radius over thickness.
//!
//! A sphere's contact on a bonded layer loses more of its force than on a half space, since what keeps its volume can hardly give way there:
//! of the undrained force `(1 - drop) exp(-m a / h)` stays, with `m = 0.55 (1 - 2 nu)^0.43` for a drained Poisson's ratio nu (within 0.02 of the
//! force of `sphere_indentation` for a up to 2 h). Fluid gets out to the sides alone, past what drains there as well: the times grow less than as
//! a^2, the less the more is given up, and lie the closer together the wider the contact. Both laws are fits to finite elements of
//! pads (`python -m trial.finite_elements.against_drainage` in `tests`); Hu, Chan, Vlassak & Suo 2011 (J Appl Phys 110:086103) give the curves of layers
//! that slide on their base.

use super::definition::active::ActiveEffect;
use super::definition::entry::Effect;
use super::drainage::{CURVE, DIFFUSIVITY, DRAINED, LAYER, RADIUS, SPREAD};

/// Power of the contact's radius with which times grow: for small shares, and less by this for a share of 1; its bounds.
const GROWS: (f64, f64) = (1.6, 1.4);
const MOST_GROWS: (f64, f64) = (1.0, 2.0);
/// What the spread loses as the contact grows by a factor e: the wider it is, the more alike are the ways out.
pub const NARROWS: f64 = 0.3;
/// Time, in a^2 / D, of the half space's main exponential: that of the middle of a layer's times.
pub const MIDDLE: f64 = 0.605;
/// m of a layer that gives up all volume, and the power of 1 - 2 nu.
const THINS: (f64, f64) = (0.55, 0.43);
/// Contact of reference over the thickness from which times are wholly a layer's: about the smallest to which the law was fitted (0.28).
const FROM: f64 = 0.3;
/// Widest contact, over the thickness, to which the share is known.
const WIDEST: f64 = 2.0;
/// Spread below which times come no closer together.
const LEAST_SPREAD: f64 = 0.05;
/// Least radius of a contact, over the reference: one vertex has none.
const LEAST: f64 = 0.1;

/// Power of the contact's radius with which the time of drainage grows where it takes a share of the load.
pub fn growth(share: f64) -> f64 {
    (GROWS.0 - GROWS.1 * share).clamp(MOST_GROWS.0, MOST_GROWS.1)
}

/// Part of the force that a sphere's contact on a layer of a thickness loses in the end (mm both; of infinite thickness a half space). A
/// contact wider than two thicknesses counts as one of that width.
pub fn drop_of_layer(drained_poisson_ratio: f64, (radius, thickness): (f64, f64)) -> f64 {
    let bare = 0.5 / (1.0 - drained_poisson_ratio);
    1.0 - bare * libm::exp(-thins(drained_poisson_ratio, (radius, thickness)))
}

/// `m a / h`.
fn thins(drained_poisson_ratio: f64, (radius, thickness): (f64, f64)) -> f64 {
    let share = (radius / thickness).min(WIDEST);
    THINS.0 * libm::pow(1.0 - 2.0 * drained_poisson_ratio, THINS.1) * share
}

/// The law in a region whose tissue is a layer.
#[derive(Debug, Clone, PartialEq)]
pub struct LayerDrainage {
    effect: ActiveEffect,
    /// By region, mm.
    thickness: Vec<f64>,
}

impl LayerDrainage {
    /// None where the effect's curve is that of a half space.
    pub fn of(effect: &ActiveEffect, thickness: &[f64]) -> Option<LayerDrainage> {
        let is_it = effect.effect == Effect::Drainage && effect.chosen[CURVE] == LAYER;
        is_it.then(|| LayerDrainage {
            effect: effect.clone(),
            thickness: thickness.to_vec(),
        })
    }

    /// Share of the force that drains in the end under a contact of that radius, mm.
    pub fn drop(&self, region: usize, radius: f64) -> f64 {
        drop_of_layer(self.effect.shape[DRAINED], (radius, self.thickness[region]))
    }

    /// Weight, and place in standard deviations, of each of a layer's times.
    pub fn branches(&self) -> Vec<(f64, f64)> {
        let all: f64 = NODES.iter().map(|(_, weight)| weight).sum();
        NODES.iter().map(|(z, w)| (w / all, *z)).collect()
    }

    /// By how much `seconds` under a contact of that radius (mm) take the time at `z` standard deviations on, in its own units.
    pub fn progress(&self, (region, z): (usize, f64), seconds: f64, radius: f64) -> f64 {
        let [diffusivity, spread, reference] =
            [DIFFUSIVITY, SPREAD, RADIUS].map(|n| self.effect.shape[n]);
        if radius <= 0.0 {
            return 0.0;
        }
        let size = (radius / reference).max(LEAST);
        // Of a layer, from a half space's: by how wide the contact of reference is against the thickness.
        let layer = (reference / (FROM * self.thickness[region])).min(1.0);
        let share = self.effect.amplitude_on(region as u32) * self.drop(region, reference);
        let grows = MOST_GROWS.1 + layer * (growth(share) - MOST_GROWS.1);
        let narrowed = spread - layer * NARROWS * libm::log(size);
        let spread = narrowed.max(LEAST_SPREAD.min(spread));
        let time = MIDDLE * reference * reference / diffusivity * libm::pow(size, grows);
        seconds / (time * libm::exp(spread * z))
    }
}

/// A normal law of mean 0 and variance 1 at even steps: places, and weights that do not sum to 1.
pub const NODES: [(f64, f64); 7] = [
    (-3.0 * STEP, TAILS[2]),
    (-2.0 * STEP, TAILS[1]),
    (-STEP, TAILS[0]),
    (0.0, 1.0),
    (STEP, TAILS[0]),
    (2.0 * STEP, TAILS[1]),
    (3.0 * STEP, TAILS[2]),
];
/// Step between them: 3/4, widened by what the cut tails take from the variance.
const STEP: f64 = 0.773_9;
/// `exp(-z^2 / 2)` at z = 3/4, 3/2 and 9/4.
const TAILS: [f64; 3] = [0.754_84, 0.324_65, 0.079_56];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::drainage::drop;

    fn of(thickness: f64, reference: f64) -> LayerDrainage {
        let effect = ActiveEffect::named("drainage", 0.6).unwrap();
        let effect = effect.with("radius_mm", reference).unwrap();
        let layer = effect.choose("curve", "layer").unwrap();
        LayerDrainage::of(&layer, &[thickness]).unwrap()
    }

    #[test]
    fn only_drainage_of_a_layer_is_one() {
        for name in ["drainage", "relaxation"] {
            let effect = ActiveEffect::named(name, 1.0).unwrap();
            assert_eq!(LayerDrainage::of(&effect, &[5.0]), None);
        }
    }

    /// The middle time grows as the radius to the power of the share; the slow times grow less, the fast ones more. On a half space all grow as
    /// its square.
    #[test]
    fn times_grow_with_the_contact_and_come_closer_together() {
        let time =
            |layer: &LayerDrainage, z: f64, radius: f64| 1.0 / layer.progress((0, z), 1.0, radius);
        let layer = of(5.0, 3.0);
        let share = 0.6 * layer.drop(0, 3.0);
        assert!((time(&layer, 0.0, 3.0) - MIDDLE * 9.0 / 0.5).abs() < 1e-12);
        let grown = |z: f64| libm::log2(time(&layer, z, 6.0) / time(&layer, z, 3.0));
        assert!((grown(0.0) - (1.6 - 1.4 * share)).abs() < 1e-12);
        assert!((grown(0.0) - grown(1.0) - 0.3).abs() < 1e-12);
        let wide = libm::log(time(&layer, 1.0, 3.0) / time(&layer, 0.0, 3.0));
        assert!((wide - 1.2).abs() < 1e-12);
        let half_space = of(f64::INFINITY, 3.0);
        let grown = time(&half_space, 1.0, 6.0) / time(&half_space, 1.0, 3.0);
        assert!((grown - 4.0).abs() < 1e-12);
        assert_eq!(half_space.drop(0, 6.0), drop(&half_space.effect));
        let thick = of(3e6, 3.0);
        let grown = time(&thick, 1.0, 6.0) / time(&thick, 1.0, 3.0);
        assert!(
            (grown - 4.0).abs() < 1e-5 && (thick.drop(0, 6.0) - drop(&thick.effect)).abs() < 1e-5
        );
        assert_eq!(layer.progress((0, 0.0), 1.0, 0.0), 0.0);
        // They meet, and do not trade places.
        let widest = libm::log(time(&layer, 1.0, 300.0) / time(&layer, 0.0, 300.0));
        assert!((widest - 0.05).abs() < 1e-12, "{widest}");
    }

    #[test]
    fn the_share_grows_to_the_widest_contact_that_is_known() {
        let layer = of(5.0, 3.0);
        assert!(layer.drop(0, 8.0) > layer.drop(0, 2.0) && layer.drop(0, 2.0) > layer.drop(0, 0.0));
        assert!((layer.drop(0, 0.0) - drop(&layer.effect)).abs() < 1e-12);
        assert_eq!(layer.drop(0, 10.0), layer.drop(0, 50.0));
    }

    #[test]
    fn the_larger_the_share_the_less_times_grow() {
        assert_eq!([growth(-1.0), growth(0.0), growth(0.9)], [2.0, 1.6, 1.0]);
    }
}
