//! Effect `dead_cells`: sensels that read low or nothing, painted on the mat.

use super::signals::Signals;
use crate::effects::{ActiveEffect, Consequence, Entry, Sign, Stage};

pub const ENTRY: Entry = Entry {
    name: "dead_cells",
    stage: Stage::Instrument,
    meaning: "sensels that show nothing",
    amplitude: "share of the reading that a dead sensel loses",
    most: 1.0,
    shape: &[],
    choices: &[],
    painted: Some("1 where a sensel is dead, 0 where it is well; one per sensel"),
    check: None,
    consequences: &[
        Consequence {
            sign: Sign::MovesWithTheMat,
            sentence: "the same sensels are silent at every pose, load and time",
        },
        Consequence {
            sign: Sign::ChannelsDisagree,
            sentence: "the map's sum falls short of the load cell by what lies on them",
        },
    ],
    source: "broken traces",
};

/// Applies it.
pub fn apply(effect: &ActiveEffect, signals: &mut Signals) {
    let Some(dead) = effect.painted.as_deref() else {
        return;
    };
    for frame in &mut signals.frames {
        for (reading, dead) in frame.iter_mut().zip(dead).filter(|(_, dead)| **dead > 0.0) {
            *reading *= 1.0 - effect.amplitude * dead.min(1.0);
        }
    }
}
