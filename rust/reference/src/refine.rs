//! Finer skin where the product is near: contact needs several vertices over its width.

use std::collections::BTreeMap;

use thenar_surface::{Mesh, Vec3, vertex_normals};

use crate::Tissue;

/// Tissue with new vertices on long edges.
pub struct Refined {
    pub tissue: Tissue,
    /// The two vertices between which every new vertex lies; new ones follow the old.
    pub parents: Vec<[u32; 2]>,
}

impl Refined {
    /// Splits, once, edges longer than `longest` mm one of whose ends is `near`. New vertices lie on the round surface that the old
    /// normals tell.
    pub fn new(tissue: &Tissue, near: impl Fn(usize) -> bool, longest: f64) -> Refined {
        let normals = Mesh::new(tissue.skin.clone(), tissue.triangles.clone())
            .map(|mesh| vertex_normals(&mesh));
        let normals = normals.unwrap_or_else(|_| vec![Vec3::zeros(); tissue.skin.len()]);
        let mut tissue = tissue.clone();
        let mut parents = Vec::new();
        let mut middles: BTreeMap<[u32; 2], Option<u32>> = BTreeMap::new();
        let old = std::mem::take(&mut tissue.triangles);
        for triangle in old {
            let corners = [0, 1, 2].map(|k| {
                let (a, b) = (triangle[k], triangle[(k + 1) % 3]);
                let side = [a.min(b), a.max(b)];
                *middles.entry(side).or_insert_with(|| {
                    let [a, b] = side.map(|v| v as usize);
                    let is_long = (tissue.skin[a] - tissue.skin[b]).norm() > longest;
                    if !is_long || !(near(a) || near(b)) {
                        return None;
                    }
                    parents.push(side);
                    tissue.skin.push(middle(
                        [tissue.skin[a], tissue.skin[b]],
                        [normals[a], normals[b]],
                    ));
                    tissue.bone.push((tissue.bone[a] + tissue.bone[b]) / 2.0);
                    tissue.is_held.push(tissue.is_held[a] && tissue.is_held[b]);
                    let can_touch = tissue.can_touch[a] && tissue.can_touch[b];
                    tissue.can_touch.push(can_touch);
                    for values in [&mut tissue.shear_modulus_mpa, &mut tissue.stiffening] {
                        values.push((values[a] + values[b]) / 2.0);
                    }
                    Some(tissue.skin.len() as u32 - 1)
                })
            });
            split(triangle, corners, &mut tissue.triangles);
        }
        Refined { tissue, parents }
    }
}

/// Middle of an edge on the surface that is square to the normals of its ends (Vlachos et al. 2001, curved PN triangles: the cubic along
/// the edge at its middle).
fn middle(ends: [Vec3; 2], normals: [Vec3; 2]) -> Vec3 {
    let along = ends[1] - ends[0];
    let lift = normals[0] * along.dot(&normals[0]) - normals[1] * along.dot(&normals[1]);
    (ends[0] + ends[1]) / 2.0 - lift / 8.0
}

/// Triangles of a triangle with a new vertex on some of its sides (first to second corner, second to third, third to first).
fn split([a, b, c]: [u32; 3], middles: [Option<u32>; 3], out: &mut Vec<[u32; 3]>) {
    match middles {
        [None, None, None] => out.push([a, b, c]),
        [Some(d), None, None] => out.extend([[a, d, c], [d, b, c]]),
        [Some(d), Some(e), None] => out.extend([[d, b, e], [a, d, e], [a, e, c]]),
        [Some(d), Some(e), Some(f)] => out.extend([[a, d, f], [d, b, e], [f, e, c], [d, e, f]]),
        [d, e, f] => split([b, c, a], [e, f, d], out),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Any choice of split sides covers the triangle once, with no corner on a side.
    #[test]
    fn a_split_triangle_keeps_its_area_and_its_turn() {
        let places = [
            Vec3::zeros(),
            Vec3::new(4.0, 0.0, 0.0),
            Vec3::new(0.0, 4.0, 0.0),
            Vec3::new(2.0, 0.0, 0.0),
            Vec3::new(2.0, 2.0, 0.0),
            Vec3::new(0.0, 2.0, 0.0),
        ];
        for sides in 0..8 {
            let middles = [0, 1, 2].map(|k| (sides >> k & 1 == 1).then_some(3 + k));
            let mut out = Vec::new();
            split([0, 1, 2], middles, &mut out);
            assert_eq!(out.len(), 1 + middles.iter().flatten().count());
            let area = |t: &[u32; 3]| {
                let [a, b, c] = t.map(|v| places[v as usize]);
                (b - a).cross(&(c - a)).z / 2.0
            };
            assert!(out.iter().all(|t| area(t) > 0.0));
            assert!((out.iter().map(area).sum::<f64>() - 8.0).abs() < 1e-12);
        }
    }

    #[test]
    fn a_new_vertex_lies_on_the_round_surface() {
        let at = |angle: f64| Vec3::new(angle.cos(), angle.sin(), 0.0);
        let (a, b) = (at(0.0), at(0.3));
        assert!((middle([a * 8.0, b * 8.0], [a, b]).norm() - 8.0).abs() < 0.002);
        assert!(
            ((a * 8.0 + b * 8.0) / 2.0).norm() < 7.92,
            "the chord lies below"
        );
    }
}
