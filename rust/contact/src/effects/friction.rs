//! Effect `friction`: Coulomb's law between skin and product.
//!
//! The shear force on a vertex stays within the coefficient times its normal force; where it is that large the skin slips
//! against it. The skin answers as a bonded layer, or a half space (Cerruti), sheared at its surface. It acts when the product
//! is dragged ([`crate::Drag`]); a press along the normal alone shears nothing.

use super::definition::active::ActiveEffect;
use super::definition::entry::{Consequence, Entry, ShapeNumber, Sign, Stage};

const COEFFICIENT: usize = 0;

pub const ENTRY: Entry = Entry {
    name: "friction",
    stage: Stage::Interface,
    meaning: "skin that sticks to the product and slips over it by Coulomb's law when the product is dragged",
    amplitude: "share of the coefficient of friction",
    most: 1.0,
    shape: &[ShapeNumber {
        name: "coefficient",
        unit: "1",
        default: 0.5,
        admissible: [0.0, 10.0],
        physiological: [0.27, 0.66],
        meaning: "shear force over normal force at which skin slips",
        source: "Buchholz 1988, Ergonomics 31:317: palm on paper 0.27 to suede and tape, moist, 0.66; textured vinyl 0.50",
    }],
    choices: &[],
    painted: None,
    check: None,
    consequences: &[
        Consequence {
            sign: Sign::TangentialForce,
            sentence: "a dragged product pulls along the skin, at most the coefficient times the normal force",
        },
        Consequence {
            sign: Sign::FollowsSliding,
            sentence: "the pull and what it does to the skin turn round with the direction of sliding",
        },
        Consequence {
            sign: Sign::LoopIsOpen,
            sentence: "dragging to and fro encloses a loop of force over travel, of the same area at every speed",
        },
        Consequence {
            sign: Sign::SpeedDoesNotMatter,
            sentence: "curves at different speeds lie on one another",
        },
    ],
    source: "Coulomb; Cattaneo 1938, Mindlin 1949; Johnson 1985, Contact Mechanics 7.2",
};

/// The coefficient of friction at amplitude 1.
pub fn coefficient(friction: &ActiveEffect) -> f64 {
    friction.shape[COEFFICIENT]
}
