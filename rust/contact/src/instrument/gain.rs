//! Effect `gain`: readings off by a factor, common or per sensel.
//!
//! `y' = y (1 + amplitude * error)`; painted, each sensel has its own error.

use super::channel;
use super::channel::CHANNEL;
use super::signals::Signals;
use crate::effects::{ActiveEffect, Consequence, Entry, ShapeNumber, Sign, Stage};

pub const ENTRY: Entry = Entry {
    name: "gain",
    stage: Stage::Instrument,
    meaning: "readings too large or too small by a factor: an error of calibration",
    amplitude: "share of the error",
    most: 1.0,
    shape: &[ShapeNumber {
        name: "error",
        unit: "1",
        default: 0.1,
        admissible: [-0.99, 10.0],
        physiological: [-0.32, 0.32],
        meaning: "reading over what is there, less 1",
        source: "film sensors: linear calibration up to 24 % of range off (Tekscan calibration study), combinations of hardware \
                 5 to 32 % apart (Morin 2000, ADP011007); default: ours",
    }],
    choices: &[CHANNEL],
    painted: Some("error of each sensel, 1"),
    check: None,
    consequences: &[
        Consequence {
            sign: Sign::ScalesReadings,
            sentence: "readings are off by one factor at every load, place, speed and time",
        },
        Consequence {
            sign: Sign::ChannelsDisagree,
            sentence: "the sum of the map and the load cell differ by that factor",
        },
    ],
    source: "linear calibration",
};

/// Applies it.
pub fn apply(effect: &ActiveEffect, signals: &mut Signals) {
    let painted = effect
        .painted
        .as_deref()
        .filter(|_| channel::is_map(effect));
    channel::change(effect, signals, |reading, _, sensel| {
        let own = sensel
            .and_then(|k| painted.map(|errors| errors[k]))
            .filter(|e| !e.is_nan());
        reading * (1.0 + effect.amplitude * own.unwrap_or(effect.shape[0]))
    });
}
