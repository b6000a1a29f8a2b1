//! Effect `misregistration`: a mat shifted and rotated against its stated placement.

use super::mat::placement::Placement;
use crate::effects::{ActiveEffect, Consequence, Entry, ShapeNumber, Sign, Stage};

const SHIFT: &str =
    "where a mat taped on by hand lies: about 1 mm and 2 degrees; range: half a sensel to two";

pub const ENTRY: Entry = Entry {
    name: "misregistration",
    stage: Stage::Instrument,
    meaning: "a mat that lies beside where it is said to lie",
    amplitude: "share of shift and turn",
    most: 1.0,
    shape: &[
        shift("shift_1_mm", 1.0, "shift of the mat in its first direction"),
        shift(
            "shift_2_mm",
            0.0,
            "shift of the mat in its second direction",
        ),
        ShapeNumber {
            name: "turn_rad",
            unit: "rad",
            default: 0.0,
            admissible: [-7.0, 7.0],
            physiological: [-0.2, 0.2],
            meaning: "turn of the mat about its middle, from the first direction to the second, before the shift",
            source: SHIFT,
        },
    ],
    choices: &[],
    painted: None,
    check: None,
    consequences: &[
        Consequence {
            sign: Sign::MovesWithTheMat,
            sentence: "the map is displaced by the same shift and turn in every recording of that mat, whatever the skin does",
        },
        Consequence {
            sign: Sign::ForceStays,
            sentence: "the map's force stays unless the contact leaves the mat",
        },
    ],
    source: "rigid motion on the unrolled mat",
};

const fn shift(name: &'static str, default: f64, meaning: &'static str) -> ShapeNumber {
    ShapeNumber {
        name,
        unit: "mm",
        default,
        admissible: [-1000.0, 1000.0],
        physiological: [-10.0, 10.0],
        meaning,
        source: SHIFT,
    }
}

/// How the mat lies with it.
pub fn placement(effect: &ActiveEffect) -> Placement {
    let [x, y, turn] = [0, 1, 2].map(|k| effect.amplitude * effect.shape[k]);
    Placement {
        shift_mm: [x, y],
        turn_rad: turn,
    }
}
