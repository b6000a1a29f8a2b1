//! Counts the triangles of a mesh that pass through others.

use crate::mesh::triangles::{Mesh, Standing, Vec3, standings};
use crate::tree::bvh::{Source, Tree};

/// How many triangles properly cross a triangle they share no vertex with. Touching and coplanar pairs do not count, nor do degenerate and
/// duplicated triangles.
pub fn self_intersections(mesh: &Mesh) -> usize {
    let standing = standings(mesh.positions(), mesh.triangles());
    let sound = (0..standing.len()).filter(|&t| standing[t] == Standing::Sound);
    let source = |t| Source {
        id: t as u32,
        corners: mesh.corners(t),
        is_sheet: false,
        piece_of: None,
    };
    let sound: Vec<Source> = sound.map(source).collect();
    if sound.is_empty() {
        return 0;
    }
    let tree = Tree::new(&sound, standing.len());
    let mut crosses = vec![false; standing.len()];
    let mut near = Vec::new();
    for Source { id: t, corners, .. } in &sound {
        tree.overlapping(corners, &mut near);
        let own = mesh.triangles()[*t as usize];
        for &other in near.iter().filter(|&&other| other > *t) {
            let shares = mesh.triangles()[other as usize]
                .iter()
                .any(|i| own.contains(i));
            if !shares && cross(corners, &mesh.corners(other as usize)) {
                crosses[*t as usize] = true;
                crosses[other as usize] = true;
            }
        }
    }
    crosses.iter().filter(|c| **c).count()
}

/// Whether an edge of either triangle passes through the inside of the other.
pub(crate) fn cross(a: &[Vec3; 3], b: &[Vec3; 3]) -> bool {
    (0..3).any(|k| pierces(a[k], a[(k + 1) % 3], b))
        || (0..3).any(|k| pierces(b[k], b[(k + 1) % 3], a))
}

fn pierces(from: Vec3, to: Vec3, t: &[Vec3; 3]) -> bool {
    let side = |p: Vec3| (t[1] - t[0]).cross(&(t[2] - t[0])).dot(&(p - t[0]));
    if side(from) * side(to) >= 0.0 {
        return false;
    }
    let volume = |k: usize| {
        (to - from)
            .cross(&(t[k] - from))
            .dot(&(t[(k + 1) % 3] - from))
    };
    let (u, v, w) = (volume(0), volume(1), volume(2));
    (u > 0.0 && v > 0.0 && w > 0.0) || (u < 0.0 && v < 0.0 && w < 0.0)
}
