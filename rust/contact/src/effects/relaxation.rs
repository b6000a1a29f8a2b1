//! Effect `relaxation`: force that fades while the depth is held (quasi-linear viscoelasticity).
//!
//! `g(t) = 1 - amplitude + amplitude sum_k w_k exp(-t / time_k)`, the w normalized to 1; the force on a site is `g * d f_e`,
//! f_e being what an elastic tissue would bear (Fung 1993, 7.6). A press without a protocol is the answer at once, g = 1.

use super::definition::active::ActiveEffect;
use super::definition::entry::{Consequence, Entry, ShapeNumber, Sign, Stage};

const BRANCHES: usize = 3;

pub const ENTRY: Entry = Entry {
    name: "relaxation",
    stage: Stage::History,
    meaning: "force that fades with time at held depth, by three exponentials of time",
    amplitude: "share of the force that fades in the end; 0.33 to 0.36 on palms (Shojaeizadeh 2022)",
    most: 0.99,
    shape: &[
        time("time_1_s", 0.004, [0.001, 0.02]),
        time("time_2_s", 0.07, [0.02, 0.3]),
        time("time_3_s", 1.4, [0.3, 15.0]),
        weight("weight_1"),
        weight("weight_2"),
        weight("weight_3"),
    ],
    choices: &[],
    painted: None,
    check: Some(check),
    consequences: &[
        Consequence {
            sign: Sign::ForceFallsInHold,
            sentence: "force at held depth falls with time and comes to rest above zero",
        },
        Consequence {
            sign: Sign::ForceGrowsWithRate,
            sentence: "fast presses need more force at equal depth than slow ones",
        },
        Consequence {
            sign: Sign::LoopIsOpen,
            sentence: "loading and unloading enclose a loop, whose area depends on speed",
        },
        Consequence {
            sign: Sign::ClockIsFixed,
            sentence: "the time constants are the same for small and large contacts",
        },
    ],
    source: "Pawluk & Howe 1999, J Biomech Eng 121:178; Fung 1993, Biomechanics 7.6",
};

const fn time(name: &'static str, default: f64, physiological: [f64; 2]) -> ShapeNumber {
    ShapeNumber {
        name,
        unit: "s",
        default,
        admissible: [1e-6, 1e6],
        physiological,
        meaning: "time constant of one branch",
        source: "4 ms, 70 ms, 1.4 s (Pawluk & Howe 1999); tangential relaxation lasts 11.8 s (Pataky 2005)",
    }
}

const fn weight(name: &'static str) -> ShapeNumber {
    ShapeNumber {
        name,
        unit: "1",
        default: 1.0,
        admissible: [0.0, 1e6],
        physiological: [0.0, 10.0],
        meaning: "weight of this branch against the others",
        source: "equal weights: ours, since the abstract of Pawluk & Howe 1999 gives times only",
    }
}

/// What is wrong beyond the ranges of single numbers.
fn check(shape: &[f64], _painted: &[f64]) -> Result<(), String> {
    if shape[BRANCHES..].iter().sum::<f64>() > 0.0 {
        Ok(())
    } else {
        Err("all weights are 0; at least one must be positive".to_owned())
    }
}

/// Share of the fading force and time constant (s) of each branch.
pub fn branches(effect: &ActiveEffect) -> Vec<(f64, f64)> {
    let (times, weights) = effect.shape.split_at(BRANCHES);
    let sum: f64 = weights.iter().sum();
    let branch = |(weight, time): (&f64, &f64)| (weight / sum, *time);
    weights
        .iter()
        .zip(times)
        .map(branch)
        .filter(|b| b.0 > 0.0)
        .collect()
}
