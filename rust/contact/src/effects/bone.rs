//! Effect `bone`: soft tissue of another thickness over bone, level, sloping or painted.
//!
//! Thickness enters through its inverse: `1/h = (1 - amplitude) / h_base + amplitude / h_bone`, so that amplitude 0 is the
//! material's own thickness and amplitude 1 the bone's. Sloping bone lies at
//! `h(x) = thickness_mm + slope * (x - center) . direction`, the center being the middle of the skin it acts on, and is held
//! between a quarter and four times `thickness_mm`. The response stays that of bonded layers (Johnson, Contact Mechanics
//! 5.8), mixed between few thicknesses by a partition of unity, and so definite.

use thenar_surface::Vec3;

use super::definition::active::ActiveEffect;
use super::definition::entry::{Consequence, Entry, ShapeNumber, Sign, Stage};
use crate::skin::sites::Sites;

const THICKNESS: usize = 0;
const SLOPE: usize = 1;
const DIRECTION: usize = 2;
/// Sloping bone stays within this factor of the thickness given.
const MOST_SLOPED: f64 = 4.0;

const DIRECTION_SOURCE: &str = "frame of the rest mesh, as the user turns it";

pub const ENTRY: Entry = Entry {
    name: "bone",
    stage: Stage::Geometry,
    meaning: "soft tissue of finite thickness, bonded to bone that is level, sloping or painted",
    amplitude: "share of the bone's inverse thickness in place of the material's own",
    most: 1.0,
    shape: &[
        ShapeNumber {
            name: "thickness_mm",
            unit: "mm",
            default: 5.0,
            admissible: [0.05, 1000.0],
            physiological: [2.0, 20.0],
            meaning: "soft tissue over the bone",
            source: "the deepest bulge at 1.12 h puts Xie Table 2 at 7.1 mm (finger) and 13.4 mm (palm); range: ours around these",
        },
        ShapeNumber {
            name: "slope",
            unit: "1",
            default: 0.0,
            admissible: [-2.0, 2.0],
            physiological: [-1.0, 1.0],
            meaning: "growth of thickness along the direction, mm per mm",
            source: "geometry; 1 is bone at 45 degrees to the skin",
        },
        direction("direction_x", 1.0),
        direction("direction_y", 0.0),
        direction("direction_z", 0.0),
    ],
    choices: &[],
    painted: Some("thickness over bone, mm"),
    check: Some(check),
    consequences: &[
        Consequence {
            sign: Sign::AreaChanges,
            sentence: "the contact area at equal depth differs from that of the base model's thickness: thinner tissue touches more",
        },
        Consequence {
            sign: Sign::StiffensWithContactSize,
            sentence: "force grows faster with depth, the larger the contact is against the thickness",
        },
        Consequence {
            sign: Sign::SpeedDoesNotMatter,
            sentence: "curves at different speeds lie on one another",
        },
        Consequence {
            sign: Sign::BelongsToThePlace,
            sentence: "thick and thin places differ under the same tool, in every posture alike",
        },
    ],
    source: "bonded elastic layer: Johnson 1985, Contact Mechanics 5.8",
};

const fn direction(name: &'static str, default: f64) -> ShapeNumber {
    ShapeNumber {
        name,
        unit: "1",
        default,
        admissible: [-1e6, 1e6],
        physiological: [-1.0, 1.0],
        meaning: "direction in which thickness grows, any length",
        source: DIRECTION_SOURCE,
    }
}

/// What is wrong beyond the ranges of single numbers.
fn check(shape: &[f64], painted: &[f64]) -> Result<(), String> {
    if shape[SLOPE] != 0.0 && along(shape).norm() == 0.0 {
        return Err(
            "the direction of its slope is zero; give direction_x, direction_y or direction_z"
                .to_owned(),
        );
    }
    let [low, high] = ENTRY.shape[THICKNESS].admissible;
    let stray = painted
        .iter()
        .enumerate()
        .filter(|(_, h)| !h.is_nan())
        .find(|(_, h)| !(**h >= low && **h <= high));
    match stray {
        Some((vertex, h)) => Err(format!(
            "the painted thickness at vertex {vertex} is {h} mm, but must be from {low} to {high} mm"
        )),
        None => Ok(()),
    }
}

/// True if the thickness differs from vertex to vertex.
pub fn is_field(bone: &ActiveEffect) -> bool {
    bone.painted.is_some() || bone.shape[SLOPE] != 0.0
}

/// Thickness of level bone, mm.
pub fn thickness(bone: &ActiveEffect) -> f64 {
    bone.shape[THICKNESS]
}

/// Inverse thickness that bone leaves at every site, 1/mm, where `base` was before. `source` is the vertex of the mesh as
/// given that each welded vertex stands for.
pub fn field(bone: &ActiveEffect, (sites, source): (&Sites, &[u32]), base: &[f64]) -> Vec<f64> {
    let acts = |site: usize| bone.acts_on(sites.home_region(site));
    let (mut center, mut area) = (Vec3::zeros(), 0.0);
    for site in (0..sites.len()).filter(|&s| sites.is_skin(s) && acts(s)) {
        center += sites.rest[site].position * sites.area[site];
        area += sites.area[site];
    }
    let center = if area > 0.0 { center / area } else { center };
    let along = along(&bone.shape)
        .try_normalize(0.0)
        .unwrap_or_else(Vec3::zeros);
    let level = bone.shape[THICKNESS];
    let at = |site: usize| {
        let painted = bone.painted.as_ref().map_or(f64::NAN, |p| {
            p[source[sites.vertex[site] as usize] as usize]
        });
        let sloped = level + bone.shape[SLOPE] * (sites.rest[site].position - center).dot(&along);
        let h = if painted.is_nan() {
            sloped.clamp(level / MOST_SLOPED, level * MOST_SLOPED)
        } else {
            painted
        };
        if acts(site) {
            (1.0 - bone.amplitude) * base[site] + bone.amplitude / h
        } else {
            base[site]
        }
    };
    (0..sites.len()).map(at).collect()
}

fn along(shape: &[f64]) -> Vec3 {
    Vec3::new(shape[DIRECTION], shape[DIRECTION + 1], shape[DIRECTION + 2])
}
