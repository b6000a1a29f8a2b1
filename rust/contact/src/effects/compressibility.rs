//! Effect `compressibility`: tissue that gives up volume, Poisson's ratio below 1/2.
//!
//! `nu = (1 - amplitude) nu_base + amplitude poisson_ratio`, in the half space (Boussinesq's `(1 - nu) / (2 pi G r)`) and in
//! the bonded layer's kernel alike.

use super::definition::active::ActiveEffect;
use super::definition::entry::{Consequence, Entry, ShapeNumber, Sign, Stage};

pub const ENTRY: Entry = Entry {
    name: "compressibility",
    stage: Stage::Geometry,
    meaning: "tissue that gives up volume when pressed",
    amplitude: "share of the way from the material's Poisson's ratio to this one",
    most: 1.0,
    shape: &[ShapeNumber {
        name: "poisson_ratio",
        unit: "1",
        default: 0.45,
        admissible: [0.0, 0.5],
        physiological: [0.4, 0.5],
        meaning: "Poisson's ratio of the tissue",
        source: "fingertips lose up to about 5 % of their volume (Srinivasan, Gulati & Dandekar 1992); nu 0.45 to 0.49 is common in finger models",
    }],
    choices: &[],
    painted: None,
    check: None,
    consequences: &[
        Consequence {
            sign: Sign::VolumeIsLost,
            sentence: "the skin that rises beside the contact holds less volume than the dent",
        },
        Consequence {
            sign: Sign::ForceIsSmaller,
            sentence: "less force is needed at equal depth, the more so over thin tissue",
        },
        Consequence {
            sign: Sign::SpeedDoesNotMatter,
            sentence: "curves at different speeds lie on one another",
        },
    ],
    source: "Johnson 1985, Contact Mechanics 3.2 (half space) and 5.8 (layer)",
};

/// Poisson's ratio of `region` where `base` was before.
pub fn poisson_ratio(effect: &ActiveEffect, region: u32, base: f64) -> f64 {
    let share = effect.amplitude_on(region);
    (1.0 - share) * base + share * effect.shape[0]
}
