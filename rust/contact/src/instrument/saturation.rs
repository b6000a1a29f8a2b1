//! Effect `saturation`: readings clipped at a ceiling.

use super::channel;
use super::channel::CHANNEL;
use super::signals::Signals;
use crate::effects::{ActiveEffect, Consequence, Entry, ShapeNumber, Sign, Stage};

pub const ENTRY: Entry = Entry {
    name: "saturation",
    stage: Stage::Instrument,
    meaning: "readings that stop at a ceiling",
    amplitude: "share of what is above the ceiling that is lost",
    most: 1.0,
    shape: &[
        ShapeNumber {
            name: "ceiling_kpa",
            unit: "kPa",
            default: 200.0,
            admissible: [1e-6, 1e6],
            physiological: [30.0, 3500.0],
            meaning: "largest pressure that a sensel shows",
            source: "the mat's data sheet; hand tools stay below 250 kPa but for high forces (Hall 1997)",
        },
        ShapeNumber {
            name: "ceiling_n",
            unit: "N",
            default: 10.0,
            admissible: [1e-6, 1e6],
            physiological: [0.1, 1000.0],
            meaning: "largest force that the load cell shows",
            source: "the load cell's data sheet",
        },
    ],
    choices: &[CHANNEL],
    painted: None,
    check: None,
    consequences: &[
        Consequence {
            sign: Sign::ClipsAtCeiling,
            sentence: "no reading is above one ceiling, the same at all speeds, places and times",
        },
        Consequence {
            sign: Sign::ChannelsDisagree,
            sentence: "the load cell grows on where the map does not",
        },
    ],
    source: "range of the converter",
};

/// Applies it.
pub fn apply(effect: &ActiveEffect, signals: &mut Signals) {
    let ceiling = effect.shape[effect.chosen[0]];
    channel::change(effect, signals, |reading, _, _| {
        reading - effect.amplitude * (reading - ceiling).max(0.0)
    });
}
