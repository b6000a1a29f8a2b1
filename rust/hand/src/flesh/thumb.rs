//! Sections of the thumb, from its metacarpal to the broad flat tip.

use super::sweep::{Section, Sweep};
use crate::skeleton::{Skeleton, THUMB};

/// The thumb's sweep; its root lies inside the thenar mass.
pub(super) fn sweep(skeleton: &Skeleton) -> Sweep {
    let digit = &skeleton.digits[THUMB];
    let [l1, l2, l3] = digit.lengths();
    let hb = skeleton.breadth;
    // Along, then half breadth, palmar and dorsal depth in HB. Breadth at the IP joint .26 HB, depth .245 (22.6 and 21.3 of 87 mm; Pheasant & Haslegrave: 23 and 22).
    let at = |along: f64, half: f64, palmar: f64, dorsal: f64| Section {
        along,
        half: half * hb,
        palmar: palmar * hb,
        dorsal: dorsal * hb,
    };
    let (mp, ip) = (l1, l1 + l2);
    let sections = vec![
        at(-0.1 * l1, 0.130, 0.130, 0.125),
        at(0.35 * l1, 0.135, 0.140, 0.118),
        at(0.75 * l1, 0.134, 0.138, 0.116),
        at(mp + 1.0, 0.132, 0.126, 0.128),
        at(mp + 0.50 * l2, 0.120, 0.130, 0.110),
        at(ip - 1.0, 0.130, 0.121, 0.124),
        at(ip + 0.25 * l3, 0.128, 0.118, 0.110),
        at(ip + 0.55 * l3, 0.130, 0.126, 0.088),
        at(ip + 0.82 * l3, 0.118, 0.108, 0.072),
        at(ip + l3 + digit.tip_mm, 0.104, 0.090, 0.058),
    ];
    Sweep::new(digit, sections, 0.112 * hb, 0.14 * hb)
}
