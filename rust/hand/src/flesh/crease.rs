//! The long creases of the palm as shallow grooves.

use crate::skeleton::Skeleton;
use thenar_surface::Vec3;

/// Half width of a groove, mm; narrower ones turn into ripples at 2.4 mm edges.
const WIDTH: f64 = 2.0;
const DEPTH: f64 = 0.6;

/// One groove along a curve seen from the palm.
pub(super) struct Crease {
    points: Vec<[f64; 2]>,
    low: [f64; 2],
    high: [f64; 2],
    depth: f64,
}

/// Thenar, proximal and distal palm crease and the wrist crease; courses drawn by eye through the published crease offsets (Bugbee & Botte 1993).
pub(super) fn palm_creases(skeleton: &Skeleton) -> Vec<Crease> {
    let courses: [(&[[f64; 2]], f64); 4] = [
        (
            &[
                [39.0, 78.0],
                [27.0, 75.0],
                [14.0, 60.0],
                [7.0, 42.0],
                [5.0, 22.0],
                [8.0, 6.0],
            ],
            DEPTH * 1.2,
        ),
        (
            &[
                [40.0, 78.0],
                [26.0, 76.0],
                [8.0, 68.0],
                [-14.0, 56.0],
                [-27.0, 47.0],
            ],
            DEPTH,
        ),
        (
            &[
                [-47.0, 61.0],
                [-34.0, 64.0],
                [-16.0, 70.0],
                [2.0, 79.0],
                [10.0, 87.0],
            ],
            DEPTH * 1.2,
        ),
        (
            &[[-32.0, 1.0], [-14.0, -1.0], [14.0, -1.0], [32.0, 1.0]],
            DEPTH * 0.6,
        ),
    ];
    let scale = [skeleton.across(), skeleton.lengthwise()];
    courses
        .iter()
        .map(|(course, depth)| Crease::new(course, scale, *depth))
        .collect()
}

impl Crease {
    fn new(course: &[[f64; 2]], scale: [f64; 2], depth: f64) -> Crease {
        let points: Vec<[f64; 2]> = (0..=32)
            .map(|k| curve(course, k as f64 / 32.0))
            .map(|p| [p[0] * scale[0], p[1] * scale[1]])
            .collect();
        let margin = 3.0 * WIDTH;
        let low =
            [0, 1].map(|i| points.iter().map(|p| p[i]).fold(f64::INFINITY, f64::min) - margin);
        let high = [0, 1].map(|i| {
            points
                .iter()
                .map(|p| p[i])
                .fold(f64::NEG_INFINITY, f64::max)
                + margin
        });
        Crease {
            points,
            low,
            high,
            depth,
        }
    }

    /// How deep the groove is at a point of the skin, mm.
    pub fn depth(&self, p: Vec3) -> f64 {
        let q = [p.x, p.y];
        if p.z < 0.0 || (0..2).any(|i| q[i] < self.low[i] || q[i] > self.high[i]) {
            return 0.0;
        }
        let square = self
            .points
            .windows(2)
            .map(|ends| square_distance(q, ends))
            .fold(f64::INFINITY, f64::min);
        self.depth * (-square / (WIDTH * WIDTH)).exp() * (p.z / 6.0).min(1.0)
    }
}

fn square_distance(q: [f64; 2], ends: &[[f64; 2]]) -> f64 {
    let (a, b) = (ends[0], ends[1]);
    let edge = [b[0] - a[0], b[1] - a[1]];
    let offset = [q[0] - a[0], q[1] - a[1]];
    let t = ((offset[0] * edge[0] + offset[1] * edge[1]) / (edge[0] * edge[0] + edge[1] * edge[1]))
        .clamp(0.0, 1.0);
    (offset[0] - edge[0] * t).powi(2) + (offset[1] - edge[1] * t).powi(2)
}

/// Catmull-Rom curve through the points, `share` from 0 to 1.
fn curve(points: &[[f64; 2]], share: f64) -> [f64; 2] {
    let last = points.len() - 1;
    let place = share * last as f64;
    let k = (place as usize).min(last - 1);
    let t = place - k as f64;
    let [a, b, c, d] = [k.saturating_sub(1), k, k + 1, (k + 2).min(last)].map(|i| points[i]);
    [0, 1].map(|i| {
        let (linear, square) = (c[i] - a[i], 2.0 * a[i] - 5.0 * b[i] + 4.0 * c[i] - d[i]);
        let cube = 3.0 * b[i] - a[i] - 3.0 * c[i] + d[i];
        0.5 * (2.0 * b[i] + t * (linear + t * (square + t * cube)))
    })
}
