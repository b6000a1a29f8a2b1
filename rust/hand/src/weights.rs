//! How much each vertex follows each bone.

use crate::anatomy::Place;
use crate::armature::Bone;
use crate::skeleton::{Skeleton, THUMB};
use rayon::prelude::*;
use thenar_surface::{Adjacency, Vec3};

/// Up to four bones and their shares, largest first; unused places have share 0. Shares sum to 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VertexWeights {
    /// Places in [`crate::Hand::bones`].
    pub bones: [u32; 4],
    /// Shares, each in 0..1.
    pub shares: [f64; 4],
}

/// Sharing across a joint reaches this share of the shorter neighbouring bone to both sides (practice: 30 to 35 %).
const JOINT_REACH: f64 = 0.34;
/// A smooth step is so much steeper in its middle than a line of the same reach.
const STEEPEST: f64 = 1.5;
/// Palm skin in front of a knuckle follows the finger so much farther from it than skin of the back, mm (reference size).
const PALM_EASE: f64 = 16.0;
/// Palmar skin changes over from palm to finger so far beyond the MCP, mm (reference size): between the base crease, 14 to 20 mm
/// beyond it, and the distal palm crease, 7 to 10 mm before it (Bugbee & Botte 1993).
const PALMAR_CREASE: f64 = 3.0;
/// Smoothing passes at 2.5 mm spacing.
const PASSES: f64 = 6.0;
/// The most the thenar mass follows the thumb's metacarpal (practice: 50 to 70 %).
const THENAR_SHARE: f64 = 0.65;
/// Beyond the MCP by this many mm (reference size) a finger's skin follows no other finger.
const OWN_SKIN: f64 = 23.0;

/// Skin follows its neighbour less the farther it is from it, down to nothing over this width, mm.
const WEB_REACH: f64 = 12.0;

const FOREARM: usize = 0;
const CARPUS: usize = 1;
const THUMB_METACARPAL: usize = 18;

/// First bone of finger `k`: its metacarpal.
fn metacarpal(k: usize) -> usize {
    2 + 4 * k
}

/// Weights of every vertex.
pub(crate) fn weights(
    skeleton: &Skeleton,
    bones: &[Bone],
    places: &[Place],
    adjacency: &Adjacency,
    spacing: f64,
) -> Vec<VertexWeights> {
    let mut dense: Vec<Vec<f64>> = places
        .par_iter()
        .map(|place| first_guess(skeleton, bones, place))
        .collect();
    let passes = (PASSES * (2.5 / spacing).powi(2)).round().clamp(2.0, 40.0) as usize;
    for _ in 0..passes {
        dense = (0..dense.len())
            .into_par_iter()
            .map(|v| {
                let around = adjacency.neighbors(v);
                let mut row: Vec<f64> = dense[v].iter().map(|w| 0.5 * w).collect();
                for &n in around {
                    row.iter_mut()
                        .zip(&dense[n as usize])
                        .for_each(|(own, w)| *own += 0.5 * w / around.len() as f64);
                }
                confine(skeleton, &places[v], &mut row);
                row
            })
            .collect();
    }
    dense.iter().map(|row| largest_four(row)).collect()
}

fn smooth_step(t: f64) -> f64 {
    let t = t.clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// Share of the bone beyond a joint at `along`, mm.
fn beyond(along: f64, joint: f64, reach: f64) -> f64 {
    smooth_step(0.5 + 0.5 * (along - joint) / reach)
}

/// How far to both sides of a joint skin has to share, mm, which lies `palmar` mm from the joint's axis on the side that closes.
///
/// Bent by `t`, the two sides of a fold meet in the plane that halves the angle. A vertex `s` beyond the joint with share
/// `1/2 + s / (2 L)` stays on its own side of it if `L > palmar tan(t / 2)`.
fn fold_reach(bone: &Bone, palmar: f64) -> f64 {
    STEEPEST * palmar * (0.5 * (bone.rest_flexion + bone.limits.flexion.1)).tan()
}

fn first_guess(skeleton: &Skeleton, bones: &[Bone], place: &Place) -> Vec<f64> {
    let mut row = vec![0.0; bones.len()];
    let [l1, l2, l3] = skeleton.digits[place.digit].lengths();
    let along = place.station.along;
    let scale = skeleton.lengthwise();
    let palmar = place.station.palmar.max(0.0);
    let is_thumb = place.digit == THUMB;
    let first_bone = if is_thumb {
        THUMB_METACARPAL
    } else {
        metacarpal(place.digit) + 1
    };
    let fold = |bone: usize| fold_reach(&bones[bone], palmar);
    let second = beyond(
        along,
        l1,
        (JOINT_REACH * l1.min(l2)).max(fold(first_bone + 1)),
    );
    let third = beyond(
        along,
        l1 + l2,
        (JOINT_REACH * l2.min(l3)).max(fold(first_bone + 2)),
    );
    let ease = if is_thumb { 0.0 } else { PALM_EASE } * scale * smooth_step(palmar / (6.0 * scale));
    let near = 1.0 - smooth_step((place.distance - 1.5) / (4.0 + ease));
    let own = if is_thumb {
        smooth_step((along - 0.35 * l1) / (0.45 * l1))
    } else {
        let joint = if palmar > 0.0 { PALMAR_CREASE } else { 1.0 } * scale;
        beyond(along, joint, (11.0 * scale).max(fold(first_bone)))
    };
    let digit = own * near;
    let mut first = digit * (1.0 - second);
    for finger in 0..THUMB {
        let share = first * web_share(skeleton, place, finger);
        row[metacarpal(finger) + 1] += share;
        first -= share;
    }
    row[first_bone] += first;
    row[first_bone + 1] += digit * second * (1.0 - third);
    row[first_bone + 2] += digit * second * third;
    let hand = smooth_step(0.5 + 0.5 * place.position.y / (14.0 * scale));
    row[FOREARM] += (1.0 - digit) * (1.0 - hand);
    share_palm(skeleton, bones, place, ((1.0 - digit) * hand, &mut row));
    row
}

/// Spreads `amount` over carpus, metacarpals and the thumb's metacarpal by distance.
fn share_palm(
    skeleton: &Skeleton,
    bones: &[Bone],
    place: &Place,
    (amount, row): (f64, &mut [f64]),
) {
    let p = place.position;
    let s = skeleton.across();
    let thumb_distance = segment_distance(p, &bones[THUMB_METACARPAL]) - 4.0 * s;
    let distances: [f64; 4] = std::array::from_fn(|k| segment_distance(p, &bones[metacarpal(k)]));
    let nearest = distances.iter().copied().fold(f64::INFINITY, f64::min);
    let thumb = THENAR_SHARE * smooth_step(0.5 + (nearest - thumb_distance) / (16.0 * s));
    row[THUMB_METACARPAL] += amount * thumb;
    let rest = amount * (1.0 - thumb);
    let carpal = 1.0 - smooth_step((p.y / skeleton.lengthwise() - 4.0) / 30.0);
    row[CARPUS] += rest * carpal;
    let shares = distances.map(|d| (-((d - nearest) / (6.0 * s)).powi(2)).exp());
    let total: f64 = shares.iter().sum();
    for (k, share) in shares.iter().enumerate() {
        row[metacarpal(k)] += rest * (1.0 - carpal) * share / total;
    }
}

fn segment_distance(p: Vec3, bone: &Bone) -> f64 {
    let edge = bone.tail - bone.head;
    let t = ((p - bone.head).dot(&edge) / edge.norm_squared()).clamp(0.0, 1.0);
    (p - bone.head - edge * t).norm()
}

/// The most a vertex of one finger may follow a neighbouring finger: half on the middle of the web, nothing [`WEB_REACH`] mm from it or beyond it.
fn web_share(skeleton: &Skeleton, place: &Place, finger: usize) -> f64 {
    if place.digit == THUMB || finger == place.digit {
        return 0.0;
    }
    let apart = (place.distances[finger] - place.distance) / WEB_REACH;
    let scale = skeleton.lengthwise();
    let beyond = smooth_step((place.station.along / scale - OWN_SKIN) / 8.0);
    smooth_step(0.5 - 0.5 * apart) * (1.0 - beyond)
}

/// Takes away what smoothing carried onto a finger from its neighbours.
fn confine(skeleton: &Skeleton, place: &Place, row: &mut [f64]) {
    if place.digit == THUMB {
        return;
    }
    for finger in (0..THUMB).filter(|&k| k != place.digit) {
        let allowed = web_share(skeleton, place, finger);
        let phalanges = metacarpal(finger) + 1..metacarpal(finger) + 4;
        let present: f64 = row[phalanges.clone()].iter().sum();
        if present > allowed {
            row[phalanges]
                .iter_mut()
                .for_each(|share| *share *= allowed / present);
            row[metacarpal(place.digit) + 1] += present - allowed;
        }
    }
}

fn largest_four(row: &[f64]) -> VertexWeights {
    let mut order: Vec<usize> = (0..row.len()).collect();
    order.sort_by(|&a, &b| row[b].total_cmp(&row[a]).then(a.cmp(&b)));
    let total: f64 = order[..4].iter().map(|&b| row[b]).sum();
    VertexWeights {
        bones: std::array::from_fn(|k| order[k] as u32),
        shares: std::array::from_fn(|k| row[order[k]] / total),
    }
}
