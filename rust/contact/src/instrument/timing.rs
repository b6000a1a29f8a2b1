//! Effect `timing`: a time lag between channels.

use super::signals::Signals;
use crate::effects::{ActiveEffect, Choice, Consequence, Entry, ShapeNumber, Sign, Stage};

pub const ENTRY: Entry = Entry {
    name: "timing",
    stage: Stage::Instrument,
    meaning: "a channel whose clock is behind that of the others",
    amplitude: "share of the delay",
    most: 1.0,
    shape: &[ShapeNumber {
        name: "delay_s",
        unit: "s",
        default: 0.02,
        admissible: [-1e4, 1e4],
        physiological: [-0.5, 0.5],
        meaning: "how much later the channel shows what happens; negative: earlier",
        source: "ours: one frame of a mat at 50 Hz",
    }],
    choices: &[Choice {
        name: "channel",
        options: &["map", "force", "depth"],
        meaning: "which channel is behind: the map, the load cell (with its tangential force), or the motion",
    }],
    painted: None,
    check: None,
    consequences: &[
        Consequence {
            sign: Sign::LagsBehind,
            sentence: "the channel is behind by the same time at every speed, so by more travel in faster presses",
        },
        Consequence {
            sign: Sign::ForceStaysInHold,
            sentence: "nothing changes in holds",
        },
    ],
    source: "shift of a clock, readings between instants on straight lines",
};

/// Applies it; before the first instant and after the last a channel keeps its value.
pub fn apply(effect: &ActiveEffect, signals: &mut Signals) {
    let delay = effect.amplitude * effect.shape[0];
    if delay == 0.0 || signals.time_s.is_empty() {
        return;
    }
    let times = signals.time_s.clone();
    let between: Vec<(usize, f64)> = times.iter().map(|t| at(&times, t - delay)).collect();
    let shifted = |channel: &[f64]| -> Vec<f64> {
        let value =
            |&(k, share): &(usize, f64)| mixed(channel[k], channel[next(k, channel.len())], share);
        between.iter().map(value).collect()
    };
    match effect.chosen[0] {
        0 => {
            let frames = &signals.frames;
            if frames.is_empty() {
                return;
            }
            let frame = |&(k, share): &(usize, f64)| -> Vec<f64> {
                let pairs = frames[k].iter().zip(&frames[next(k, frames.len())]);
                pairs.map(|(a, b)| mixed(*a, *b, share)).collect()
            };
            signals.frames = between.iter().map(frame).collect();
        }
        1 => {
            for channel in [&mut signals.force_n, &mut signals.tangential_force_n] {
                if !channel.is_empty() {
                    *channel = shifted(channel);
                }
            }
        }
        _ if signals.depth_mm.is_empty() => {}
        _ => signals.depth_mm = shifted(&signals.depth_mm),
    }
}

fn next(k: usize, count: usize) -> usize {
    (k + 1).min(count - 1)
}

fn mixed(a: f64, b: f64, share: f64) -> f64 {
    a + share * (b - a)
}

/// The instant before a time, and how far it is to the next, 0 to 1.
fn at(times: &[f64], time: f64) -> (usize, f64) {
    let after = times.partition_point(|t| *t <= time);
    if after == 0 {
        return (0, 0.0);
    }
    let k = after - 1;
    match times.get(after) {
        Some(later) => (k, (time - times[k]) / (later - times[k])),
        None => (k, 0.0),
    }
}
