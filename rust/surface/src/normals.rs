//! Normals, areas and edge lengths of a mesh.

use crate::mesh::{Mesh, Vec3};

/// Unit normal at each vertex (n), the sum of the triangle normals weighted by the angle at the vertex (Thuermer & Wuethrich 1998).
///
/// Zero where no triangle with area meets. Degenerate and duplicated triangles are ignored.
pub fn vertex_normals(mesh: &Mesh) -> Vec<Vec3> {
    let mut sums = vec![Vec3::zeros(); mesh.positions().len()];
    for (vertices, corners) in mesh.sound_triangles() {
        add_angle_weighted(&mut sums, vertices, corners);
    }
    for n in &mut sums {
        *n = n.try_normalize(1e-12).unwrap_or_default();
    }
    sums
}

/// [`vertex_normals`] of a mesh of which some vertices have moved, bit for bit, from the `normals` before; `has_moved` (n).
pub fn renew_normals(mesh: &Mesh, has_moved: &[bool], normals: &mut [Vec3]) {
    let is_stale = beside(mesh, has_moved);
    let mut sums: Vec<Vec3> = vec![Vec3::zeros(); normals.len()];
    let is_around = |vertices: &[u32; 3]| vertices.iter().any(|&v| is_stale[v as usize]);
    for (vertices, corners) in mesh.sound_triangles_where(is_around) {
        add_angle_weighted(&mut sums, vertices, corners);
    }
    for (k, n) in normals.iter_mut().enumerate() {
        if is_stale[k] {
            *n = sums[k].try_normalize(1e-12).unwrap_or_default();
        }
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
    let [a, b, c] = corners;
    let (ab, ac, bc) = (b - a, c - a, c - b);
    let cross = ab.cross(&ac);
    let twice = cross.norm();
    if twice <= 0.0 {
        return;
    }
    // The sine part of every angle is twice the area; the last angle is what the others leave.
    let at_a = twice.atan2(ab.dot(&ac));
    let at_b = twice.atan2(-ab.dot(&bc));
    let at_c = std::f64::consts::PI - at_a - at_b;
    let normal = cross / twice;
    for (vertex, angle) in vertices.into_iter().zip([at_a, at_b, at_c]) {
        sums[vertex as usize] += normal * angle;
    }
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

/// [`vertex_areas`] of a mesh of which some vertices have moved, bit for bit, from the `areas` before; `has_moved` (n).
pub fn renew_areas(mesh: &Mesh, has_moved: &[bool], areas: &mut [f64]) {
    let is_stale = beside(mesh, has_moved);
    let is_around = |vertices: &[u32; 3]| vertices.iter().any(|&v| is_stale[v as usize]);
    for (area, is_stale) in areas.iter_mut().zip(&is_stale) {
        *area = if *is_stale { 0.0 } else { *area };
    }
    for (vertices, [a, b, c]) in mesh.sound_triangles_where(is_around) {
        let third = (b - a).cross(&(c - a)).norm() / 6.0;
        for v in vertices.into_iter().map(|v| v as usize) {
            areas[v] += if is_stale[v] { third } else { 0.0 };
        }
    }
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
