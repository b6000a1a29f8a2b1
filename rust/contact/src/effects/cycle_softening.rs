//! Effect `cycle_softening`: tissue that grows softer with use and recovers in rest.
//!
//! The modulus of a region is multiplied by `1 - amplitude D`. While depth grows, D follows `dD = (1 - D) dd / travel_mm`; in
//! unloading and holding it stays; while nothing presses the region, it fades as `exp(-t / recovery_s)`. Stiffness thus
//! falls only under load and comes back only without, so that no cycle gives energy.

use super::definition::active::ActiveEffect;
use super::definition::entry::{Consequence, Entry, ShapeNumber, Sign, Stage};

const TRAVEL: usize = 0;
const RECOVERY: usize = 1;

pub const ENTRY: Entry = Entry {
    name: "cycle_softening",
    stage: Stage::History,
    meaning: "stiffness that falls from cycle to cycle and recovers in rest (preconditioning)",
    amplitude: "share of the stiffness that use can take away",
    most: 0.95,
    shape: &[
        ShapeNumber {
            name: "travel_mm",
            unit: "mm",
            default: 3.0,
            admissible: [1e-3, 1e4],
            physiological: [0.5, 30.0],
            meaning: "loading travel, added over cycles, after which 63 % of the softening has happened",
            source: "ours: a few presses of 1 to 3 mm; preconditioning takes a few cycles (Fung 1993, 7.2)",
        },
        ShapeNumber {
            name: "recovery_s",
            unit: "s",
            default: 60.0,
            admissible: [1e-3, 1e7],
            physiological: [5.0, 1000.0],
            meaning: "time without load after which 63 % has come back",
            source: "ours: minutes, as preconditioned tissue recovers in rest; no figure for fingers was found",
        },
    ],
    choices: &[],
    painted: None,
    check: None,
    consequences: &[
        Consequence {
            sign: Sign::LaterCyclesAreSofter,
            sentence: "later cycles need less force at equal depth, by less from cycle to cycle",
        },
        Consequence {
            sign: Sign::RestRestores,
            sentence: "after minutes without load the first cycle's force is back",
        },
        Consequence {
            sign: Sign::SpeedDoesNotMatter,
            sentence: "what matters is the count of cycles and their depth, not their speed",
        },
    ],
    source: "Mullins-like softening by internal variable (Ogden & Roxburgh 1999), accumulating; preconditioning: Fung 1993, 7.2",
};

/// D of a region after a step that brought its depth from `last` to `depth` (mm).
pub fn used(effect: &ActiveEffect, d: f64, (last, depth): (f64, f64)) -> f64 {
    1.0 - (1.0 - d) * (-(depth - last).max(0.0) / effect.shape[TRAVEL]).exp()
}

/// D of a region after `seconds` without load.
pub fn rested(effect: &ActiveEffect, d: f64, seconds: f64) -> f64 {
    d * (-seconds / effect.shape[RECOVERY]).exp()
}
