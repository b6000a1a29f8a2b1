//! Normals, areas and edge lengths of a mesh.

use crate::mesh::triangles::{Mesh, Vec3};

/// Unit normal at each vertex (n), the sum of the triangle normals weighted by the angle at the vertex (Thuermer & Wuethrich 1998).
///
/// Zero where no triangle with area meets. Degenerate and duplicated triangles are ignored.
pub fn vertex_normals(mesh: &Mesh) -> Vec<Vec3> {
    normals_of(mesh.positions().len(), mesh.sound_triangles())
}

fn normals_of(count: usize, triangles: impl Iterator<Item = ([u32; 3], [Vec3; 3])>) -> Vec<Vec3> {
    let mut sums = vec![Vec3::zeros(); count];
    for (vertices, corners) in triangles {
        add_angle_weighted(&mut sums, vertices, corners);
    }
    for n in &mut sums {
        *n = n.try_normalize(1e-12).unwrap_or_default();
    }
    sums
}

/// [`vertex_normals`] of some vertices, in their order.
pub(crate) fn normals_at(mesh: &Mesh, vertices: &[u32]) -> Vec<Vec3> {
    let mut is_wanted = vec![false; mesh.positions().len()];
    vertices.iter().for_each(|&v| is_wanted[v as usize] = true);
    let is_beside = |t: &[u32; 3]| t.iter().any(|&v| is_wanted[v as usize]);
    let normals = normals_of(
        mesh.positions().len(),
        mesh.sound_triangles_where(is_beside),
    );
    vertices.iter().map(|&v| normals[v as usize]).collect()
}

/// [`vertex_normals`] and [`vertex_areas`] of a mesh of which some vertices have moved, bit for bit, from those before.
///
/// `has_moved`, `normals` and `areas` (n).
pub fn renew_shape(mesh: &Mesh, has_moved: &[bool], (normals, areas): (&mut [Vec3], &mut [f64])) {
    let is_stale = beside(mesh, has_moved);
    let is_around = |vertices: &[u32; 3]| vertices.iter().any(|&v| is_stale[v as usize]);
    for ((normal, area), _) in normals
        .iter_mut()
        .zip(areas.iter_mut())
        .zip(&is_stale)
        .filter(|(_, is_stale)| **is_stale)
    {
        (*normal, *area) = (Vec3::zeros(), 0.0);
    }
    for (vertices, corners) in mesh.sound_triangles_where(is_around) {
        let [a, b, c] = corners;
        let third = (b - a).cross(&(c - a)).norm() / 6.0;
        let shares = angle_weighted(corners).unwrap_or_default();
        for (v, share) in vertices.into_iter().zip(shares) {
            let v = v as usize;
            if is_stale[v] {
                normals[v] += share;
                areas[v] += third;
            }
        }
    }
    let stale = normals.iter_mut().zip(&is_stale);
    for (normal, _) in stale.filter(|(_, is_stale)| **is_stale) {
        *normal = normal.try_normalize(1e-12).unwrap_or_default();
    }
}

/// Which vertices share a triangle with one that has moved.
fn beside(mesh: &Mesh, has_moved: &[bool]) -> Vec<bool> {
    let mut is_beside = vec![false; has_moved.len()];
    for triangle in mesh.triangles() {
        if triangle.iter().any(|&v| has_moved[v as usize]) {
            triangle.iter().for_each(|&v| is_beside[v as usize] = true);
        }
    }
    is_beside
}

/// Adds the normal of one triangle to its vertices, weighted by the angle at each.
pub(crate) fn add_angle_weighted(sums: &mut [Vec3], vertices: [u32; 3], corners: [Vec3; 3]) {
    for (vertex, share) in vertices
        .into_iter()
        .zip(angle_weighted(corners).into_iter().flatten())
    {
        sums[vertex as usize] += share;
    }
}

/// The normal of a triangle weighted by the angle at each corner; None without area.
fn angle_weighted([a, b, c]: [Vec3; 3]) -> Option<[Vec3; 3]> {
    let (ab, ac, bc) = (b - a, c - a, c - b);
    let cross = ab.cross(&ac);
    let twice = cross.norm();
    if twice <= 0.0 {
        return None;
    }
    // The sine part of every angle is twice the area; the last angle is what the others leave.
    let at_a = twice.atan2(ab.dot(&ac));
    let at_b = twice.atan2(-ab.dot(&bc));
    let at_c = std::f64::consts::PI - at_a - at_b;
    let normal = cross / twice;
    Some([at_a, at_b, at_c].map(|angle| normal * angle))
}

/// Area of each vertex (n), mm2: a third of each triangle around it. Degenerate and duplicated triangles are ignored.
pub fn vertex_areas(mesh: &Mesh) -> Vec<f64> {
    let mut areas = vec![0.0; mesh.positions().len()];
    for (vertices, [a, b, c]) in mesh.sound_triangles() {
        let third = (b - a).cross(&(c - a)).norm() / 6.0;
        vertices.iter().for_each(|&i| areas[i as usize] += third);
    }
    areas
}

/// Median length of the edges, mm (the upper one of two); 0 for a mesh whose triangles name one vertex only.
pub fn median_edge_length(mesh: &Mesh) -> f64 {
    let p = mesh.positions();
    let mut lengths: Vec<f64> = mesh
        .edges()
        .iter()
        .map(|&[a, b]| (p[a as usize] - p[b as usize]).norm())
        .collect();
    if lengths.is_empty() {
        return 0.0;
    }
    let middle = lengths.len() / 2;
    *lengths.select_nth_unstable_by(middle, f64::total_cmp).1
}
