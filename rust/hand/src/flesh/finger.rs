//! Sections of the four fingers: pads on the palm side, gentle bumps over the joints on the back, creases between the pads.

use super::sweep::{Section, Sweep};
use crate::proportions::FINGERS;
use crate::skeleton::Skeleton;

/// Share of the full depth that lies palmar of the bone axis: the bone runs along the back third (Murai 1997: 56 % palmar, 26 % dorsal).
const PALMAR_SHARE: f64 = 0.54;

/// The sweep of finger `k` (index 0 to little 3).
pub(super) fn sweep(skeleton: &Skeleton, k: usize) -> Sweep {
    let digit = &skeleton.digits[k];
    let [l1, l2, l3] = digit.lengths();
    let hb = skeleton.breadth;
    let wide = FINGERS[k].breadth.map(|b| 0.5 * b * hb);
    let deep = FINGERS[k].depth.map(|d| d * hb);
    // A place along the digit, half breadth, full depth, palmar share of it.
    let at = |along: f64, half: f64, depth: f64, share: f64| Section {
        along,
        half,
        palmar: depth * share,
        dorsal: depth * (1.0 - share),
    };
    let (pip, dip) = (l1, l1 + l2);
    let sections = vec![
        at(-0.15 * l1, wide[0] * 0.98, deep[0] * 1.02, 0.52),
        at(0.30 * l1, wide[0] * 0.99, deep[0] * 1.04, PALMAR_SHARE),
        at(0.62 * l1, wide[0] * 0.955, deep[0] * 0.99, 0.565),
        at(pip - 1.5, wide[1], deep[1] * 1.0, 0.485),
        at(pip + 0.48 * l2, wide[2] * 0.975, deep[2] * 1.03, 0.57),
        at(dip - 4.5, wide[3], deep[3] * 1.0, 0.50),
        at(dip + 1.5, wide[3], deep[3] * 0.985, 0.53),
        at(dip + 0.50 * l3, wide[4] * 1.0, deep[4] * 1.02, 0.60),
        at(dip + 0.85 * l3, wide[4] * 0.92, deep[4] * 0.91, 0.60),
        at(
            dip + l3 + digit.tip_mm,
            wide[4] * 0.86,
            deep[4] * 0.80,
            0.58,
        ),
    ];
    Sweep::new(digit, sections, wide[4] * 1.02, wide[0] * 1.1)
}
