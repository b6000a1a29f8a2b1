//! Sensel layout: normals, mat directions by parallel transport, neighbors, the unrolled mat.

use nalgebra::{Matrix3, SymmetricEigen};
use thenar_surface::Vec3;

/// Sensels around one that a plane is laid through where no normals are given.
const AROUND: usize = 8;
/// A neighbor lies within this many of the usual distance of neighbors in its direction.
const NEAR: f64 = 1.5;
/// And within this much of the direction, sideways over along.
const ASIDE: f64 = 0.6;
/// Sensels within this many pitches of one are listed: no usual load reaches farther.
const CLOSE: f64 = 5.0;

/// Turn of the normals below which the mat counts as flat between two sensels, rad.
const FLAT: f64 = 1e-9;

/// The four ways along the mat.
pub const WAYS: [(usize, f64); 4] = [(0, 1.0), (0, -1.0), (1, 1.0), (1, -1.0)];

/// How a mat lies.
#[derive(Debug, Clone, PartialEq)]
pub struct SensorGrid {
    /// Unit normals.
    pub normals: Vec<Vec3>,
    /// The mat's two directions at each sensel.
    pub axes: Vec<[Vec3; 2]>,
    /// Neighbor in each of [`WAYS`].
    pub beside: Vec<[Option<u32>; 4]>,
    /// Sides of each sensel along the two directions, mm.
    pub sides: Vec<[f64; 2]>,
    /// Sides of the sensel with the largest sum of them, mm.
    pub largest: [f64; 2],
    /// Usual distance of neighbors in the two directions, mm; a row without neighbors takes the other's.
    pub pitch: [f64; 2],
    /// Place of each sensel on the unrolled mat, mm from its middle.
    pub flat: Vec<[f64; 2]>,
    /// Sensels whose centers lie within `around_mm` of a sensel's, itself among them, in ascending order.
    around: Vec<Vec<u32>>,
    around_mm: f64,
}

impl SensorGrid {
    /// Works it out. `normals` is empty or one each; `along` says which way of the grid comes first.
    pub fn new(
        centers: &[Vec3],
        normals: &[Vec3],
        areas: &[f64],
        along: Option<Vec3>,
    ) -> SensorGrid {
        let is_given = !normals.is_empty();
        let mut normals = match is_given {
            true => normals.to_vec(),
            false => centers.iter().map(|c| plane_normal(centers, c)).collect(),
        };
        let root = middle(centers);
        let tree = spanning_tree(centers, root);
        let mut axes = vec![[Vec3::zeros(); 2]; centers.len()];
        axes[root] = first_axes(centers, &normals, (root, along));
        for &(from, to) in &tree {
            if !is_given && normals[from].dot(&normals[to]) < 0.0 {
                normals[to] = -normals[to];
            }
            let u = carried(&normals[from], &normals[to], axes[from][0]);
            axes[to] = [u, normals[to].cross(&u)];
        }
        let pitch = pitches(centers, &normals, &axes);
        let beside = (0..centers.len())
            .map(|k| WAYS.map(|way| beside(centers, &axes[k], (k, way), NEAR * pitch[way.0])))
            .collect();
        let ratio = (pitch[0] / pitch[1]).sqrt();
        let sides = |area: &f64| [area.sqrt() * ratio, area.sqrt() / ratio];
        let most = areas.iter().fold(0.0, |most: f64, area| most.max(*area));
        let mut lie = SensorGrid {
            sides: areas.iter().map(sides).collect(),
            largest: sides(&most),
            flat: vec![[0.0; 2]; centers.len()],
            normals,
            axes,
            beside,
            around: Vec::new(),
            around_mm: CLOSE * pitch[0].max(pitch[1]),
            pitch,
        };
        let is_close = |(a, b): (&Vec3, &Vec3)| (a - b).norm_squared() <= lie.around_mm.powi(2);
        let around = centers.iter().map(|from| {
            let each = centers.iter().enumerate();
            let close = each.filter(|(_, center)| is_close((center, from)));
            close.map(|(k, _)| k as u32).collect()
        });
        lie.around = around.collect();
        for &(from, to) in &tree {
            let step = lie.apart(centers, (from, to));
            lie.flat[to] = [lie.flat[from][0] + step[0], lie.flat[from][1] + step[1]];
        }
        let mean =
            |axis: usize| lie.flat.iter().map(|p| p[axis]).sum::<f64>() / centers.len() as f64;
        let (x, y) = (mean(0), mean(1));
        lie.flat.iter_mut().for_each(|p| *p = [p[0] - x, p[1] - y]);
        lie
    }

    /// Sensels beside a sensel, at most four.
    pub fn neighbors(&self, sensel: usize) -> impl Iterator<Item = usize> + '_ {
        self.beside[sensel].iter().flatten().map(|k| *k as usize)
    }

    /// Sensels that may lie within `reach` (mm) of a sensel, in ascending order: all of them where it is long.
    pub fn within(&self, sensel: usize, reach: f64) -> impl Iterator<Item = usize> + '_ {
        let is_long = reach > self.around_mm;
        let all = if is_long { self.sides.len() } else { 0 };
        let close: &[u32] = if is_long { &[] } else { &self.around[sensel] };
        (0..all).chain(close.iter().map(|k| *k as usize))
    }

    /// From one sensel to another along the mat, in its two directions, mm: exact on planes and cylinders.
    pub fn apart(&self, centers: &[Vec3], (from, to): (usize, usize)) -> [f64; 2] {
        let chord = centers[to] - centers[from];
        let (a, b) = (&self.axes[from], &self.axes[to]);
        let mean = [0, 1].map(|i| 0.5 * chord.dot(&(a[i] + b[i])));
        let turn = self.normals[from].cross(&self.normals[to]);
        let (sin, cos) = (turn.norm(), self.normals[from].dot(&self.normals[to]));
        if sin < FLAT || cos <= 0.0 {
            return mean;
        }
        // Across the axis of the turn the chord is that of an arc; along it nothing bends.
        let along = [0, 1].map(|i| turn.dot(&a[i]) / sin);
        let straight = mean[0] * along[0] + mean[1] * along[1];
        let longer = sin.atan2(cos) / sin - 1.0;
        [0, 1].map(|i| mean[i] + longer * (mean[i] - straight * along[i]))
    }
}

/// Length of the arc between two normals over its chord.
fn arc_over_chord(a: &Vec3, b: &Vec3) -> f64 {
    let half = 0.5 * a.angle(b);
    if half > FLAT { half / half.sin() } else { 1.0 }
}

/// Turns `axis` as the smallest rotation turns normal `a` into `b`.
fn carried(a: &Vec3, b: &Vec3, axis: Vec3) -> Vec3 {
    let turned = axis - (a + b) * (axis.dot(b) / (1.0 + a.dot(b)).max(1e-9));
    let tangent = turned - b * turned.dot(b);
    tangent
        .try_normalize(1e-9)
        .unwrap_or_else(|| any_tangent(b))
}

fn any_tangent(normal: &Vec3) -> Vec3 {
    let least = normal.iamin();
    let axis = Vec3::ith(least, 1.0);
    (axis - normal * normal[least]).normalize()
}

/// Normal of the plane through the sensels around a place.
fn plane_normal(centers: &[Vec3], at: &Vec3) -> Vec3 {
    let mut around: Vec<&Vec3> = centers.iter().collect();
    let most = AROUND.min(around.len() - 1);
    around.select_nth_unstable_by(most, |a, b| {
        (*a - at)
            .norm_squared()
            .total_cmp(&(*b - at).norm_squared())
    });
    let around = &around[..=most];
    let mean = around.iter().copied().sum::<Vec3>() / around.len() as f64;
    let spread: Matrix3<f64> = around
        .iter()
        .map(|p| (*p - mean) * (*p - mean).transpose())
        .sum();
    let eigen = SymmetricEigen::new(spread);
    eigen
        .eigenvectors
        .column(eigen.eigenvalues.imin())
        .into_owned()
}

fn middle(centers: &[Vec3]) -> usize {
    let mean = centers.iter().sum::<Vec3>() / centers.len() as f64;
    nearest(centers, &mean, |_| true).unwrap_or(0)
}

fn nearest(centers: &[Vec3], at: &Vec3, counts: impl Fn(usize) -> bool) -> Option<usize> {
    let distance = |k: &usize| (centers[*k] - at).norm_squared();
    (0..centers.len())
        .filter(|k| counts(*k))
        .min_by(|a, b| distance(a).total_cmp(&distance(b)))
}

/// Edges (known, new) of the shortest tree over all sensels, in the order in which it grows (Prim 1957).
fn spanning_tree(centers: &[Vec3], root: usize) -> Vec<(usize, usize)> {
    let mut best = vec![(f64::INFINITY, root); centers.len()];
    let mut is_known = vec![false; centers.len()];
    let (mut edges, mut last) = (Vec::with_capacity(centers.len()), root);
    is_known[root] = true;
    while edges.len() + 1 < centers.len() {
        let mut next = (f64::INFINITY, last);
        for k in (0..centers.len()).filter(|k| !is_known[*k]) {
            let distance = (centers[k] - centers[last]).norm_squared();
            if distance < best[k].0 {
                best[k] = (distance, last);
            }
            if best[k].0 < next.0 {
                next = (best[k].0, k);
            }
        }
        last = next.1;
        is_known[last] = true;
        edges.push((best[last].1, last));
    }
    edges
}

/// Directions of the grid at the root: towards its nearest neighbor, turned by quarters to lie nearest to `along`.
fn first_axes(
    centers: &[Vec3],
    normals: &[Vec3],
    (root, along): (usize, Option<Vec3>),
) -> [Vec3; 2] {
    let normal = normals[root];
    let towards =
        nearest(centers, &centers[root], |k| k != root).map(|k| centers[k] - centers[root]);
    let flat = |v: Vec3| (v - normal * normal.dot(&v)).try_normalize(1e-9);
    let u = towards
        .and_then(flat)
        .unwrap_or_else(|| any_tangent(&normal));
    let v = normal.cross(&u);
    let Some(along) = along else { return [u, v] };
    let ways = [u, v, -u, -v];
    let best = ways
        .into_iter()
        .max_by(|a, b| a.dot(&along).total_cmp(&b.dot(&along)));
    let u = best.unwrap_or(u);
    [u, normal.cross(&u)]
}

/// Nearest sensel in one way along the mat, no farther than `most`.
fn beside(
    centers: &[Vec3],
    axes: &[Vec3; 2],
    (k, (axis, sign)): (usize, (usize, f64)),
    most: f64,
) -> Option<u32> {
    let mut best: Option<(f64, u32)> = None;
    for (other, center) in centers.iter().enumerate().filter(|(other, _)| *other != k) {
        let d = center - centers[k];
        let ahead = sign * d.dot(&axes[axis]);
        let is_there = ahead > 0.0 && ahead <= most && d.dot(&axes[1 - axis]).abs() < ASIDE * ahead;
        if is_there && best.is_none_or(|(length, _)| d.norm() < length) {
            best = Some((d.norm(), other as u32));
        }
    }
    best.map(|b| b.1)
}

/// Median distance of neighbors in both directions.
fn pitches(centers: &[Vec3], normals: &[Vec3], axes: &[[Vec3; 2]]) -> [f64; 2] {
    let median = |axis: usize| {
        let distance = |k: usize| {
            let other = beside(centers, &axes[k], (k, (axis, 1.0)), f64::INFINITY)?;
            let other = other as usize;
            Some(
                (centers[other] - centers[k]).norm() * arc_over_chord(&normals[k], &normals[other]),
            )
        };
        let mut found: Vec<f64> = (0..centers.len()).filter_map(distance).collect();
        found.sort_unstable_by(f64::total_cmp);
        found.get(found.len() / 2).copied()
    };
    match [median(0), median(1)] {
        [Some(a), Some(b)] => [a, b],
        [Some(a), None] | [None, Some(a)] => [a, a],
        [None, None] => [1.0, 1.0],
    }
}
