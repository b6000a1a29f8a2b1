//! Registration of scanned points on the skin: signed distances and the rigid motion.

use nalgebra::{Matrix6, Rotation3, Vector3, Vector6};
use thenar_surface::{Feature, GapLimits, Mesh, Product, closest_point, vertex_normals};

use crate::observe::robust_scale::median_deviation;

/// Most steps of the first laying.
const STEPS: usize = 30;
/// Step, mm, at which it rests.
const AT_REST: f64 = 1e-5;
/// Residuals beyond this many times their spread do not pull (Tukey's weights).
const TUKEY: f64 = 4.685;
/// Smallest spread of residuals that is believed, mm.
const LEAST_SPREAD: f64 = 0.02;
/// What holds a direction that the surface leaves free, against the mean weight of a point.
const HOLD: f64 = 1e-4;

/// A rigid motion about a center: shift (mm), then turn as a rotation vector (rad).
pub type Pose = [f64; 6];

/// Where a point comes to lie.
pub fn moved(point: Vector3<f64>, pose: &Pose, center: Vector3<f64>) -> Vector3<f64> {
    let [x, y, z, u, v, w] = *pose;
    let turn = Rotation3::new(Vector3::new(u, v, w));
    center + turn * (point - center) + Vector3::new(x, y, z)
}

/// A surface to which distances are sought from triangles that are known to be near.
#[derive(Debug, Clone)]
pub struct Surface {
    mesh: Mesh,
    normals: Vec<Vector3<f64>>,
    /// By vertex: its triangles.
    around: std::sync::Arc<Vec<Vec<u32>>>,
    /// By vertex: whether the surface ends there.
    ends: std::sync::Arc<Vec<bool>>,
}

/// The point of a surface next to a point.
#[derive(Debug, Clone, Copy)]
pub struct Foot {
    /// mm; > 0 outside.
    pub distance: f64,
    /// Unit normal of the skin there.
    pub normal: Vector3<f64>,
    /// Its triangle.
    pub triangle: u32,
    /// True where the surface ends there.
    pub is_at_end: bool,
}

impl Surface {
    /// Of a mesh.
    pub fn new(mesh: Mesh) -> Surface {
        let count = mesh.positions().len();
        let mut around = vec![Vec::new(); count];
        let mut sides = std::collections::BTreeMap::new();
        for (k, triangle) in mesh.triangles().iter().enumerate() {
            for side in 0..3 {
                around[triangle[side] as usize].push(k as u32);
                let (a, b) = (triangle[side], triangle[(side + 1) % 3]);
                *sides.entry((a.min(b), a.max(b))).or_insert(0) += 1;
            }
        }
        let mut ends = vec![false; count];
        for ((a, b), _) in sides.into_iter().filter(|(_, faces)| *faces == 1) {
            (ends[a as usize], ends[b as usize]) = (true, true);
        }
        Surface {
            normals: vertex_normals(&mesh),
            mesh,
            around: std::sync::Arc::new(around),
            ends: std::sync::Arc::new(ends),
        }
    }

    /// The same surface with its vertices moved; None if one of them is not finite.
    pub(crate) fn displaced(&self, displacement: &[Vector3<f64>]) -> Option<Surface> {
        let positions = self.mesh.positions().iter().zip(displacement);
        let positions = positions.map(|(p, u)| p + u).collect();
        let mesh = self.mesh.with_positions(positions).ok()?;
        Some(Surface {
            normals: vertex_normals(&mesh),
            mesh,
            around: self.around.clone(),
            ends: self.ends.clone(),
        })
    }

    /// Vertices of the surface.
    pub fn positions(&self) -> &[Vector3<f64>] {
        self.mesh.positions()
    }

    /// Unit normals by vertex.
    pub fn normals(&self) -> &[Vector3<f64>] {
        &self.normals
    }

    /// The foot of a point, sought from a triangle from neighbor to neighbor.
    pub(crate) fn foot(&self, point: Vector3<f64>, from: u32) -> Foot {
        let on = |triangle: u32| closest_point(self.mesh.corners(triangle as usize), point);
        let (mut best, mut at) = (on(from), from);
        loop {
            let corners = self.mesh.triangles()[at as usize];
            let beside = corners.iter().flat_map(|v| &self.around[*v as usize]);
            let nearer = beside
                .map(|triangle| (on(*triangle), *triangle))
                .min_by(|a, b| a.0.distance_squared.total_cmp(&b.0.distance_squared));
            match nearer {
                Some((next, triangle)) if next.distance_squared < best.distance_squared => {
                    (best, at) = (next, triangle);
                }
                _ => break,
            }
        }
        let corners = self.mesh.triangles()[at as usize].map(|v| v as usize);
        let weighed = corners.iter().zip(best.barycentric);
        let normal: Vector3<f64> = weighed.map(|(v, weight)| self.normals[*v] * weight).sum();
        let normal = normal.try_normalize(1e-12).unwrap_or_else(Vector3::z);
        let apart = point - best.point;
        let ends = |k: u8| self.ends[corners[usize::from(k) % 3]];
        Foot {
            distance: apart.norm().copysign(apart.dot(&normal)),
            normal,
            triangle: at,
            is_at_end: match best.feature {
                Feature::Face => false,
                Feature::Edge(k) => ends(k) && ends(k + 1),
                Feature::Vertex(k) => ends(k),
            },
        }
    }

    /// Triangles next to points, sought in full; None where the surface is none.
    pub fn nearest(&self, points: &[Vector3<f64>]) -> Option<Vec<u32>> {
        let whole = Product::new(self.mesh.clone()).ok()?;
        let limits = GapLimits {
            cut_off_mm: f64::INFINITY,
            max_depth_mm: f64::INFINITY,
        };
        let gaps = whole.gaps(points, None, limits);
        let triangle = |gap: Option<thenar_surface::Gap>| gap.map(|gap| gap.triangle);
        gaps.into_iter().map(triangle).collect()
    }

    /// The rigid motion about `center` that lays points on the surface (Chen & Medioni 1992, with Tukey's weights): what the tool
    /// has moved is far off and does not pull. Directions that the surface leaves free stay as they are.
    ///
    /// `counts` says of a moved point whether it may be skin.
    pub fn lay(
        &self,
        points: &[Vector3<f64>],
        center: Vector3<f64>,
        counts: &dyn Fn(Vector3<f64>) -> bool,
    ) -> Option<Pose> {
        let mut pose = [0.0; 6];
        for _ in 0..STEPS {
            let placed: Vec<Vector3<f64>> =
                points.iter().map(|p| moved(*p, &pose, center)).collect();
            let near = self.nearest(&placed)?;
            let feet = placed.iter().zip(&near);
            let feet: Vec<(Vector3<f64>, Foot)> = feet
                .map(|(p, triangle)| (*p, self.foot(*p, *triangle)))
                .filter(|(p, foot)| !foot.is_at_end && counts(*p))
                .collect();
            let mut sizes: Vec<f64> = feet.iter().map(|(_, f)| f.distance.abs()).collect();
            let spread = median_deviation(&mut sizes).max(LEAST_SPREAD);
            let step = step(&feet, center, TUKEY * spread)?;
            for (at, by) in pose.iter_mut().zip(step.iter()) {
                *at += by;
            }
            let reach = feet
                .iter()
                .fold(1.0, |most: f64, (p, _)| most.max((p - center).norm()));
            let size = step.fixed_rows::<3>(0).norm() + reach * step.fixed_rows::<3>(3).norm();
            if size < AT_REST {
                break;
            }
        }
        Some(pose)
    }
}

/// One weighted step of shift and turn; None of too few points.
fn step(feet: &[(Vector3<f64>, Foot)], center: Vector3<f64>, cut: f64) -> Option<Vector6<f64>> {
    let (mut normal, mut side) = (Matrix6::zeros(), Vector6::zeros());
    let mut reach = 0.0;
    for (point, foot) in feet {
        let arm = point - center;
        let turn = arm.cross(&foot.normal);
        let along = Vector6::new(
            foot.normal.x,
            foot.normal.y,
            foot.normal.z,
            turn.x,
            turn.y,
            turn.z,
        );
        let share = (foot.distance / cut).abs();
        let weight = if share < 1.0 {
            (1.0 - share * share).powi(2)
        } else {
            0.0
        };
        normal += along * along.transpose() * weight;
        side -= along * (weight * foot.distance);
        reach += weight * arm.norm_squared();
    }
    if feet.len() < 6 {
        return None;
    }
    let hold = HOLD * feet.len() as f64;
    for k in 0..6 {
        let arm = if k < 3 {
            1.0
        } else {
            reach / feet.len() as f64
        };
        normal[(k, k)] += hold * arm.max(1e-9);
    }
    normal.cholesky().map(|factor| factor.solve(&side))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A grid over `height`, mm apart.
    fn grid(half: i32, spacing: f64, height: &dyn Fn(f64, f64) -> f64) -> Mesh {
        let side = (2 * half + 1) as u32;
        let at = |k: i32| f64::from(k) * spacing;
        let each = (-half..=half).flat_map(|j| (-half..=half).map(move |i| (at(i), at(j))));
        let positions = each
            .map(|(x, y)| Vector3::new(x, y, height(x, y)))
            .collect();
        let mut triangles = Vec::new();
        for j in 0..side - 1 {
            for i in 0..side - 1 {
                let k = j * side + i;
                triangles.extend([[k, k + 1, k + side], [k + 1, k + side + 1, k + side]]);
            }
        }
        Mesh::new(positions, triangles).expect("a mesh")
    }

    /// On a plane the distance is the height, from any triangle one begins at; beyond its rim the surface ends.
    #[test]
    fn signed_distance_to_a_plane_is_height() {
        let surface = Surface::new(grid(8, 1.0, &|_, _| 0.0));
        for (x, y, z) in [(3.3, -2.7, 1.5), (-6.1, 5.2, -0.4), (0.0, 0.0, 2.0)] {
            for from in [0, 100, 255] {
                let foot = surface.foot(Vector3::new(x, y, z), from);
                assert!(
                    (foot.distance - z).abs() < 1e-12 && !foot.is_at_end,
                    "{foot:?}"
                );
            }
        }
        assert!(surface.foot(Vector3::new(9.0, 0.0, 1.0), 7).is_at_end);
    }

    /// A bowl with three unequal curvatures, moved: the motion back is found, though a dent of 1 mm takes a tenth of the points.
    #[test]
    fn registration_recovers_a_rigid_motion() {
        let height = |x: f64, y: f64| -x * x / 24.0 - y * y / 60.0 + x * y * y / 900.0;
        let surface = Surface::new(grid(24, 0.5, &height));
        let center = Vector3::zeros();
        let away = [0.8, -0.5, 1.1, 0.06, -0.04, 0.05];
        let mut points = Vec::new();
        for i in -18..=18 {
            for j in -18..=18 {
                let (x, y) = (0.5 * f64::from(i), 0.5 * f64::from(j));
                let dent = if x.hypot(y) < 3.2 { -1.0 } else { 0.0 };
                points.push(moved(
                    Vector3::new(x, y, height(x, y) + dent),
                    &away,
                    center,
                ));
            }
        }
        let back = surface.lay(&points, center, &|_| true).expect("a pose");
        for (i, j) in [(-16, 0), (0, 16), (14, -14)] {
            let (x, y) = (0.5 * f64::from(i), 0.5 * f64::from(j));
            let at = Vector3::new(x, y, height(x, y));
            let found = moved(moved(at, &away, center), &back, center);
            // The grid's chords lie up to 0.5^2 / 8 / 12 = 0.003 mm under the bowl.
            assert!((found - at).norm() < 0.05, "{at:?} came to {found:?}");
        }
    }
}
