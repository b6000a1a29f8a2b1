//! Effect `inclusion`: a place where the tissue is stiffer or softer, such as a callus, a scar or a vein.
//!
//! The modulus at a site is multiplied by `1 + amplitude (contrast - 1) w`, with
//! `w = (1 + (r^2 + z^2) / radius^2)^(-3/2)`, r the distance along the skin from the center and z the depth below it: 1 in a
//! shallow inclusion's middle, falling as the cube of the distance, as the far field of an Eshelby inclusion does. The
//! factor goes through the weights on both sides of the response, which so stays definite. It is an approximation of what
//! a buried inclusion does at the surface; only its limit (an inclusion larger than the contact) is exact.

use thenar_surface::{SkinDistance, Vec3};

use super::definition::active::ActiveEffect;
use super::definition::entry::{Consequence, Entry, ShapeNumber, Sign, Stage};
use crate::skin::sites::Sites;

const CENTER: usize = 0;
const RADIUS: usize = 3;
const DEPTH: usize = 4;
const CONTRAST: usize = 5;

pub const ENTRY: Entry = Entry {
    name: "inclusion",
    stage: Stage::Stiffening,
    meaning: "a place where the tissue is stiffer or softer",
    amplitude: "share of the contrast",
    most: 1.0,
    shape: &[
        center("center_x_mm"),
        center("center_y_mm"),
        center("center_z_mm"),
        ShapeNumber {
            name: "radius_mm",
            unit: "mm",
            default: 3.0,
            admissible: [0.1, 1e5],
            physiological: [1.0, 15.0],
            meaning: "radius of the inclusion",
            source: "ours: from a wart or callus to a thenar scar; no published distribution was found",
        },
        ShapeNumber {
            name: "depth_mm",
            unit: "mm",
            default: 0.0,
            admissible: [0.0, 100.0],
            physiological: [0.0, 10.0],
            meaning: "depth of its middle below the skin; less than the soft tissue's thickness",
            source: "ours: within the soft tissue of Xie Table 2 (7.1 and 13.4 mm)",
        },
        ShapeNumber {
            name: "contrast",
            unit: "1",
            default: 3.0,
            admissible: [0.01, 100.0],
            physiological: [0.2, 10.0],
            meaning: "modulus of the inclusion over that around it",
            source: "subcutaneous to muscle moduli differ by 2.4 at light load (Isogai 2022); range: ours",
        },
    ],
    choices: &[],
    painted: None,
    check: None,
    consequences: &[
        Consequence {
            sign: Sign::BelongsToThePlace,
            sentence: "the difference stays at one place of the skin when mat or product are shifted or turned",
        },
        Consequence {
            sign: Sign::SpeedDoesNotMatter,
            sentence: "curves at different speeds lie on one another",
        },
    ],
    source: "modulus field through a congruence (ours); decay: Eshelby 1957",
};

const fn center(name: &'static str) -> ShapeNumber {
    ShapeNumber {
        name,
        unit: "mm",
        default: 0.0,
        admissible: [-1e6, 1e6],
        physiological: [-1e3, 1e3],
        meaning: "where on the skin of the rest mesh it lies; the nearest vertex of the skin counts",
        source: "frame of the rest mesh, as the user places it",
    }
}

/// Depth of the middle, mm.
pub fn depth(effect: &ActiveEffect) -> f64 {
    effect.shape[DEPTH]
}

/// The site it lies under.
pub fn home(effect: &ActiveEffect, sites: &Sites) -> usize {
    let center = Vec3::new(
        effect.shape[CENTER],
        effect.shape[CENTER + 1],
        effect.shape[CENTER + 2],
    );
    let distance = |site: usize| (sites.rest[site].position - center).norm_squared();
    let skin = (0..sites.len()).filter(|&s| sites.is_skin(s));
    skin.min_by(|a, b| distance(*a).total_cmp(&distance(*b)))
        .unwrap_or(0)
}

/// Factor of the modulus at every site.
pub fn factors(effect: &ActiveEffect, (sites, metric): (&Sites, &SkinDistance)) -> Vec<f64> {
    let home = home(effect, sites);
    let [radius, depth, contrast] = [RADIUS, DEPTH, CONTRAST].map(|i| effect.shape[i]);
    let factor = |site: usize| {
        let chord = (sites.rest[site].position - sites.rest[home].position).norm();
        let r = chord.max(metric.lower_bound(sites.patch[home], sites.patch[site]));
        let share = (1.0 + (r * r + depth * depth) / (radius * radius)).powf(-1.5);
        1.0 + effect.amplitude_on(sites.home_region(site)) * (contrast - 1.0) * share
    };
    (0..sites.len()).map(factor).collect()
}
