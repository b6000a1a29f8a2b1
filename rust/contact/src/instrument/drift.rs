//! Effect `drift`: zero drift, or creep of the sensitivity, with time.
//!
//! zero: `y' = y + amplitude * rate * t`; sensitivity: `y' = y (1 + amplitude * creep * log10(1 + t / 1 s))`; slowing, a zero whose
//! drift slows: `y' = y + amplitude * rate * 10 tau * ln(1 + t / tau) / ln(11)`, with the rate as the mean over the first 10 tau; all with t
//! from the first instant. None needs contact to go on.

use super::channel;
use super::channel::CHANNEL;
use super::signals::Signals;
use crate::effects::{ActiveEffect, Choice, Consequence, Entry, ShapeNumber, Sign, Stage};

const CREEP: usize = 2;
const TIME: usize = 3;
/// Options of the choice of form.
const ZERO: usize = 0;
const SENSITIVITY: usize = 1;
/// Times tau over which a drift that slows has its rate in the mean.
const TAUS: f64 = 10.0;
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
        ShapeNumber {
            name: "time_s",
            unit: "s",
            default: 1.0,
            admissible: [1e-3, 1e6],
            physiological: [0.1, 100.0],
            meaning: "time tau of a drift that slows; its rate is the mean over the first ten of them",
            source: "creep of film sensors is logarithmic from about a second on (Yao 2019, Measurement 145:525)",
        },
    ],
    choices: &[
        CHANNEL,
        Choice {
            name: "form",
            options: &["zero", "sensitivity", "slowing"],
            meaning: "what wanders: the zero evenly, the factor, or the zero ever more slowly",
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

/// What a drift that slows has come to after `seconds`, over its rate, s.
fn slowing(seconds: f64, time_s: f64) -> f64 {
    TAUS * time_s * (seconds / time_s).ln_1p() / TAUS.ln_1p()
}

/// Applies it.
pub fn apply(effect: &ActiveEffect, signals: &mut Signals) {
    let times = signals.time_s.clone();
    let since = |instant: usize| times[instant] - times[0];
    let rate = effect.amplitude * effect.shape[effect.chosen[0]] * MINUTE;
    let creep = effect.amplitude * effect.shape[CREEP];
    channel::change(effect, signals, |reading, instant, _| {
        match effect.chosen[1] {
            ZERO => reading + rate * since(instant),
            SENSITIVITY => reading * (1.0 + creep * (1.0 + since(instant)).log10()),
            _ => reading + rate * slowing(since(instant), effect.shape[TIME]),
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    /// On a map: the mean rate over the first ten times tau is the rate, and what comes then is slower.
    #[test]
    fn a_drift_that_slows_has_its_rate_in_the_mean_of_ten_times() {
        let mut effect = ActiveEffect::named("drift", 0.5).unwrap();
        for (name, value) in [("rate_kpa_per_min", 6.0), ("time_s", 2.0)] {
            effect = effect.with(name, value).unwrap();
        }
        let effect = effect.choose("form", "slowing").unwrap();
        let mut signals = Signals {
            time_s: vec![3.0, 23.0, 43.0],
            frames: vec![vec![1.0; 2]; 3],
            ..Signals::default()
        };
        apply(&effect, &mut signals);
        let [first, tenth, twentieth] = [0, 1, 2].map(|k| signals.frames[k][1]);
        assert!((first - 1.0).abs() < 1e-12);
        // Half of 6 kPa a minute, for 20 s.
        assert!((tenth - 2.0).abs() < 1e-12, "{tenth}");
        let wanted = 1.0 + (1.0f64 + 20.0).ln() / (1.0f64 + 10.0).ln();
        assert!((twentieth - wanted).abs() < 1e-12, "{twentieth} {wanted}");
    }
}
