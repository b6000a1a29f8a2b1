//! Bone under a skin at rest: bars along the phalanges, elsewhere at the tissue's thickness.
//!
//! A phalanx is a round bar along its bone, moved toward the back so that the tissue on the palm side has its thickness; what lies over its
//! back is thin (1.5 mm, assumed; dorsal skin of fingers is 1 to 2 mm). Over joints the bars are blended by the weights that bend the skin.

use thenar_surface::{Adjacency, Mesh, Vec3, vertex_normals};

use crate::ReferenceError;

/// Tissue over the back of a phalanx, mm.
const BACK_MM: f64 = 1.5;
/// Tissue over the end of a finger's last bone, mm.
const TIP_MM: f64 = 3.5;
/// Tissue where no thickness is known: back of the hand, mm.
const UNKNOWN_MM: f64 = 3.0;
/// Least tissue over a bone, mm.
const LEAST_TISSUE_MM: f64 = 1.0;
/// Least and largest radius of a bone, as shares of half the finger's thickness.
const RADIUS_SHARE: [f64; 2] = [0.2, 0.6];
/// Weight from which a vertex belongs to one bone, and the part of the bone's length that tells the finger's thickness.
const OWN: f64 = 0.7;
const MIDDLE: [f64; 2] = [0.25, 0.75];
/// Share of the finger's vertices that lie within its half thickness.
const MOST: f64 = 0.95;
/// Passes in which normals, thickness, and at last the way to the bone are averaged over neighbors.
const SMOOTHING: [usize; 3] = [12, 6, 3];

/// A bone of the hand, at rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Segment {
    /// Its ends, mm.
    pub ends: [Vec3; 2],
    /// Toward the palm, across the bone; `None`: not a phalanx, the tissue's thickness tells where its surface lies.
    pub palmar: Option<Vec3>,
    /// Whether nothing follows it in its finger.
    pub is_last: bool,
}

/// A hand's skin at rest and the bones that move it.
#[derive(Debug, Clone, Copy)]
pub struct RestHand<'a> {
    /// Closed or open skin, turned outward, mm.
    pub mesh: &'a Mesh,
    /// Soft tissue over bone at every vertex, mm; not finite or 0 where it is not known.
    pub thickness_mm: &'a [f64],
    /// The bones that move it; none where they are not known.
    pub segments: &'a [Segment],
    /// Share of every bone in every vertex, vertex by vertex; empty: none.
    pub weights: &'a [f64],
}

/// Point of the bone under every skin vertex, mm.
///
/// # Errors
/// [`ReferenceError::Tissue`] for arrays that do not fit each other.
pub fn bone_points(hand: RestHand<'_>) -> Result<Vec<Vec3>, ReferenceError> {
    let skin = hand.mesh.positions();
    let count = hand.segments.len();
    for (name, found, wanted) in [
        ("thickness_mm", hand.thickness_mm.len(), skin.len()),
        ("weights", hand.weights.len(), skin.len() * count),
    ] {
        if found != wanted {
            return Err(ReferenceError::Tissue {
                what: format!("array `{name}`"),
                found: format!("{found} values in place of {wanted}"),
                remedy: "give one thickness, and one weight of every bone, for every vertex",
            });
        }
    }
    if let Some(v) = hand.thickness_mm.iter().position(|h| *h < 0.0) {
        return Err(ReferenceError::Tissue {
            what: format!("array `thickness_mm`, vertex {v}"),
            found: format!("{} mm", hand.thickness_mm[v]),
            remedy: "give 0 or more, 0 where it is not known",
        });
    }
    let adjacency = Adjacency::new(hand.mesh);
    let [over_normals, over_thickness, over_all] = SMOOTHING;
    let normals = smoothed(&adjacency, vertex_normals(hand.mesh), over_normals);
    let thickness: Vec<Vec3> = hand
        .thickness_mm
        .iter()
        .map(|h| Vec3::x() * known(*h))
        .collect();
    let thickness = smoothed(&adjacency, thickness, over_thickness);
    let bars: Vec<Option<Bar>> = (0..count).map(|k| Bar::new(&hand, k)).collect();
    let under = (0..skin.len()).map(|v| {
        let weights = hand.weights.get(v * count..(v + 1) * count).unwrap_or(&[]);
        let inward = normals[v].try_normalize(1e-9).unwrap_or_default() * -thickness[v].x;
        let total: f64 = weights.iter().sum();
        if total <= 0.0 {
            return inward;
        }
        let bones = weights
            .iter()
            .zip(&bars)
            .filter(|(weight, _)| **weight > 0.0);
        let ways = bones.map(|(weight, bar)| match bar {
            Some(bar) => (bar.under(skin[v]) - skin[v]) * *weight,
            None => inward * *weight,
        });
        ways.sum::<Vec3>() / total
    });
    let ways = smoothed(&adjacency, under.collect(), over_all);
    Ok(skin
        .iter()
        .zip(ways)
        .map(|(point, way)| point + way)
        .collect())
}

fn known(thickness: f64) -> f64 {
    if thickness.is_finite() && thickness > 0.0 {
        thickness
    } else {
        UNKNOWN_MM
    }
}

fn smoothed(adjacency: &Adjacency, mut values: Vec<Vec3>, passes: usize) -> Vec<Vec3> {
    for _ in 0..passes {
        let mean = |v: usize| {
            let neighbors = adjacency.neighbors(v);
            let sum: Vec3 = neighbors.iter().map(|k| values[*k as usize]).sum();
            (sum + values[v]) / (neighbors.len() + 1) as f64
        };
        values = (0..values.len()).map(mean).collect();
    }
    values
}

/// A phalanx as a round bar with round ends.
#[derive(Debug)]
struct Bar {
    ends: [Vec3; 2],
    radius: f64,
}

impl Bar {
    /// `None` for a bone that is no phalanx, or has too little skin of its own to tell.
    fn new(hand: &RestHand<'_>, bone: usize) -> Option<Bar> {
        let Segment {
            ends,
            palmar,
            is_last,
        } = hand.segments[bone];
        let palmar = palmar?;
        let count = hand.segments.len();
        let length = (ends[1] - ends[0]).norm();
        let along = (ends[1] - ends[0]).try_normalize(1e-9)?;
        let own = (0..hand.thickness_mm.len()).filter(|v| hand.weights[v * count + bone] > OWN);
        let (mut front, mut back, mut thickness, mut farthest) =
            (Vec::new(), Vec::new(), Vec::new(), length);
        for v in own {
            let from = hand.mesh.positions()[v] - ends[0];
            let at = from.dot(&along);
            farthest = farthest.max(at);
            let height = (from - along * at).dot(&palmar);
            if (MIDDLE[0] * length..MIDDLE[1] * length).contains(&at) {
                front.push(height);
                back.push(-height);
            }
            if hand.thickness_mm[v] > 0.0 && hand.thickness_mm[v].is_finite() {
                thickness.push(hand.thickness_mm[v]);
            }
        }
        let (front, back) = (quantile(front, MOST)?, quantile(back, MOST)?);
        let half = (front + back) / 2.0;
        let thickness = if thickness.is_empty() {
            UNKNOWN_MM.max(half)
        } else {
            thickness.iter().sum::<f64>() / thickness.len() as f64
        };
        let [least, most] = RADIUS_SHARE.map(|share| share * half);
        let radius = (half - (thickness + BACK_MM) / 2.0).clamp(least, most);
        let shift = palmar * (front - thickness - radius);
        let reach = if is_last {
            length.min(farthest - TIP_MM - radius).max(0.0)
        } else {
            length
        };
        Some(Bar {
            ends: [ends[0] + shift, ends[0] + shift + along * reach],
            radius,
        })
    }

    /// Point of the bone under a skin point: on the way to the axis, below the least tissue.
    fn under(&self, point: Vec3) -> Vec3 {
        let axis = self.ends[1] - self.ends[0];
        let share = (point - self.ends[0]).dot(&axis) / axis.norm_squared().max(1e-12);
        let foot = self.ends[0] + axis * share.clamp(0.0, 1.0);
        let out = point - foot;
        let distance = out.norm();
        if distance < 1e-9 {
            return foot;
        }
        foot + out * (self.radius.min(distance - LEAST_TISSUE_MM).max(0.0) / distance)
    }
}

fn quantile(mut values: Vec<f64>, share: f64) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    let at = share * values.len().checked_sub(1)? as f64;
    values.get(at.round() as usize).copied()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A finger of radius 8 mm along y: 7 mm of tissue on the palm side leaves a bone of 3.75 mm, 1.5 mm below the back.
    #[test]
    fn a_finger_gets_its_tissue_on_the_palm_side() {
        let (sides, rings) = (48, 60);
        let ring = |k: usize| {
            (0..sides).map(move |i| {
                let (sine, cosine) = (std::f64::consts::TAU * i as f64 / sides as f64).sin_cos();
                Vec3::new(8.0 * cosine, k as f64, 8.0 * sine)
            })
        };
        let points: Vec<Vec3> = (0..=rings).flat_map(ring).collect();
        let at = |k: usize, i: usize| (k * sides + i % sides) as u32;
        let faces = (0..rings).flat_map(|k| {
            (0..sides).flat_map(move |i| {
                [
                    [at(k, i), at(k + 1, i), at(k + 1, i + 1)],
                    [at(k, i), at(k + 1, i + 1), at(k, i + 1)],
                ]
            })
        });
        let mesh = Mesh::new(points, faces.collect()).expect("a mesh");
        let thickness: Vec<f64> = mesh
            .positions()
            .iter()
            .map(|p| if p.z > 0.0 { 7.0 } else { f64::NAN })
            .collect();
        let segments = [Segment {
            ends: [Vec3::zeros(), Vec3::new(0.0, 60.0, 0.0)],
            palmar: Some(Vec3::z()),
            is_last: false,
        }];
        let weights = vec![1.0; thickness.len()];
        let hand = RestHand {
            mesh: &mesh,
            thickness_mm: &thickness,
            segments: &segments,
            weights: &weights,
        };
        let bone = bone_points(hand).expect("arrays fit");
        let over = |angle: usize| {
            let v = 30 * sides + angle;
            (bone[v] - mesh.positions()[v]).norm()
        };
        assert!(
            (over(sides / 4) - 7.0).abs() < 0.15,
            "palm side {}",
            over(sides / 4)
        );
        assert!(
            (over(3 * sides / 4) - 1.5).abs() < 0.15,
            "back {}",
            over(3 * sides / 4)
        );
        // Bone and skin are turned the same way: no prism between them is folded.
        let sides_mm = over(0);
        assert!(sides_mm > 3.0 && sides_mm < 7.0, "side {sides_mm}");
    }

    #[test]
    fn without_bones_the_tissue_has_its_thickness() {
        let points = vec![
            Vec3::zeros(),
            Vec3::new(1.0, 0.0, 0.0),
            Vec3::new(0.0, 1.0, 0.0),
            Vec3::new(1.0, 1.0, 0.0),
        ];
        let mesh = Mesh::new(points, vec![[0, 1, 2], [1, 3, 2]]).expect("a mesh");
        let hand = RestHand {
            mesh: &mesh,
            thickness_mm: &[5.0; 4],
            segments: &[],
            weights: &[],
        };
        let bone = bone_points(hand).expect("arrays fit");
        for (bone, skin) in bone.iter().zip(mesh.positions()) {
            assert!((bone - skin + Vec3::z() * 5.0).norm() < 1e-12);
        }
        let hand = RestHand {
            thickness_mm: &[5.0; 3],
            ..hand
        };
        let error = bone_points(hand).expect_err("three values for four vertices");
        assert!(error.to_string().contains("thickness_mm"), "{error}");
    }
}
