//! Effect `stiff_skin`: a thin stiff skin over soft pulp, with its bending and, if it is stretched, its tension.
//!
//! The skin is a thin plate of bending stiffness `D = E t^3 / 9` and stiffness against stretch `M = 4 E t / 3` (E modulus_mpa, t
//! thickness_mm, Poisson's ratio 1/2) under `tension_n_per_mm`, bonded to the pulp below; amplitude multiplies all three. It is part of
//! the thickness of soft tissue over bone: the pulp below is thinner by the skin's, as far as the skin is stiffer than pulp, at most by
//! half. Strains are small: what a skin that is pressed deep gains by its own stretch is left out (for balls the crate's `ball` has it).
//! Skin and pulp stiffen together: what counts is D / G0, so that the response does not depend on the depth. Needs vertices not much
//! farther apart than the bending length `((1 - nu) D / G0)^(1/3)` to be seen.

use super::definition::active::ActiveEffect;
use super::definition::entry::{Consequence, Entry, ShapeNumber, Sign, Stage};
use crate::Material;
use crate::response::plate_on_layer::Sheet;

const MODULUS: usize = 0;
const THICKNESS: usize = 1;
const TENSION: usize = 2;

pub const ENTRY: Entry = Entry {
    name: "stiff_skin",
    stage: Stage::Geometry,
    meaning: "a thin stiff skin over soft pulp",
    amplitude: "factor of the skin's modulus and tension",
    most: 1.0,
    shape: &[
        ShapeNumber {
            name: "modulus_mpa",
            unit: "MPa",
            default: 1.5,
            admissible: [1e-6, 1e5],
            physiological: [0.05, 10.0],
            meaning: "Young's modulus of the stiff skin",
            source: "epidermis and stratum corneum 1 to 2 MPa (Geerligs 2011); finger models use 0.1 to 2 MPa",
        },
        ShapeNumber {
            name: "thickness_mm",
            unit: "mm",
            default: 0.5,
            admissible: [1e-4, 10.0],
            physiological: [0.1, 2.0],
            meaning: "thickness of the stiff skin",
            source: "stratum corneum of a finger pad about 0.3 mm (Adams 2013), palm 0.17 mm (Acta Derm Venereol 87:4), with living skin more",
        },
        ShapeNumber {
            name: "tension_n_per_mm",
            unit: "N/mm",
            default: 0.0,
            admissible: [0.0, 100.0],
            physiological: [0.0, 0.1],
            meaning: "tension in the skin",
            source: "ours: a relaxed hand has little; no figure for palms was found",
        },
    ],
    choices: &[],
    painted: None,
    check: None,
    consequences: &[
        Consequence {
            sign: Sign::SmallToolsFeelStiffer,
            sentence: "small tools need more force against the base model than large ones, soon after first touch",
        },
        Consequence {
            sign: Sign::AreaChanges,
            sentence: "the contact under a round tool is smaller at equal depth, and pressure gathers at its edge",
        },
        Consequence {
            sign: Sign::SpeedDoesNotMatter,
            sentence: "curves at different speeds lie on one another",
        },
    ],
    source: "plate on an elastic layer: Timoshenko & Woinowsky-Krieger 1959, 1 and 8",
};

/// The skin over a tissue, in its terms.
pub fn sheet(effect: &ActiveEffect, region: u32, tissue: &Material) -> Sheet {
    let amplitude = effect.amplitude_on(region);
    let share = amplitude * (1.0 - tissue.poisson_ratio) / tissue.g0_mpa;
    let own = amplitude * effect.shape[MODULUS];
    let pulp = 3.0 * tissue.g0_mpa;
    let bending = effect.shape[MODULUS] * effect.shape[THICKNESS].powi(3) / 9.0;
    let stretch = 4.0 / 3.0 * effect.shape[MODULUS] * effect.shape[THICKNESS];
    Sheet {
        bending: share * bending,
        tension: share * effect.shape[TENSION],
        stretch: share * stretch,
        middle: 0.5 * effect.shape[THICKNESS],
        takes: effect.shape[THICKNESS] * (1.0 - pulp / own.max(pulp)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::Effect;

    /// 1 - 3 G / E of its thickness: nothing of a skin as soft as the pulp.
    #[test]
    fn a_skin_takes_of_the_thickness_what_is_stiffer_than_pulp() {
        let tissue = Material {
            g0_mpa: 0.01,
            ..Material::default()
        };
        let mut effect = ActiveEffect::new(Effect::StiffSkin, 1.0);
        (effect.shape[MODULUS], effect.shape[THICKNESS]) = (0.6, 0.4);
        for (amplitude, takes) in [(1.0, 0.38), (0.1, 0.2), (0.05, 0.0), (0.0, 0.0)] {
            effect.amplitude = amplitude;
            assert!((sheet(&effect, 0, &tissue).takes - takes).abs() < 1e-12);
        }
    }
}
