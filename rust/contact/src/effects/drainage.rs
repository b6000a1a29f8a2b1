//! Effect `drainage`: fluid that leaves the pressed tissue, relaxation whose clock is D t / a^2.
//!
//! At held depth the force falls from F0 to `F0 / (2 (1 - nu_drained))` along the master curve of a sphere,
//! `0.491 exp(-0.908 sqrt(tau)) + 0.509 exp(-1.679 tau)` with tau = D t / a^2 (Hu, Zhao, Vlassak & Suo 2010). The curve is
//! represented by exponentials of tau within 6e-4; the radius a of the contact is sqrt(area / pi) of the
//! region's contact at the step before. That is the curve of a half space, so of contacts small against the thickness; the curve of a
//! layer over bone is the sibling `layer_drainage`. The bulge around the contact stays that of the undrained tissue.

use super::definition::active::ActiveEffect;
use super::definition::entry::{Choice, Consequence, Entry, ShapeNumber, Sign, Stage};

pub(super) const DIFFUSIVITY: usize = 0;
pub(super) const DRAINED: usize = 1;
pub(super) const SPREAD: usize = 2;
pub(super) const RADIUS: usize = 3;
/// The choice `curve`, and its option `layer`.
pub(super) const CURVE: usize = 0;
pub(super) const LAYER: usize = 1;

pub const ENTRY: Entry = Entry {
    name: "drainage",
    stage: Stage::History,
    meaning: "fluid that leaves the pressed tissue: relaxation whose time grows with the contact",
    amplitude: "share of the drop from undrained to drained force",
    most: 1.0,
    shape: &[
        ShapeNumber {
            name: "diffusivity_mm2_per_s",
            unit: "mm2/s",
            default: 0.5,
            admissible: [1e-9, 1e6],
            physiological: [1e-3, 10.0],
            meaning: "diffusivity D of the pore fluid: permeability times the drained modulus",
            source: "ours: a contact of 4 mm then drains in half a minute, as long as published holds; no figure for pulp was found",
        },
        ShapeNumber {
            name: "drained_poisson_ratio",
            unit: "1",
            default: 0.3,
            admissible: [0.0, 0.499],
            physiological: [0.1, 0.45],
            meaning: "Poisson's ratio once fluid has left",
            source: "range of hydrated soft tissues and gels; with 0.3 the force falls by 29 % (Hu et al. 2010), palms: 33 to 36 % (Shojaeizadeh 2022)",
        },
        ShapeNumber {
            name: "spread",
            unit: "1",
            default: 1.2,
            admissible: [0.0, 4.0],
            physiological: [0.05, 3.0],
            meaning: "standard deviation of the logarithm of a layer's times, under a contact of radius_mm",
            source: "1.2 is the half space's curve (Hu et al. 2010) within 2.5 % of the drop; finite elements of pads: 0.8 to 1.5",
        },
        ShapeNumber {
            name: "radius_mm",
            unit: "mm",
            default: 4.0,
            admissible: [1e-3, 1e3],
            physiological: [0.5, 15.0],
            meaning: "radius of the contact under which a layer has that diffusivity and spread",
            source: "ours: a fingertip's contact at some newtons",
        },
    ],
    choices: &[Choice {
        name: "curve",
        options: &["halfspace", "layer"],
        meaning: "whose curve the force falls by: a half space's, for contacts that are small against the thickness, or that of a layer over bone, \
                  which loses more, in times that grow less than as the area",
    }],
    painted: None,
    check: None,
    consequences: &[
        Consequence {
            sign: Sign::ForceFallsInHold,
            sentence: "force at held depth falls with time and comes to rest",
        },
        Consequence {
            sign: Sign::ClockGrowsWithArea,
            sentence: "a larger contact takes longer: one of twice the radius four times as long on a half space, less on a layer",
        },
        Consequence {
            sign: Sign::VolumeIsLost,
            sentence: "the tissue loses volume while it drains",
        },
    ],
    source: "Hu, Zhao, Vlassak & Suo 2010, Appl Phys Lett 96:121904",
};

/// Weights, summing to 1, and times (in tau) of the exponentials: a least-squares fit to the published curve from tau = 1e-4 to
/// 100, where it stays within 6e-4.
const MASTER: [(f64, f64); 7] = [
    (0.006507, 0.00015339),
    (0.015414, 0.00268503),
    (0.036168, 0.0224747),
    (0.074761, 0.134246),
    (0.639581, 0.605027),
    (0.160664, 2.64932),
    (0.066905, 9.75762),
];

/// Share of the force that drains away in the end.
pub fn drop(effect: &ActiveEffect) -> f64 {
    1.0 - 0.5 / (1.0 - effect.shape[DRAINED])
}

/// Share of the fading force and time constant (in tau) of each branch.
pub fn branches() -> Vec<(f64, f64)> {
    MASTER.to_vec()
}

/// Growth of tau in `seconds` for a contact of radius `a` (mm).
pub fn progress(effect: &ActiveEffect, seconds: f64, a: f64) -> f64 {
    if a > 0.0 {
        effect.shape[DIFFUSIVITY] * seconds / (a * a)
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_exponentials_follow_the_master_curve() {
        let published =
            |tau: f64| 0.491 * (-0.908 * tau.sqrt()).exp() + 0.509 * (-1.679 * tau).exp();
        for i in 0..=600 {
            let tau = if i == 0 {
                0.0
            } else {
                10f64.powf(-4.0 + f64::from(i) / 100.0)
            };
            let fitted: f64 = MASTER.iter().map(|(w, t)| w * (-tau / t).exp()).sum();
            assert!(
                (fitted - published(tau)).abs() < 6e-4,
                "{tau}: {fitted} {}",
                published(tau)
            );
        }
    }
}
