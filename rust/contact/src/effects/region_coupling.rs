//! Effect `region_coupling`: cuts along creases, whole or in part.
//!
//! The response becomes `(1 - amplitude) K + amplitude blockdiag(K)`, the blocks being the regions it acts on, and the rest of
//! the skin as one. Both terms are definite, and so is their mixture. Amplitude 1 is the cut that the paper makes between
//! all regions (Xie 3.2); amplitude 0 is skin in one piece.

use super::definition::active::ActiveEffect;
use super::definition::entry::{Consequence, Entry, Sign, Stage};
use crate::response::tissue_geometry::Cut;
use crate::skin::sites::Sites;

pub const ENTRY: Entry = Entry {
    name: "region_coupling",
    stage: Stage::Geometry,
    meaning: "regions that answer each other's forces only in part, as if cut along their creases",
    amplitude: "share of the response across borders that is cut; 1 makes regions independent",
    most: 1.0,
    shape: &[],
    choices: &[],
    painted: None,
    check: None,
    consequences: &[
        Consequence {
            sign: Sign::BelongsToTheCrease,
            sentence: "presses within one region stay as they are; presses across a crease change",
        },
        Consequence {
            sign: Sign::ForceIsLarger,
            sentence: "a press across a crease needs more force at equal depth than skin in one piece",
        },
        Consequence {
            sign: Sign::SpeedDoesNotMatter,
            sentence: "curves at different speeds lie on one another",
        },
    ],
    source: "independent regions: Xie 3.2; partial coupling: a convex combination of both limits (ours)",
};

/// The cut that it makes.
pub fn cut(coupling: &ActiveEffect, sites: &Sites) -> Cut {
    let block = |site: usize| {
        let region = sites.home_region(site);
        if coupling.acts_on(region) {
            region
        } else {
            u32::MAX
        }
    };
    Cut {
        block: (0..sites.len()).map(block).collect(),
        kept: 1.0 - coupling.amplitude,
    }
}
