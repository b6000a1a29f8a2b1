//! Makes vertices at one place one, as exporters split them at seams.

use crate::mesh::audit::{find, join};
use crate::mesh::edges::{joins, sides};
use crate::mesh::triangles::{Mesh, standings};

/// Triangles that name, for each vertex, the first one at the same place; of closed parts, the first one of the same part.
pub(crate) fn weld(mesh: &Mesh) -> Vec<[u32; 3]> {
    let p = mesh.positions();
    // Adding 0 makes -0 and 0 one.
    let bits = |i: u32| {
        let q = p[i as usize];
        [
            (q.x + 0.0).to_bits(),
            (q.y + 0.0).to_bits(),
            (q.z + 0.0).to_bits(),
        ]
    };
    let mut order: Vec<u32> = (0..p.len() as u32).collect();
    order.sort_unstable_by_key(|&i| (bits(i), i));
    let is_same = |a: &u32, b: &u32| bits(*a) == bits(*b);
    let kin = if order.chunk_by(is_same).all(|g| g.len() == 1) {
        Vec::new()
    } else {
        closed_parts(mesh)
    };
    let mut first = vec![0u32; p.len()];
    for group in order.chunk_by_mut(is_same) {
        if group.len() > 1 {
            group.sort_unstable_by_key(|&i| (kin[i as usize], i));
        }
        for own in group.chunk_by(|a, b| kin.is_empty() || kin[*a as usize] == kin[*b as usize]) {
            own.iter().for_each(|&i| first[i as usize] = own[0]);
        }
    }
    mesh.triangles()
        .iter()
        .map(|t| t.map(|i| first[i as usize]))
        .collect()
}

/// By vertex, the first vertex of its part if that is closed by itself; `u32::MAX` for all others.
fn closed_parts(mesh: &Mesh) -> Vec<u32> {
    let count = mesh.positions().len();
    let standing = standings(mesh.positions(), mesh.triangles());
    let all = sides(count, mesh.triangles(), |t| joins(standing[t]));
    let mut root: Vec<u32> = (0..count as u32).collect();
    for t in mesh.triangles() {
        join(&mut root, t[0], t[1]);
        join(&mut root, t[0], t[2]);
    }
    let mut is_open = vec![false; count];
    for group in all
        .chunk_by(|a, b| a.edge == b.edge)
        .filter(|g| g.len() == 1)
    {
        is_open[find(&mut root, group[0].edge[0]) as usize] = true;
    }
    let part = |i: u32| match find(&mut root, i) {
        own if is_open[own as usize] => u32::MAX,
        own => own,
    };
    (0..count as u32).map(part).collect()
}
