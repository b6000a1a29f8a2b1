//! Effect `crosstalk`: sensels that share part of their reading with their neighbors.
//!
//! Through each side shared by two sensels flows `amplitude * share * min(A_i, A_j) (p_j - p_i)`, so the map's force stays what it is
//! and an even pressure stays even.

use super::mat::Mat;
use super::signals::Signals;
use crate::effects::{ActiveEffect, Consequence, Entry, ShapeNumber, Sign, Stage};

pub const ENTRY: Entry = Entry {
    name: "crosstalk",
    stage: Stage::Instrument,
    meaning: "sensels that pass part of their reading to the sensels beside them",
    amplitude: "share of the crosstalk",
    most: 1.0,
    shape: &[ShapeNumber {
        name: "share",
        unit: "1",
        default: 0.05,
        admissible: [0.0, 0.25],
        physiological: [0.0, 0.15],
        meaning: "part of the difference of two neighbors that passes from one to the other",
        source: "ours; with four neighbors more than 0.25 would turn a peak into a hollow",
    }],
    choices: &[],
    painted: None,
    check: None,
    consequences: &[
        Consequence {
            sign: Sign::BlursTheMap,
            sentence: "an edge is blurred over neighboring sensels, under a rigid stamp too, while the force stays",
        },
        Consequence {
            sign: Sign::MovesWithTheMat,
            sentence: "the blur follows the mat's rows and columns when the mat is turned",
        },
    ],
    source: "diffusion between neighbors, one explicit step",
};

/// Applies it.
pub fn apply(effect: &ActiveEffect, signals: &mut Signals, mat: &Mat) {
    let share = effect.amplitude * effect.shape[0];
    for frame in &mut signals.frames {
        *frame = blurred(mat, frame, share);
    }
}

fn blurred(mat: &Mat, frame: &[f64], share: f64) -> Vec<f64> {
    let mut blurred = frame.to_vec();
    let areas = mat.areas();
    for sensel in 0..mat.len() {
        for other in mat.neighbors(sensel) {
            // Each shared side once: from the lower number, or where only the higher one knows of it.
            if other < sensel && mat.neighbors(other).any(|back| back == sensel) {
                continue;
            }
            let flow = share * areas[sensel].min(areas[other]) * (frame[other] - frame[sensel]);
            blurred[sensel] += flow / areas[sensel];
            blurred[other] -= flow / areas[other];
        }
    }
    blurred
}
