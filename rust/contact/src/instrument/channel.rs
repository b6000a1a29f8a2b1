//! The channel of a recording that an instrument effect acts on: map or load cell.

use super::signals::Signals;
use crate::effects::{ActiveEffect, Choice};

/// Choice `channel`: the map or the load cell.
pub const CHANNEL: Choice = Choice {
    name: "channel",
    options: &["map", "force"],
    meaning: "what it acts on: the mat's map, or the load cell's force",
};

/// True if the effect acts on the map.
pub fn is_map(effect: &ActiveEffect) -> bool {
    effect.chosen.first() == Some(&0)
}

/// Changes every reading of the chosen channel: `change` gets the reading, the instant's number and the sensel's.
pub fn change(
    effect: &ActiveEffect,
    signals: &mut Signals,
    change: impl Fn(f64, usize, Option<usize>) -> f64,
) {
    if is_map(effect) {
        for (instant, frame) in signals.frames.iter_mut().enumerate() {
            for (sensel, reading) in frame.iter_mut().enumerate() {
                *reading = change(*reading, instant, Some(sensel));
            }
        }
        return;
    }
    for (instant, reading) in signals.force_n.iter_mut().enumerate() {
        *reading = change(*reading, instant, None);
    }
}
