//! Effect `adhesion`: skin that clings to the product, from DMT's limit to JKR's.
//!
//! Attraction falls linearly with the gap and ends at `range_mm`; its area is the work of adhesion, as in Maugis (1992) with
//! a ramp for his step. A wide range gives DMT's pull-off `2 pi w R`, a short one JKR's `1.5 pi w R`. It pulls where skin is
//! nearer than the range, so the skin leaps into contact and lets go later than it came. Bonds that form on touch alone, as those of
//! sweat or glue, pull nothing on the way in: skin is pulled from when it touches until its gap exceeds the range.

use super::definition::active::ActiveEffect;
use super::definition::entry::{Choice, Consequence, Entry, ShapeNumber, Sign, Stage};

const WORK: usize = 0;
const RANGE: usize = 1;
/// N/mm in 1 J/m2.
const N_PER_MM: f64 = 1e-3;

pub const ENTRY: Entry = Entry {
    name: "adhesion",
    stage: Stage::Interface,
    meaning: "attraction between skin and product over a short range, which holds on when the product leaves",
    amplitude: "share of the work of adhesion",
    most: 1.0,
    shape: &[
        ShapeNumber {
            name: "work_j_per_m2",
            unit: "J/m2",
            default: 0.1,
            admissible: [0.0, 100.0],
            physiological: [0.0, 0.4],
            meaning: "energy to separate skin and product, per area",
            source: "Spinner 2016, doi 10.1016/j.jbiomech.2016.01.033: at most 15 mN on smooth epoxy, 0.4 J/m2 by JKR on a pad of \
                     8 mm; Tiwari 2020, arXiv 2007.03515: none measurable for a dry finger on clean glass",
        },
        ShapeNumber {
            name: "range_mm",
            unit: "mm",
            default: 0.02,
            admissible: [1e-6, 10.0],
            physiological: [1e-4, 0.1],
            meaning: "gap at which the attraction ends",
            source: "ours: about the roughness between skin ridges; no measurement known",
        },
    ],
    choices: &[Choice {
        name: "bonds",
        options: &["reversible", "touched"],
        meaning: "which skin is pulled: all within the range (reversible), or only what has touched and has not let go since",
    }],
    painted: None,
    check: None,
    consequences: &[
        Consequence {
            sign: Sign::ForcePulls,
            sentence: "on the way out the product must be pulled off",
        },
        Consequence {
            sign: Sign::AreaAtZeroForce,
            sentence: "there is contact at no load, and more of it on the way out than on the way in",
        },
        Consequence {
            sign: Sign::LoopIsOpen,
            sentence: "loading and unloading enclose a loop near no load, of the same area at every speed",
        },
    ],
    source: "Maugis 1992, J Colloid Interface Sci 150:243; Johnson, Kendall & Roberts 1971; Derjaguin, Muller & Toporov 1975",
};

/// Work of adhesion at amplitude 1, N/mm.
pub fn work(adhesion: &ActiveEffect) -> f64 {
    adhesion.shape[WORK] * N_PER_MM
}

/// Gap at which the attraction ends, mm.
pub fn range(adhesion: &ActiveEffect) -> f64 {
    adhesion.shape[RANGE]
}

/// Whether bonds form on touch alone.
pub fn is_on_touch(adhesion: &ActiveEffect) -> bool {
    adhesion.chosen[0] == 1
}
