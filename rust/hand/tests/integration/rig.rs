//! Bones, weights and regions: where they lie, and what a closing hand does to the skin.

use crate::measuring;

use measuring::{bone, default_hand, hand, posture, volume};
use thenar_hand::{Hand, HandShape, NO_REGION, RegionKind, Side};
use thenar_surface::{Adjacency, Mesh, Vec3, self_intersections};

const FINGERS: [&str; 4] = ["index", "middle", "ring", "little"];

/// Winding number of a closed mesh about a point: 1 inside, 0 outside (van Oosterom & Strackee 1983).
fn winding(mesh: &Mesh, p: Vec3) -> f64 {
    let angle = |[a, b, c]: [Vec3; 3]| {
        let (a, b, c) = (a - p, b - p, c - p);
        let (la, lb, lc) = (a.norm(), b.norm(), c.norm());
        let below = la * lb * lc + a.dot(&b) * lc + b.dot(&c) * la + c.dot(&a) * lb;
        2.0 * a.dot(&b.cross(&c)).atan2(below)
    };
    (0..mesh.triangles().len())
        .map(|t| angle(measuring::corners(mesh, t)))
        .sum::<f64>()
        / (4.0 * std::f64::consts::PI)
}

#[test]
fn bones_lie_inside_the_skin_and_hang_together() {
    let hand = default_hand();
    assert_eq!(hand.bones.len(), 21);
    for (k, bone) in hand.bones.iter().enumerate() {
        assert!(bone.parent.is_none_or(|parent| parent < k));
        for share in [0.03, 0.5, 0.97] {
            let p = bone.head + (bone.tail - bone.head) * share;
            assert!(
                (winding(&hand.mesh, p) - 1.0).abs() < 1e-6,
                "{} at {share}",
                bone.name
            );
        }
        let along = (bone.tail - bone.head).normalize();
        assert!(
            along.dot(&bone.flexion_axis).abs() < 0.2 && along.dot(&bone.palmar).abs() < 1e-9,
            "{}",
            bone.name
        );
    }
}

#[test]
fn positive_turns_close_the_hand_on_both_sides() {
    for side in [Side::Right, Side::Left] {
        let hand = hand(&HandShape {
            side,
            spacing_mm: 5.0,
            ..HandShape::default()
        });
        for finger in FINGERS {
            let mut turns = posture(&hand, &[(&format!("{finger}_proximal"), 60.0)]);
            let tip = hand.bones[bone(&hand, &format!("{finger}_distal"))].tail;
            let k = bone(&hand, &format!("{finger}_proximal"));
            let moved = hand.bone_transforms(&turns)[k + 2] * nalgebra::Point3::from(tip);
            assert!(moved.z > tip.z + 20.0, "{finger} {side:?}");
            turns[k].flexion = 0.0;
            turns[k].abduction = 0.2;
            let moved = hand.bone_transforms(&turns)[k + 2] * nalgebra::Point3::from(tip);
            let radial = if side == Side::Right { 1.0 } else { -1.0 };
            assert!((moved.x - tip.x) * radial > 5.0, "{finger} {side:?}");
        }
    }
}

#[test]
fn bent_fingers_converge_on_the_scaphoid() {
    let hand = hand(&HandShape {
        spacing_mm: 5.0,
        ..HandShape::default()
    });
    let tip = |finger: &str| {
        let names = ["proximal", "middle", "distal"].map(|part| format!("{finger}_{part}"));
        let turns = posture(
            &hand,
            &[(&names[0], 85.0), (&names[1], 95.0), (&names[2], 40.0)],
        );
        let k = bone(&hand, &names[2]);
        (hand.bone_transforms(&turns)[k] * nalgebra::Point3::from(hand.bones[k].tail)).coords
    };
    let straight = |finger: &str| hand.bones[bone(&hand, &format!("{finger}_distal"))].tail;
    let bent = (tip("index") - tip("little")).norm();
    let open = (straight("index") - straight("little")).norm();
    assert!(bent < 0.7 * open, "{bent} mm bent, {open} mm open");
}

#[test]
fn weights_sum_to_one_and_never_bleed_onto_another_finger() {
    let hand = default_hand();
    let bases: Vec<usize> = FINGERS
        .iter()
        .map(|finger| bone(hand, &format!("{finger}_proximal")))
        .collect();
    for (v, weights) in hand.weights.iter().enumerate() {
        assert!((weights.shares.iter().sum::<f64>() - 1.0).abs() < 1e-12);
        assert!(
            weights
                .shares
                .iter()
                .all(|share| (0.0..=1.0).contains(share))
        );
        let region = hand.regions[v];
        if !(2..14).contains(&region) {
            continue;
        }
        let own = (region as usize - 2) / 3;
        for (bone, share) in weights.bones.iter().zip(weights.shares) {
            let other = bases
                .iter()
                .position(|base| (*base..base + 3).contains(&(*bone as usize)));
            let most = if (region - 2) % 3 == 2 { 0.5 } else { 1e-9 };
            assert!(
                other.is_none_or(|finger| finger == own) || share < most,
                "vertex {v} of region {region}: {share}"
            );
        }
    }
}

#[test]
fn weights_change_smoothly_along_the_skin() {
    let hand = default_hand();
    let mut steepest = 0.0_f64;
    for triangle in hand.mesh.triangles() {
        for k in 0..3 {
            let (a, b) = (
                &hand.weights[triangle[k] as usize],
                &hand.weights[triangle[(k + 1) % 3] as usize],
            );
            let share = |w: &thenar_hand::VertexWeights, bone: u32| {
                (0..4)
                    .filter(|&i| w.bones[i] == bone)
                    .map(|i| w.shares[i])
                    .sum::<f64>()
            };
            let change: f64 = a
                .bones
                .iter()
                .map(|&bone| (share(a, bone) - share(b, bone)).abs())
                .sum();
            steepest = steepest.max(change);
        }
    }
    assert!(steepest < 1.1, "{steepest} over one edge");
}

#[test]
fn nineteen_regions_each_in_one_piece_and_none_on_nails_or_back() {
    let hand = default_hand();
    let adjacency = Adjacency::new(&hand.mesh);
    assert_eq!(hand.region_names.len(), 19);
    assert_eq!(
        hand.kinds
            .iter()
            .filter(|kind| **kind == RegionKind::Finger)
            .count(),
        14
    );
    for region in 0..19 {
        let members: Vec<usize> = (0..hand.regions.len())
            .filter(|&v| hand.regions[v] == region)
            .collect();
        assert!(
            members.len() >= 40,
            "{} has {}",
            hand.region_names[region as usize],
            members.len()
        );
        let mut seen = vec![false; hand.regions.len()];
        let mut stack = vec![members[0]];
        seen[members[0]] = true;
        let mut reached = 0;
        while let Some(v) = stack.pop() {
            reached += 1;
            for &n in adjacency.neighbors(v) {
                if hand.regions[n as usize] == region && !seen[n as usize] {
                    seen[n as usize] = true;
                    stack.push(n as usize);
                }
            }
        }
        assert_eq!(
            reached,
            members.len(),
            "{} is in pieces",
            hand.region_names[region as usize]
        );
    }
    let normals = thenar_surface::vertex_normals(&hand.mesh);
    for (v, normal) in normals.iter().enumerate() {
        let palmar = hand.bones[hand.weights[v].bones[0] as usize].palmar;
        assert!(
            normal.dot(&palmar) > -0.75 || hand.regions[v] == NO_REGION,
            "vertex {v} faces back"
        );
    }
    assert!((0..hand.nails.len()).all(|v| !hand.nails[v] || hand.regions[v] == NO_REGION));
    assert!(hand.nails.iter().filter(|nail| **nail).count() > 150);
}

/// Flexion of MCP, PIP, DIP around a cylinder some 48 mm thick, and in a fist.
fn closed(hand: &Hand, [mcp, pip, dip]: [f64; 3]) -> Mesh {
    let names: Vec<(String, f64)> = FINGERS
        .iter()
        .flat_map(|finger| {
            [("proximal", mcp), ("middle", pip), ("distal", dip)]
                .map(|(part, angle)| (format!("{finger}_{part}"), angle))
        })
        .collect();
    let mut flexions: Vec<(&str, f64)> = names
        .iter()
        .map(|(name, angle)| (name.as_str(), *angle))
        .collect();
    flexions.extend([("ring_metacarpal", 6.0), ("little_metacarpal", 12.0)]);
    hand.mesh
        .with_positions(hand.posed(&posture(hand, &flexions)))
        .expect("a posed mesh")
}

#[test]
fn closing_hands_keep_their_volume_and_hardly_cut_themselves() {
    let hand = default_hand();
    let open = volume(&hand.mesh);
    for (angles, most_volume, most_crossing) in [
        ([45.0, 55.0, 30.0], 0.04, 0.01),
        ([80.0, 95.0, 55.0], 0.12, 0.06),
    ] {
        let mesh = closed(hand, angles);
        let change = (volume(&mesh) - open).abs() / open;
        let crossing = self_intersections(&mesh) as f64 / mesh.triangles().len() as f64;
        println!(
            "flexion {angles:?}: volume changes by {:.2} %, {:.2} % of triangles cross",
            100.0 * change,
            100.0 * crossing
        );
        assert!(
            change < most_volume,
            "volume changes by {change} at {angles:?}"
        );
        assert!(
            crossing < most_crossing,
            "{crossing} of triangles cross at {angles:?}"
        );
    }
}
