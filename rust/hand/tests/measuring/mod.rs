//! What several tests of the hand measure.
#![allow(dead_code)]

use thenar_hand::{Hand, HandShape, JointTurn};
use thenar_surface::{Mesh, Vec3};

/// The hand of a shape that must be buildable.
pub fn hand(shape: &HandShape) -> Hand {
    shape.build().expect("a hand")
}

/// The default hand, made once for all tests of a file.
pub fn default_hand() -> &'static Hand {
    static HAND: std::sync::OnceLock<Hand> = std::sync::OnceLock::new();
    HAND.get_or_init(|| hand(&HandShape::default()))
}

/// Corners of a triangle.
pub fn corners(mesh: &Mesh, triangle: usize) -> [Vec3; 3] {
    mesh.triangles()[triangle].map(|v| mesh.positions()[v as usize])
}

/// Smallest angle of a triangle, degrees.
pub fn smallest_angle([a, b, c]: [Vec3; 3]) -> f64 {
    let angle = |p: Vec3, q: Vec3, r: Vec3| (q - p).angle(&(r - p)).to_degrees();
    angle(a, b, c).min(angle(b, c, a)).min(angle(c, a, b))
}

/// Share of the edges between palmar vertices that are 0.6 to 1.6 spacings long.
pub fn palmar_edges_in_range(hand: &Hand, spacing_mm: f64) -> f64 {
    let (mut all, mut good) = (0usize, 0usize);
    for triangle in hand.mesh.triangles() {
        for k in 0..3 {
            let (a, b) = (triangle[k] as usize, triangle[(k + 1) % 3] as usize);
            if a < b && hand.regions[a] >= 0 && hand.regions[b] >= 0 {
                let length =
                    (hand.mesh.positions()[a] - hand.mesh.positions()[b]).norm() / spacing_mm;
                all += 1;
                good += usize::from((0.6..=1.6).contains(&length));
            }
        }
    }
    good as f64 / all as f64
}

/// Place of a bone.
pub fn bone(hand: &Hand, name: &str) -> usize {
    hand.bones
        .iter()
        .position(|bone| bone.name == name)
        .unwrap_or_else(|| panic!("no bone {name}"))
}

/// Turns given by bone name in degrees of anatomical flexion (0 is straight); all other joints stay at rest.
pub fn posture(hand: &Hand, flexions: &[(&str, f64)]) -> Vec<JointTurn> {
    let mut turns = vec![JointTurn::default(); hand.bones.len()];
    for (name, degrees) in flexions {
        let k = bone(hand, name);
        turns[k].flexion = degrees.to_radians() - hand.bones[k].rest_flexion;
    }
    turns
}

/// Volume enclosed by a closed mesh, mm3, by the divergence theorem.
pub fn volume(mesh: &Mesh) -> f64 {
    (0..mesh.triangles().len())
        .map(|t| corners(mesh, t))
        .map(|[a, b, c]| a.dot(&b.cross(&c)) / 6.0)
        .sum()
}
