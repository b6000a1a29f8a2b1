//! Effect `offset`: zero offsets of the map, the load cell, or the depth at first touch.

use super::signals::Signals;
use crate::effects::{ActiveEffect, Choice, Consequence, Entry, ShapeNumber, Sign, Stage};

pub const ENTRY: Entry = Entry {
    name: "offset",
    stage: Stage::Instrument,
    meaning: "a zero point that is not at zero",
    amplitude: "share of the offset",
    most: 1.0,
    shape: &[
        number(
            "offset_kpa",
            "kPa",
            1.0,
            [-20.0, 20.0],
            "reading of the map without load",
        ),
        number(
            "offset_n",
            "N",
            0.05,
            [-1.0, 1.0],
            "reading of the load cell without load",
        ),
        number(
            "offset_mm",
            "mm",
            0.05,
            [-1.0, 1.0],
            "depth shown at first touch",
        ),
    ],
    choices: &[Choice {
        name: "channel",
        options: &["map", "force", "depth"],
        meaning: "whose zero is off: the map's, the load cell's, or the depth's",
    }],
    painted: None,
    check: None,
    consequences: &[
        Consequence {
            sign: Sign::ShiftsReadings,
            sentence: "every reading is off by the same amount, without contact too",
        },
        Consequence {
            sign: Sign::SpeedDoesNotMatter,
            sentence: "the amount is the same at every speed, load and time",
        },
    ],
    source: "zero error",
};

const fn number(
    name: &'static str,
    unit: &'static str,
    default: f64,
    physiological: [f64; 2],
    meaning: &'static str,
) -> ShapeNumber {
    ShapeNumber {
        name,
        unit,
        default,
        admissible: [-1e6, 1e6],
        physiological,
        meaning,
        source: "ours: what a set-up zeroed by hand leaves; no measurement known",
    }
}

/// Applies it.
pub fn apply(effect: &ActiveEffect, signals: &mut Signals) {
    let (chosen, amplitude) = (effect.chosen[0], effect.amplitude);
    let more = amplitude * effect.shape[chosen];
    match chosen {
        0 => signals.frames.iter_mut().flatten().for_each(|p| *p += more),
        1 => signals.force_n.iter_mut().for_each(|f| *f += more),
        _ => signals.depth_mm.iter_mut().for_each(|d| *d += more),
    }
}
