//! Effect `rate_independent_loss`: a loop between loading and unloading that does not know time.
//!
//! A branch that fades with the way pressed instead of with time (endochronic theory, Valanis 1971): its clock is the travel
//! of the region's largest depth over `length_mm`. The loop is the same at every speed, and nothing fades in a hold.

use super::definition::active::ActiveEffect;
use super::definition::entry::{Consequence, Entry, ShapeNumber, Sign, Stage};

pub const ENTRY: Entry = Entry {
    name: "rate_independent_loss",
    stage: Stage::History,
    meaning: "energy lost per cycle that does not depend on speed",
    amplitude: "share of the stiffness that fades with travel",
    most: 0.99,
    shape: &[ShapeNumber {
        name: "length_mm",
        unit: "mm",
        default: 0.5,
        admissible: [1e-4, 1e4],
        physiological: [0.05, 5.0],
        meaning: "travel over which it fades to 1/e",
        source: "ours: between the smallest strokes (0.2 mm) and the largest depths recorded; loops lose 48 to 80 % (Wang & Hayward 2007)",
    }],
    choices: &[],
    painted: None,
    check: None,
    consequences: &[
        Consequence {
            sign: Sign::LoopIsOpen,
            sentence: "loading and unloading enclose a loop",
        },
        Consequence {
            sign: Sign::SpeedDoesNotMatter,
            sentence: "the loop's area is the same at every speed",
        },
        Consequence {
            sign: Sign::ForceStaysInHold,
            sentence: "force at held depth does not fall",
        },
    ],
    source: "Valanis 1971, Arch Mech 23:517 (endochronic theory)",
};

/// Travel over which the branch fades, mm.
pub fn length(effect: &ActiveEffect) -> f64 {
    effect.shape[0]
}
