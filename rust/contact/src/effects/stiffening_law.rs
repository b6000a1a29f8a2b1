//! Effect `stiffening_law`: another growth of the modulus than the material's straight line (Xie Eq. 3).
//!
//! `G = (1 - amplitude) G_line(d) + amplitude G0 f(x)`, f(0) = 1, with x the region's largest depth over
//! `reference_depth_mm`, or its strain a/R over `reference_strain`:
//!
//! - exponential: `f = exp(x)` (Fung 1993);
//! - power: `f = 1 + x^exponent`;
//! - ogden: `f = 2 / (3 m) (l^(-m/2 - 1) - l^(m - 1)) / (1 - l)`, the secant modulus of a one-term Ogden solid of power
//!   m = exponent, squeezed to the stretch `l = 1 / (1 + x)` (Ogden 1972, uniaxial).
//!
//! The strain is known before the solve: penetration of depth d and volume V belongs to a sphere with
//! `a/R = sqrt(pi d^3 / V)`, a being Hertz's contact radius.

use super::definition::active::ActiveEffect;
use super::definition::entry::{Choice, Consequence, Entry, ShapeNumber, Sign, Stage};
use crate::skin::materials::Material;

const REFERENCE_DEPTH: usize = 0;
const REFERENCE_STRAIN: usize = 1;
const EXPONENT: usize = 2;
/// Largest growth of the modulus: beyond, the tissue is as rigid as bone.
const MOST_GROWTH: f64 = 1e4;

pub const ENTRY: Entry = Entry {
    name: "stiffening_law",
    stage: Stage::Stiffening,
    meaning: "modulus that grows with depth or strain by an exponential, a power or an Ogden law",
    amplitude: "share of this law in place of the material's line",
    most: 1.0,
    shape: &[
        ShapeNumber {
            name: "reference_depth_mm",
            unit: "mm",
            default: 2.0,
            admissible: [0.01, 1000.0],
            physiological: [0.3, 20.0],
            meaning: "depth at which the law's x is 1, for measure depth",
            source: "force on fingerpads grows exponentially with depth within 2 to 3 mm (Pawluk & Howe 1999); range: ours",
        },
        ShapeNumber {
            name: "reference_strain",
            unit: "1",
            default: 0.4,
            admissible: [0.001, 100.0],
            physiological: [0.05, 2.0],
            meaning: "strain a/R at which the law's x is 1, for measure strain",
            source: "2 mm into a sphere of 12 mm; ours",
        },
        ShapeNumber {
            name: "exponent",
            unit: "1",
            default: 2.0,
            admissible: [0.1, 30.0],
            physiological: [0.5, 20.0],
            meaning: "power of the power law, or of the Ogden law",
            source: "ours; a power of 1 is a straight line, an Ogden power of 2 is neo-Hookean (Ogden 1972)",
        },
    ],
    choices: &[
        Choice {
            name: "law",
            options: &["exponential", "power", "ogden"],
            meaning: "how the modulus grows",
        },
        Choice {
            name: "measure",
            options: &["depth", "strain"],
            meaning: "with what the modulus grows: largest depth of the region, or strain a/R",
        },
    ],
    painted: None,
    check: None,
    consequences: &[
        Consequence {
            sign: Sign::AreaStays,
            sentence: "the contact area at equal depth is the base model's: a modulus alone cannot change it",
        },
        Consequence {
            sign: Sign::CurveBends,
            sentence: "force over the base model's force is a curve of depth, or of a/R, and of nothing else",
        },
        Consequence {
            sign: Sign::SpeedDoesNotMatter,
            sentence: "curves at different speeds lie on one another",
        },
    ],
    source: "Fung 1993, Biomechanics 7; Ogden 1972, Proc R Soc A 326:565",
};

/// True if the law's x is the contact strain, not the depth.
pub fn grows_with_strain(law: &ActiveEffect) -> bool {
    law.chosen[1] == 1
}

/// Shear modulus by region, MPa: the materials' lines, with what `laws` make of them, at these depths (mm) and contact strains
/// by region. Strains are read only by laws that grow with them.
pub fn shear_moduli(
    materials: &[Material],
    laws: &[ActiveEffect],
    (depths, strains): (&[f64], &[f64]),
) -> Vec<f64> {
    let line = materials.iter().zip(depths);
    let line = line.map(|(m, depth)| m.shear_modulus(*depth));
    let mut moduli: Vec<f64> = line.collect();
    for law in laws {
        for (region, modulus) in moduli.iter_mut().enumerate() {
            let share = law.amplitude_on(region as u32);
            let x = match grows_with_strain(law) {
                true => strains[region] / law.shape[REFERENCE_STRAIN],
                false => depths[region] / law.shape[REFERENCE_DEPTH],
            };
            let g0 = materials[region].g0_mpa;
            *modulus = (1.0 - share) * *modulus + share * g0 * growth(law, x);
        }
    }
    moduli
}

/// Contact strain a/R of a penetration of that depth (mm) and volume (mm3); 0 without.
pub fn contact_strain(depth: f64, volume: f64) -> f64 {
    if volume > 0.0 {
        (std::f64::consts::PI * depth.powi(3) / volume).sqrt()
    } else {
        0.0
    }
}

/// The law's f(x).
fn growth(law: &ActiveEffect, x: f64) -> f64 {
    let m = law.shape[EXPONENT];
    let growth = match law.chosen[0] {
        0 => x.exp(),
        1 => 1.0 + x.powf(m),
        _ => {
            // Below this the quotient cancels; its limit is 1.
            let x = x.max(1e-6);
            let stretch = 1.0 / (1.0 + x);
            let stress = stretch.powf(-0.5 * m - 1.0) - stretch.powf(m - 1.0);
            2.0 / (3.0 * m) * stress / (1.0 - stretch)
        }
    };
    growth.min(MOST_GROWTH)
}
