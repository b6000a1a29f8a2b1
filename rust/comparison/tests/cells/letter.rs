//! A letter pressed on a sheet of paper, and what the paper shows of it.

use super::shares;
use nalgebra::Vector3;
use thenar_comparison::Comparison;
use thenar_comparison::{Pressed, Printed, StillPrint, compare_print};
use thenar_inference::Mat;

pub type Vec3 = Vector3<f64>;

/// The letter F, in mm about the middle of its box: no turn and no mirror brings it on itself.
pub fn letter(x: f64, y: f64) -> bool {
    let within = |[left, low]: [f64; 2], [right, high]: [f64; 2]| {
        x > left && x < right && y > low && y < high
    };
    within([-10.0, -15.0], [-4.0, 15.0])
        || within([-10.0, 9.0], [10.0, 15.0])
        || within([-10.0, -2.0], [5.0, 4.0])
}

/// A skin of vertices 1 mm apart that presses with 10 kPa on the letter, turned and moved on the product.
pub struct Skin {
    pub positions: Vec<Vec3>,
    pub areas: Vec<f64>,
    pub force_n: Vec<f64>,
}

/// The skin on which the letter presses.
pub fn pressed_letter() -> Skin {
    let each = (0..80 * 80).map(|k| (f64::from(k % 80) - 39.5, f64::from(k / 80) - 39.5));
    let positions: Vec<Vec3> = each.map(|(x, y)| Vec3::new(x, y, 0.0)).collect();
    let force = |p: &Vec3| if letter(p.x, p.y) { 0.01 } else { 0.0 };
    Skin {
        areas: vec![1.0; positions.len()],
        force_n: positions.iter().map(force).collect(),
        positions,
    }
}

/// A sheet of 50 x 50 mm in cells of 1 mm about the origin.
pub fn sheet() -> Mat {
    let at = |number: usize| number as f64 + 0.5 - 25.0;
    let cells = 0..50 * 50;
    Mat {
        centers: cells
            .clone()
            .map(|k| Vec3::new(at(k % 50), at(k / 50), 0.0))
            .collect(),
        normals: vec![Vec3::z(); 2500],
        areas: vec![1.0; 2500],
        places: cells
            .map(|k| Some([(k / 50) as u32, (k % 50) as u32]))
            .collect(),
    }
}

/// A print beside a skin.
pub fn found(skin: &Skin, mat: Mat, inked: &[f64]) -> (Printed, Comparison) {
    found_by(skin, (mat, inked), (&[], &[]))
}

/// The same with regions of the skin.
pub fn found_by(
    skin: &Skin,
    (mat, inked): (Mat, &[f64]),
    regions: (&[i32], &[String]),
) -> (Printed, Comparison) {
    let comparison = compare_print(StillPrint {
        name: "ink",
        product: "plate",
        hand: "hand",
        pressed: Pressed {
            positions: &skin.positions,
            areas: &skin.areas,
            force_n: &skin.force_n,
        },
        mat,
        inked,
        ink_kpa: 2.0,
        regions,
        unknown: Vec::new(),
    });
    let comparison = comparison.unwrap();
    (comparison.recordings[0].print.clone().unwrap(), comparison)
}

/// Where a place of a paper that lies `pose` off, turned about its middle, comes to lie on the product.
pub fn carried([u, v]: [f64; 2], [x, y, turn]: [f64; 3]) -> [f64; 2] {
    let (sin, cos) = turn.sin_cos();
    [cos * u - sin * v + x, sin * u + cos * v + y]
}

/// What a paper that lies `pose` off shows of a shape on the product.
pub fn seen(shape: &dyn Fn(f64, f64) -> bool, pose: [f64; 3]) -> Vec<f64> {
    shares([50, 50], 1.0, &|u, v| {
        let [x, y] = carried([u - 25.0, v - 25.0], pose);
        shape(x, y)
    })
}

/// The same pose as the library tells it: it turns the paper about the middle of its ink, which shifts by as much as that is carried.
pub fn about_the_ink(inked: &[f64], pose: [f64; 3]) -> [f64; 3] {
    let touched = (0..inked.len()).filter(|k| inked[*k] >= 0.5);
    let (mut sum, mut all) = ([0.0; 2], 0.0);
    for k in touched {
        sum = [
            sum[0] + (k % 50) as f64 - 24.5,
            sum[1] + (k / 50) as f64 - 24.5,
        ];
        all += 1.0;
    }
    let middle = sum.map(|s| s / all);
    let [x, y] = carried(middle, pose);
    [x - middle[0], y - middle[1], pose[2]]
}
