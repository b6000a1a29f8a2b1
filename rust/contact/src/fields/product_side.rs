//! The product's side of the contact: nodal forces of the skin spread over the product's vertices, none lost.

use std::collections::HashMap;

use thenar_surface::{Gap, Mesh, Product, Vec3, vertex_areas};

/// Reach over which a nodal force is spread, in vertex spacings of the hand: the coarser mesh sets what a map can resolve,
/// and two meshes that sample each other point by point would show stripes.
const SPREAD: f64 = 1.2;
/// Share of that reach beyond which a vertex off the touched plane belongs to another wall.
const WALL_SHARE: f64 = 0.6;

/// Pressure at every product vertex, MPa, and the force that it sums to, N.
///
/// Each nodal force is spread over the product's vertices within reach of its touch, by area and nearness; where there are
/// none (a coarse product) it goes to the corners of the touched triangle by barycentric coordinates. `spacing` is the
/// hand's, mm.
pub fn product_pressure(
    product: &Product,
    touches: &[(f64, Gap)],
    spacing: f64,
) -> (Vec<f64>, f64) {
    let mesh = product.mesh();
    let areas = vertex_areas(mesh);
    let mut force = vec![0.0; areas.len()];
    let reach = SPREAD * spacing;
    let cells = vertices_near(mesh, touches, reach);
    for (nodal, gap) in touches {
        let shares = shares(mesh, (gap, reach), (&cells, &areas));
        let sum: f64 = shares.iter().map(|s| s.1).sum();
        if sum > 0.0 {
            shares
                .iter()
                .for_each(|(vertex, share)| force[*vertex as usize] += nodal * share / sum);
        } else {
            let triangle = mesh.triangles()[gap.triangle as usize];
            for (corner, share) in triangle.into_iter().zip(gap.barycentric) {
                force[corner as usize] += nodal * share;
            }
        }
    }
    let total = force.iter().sum();
    let pressure = force
        .iter()
        .zip(&areas)
        .map(|(f, a)| if *a > 0.0 { f / a } else { 0.0 })
        .collect();
    (pressure, total)
}

type Cells = HashMap<[i64; 3], Vec<u32>>;

fn cell(point: &Vec3, size: f64) -> [i64; 3] {
    [point.x, point.y, point.z].map(|c| (c / size).floor() as i64)
}

/// Product vertices by grid cell, for the cells within reach of a touch.
fn vertices_near(mesh: &Mesh, touches: &[(f64, Gap)], reach: f64) -> Cells {
    let mut cells = Cells::new();
    for (_, gap) in touches {
        let home = cell(&gap.closest, reach);
        for step in 0..27 {
            cells
                .entry([
                    home[0] + step % 3 - 1,
                    home[1] + step / 3 % 3 - 1,
                    home[2] + step / 9 - 1,
                ])
                .or_default();
        }
    }
    for (vertex, position) in mesh.positions().iter().enumerate() {
        if let Some(list) = cells.get_mut(&cell(position, reach)) {
            list.push(vertex as u32);
        }
    }
    cells
}

fn shares(
    mesh: &Mesh,
    (gap, reach): (&Gap, f64),
    (cells, areas): (&Cells, &[f64]),
) -> Vec<(u32, f64)> {
    let home = cell(&gap.closest, reach);
    let mut found = Vec::new();
    for step in 0..27 {
        let near = [
            home[0] + step % 3 - 1,
            home[1] + step / 3 % 3 - 1,
            home[2] + step / 9 - 1,
        ];
        for &vertex in cells.get(&near).map_or(&[][..], Vec::as_slice) {
            let offset = mesh.positions()[vertex as usize] - gap.closest;
            let far = offset.norm_squared() / (reach * reach);
            if far < 1.0 && offset.dot(&gap.normal).abs() < WALL_SHARE * reach {
                found.push((vertex, areas[vertex as usize] * (1.0 - far) * (1.0 - far)));
            }
        }
    }
    found
}
