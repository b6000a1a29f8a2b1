//! Effect `drift`: zero drift, or creep of the sensitivity, with time.
//!
//! zero: `y' = y + amplitude * rate * t`; sensitivity: `y' = y (1 + amplitude * creep * log10(1 + t / 1 s))`, both with t from
//! the first instant. Neither needs contact to go on.

use super::channel;
use super::channel::CHANNEL;
use super::signals::Signals;
use crate::effects::{ActiveEffect, Choice, Consequence, Entry, ShapeNumber, Sign, Stage};

const CREEP: usize = 2;
/// Minutes in a second.
const MINUTE: f64 = 1.0 / 60.0;

pub const ENTRY: Entry = Entry {
    name: "drift",
    stage: Stage::Instrument,
    meaning: "readings that wander with time, with or without contact",
    amplitude: "share of the drift",
    most: 1.0,
    shape: &[
        ShapeNumber {
            name: "rate_kpa_per_min",
            unit: "kPa/min",
            default: 1.0,
            admissible: [-1e6, 1e6],
            physiological: [-20.0, 20.0],
            meaning: "wandering of the map's zero",
            source: "ours; about 3 % of 30 kPa in a minute",
        },
        ShapeNumber {
            name: "rate_n_per_min",
            unit: "N/min",
            default: 0.05,
            admissible: [-1e6, 1e6],
            physiological: [-1.0, 1.0],
            meaning: "wandering of the load cell's zero",
            source: "ours; no measurement known",
        },
        ShapeNumber {
            name: "creep",
            unit: "1",
            default: 0.02,
            admissible: [-0.2, 0.2],
            physiological: [-0.1, 0.1],
            meaning: "growth of the sensitivity in each decade of time",
            source: "2.9 % in 30 s on a hand-handle sensor (Yao 2019, Measurement 145:525), so 2 % a decade",
        },
    ],
    choices: &[
        CHANNEL,
        Choice {
            name: "form",
            options: &["zero", "sensitivity"],
            meaning: "what wanders: the zero, or the factor",
        },
    ],
    painted: None,
    check: None,
    consequences: &[
        Consequence {
            sign: Sign::TrendsWithoutContact,
            sentence: "the trend goes on without contact and after it (the zero), and under a dead weight",
        },
        Consequence {
            sign: Sign::ClockIsFixed,
            sentence: "the clock is the recording's, not that of the contact",
        },
    ],
    source: "zero drift; logarithmic creep of film sensors",
};

/// Applies it.
pub fn apply(effect: &ActiveEffect, signals: &mut Signals) {
    let times = signals.time_s.clone();
    let since = |instant: usize| times[instant] - times[0];
    let rate = effect.amplitude * effect.shape[effect.chosen[0]] * MINUTE;
    let creep = effect.amplitude * effect.shape[CREEP];
    let is_zero = effect.chosen[1] == 0;
    channel::change(effect, signals, |reading, instant, _| {
        if is_zero {
            reading + rate * since(instant)
        } else {
            reading * (1.0 + creep * (1.0 + since(instant)).log10())
        }
    });
}
