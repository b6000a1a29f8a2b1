//! The 19 palmar regions, cut along the creases, and the tissue under each.

use crate::anatomy::Place;
use crate::skeleton::{Skeleton, THUMB};
use thenar_surface::Adjacency;

/// Which of the two published parameter sets a region takes (Xie Table 2).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RegionKind {
    /// The twelve finger pads and the two of the thumb.
    Finger,
    /// The five parts of the palm.
    Palm,
}

/// Vertices outside every region: nails, back of the hand, wrist.
pub const NO_REGION: i32 = -1;

/// Names of the regions in the order of their numbers.
pub const REGION_NAMES: [&str; 19] = [
    "thumb_distal_pad",
    "thumb_proximal_pad",
    "index_distal_pad",
    "index_middle_pad",
    "index_proximal_pad",
    "middle_distal_pad",
    "middle_middle_pad",
    "middle_proximal_pad",
    "ring_distal_pad",
    "ring_middle_pad",
    "ring_proximal_pad",
    "little_distal_pad",
    "little_middle_pad",
    "little_proximal_pad",
    "distal_palm_radial",
    "distal_palm_ulnar",
    "palm_hollow",
    "thenar",
    "hypothenar",
];

const DISTAL_PALM_RADIAL: i32 = 14;
const DISTAL_PALM_ULNAR: i32 = 15;
const PALM_HOLLOW: i32 = 16;
const THENAR: i32 = 17;
const HYPOTHENAR: i32 = 18;

/// Soft tissue over bone under a finger region, mm, assumed: a layer bulges most at 1.12 times its thickness from a narrow indenter,
/// and Xie Table 2 puts the bulge at 8 mm; pulp thickness by region was found in no source.
pub const FINGER_THICKNESS_MM: f64 = 8.0 / 1.12;
/// The same for the palm, where Xie Table 2 puts the bulge at 15 mm.
pub const PALM_THICKNESS_MM: f64 = 15.0 / 1.12;

/// Kind of each region, in the order of [`REGION_NAMES`].
pub fn region_kinds() -> [RegionKind; 19] {
    std::array::from_fn(|k| {
        if (k as i32) < DISTAL_PALM_RADIAL {
            RegionKind::Finger
        } else {
            RegionKind::Palm
        }
    })
}

/// Creases of the fingers, mm at the reference size (Bugbee & Botte 1993): base crease beyond the MCP, PIP and DIP crease before the joint.
const BASE_CREASE: [f64; 4] = [19.5, 19.5, 19.5, 16.0];
const PIP_CREASE: f64 = 2.5;
const DIP_CREASE: f64 = 7.5;
/// The thumb's creases before the IP joint and beyond the MP joint, mm; assumed, not in the source.
const THUMB_IP_CREASE: f64 = 2.5;
const THUMB_MP_CREASE: f64 = 9.5;

/// Skin this near a nail belongs to its fold, not to the pad, mm.
const NAIL_FOLD: f64 = 1.5;

/// Region of every vertex: cut by creases, then cleaned so that each region is one piece.
pub(crate) fn regions(skeleton: &Skeleton, places: &[Place], adjacency: &Adjacency) -> Vec<i32> {
    let mut regions: Vec<i32> = places.iter().map(|place| region(skeleton, place)).collect();
    for region in 0..REGION_NAMES.len() as i32 {
        keep_largest_piece(&mut regions, region, adjacency);
    }
    regions
}

fn region(skeleton: &Skeleton, place: &Place) -> i32 {
    let scale = skeleton.lengthwise();
    let [l1, l2, _] = skeleton.digits[place.digit].lengths();
    let along = place.station.along;
    let first = [2, 5, 8, 11, 0][place.digit];
    let is_pad = place.station.palmar > -0.02 * skeleton.breadth
        && place.nail > NAIL_FOLD
        && place.distance < 2.5;
    if place.digit == THUMB {
        if along < l1 + THUMB_MP_CREASE * scale || place.distance > 2.5 {
            return palm_region(skeleton, place);
        }
        let border = l1 + l2 - THUMB_IP_CREASE * scale;
        return if !is_pad {
            NO_REGION
        } else if along > border {
            first
        } else {
            first + 1
        };
    }
    if along < BASE_CREASE[place.digit] * scale || place.distance > 2.5 {
        return palm_region(skeleton, place);
    }
    let (pip, dip) = (l1 - PIP_CREASE * scale, l1 + l2 - DIP_CREASE * scale);
    if !is_pad {
        NO_REGION
    } else if along > dip {
        first
    } else if along > pip {
        first + 1
    } else {
        first + 2
    }
}

/// The palm, seen from its front in mm of the reference hand: distal of the palm creases, radial of the thenar crease, or ulnar of the hollow.
fn palm_region(skeleton: &Skeleton, place: &Place) -> i32 {
    let (x, y) = (
        place.position.x / skeleton.across(),
        place.position.y / skeleton.lengthwise(),
    );
    if place.normal.z < 0.12 || y < 0.0 {
        return NO_REGION;
    }
    // Distal crease 6.9, 10.3, 7.9 mm before the MCP of middle, ring, little; proximal crease 9.1 mm before that of the index.
    let distal = [
        [-60.0, 60.0],
        [-34.0, 62.0],
        [-17.5, 67.4],
        [0.0, 75.5],
        [21.0, 75.8],
        [60.0, 78.0],
    ];
    let thenar = [
        [0.0, 8.0],
        [22.0, 5.0],
        [42.0, 7.0],
        [60.0, 14.0],
        [75.0, 27.0],
        [79.0, 60.0],
    ];
    if y > height(&distal, x) && x < 40.0 {
        return if x > -8.75 {
            DISTAL_PALM_RADIAL
        } else {
            DISTAL_PALM_ULNAR
        };
    }
    if x > height(&thenar, y) {
        THENAR
    } else if x < -3.0 - 0.35 * y {
        HYPOTHENAR
    } else {
        PALM_HOLLOW
    }
}

/// Height of a polyline over `at`.
fn height(line: &[[f64; 2]], at: f64) -> f64 {
    let k = line[1..line.len() - 1]
        .iter()
        .take_while(|point| point[0] < at)
        .count();
    let (a, b) = (line[k], line[k + 1]);
    a[1] + (b[1] - a[1]) * ((at - a[0]) / (b[0] - a[0])).clamp(0.0, 1.0)
}

/// Gives every smaller piece of a region to the neighbour it has most vertices beside.
fn keep_largest_piece(regions: &mut [i32], region: i32, adjacency: &Adjacency) {
    let mut seen = vec![false; regions.len()];
    let mut pieces: Vec<Vec<usize>> = Vec::new();
    for start in 0..regions.len() {
        if regions[start] != region || seen[start] {
            continue;
        }
        seen[start] = true;
        let mut piece = vec![start];
        let mut at = 0;
        while at < piece.len() {
            for &n in adjacency.neighbors(piece[at]) {
                if regions[n as usize] == region && !seen[n as usize] {
                    seen[n as usize] = true;
                    piece.push(n as usize);
                }
            }
            at += 1;
        }
        pieces.push(piece);
    }
    pieces.sort_by_key(|piece| std::cmp::Reverse(piece.len()));
    for piece in pieces.iter().skip(1) {
        let mut votes = [0usize; REGION_NAMES.len() + 1];
        for &v in piece {
            for &n in adjacency
                .neighbors(v)
                .iter()
                .filter(|&&n| regions[n as usize] != region)
            {
                votes[(regions[n as usize] + 1) as usize] += 1;
            }
        }
        let winner = (0..votes.len())
            .max_by_key(|&k| (votes[k], std::cmp::Reverse(k)))
            .unwrap_or(0);
        piece.iter().for_each(|&v| regions[v] = winner as i32 - 1);
    }
}
