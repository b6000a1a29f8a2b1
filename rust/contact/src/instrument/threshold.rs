//! Effect `threshold`: readings below a floor are shown as zero.

use super::channel;
use super::channel::CHANNEL;
use super::signals::Signals;
use crate::effects::{ActiveEffect, Consequence, Entry, ShapeNumber, Sign, Stage};

pub const ENTRY: Entry = Entry {
    name: "threshold",
    stage: Stage::Instrument,
    meaning: "readings below a floor that are shown as nothing",
    amplitude: "share of a reading below the floor that is lost",
    most: 1.0,
    shape: &[
        ShapeNumber {
            name: "floor_kpa",
            unit: "kPa",
            default: 5.0,
            admissible: [0.0, 1e6],
            physiological: [0.0, 30.0],
            meaning: "smallest pressure that a sensel shows",
            source: "the mat's data sheet; default: ours",
        },
        ShapeNumber {
            name: "floor_n",
            unit: "N",
            default: 0.02,
            admissible: [0.0, 1e6],
            physiological: [0.0, 1.0],
            meaning: "smallest force that the load cell shows",
            source: "the load cell's data sheet; default: ours",
        },
    ],
    choices: &[CHANNEL],
    painted: None,
    check: None,
    consequences: &[
        Consequence {
            sign: Sign::SilentBelowFloor,
            sentence: "there is no reading between nothing and the floor",
        },
        Consequence {
            sign: Sign::ChannelsDisagree,
            sentence: "light pressure at the rim of the contact is missing from the map's sum, not from the load cell",
        },
    ],
    source: "suppression of noise in the reading's electronics",
};

/// Applies it.
pub fn apply(effect: &ActiveEffect, signals: &mut Signals) {
    let (floor, left) = (effect.shape[effect.chosen[0]], 1.0 - effect.amplitude);
    channel::change(effect, signals, |reading, _, _| {
        if reading.abs() < floor {
            left * reading
        } else {
            reading
        }
    });
}
