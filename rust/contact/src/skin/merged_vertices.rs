//! Merges coincident vertices (seams of unwelded meshes) and vertices too close for the response.

use std::collections::HashMap;
use std::hash::{BuildHasherDefault, Hasher};

use thenar_surface::{Mesh, MeshError, Vec3};

/// Share of the edges around both below which two vertices count as one: nearer points make the response indefinite.
const MERGE_SHARE: f64 = 0.25;

/// A mesh without coincident vertices, and the map to and from the original ones.
#[derive(Debug, Clone)]
pub struct MergedMesh {
    /// The welded mesh.
    pub mesh: Mesh,
    /// Original vertex that each welded vertex takes its position from.
    pub source: Vec<u32>,
    /// Welded vertex of each original vertex.
    pub merged_of: Vec<u32>,
    /// Positions of the mesh as given, mm; empty where nothing was merged.
    pub given: Vec<Vec3>,
}

impl MergedMesh {
    /// Merges vertices nearer to each other than a quarter of the mean edge around either.
    ///
    /// # Errors
    /// [`MeshError`] if nothing is left after merging.
    pub fn new(mesh: &Mesh) -> Result<Self, MeshError> {
        let positions = mesh.positions();
        let welded = representatives(positions, &merge_radii(mesh));
        let mut number = vec![u32::MAX; positions.len()];
        let mut source = Vec::new();
        for (i, &w) in welded.iter().enumerate() {
            if w as usize == i {
                number[i] = source.len() as u32;
                source.push(i as u32);
            }
        }
        let welded: Vec<u32> = welded.iter().map(|&w| number[w as usize]).collect();
        if source.len() == positions.len() {
            return Ok(MergedMesh {
                mesh: mesh.clone(),
                source,
                merged_of: welded,
                given: Vec::new(),
            });
        }
        let kept = source.iter().map(|&i| positions[i as usize]).collect();
        let triangles = mesh
            .triangles()
            .iter()
            .map(|t| t.map(|v| welded[v as usize]));
        let triangles = triangles
            .filter(|t| t[0] != t[1] && t[1] != t[2] && t[2] != t[0])
            .collect();
        Ok(MergedMesh {
            mesh: Mesh::new(kept, triangles)?,
            source,
            merged_of: welded,
            given: positions.to_vec(),
        })
    }

    /// Number of original vertices that were merged into another.
    pub fn merged(&self) -> usize {
        self.merged_of.len() - self.source.len()
    }
}

/// A quarter of the mean edge around every vertex, mm; 0 for loose ones.
fn merge_radii(mesh: &Mesh) -> Vec<f64> {
    let positions = mesh.positions();
    let mut sums = vec![(0.0, 0u32); positions.len()];
    for [a, b] in mesh.edges() {
        let length = (positions[a as usize] - positions[b as usize]).norm();
        for end in [a, b] {
            let sum = &mut sums[end as usize];
            *sum = (sum.0 + length, sum.1 + 1);
        }
    }
    sums.iter()
        .map(|(sum, count)| MERGE_SHARE * sum / f64::from((*count).max(1)))
        .collect()
}

/// For each point, its representative: the lowest earlier representative within both points' radii, or the point itself.
fn representatives(points: &[Vec3], radius: &[f64]) -> Vec<u32> {
    let widest = radius.iter().fold(0.0, |most, r| f64::max(most, *r));
    if widest <= 0.0 {
        return (0..points.len() as u32).collect();
    }
    let cell = |p: &Vec3| [p.x, p.y, p.z].map(|c| (c / widest).floor() as i64);
    let mut cells: HashMap<[i64; 3], Vec<u32>, BuildHasherDefault<CellHasher>> =
        HashMap::with_capacity_and_hasher(points.len(), BuildHasherDefault::default());
    let mut found = Vec::with_capacity(points.len());
    for (i, p) in points.iter().enumerate() {
        let home = cell(p);
        let mut best: Option<u32> = None;
        for offset in 0..27 {
            let near = [
                home[0] + offset % 3 - 1,
                home[1] + offset / 3 % 3 - 1,
                home[2] + offset / 9 - 1,
            ];
            for &other in cells.get(&near).map_or(&[][..], Vec::as_slice) {
                if (points[other as usize] - p).norm() < radius[i].min(radius[other as usize]) {
                    best = Some(best.map_or(other, |b| b.min(other)));
                }
            }
        }
        if best.is_none() {
            cells.entry(home).or_default().push(i as u32);
        }
        found.push(best.unwrap_or(i as u32));
    }
    found
}

/// Hashes the numbers of a cell; the map is only asked, never listed, so that its order does not matter.
#[derive(Default)]
struct CellHasher(u64);

impl Hasher for CellHasher {
    fn finish(&self) -> u64 {
        self.0 ^ (self.0 >> 29)
    }

    fn write(&mut self, bytes: &[u8]) {
        for eight in bytes.chunks(8) {
            let mut word = [0; 8];
            word[..eight.len()].copy_from_slice(eight);
            // Knuth's multiplicative hashing with the golden ratio in 64 bits.
            let mixed = (self.0.rotate_left(23) ^ u64::from_le_bytes(word)).wrapping_add(1);
            self.0 = mixed.wrapping_mul(0x9e37_79b9_7f4a_7c15);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_seam_is_closed_and_distinct_vertices_stay() {
        let p = |x: f64, y: f64| Vec3::new(x, y, 0.0);
        let positions = vec![
            p(0.0, 0.0),
            p(1.0, 0.0),
            p(0.0, 1.0),
            p(1.0, 1e-9),
            p(0.0, 1.0),
            p(1.0, 1.0),
        ];
        let mesh = Mesh::new(positions, vec![[0, 1, 2], [3, 5, 4]]).unwrap();
        let welded = MergedMesh::new(&mesh).unwrap();
        assert_eq!(welded.merged(), 2);
        assert_eq!(welded.merged_of, [0, 1, 2, 1, 2, 3]);
        assert_eq!(welded.mesh.triangles(), [[0, 1, 2], [1, 3, 2]]);
    }
}
