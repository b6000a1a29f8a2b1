//! Faces of any number of corners, and how they are cut into triangles: convex ones as a fan, others by their ears.

use earcut::Earcut;
use nalgebra::Vector3;

/// Part of its sides' product by which a corner may turn back and still count as straight.
const STRAIGHT: f64 = 1e-9;

/// Faces as they stand in a file.
#[derive(Default)]
pub(super) struct Faces {
    corners: Vec<u32>,
    ends: Vec<usize>,
}

impl Faces {
    /// Adds a face of three or more corners.
    pub fn push(&mut self, corners: &[u32]) {
        self.corners.extend_from_slice(corners);
        self.ends.push(self.corners.len());
    }

    /// The faces in order.
    pub fn iter(&self) -> impl Iterator<Item = &[u32]> {
        let starts = std::iter::once(0).chain(self.ends.iter().copied());
        starts
            .zip(&self.ends)
            .map(|(start, end)| &self.corners[start..*end])
    }

    /// All triangles, as vertex numbers.
    pub fn triangles(&self, positions: &[Vector3<f64>]) -> Vec<[u32; 3]> {
        let cut = |face| {
            let halves = cut(face, positions).into_iter();
            halves.map(|triangle| triangle.map(|k| face[k]))
        };
        self.iter().flat_map(cut).collect()
    }
}

/// The triangles of one face, as places in its list of corners. All its sides are sides of them, so that neighbors stay joined.
///
/// A face with a corner that is not in `positions` becomes a fan.
pub(super) fn cut(face: &[u32], positions: &[Vector3<f64>]) -> Vec<[usize; 3]> {
    let fan = || (2..face.len()).map(|k| [0, k - 1, k]).collect();
    if face.len() < 4 {
        return fan();
    }
    let places: Option<Vec<Vector3<f64>>> = face
        .iter()
        .map(|&i| positions.get(i as usize).copied())
        .collect();
    let Some(places) = places else { return fan() };
    let normal = normal(&places);
    if is_convex(&places, &normal) {
        return fan();
    }
    ears(&places, &normal).unwrap_or_else(fan)
}

/// Twice the area of the polygon as a vector: counter-clockwise about it.
fn normal(places: &[Vector3<f64>]) -> Vector3<f64> {
    let from = places[0];
    let pairs = places.windows(2);
    pairs.map(|p| (p[0] - from).cross(&(p[1] - from))).sum()
}

fn is_convex(places: &[Vector3<f64>], normal: &Vector3<f64>) -> bool {
    let count = places.len();
    let size = normal.norm();
    (0..count).all(|k| {
        let before = places[k] - places[(k + count - 1) % count];
        let after = places[(k + 1) % count] - places[k];
        before.cross(&after).dot(normal) >= -STRAIGHT * size * before.norm() * after.norm()
    })
}

/// Ears cut off in the polygon's mean plane; `None` where it has none.
fn ears(places: &[Vector3<f64>], normal: &Vector3<f64>) -> Option<Vec<[usize; 3]>> {
    let up = normal.try_normalize(0.0)?;
    let right = up.cross(&Vector3::ith(up.iamin(), 1.0)).normalize();
    let ahead = up.cross(&right);
    let flat = places.iter().map(|p| {
        let p = p - places[0];
        [p.dot(&right), p.dot(&ahead)]
    });
    let mut numbers: Vec<usize> = Vec::new();
    Earcut::new().earcut(flat, &[] as &[usize], &mut numbers);
    let mut triangles: Vec<[usize; 3]> = numbers.as_chunks::<3>().0.to_vec();
    if triangles.is_empty() {
        return None;
    }
    let doubled = |[a, b, c]: [usize; 3]| {
        let [a, b, c] = [a, b, c].map(|k| places[k]);
        (b - a).cross(&(c - a)).dot(&up)
    };
    if triangles.iter().map(|t| doubled(*t)).sum::<f64>() < 0.0 {
        triangles.iter_mut().for_each(|t| t.swap(1, 2));
    }
    put_back(places.len(), triangles)
}

/// Puts corners that were passed over, as those on a straight side are, back into the triangle on that side.
fn put_back(count: usize, mut triangles: Vec<[usize; 3]>) -> Option<Vec<[usize; 3]>> {
    let mut is_used = vec![false; count];
    triangles.iter().flatten().for_each(|&k| is_used[k] = true);
    let used: Vec<usize> = (0..count).filter(|&k| is_used[k]).collect();
    for (k, &from) in used.iter().enumerate() {
        let to = used[(k + 1) % used.len()];
        let mut last = from;
        let mut next = (from + 1) % count;
        while next != to {
            let has_side = |t: &[usize; 3]| (0..3).find(|&s| t[s] == last && t[(s + 1) % 3] == to);
            let (at, side) = triangles
                .iter()
                .enumerate()
                .find_map(|(at, t)| Some((at, has_side(t)?)))?;
            let tip = triangles[at][(side + 2) % 3];
            triangles[at] = [last, next, tip];
            triangles.push([next, to, tip]);
            (last, next) = (next, (next + 1) % count);
        }
    }
    Some(triangles)
}
