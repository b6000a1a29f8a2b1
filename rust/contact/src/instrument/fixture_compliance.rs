//! Effect `fixture_compliance`: a fixture in series with the skin, so that the machine shows more travel.
//!
//! `depth shown = depth in the skin + amplitude * compliance * force`: a spring in series with the skin.

use super::signals::Signals;
use crate::effects::{ActiveEffect, Consequence, Entry, ShapeNumber, Sign, Stage};

pub const ENTRY: Entry = Entry {
    name: "fixture_compliance",
    stage: Stage::Instrument,
    meaning: "a fixture that yields in series with the skin",
    amplitude: "share of the compliance",
    most: 1.0,
    shape: &[ShapeNumber {
        name: "compliance_mm_per_n",
        unit: "mm/N",
        default: 0.02,
        admissible: [0.0, 1000.0],
        physiological: [0.0, 0.5],
        meaning: "travel lost for each newton",
        source: "ours: 50 N/mm, a printed bracket; no measurement known",
    }],
    choices: &[],
    painted: None,
    check: None,
    consequences: &[
        Consequence {
            sign: Sign::ForceIsSmaller,
            sentence: "at equal travel there is less force, the more so the stiffer what is pressed",
        },
        Consequence {
            sign: Sign::YieldsToForceOnly,
            sentence: "the travel lost is the same for every tool, place and speed of equal force, and on steel too",
        },
    ],
    source: "springs in series",
};

/// Travel lost for each newton, mm/N.
pub fn compliance(effect: &ActiveEffect) -> f64 {
    effect.amplitude * effect.shape[0]
}

/// Applies it: what the machine shows where the skin gets `depth_mm`.
pub fn apply(effect: &ActiveEffect, signals: &mut Signals) {
    let compliance = compliance(effect);
    for (depth, force) in signals.depth_mm.iter_mut().zip(&signals.force_n) {
        *depth += compliance * force;
    }
}
