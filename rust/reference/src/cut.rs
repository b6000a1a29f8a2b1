//! How deep the product lies in the skin between its vertices, where no contact is tested.

use thenar_surface::{GapLimits, Mesh, Product, Vec3, vertex_normals};

use crate::Tissue;
use crate::obstacle::Obstacle;

/// Distance between the points of a triangle that are measured, mm, and the most parts of its sides.
const SPACING_MM: f64 = 0.25;
const MOST_PARTS: usize = 16;
/// Product vertices farther from the skin than this are not looked for, mm.
const REACH_MM: f64 = 3.0;

/// What contact at vertices alone leaves inside the product.
#[derive(Debug, Clone, Copy, Default)]
pub struct Cut {
    /// Deepest place between vertices, mm; 0 where there is none.
    pub depth_mm: f64,
    /// The nearest skin vertex.
    pub vertex: usize,
    /// Volume that is left over the volume before the press, 0 to 1.
    pub share: f64,
}

impl Cut {
    /// Points of deformed triangles inside the product, and product vertices under the deformed skin; `places` (n) of the skin, mm. Only
    /// triangles all of whose corners can touch count.
    pub fn new(tissue: &Tissue, obstacle: &Obstacle<'_>, places: &[Vec3]) -> Cut {
        let before = Between::new(tissue, obstacle, &tissue.skin);
        let after = Between::new(tissue, obstacle, places);
        let under = under_skin(tissue, places, obstacle);
        let (depth_mm, vertex) = if after.deepest.0 > under.0 {
            after.deepest
        } else {
            under
        };
        let share = if before.volume > 0.0 {
            (after.volume / before.volume).min(1.0)
        } else {
            // Nothing of the skin was in the product: what lies under the skin was never met.
            f64::from(u8::from(under.0 > 0.0))
        };
        Cut {
            depth_mm,
            vertex,
            share,
        }
    }
}

/// Points of skin triangles inside the product.
struct Between {
    /// Depth, mm, and nearest vertex.
    deepest: (f64, usize),
    /// Depth over the area, mm3.
    volume: f64,
}

impl Between {
    fn new(tissue: &Tissue, obstacle: &Obstacle<'_>, places: &[Vec3]) -> Between {
        let mut gap = vec![f64::INFINITY; places.len()];
        for (v, distance) in obstacle.readings(|v| places[v]) {
            gap[v] = distance;
        }
        let (mut points, mut facing, mut weights) = (Vec::new(), Vec::new(), Vec::new());
        for triangle in tissue.triangles.iter().filter(|t| obstacle.follows(t)) {
            let corners = triangle.map(|v| v as usize);
            let [a, b, c] = corners.map(|v| places[v]);
            let longest = (b - a).norm().max((c - b).norm()).max((a - c).norm());
            if corners.iter().all(|v| gap[*v] > longest) {
                continue;
            }
            let parts = ((longest / SPACING_MM).ceil() as usize).clamp(2, MOST_PARTS);
            let first = points.len();
            for shares in shares(parts) {
                points.push(a * shares[0] + b * shares[1] + c * shares[2]);
                facing.push(obstacle.facing(corners, shares));
                weights.push((0.0, corners[largest(&shares)]));
            }
            let area = (b - a).cross(&(c - a)).norm() / 2.0;
            let each = area / (points.len() - first) as f64;
            weights[first..].iter_mut().for_each(|(w, _)| *w = each);
        }
        let found = obstacle.distances(&points, &facing);
        let mut between = Between {
            deepest: (0.0, 0),
            volume: 0.0,
        };
        for (distance, (area, vertex)) in found.into_iter().zip(weights) {
            between.volume += area * (-distance).max(0.0);
            if -distance > between.deepest.0 {
                between.deepest = (-distance, vertex);
            }
        }
        between
    }
}

/// The product vertex deepest under the deformed skin, mm, and the skin vertex nearest to it.
fn under_skin(tissue: &Tissue, places: &[Vec3], obstacle: &Obstacle<'_>) -> (f64, usize) {
    let mesh = Mesh::new(places.to_vec(), tissue.triangles.clone());
    let Ok((skin, normals)) = mesh.and_then(|mesh| {
        let normals = vertex_normals(&mesh);
        Ok((Product::new(mesh)?, normals))
    }) else {
        return (0.0, 0);
    };
    let limits = GapLimits {
        cut_off_mm: REACH_MM,
        max_depth_mm: REACH_MM,
    };
    let points = obstacle.product().mesh().positions();
    let gaps = skin.gaps(points, None, limits);
    let under = points.iter().zip(gaps).filter_map(|(point, gap)| {
        let gap = gap.filter(|gap| gap.distance.abs() < REACH_MM)?;
        let corners = skin.mesh().triangles()[gap.triangle as usize];
        let along = |k: usize| normals[corners[k] as usize] * gap.barycentric[k];
        let is_under = (point - gap.closest).dot(&(0..3).map(along).sum()) < 0.0;
        let vertex = corners[largest(&gap.barycentric)] as usize;
        (is_under && obstacle.follows(&corners)).then_some((gap.distance.abs(), vertex))
    });
    under.fold(
        (0.0, 0),
        |most, one| if one.0 > most.0 { one } else { most },
    )
}

/// Weights of the points of a triangle whose sides are cut into `parts`, without its corners.
fn shares(parts: usize) -> impl Iterator<Item = [f64; 3]> {
    let rows = (0..=parts).flat_map(move |i| (0..=parts - i).map(move |j| [i, j, parts - i - j]));
    rows.filter(move |row| !row.contains(&parts))
        .map(move |row| row.map(|k| k as f64 / parts as f64))
}

fn largest(values: &[f64; 3]) -> usize {
    (0..3).fold(0, |most, k| if values[k] > values[most] { k } else { most })
}
