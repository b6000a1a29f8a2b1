//! Lengths, breadths and depths measured on the mesh against the published table, both sexes, 5th, 50th and 95th percentile.

use crate::measuring;

use measuring::{bone, hand, posture};
use thenar_hand::{Hand, HandShape, Sex};
use thenar_surface::{Mesh, Vec3};

/// Pheasant & Haslegrave, Bodyspace, British adults 19 to 65, mm: men 5th, 50th, 95th percentile, deviation; women the same.
///
/// Written down without the book at hand: only hand breadth was checked, against a reprint that rounds to 5 mm.
const TABLE: [(&str, [f64; 8]); 13] = [
    (
        "hand length",
        [173.0, 189.0, 205.0, 10.0, 159.0, 174.0, 189.0, 9.0],
    ),
    (
        "palm length",
        [98.0, 107.0, 116.0, 6.0, 89.0, 97.0, 105.0, 5.0],
    ),
    (
        "thumb length",
        [44.0, 51.0, 58.0, 4.0, 40.0, 47.0, 53.0, 4.0],
    ),
    (
        "index length",
        [64.0, 72.0, 79.0, 5.0, 60.0, 67.0, 74.0, 4.0],
    ),
    (
        "middle length",
        [76.0, 83.0, 90.0, 5.0, 69.0, 77.0, 84.0, 5.0],
    ),
    (
        "ring length",
        [65.0, 72.0, 80.0, 4.0, 59.0, 66.0, 73.0, 4.0],
    ),
    (
        "little length",
        [48.0, 55.0, 63.0, 4.0, 43.0, 50.0, 57.0, 4.0],
    ),
    (
        "thumb breadth at IP",
        [20.0, 23.0, 26.0, 2.0, 17.0, 19.0, 21.0, 2.0],
    ),
    (
        "thumb depth at IP",
        [19.0, 22.0, 24.0, 2.0, 15.0, 18.0, 20.0, 2.0],
    ),
    (
        "index breadth at PIP",
        [19.0, 21.0, 23.0, 1.0, 16.0, 18.0, 20.0, 1.0],
    ),
    (
        "index depth at PIP",
        [17.0, 19.0, 21.0, 1.0, 14.0, 16.0, 18.0, 1.0],
    ),
    (
        "hand breadth",
        [78.0, 87.0, 95.0, 5.0, 69.0, 76.0, 83.0, 4.0],
    ),
    (
        "hand depth at middle MCP",
        [27.0, 33.0, 38.0, 3.0, 24.0, 28.0, 33.0, 3.0],
    ),
];

/// A hand with straight fingers, and its skin.
struct Straight {
    hand: Hand,
    skin: Mesh,
}

impl Straight {
    fn new(shape: &HandShape) -> Straight {
        let hand = hand(shape);
        let names: Vec<String> = hand
            .bones
            .iter()
            .filter(|b| b.rest_flexion > 0.0)
            .map(|b| b.name.clone())
            .collect();
        let flexions: Vec<(&str, f64)> = names.iter().map(|name| (name.as_str(), 0.0)).collect();
        let skin = hand
            .mesh
            .with_positions(hand.posed(&posture(&hand, &flexions)))
            .expect("a straight hand");
        Straight { hand, skin }
    }

    /// Distance along a digit from its base crease (the palmar border of its last pad) to its tip.
    fn digit_length(&self, digit: &str, first: &str) -> f64 {
        let base = &self.hand.bones[bone(&self.hand, &format!("{digit}_{first}"))];
        let region = self
            .hand
            .region_names
            .iter()
            .position(|n| *n == format!("{digit}_proximal_pad"))
            .expect("a pad") as i32;
        let straight = self.straight_direction(digit, first);
        let along = |v: usize| (self.skin.positions()[v] - base.head).dot(&straight);
        let on_axis = |v: usize| {
            (self.hand.mesh.positions()[v] - base.head)
                .dot(&base.flexion_axis)
                .abs()
                < 4.0
        };
        let own = |v: usize| {
            self.hand.bones[self.hand.weights[v].bones[0] as usize]
                .name
                .starts_with(digit)
        };
        let all = 0..self.hand.regions.len();
        let tip = all
            .clone()
            .filter(|&v| own(v))
            .map(along)
            .fold(f64::NEG_INFINITY, f64::max);
        let crease = all
            .filter(|&v| self.hand.regions[v] == region && on_axis(v))
            .map(along)
            .fold(f64::INFINITY, f64::min);
        tip - crease
    }

    /// Direction of a straightened digit: its first bone's rest direction turned back by its rest flexion.
    fn straight_direction(&self, digit: &str, first: &str) -> Vec3 {
        let bone = &self.hand.bones[bone(&self.hand, &format!("{digit}_{first}"))];
        let along = (bone.tail - bone.head).normalize();
        nalgebra::Rotation3::from_scaled_axis(-bone.flexion_axis * bone.rest_flexion) * along
    }

    /// Extent along `measured` of the cut through the rest skin by the plane at `at` across `along`, within 20 mm.
    fn section(&self, own: impl Fn(usize) -> bool, at: Vec3, [along, measured]: [Vec3; 2]) -> f64 {
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for triangle in self
            .hand
            .mesh
            .triangles()
            .iter()
            .filter(|t| own(t[0] as usize))
        {
            for k in 0..3 {
                let [a, b] = [triangle[k], triangle[(k + 1) % 3]]
                    .map(|v| self.hand.mesh.positions()[v as usize] - at);
                let (da, db) = (a.dot(&along), b.dot(&along));
                if da * db < 0.0 {
                    let p = a + (b - a) * (da / (da - db));
                    if p.norm() < 24.0 {
                        low = low.min(p.dot(&measured));
                        high = high.max(p.dot(&measured));
                    }
                }
            }
        }
        high - low
    }

    fn belongs(&self, v: usize, digit: &str) -> bool {
        self.hand.bones[self.hand.weights[v].bones[0] as usize]
            .name
            .starts_with(digit)
    }

    fn joint_section(&self, name: &str) -> (f64, f64) {
        let k = bone(&self.hand, name);
        let (own, before) = (&self.hand.bones[k], &self.hand.bones[k - 1]);
        let along = ((own.tail - own.head).normalize() + (before.tail - before.head).normalize())
            .normalize();
        let deep = (own.palmar + before.palmar).normalize();
        let digit = &name[..5];
        let extent =
            |measured: Vec3| self.section(|v| self.belongs(v, digit), own.head, [along, measured]);
        (extent(own.flexion_axis), extent(deep))
    }

    fn measures(&self) -> [f64; 13] {
        let hand = &self.hand;
        let highest = |v: &Vec3| v.y;
        let length = self
            .skin
            .positions()
            .iter()
            .map(highest)
            .fold(0.0, f64::max);
        let middle = self.digit_length("middle", "proximal");
        let (index, little) = (bone(hand, "index_proximal"), bone(hand, "little_proximal"));
        let (top, bottom) = (
            hand.bones[index].head.y + 4.0,
            hand.bones[little].head.y - 4.0,
        );
        let finger_side = |v: usize| {
            !hand.bones[hand.weights[v].bones[0] as usize]
                .name
                .starts_with("thumb")
        };
        let positions = hand.mesh.positions();
        let across = (0..positions.len())
            .filter(|&v| finger_side(v) && (bottom..top).contains(&positions[v].y))
            .map(|v| positions[v].x);
        let (low, high) = across.fold((0.0_f64, 0.0_f64), |(low, high), x| {
            (low.min(x), high.max(x))
        });
        let thumb = self.joint_section("thumb_distal");
        let pip = self.joint_section("index_middle");
        let knuckle = hand.bones[bone(hand, "middle_proximal")].head;
        [
            length,
            length - middle,
            self.digit_length("thumb", "proximal"),
            self.digit_length("index", "proximal"),
            middle,
            self.digit_length("ring", "proximal"),
            self.digit_length("little", "proximal"),
            thumb.0,
            thumb.1,
            pip.0,
            pip.1,
            high - low,
            self.section(
                |v| self.belongs(v, "middle"),
                knuckle,
                [Vec3::y(), Vec3::z()],
            ),
        ]
    }
}

#[test]
fn every_measure_lies_within_one_deviation_of_the_published_table() {
    let mut wrong = Vec::new();
    println!(
        "{:<26}{:>9}{:>9}{:>7}{:>8}",
        "measure, mm", "mesh", "table", "SD", "(m-t)/SD"
    );
    for (sex, first) in [(Sex::Male, 0), (Sex::Female, 4)] {
        for (place, percentile) in [5.0, 50.0, 95.0].into_iter().enumerate() {
            println!("{sex:?}, percentile {percentile}");
            let measures = Straight::new(&HandShape {
                sex,
                percentile,
                spacing_mm: 3.0,
                ..HandShape::default()
            })
            .measures();
            for ((name, row), measured) in TABLE.iter().zip(measures) {
                let (expected, deviation) = (row[first + place], row[first + 3]);
                let off = (measured - expected) / deviation;
                println!("{name:<26}{measured:>9.1}{expected:>9.0}{deviation:>7.0}{off:>8.2}");
                if off.abs() > 1.0 {
                    wrong.push(format!(
                        "{name}, {sex:?}, {percentile}: {measured:.1} mm for {expected} mm"
                    ));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn own_length_and_breadth_are_met_on_the_mesh() {
    let shape = HandShape {
        length_mm: Some(190.0),
        breadth_mm: Some(85.0),
        ..HandShape::default()
    };
    let measures = Straight::new(&shape).measures();
    assert!(
        (measures[0] - 190.0).abs() < 2.0,
        "length {} mm",
        measures[0]
    );
    assert!(
        (measures[11] - 85.0).abs() < 2.5,
        "breadth {} mm",
        measures[11]
    );
}
