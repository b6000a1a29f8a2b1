//! Faces that say by their own normal which side of them is solid, so that points over their inside need no winding number.

use std::sync::OnceLock;

use crate::mesh::closest_point::Feature;
use crate::mesh::triangles::{Vec3, least_height};
use crate::solid::orientation::{Oriented, SLIVER};
use crate::solid::union::may_touch;
use crate::tree::bvh::Tree;
use crate::tree::face::Face;
use crate::tree::nearest::Hit;
use crate::tree::self_intersections::cross;
use crate::tree::winding_number::Winding;

/// Corners within this part of the product's extent are one.
const SAME_CORNER: f64 = 1e-12;

/// A winding number this far from a whole one is that of a place near a hole; clusters of faces taken as one err by 0.01.
const UNSURE: f64 = 0.02;

/// Faces that are plain: solid is behind and none in front of them, all over.
///
/// Such a face meets no other one but at a corner or an edge that both have, and is no sliver. From a point whose nearest place is within
/// the face, the way there crosses no other face: its side is that of the face, as the winding number says of the face's middle. The same
/// is so at an edge that it shares with one other plain face, by the sum of their normals (Baerentzen & Aanaes 2005).
#[derive(Debug, Clone)]
pub(crate) struct PlainFaces {
    /// What counts as no distance between two faces, mm.
    thin: f64,
    /// By slot of the tree, what was found of a face when it was first asked for; empty where the product is open or has sheets.
    found: Vec<OnceLock<Option<Across>>>,
}

/// Of a plain face, the face across each edge, if that is the only other one there; `u32::MAX` if not.
type Across = [u32; 3];

impl PlainFaces {
    /// Prepares the faces of a tree; each is looked at when it is first the nearest one.
    pub(crate) fn new(oriented: &Oriented, tree: &Tree) -> PlainFaces {
        let is_closed = !oriented.is_open && !tree.faces.iter().any(|face| face.is_sheet);
        let count = if is_closed { tree.faces.len() } else { 0 };
        PlainFaces {
            thin: oriented.thin,
            found: vec![OnceLock::new(); count],
        }
    }

    /// The direction out of the solid at the place of a hit, not of unit length; none where no plain face says.
    pub(crate) fn outward(&self, (tree, winding): (&Tree, &Winding), hit: &Hit) -> Option<Vec3> {
        let across = |slot: u32| {
            let found = self.found.get(slot as usize)?;
            *found.get_or_init(|| plain((tree, winding), self.thin, slot as usize))
        };
        let own = tree.faces[hit.slot as usize].normal;
        match hit.on.feature {
            Feature::Face => across(hit.slot).map(|_| own),
            Feature::Edge(side) => {
                let other = across(hit.slot)?[side as usize];
                across(other).map(|_| own + tree.faces[other as usize].normal)
            }
            Feature::Vertex(_) => None,
        }
    }
}

fn plain((tree, winding): (&Tree, &Winding), thin: f64, slot: usize) -> Option<Across> {
    let face = &tree.faces[slot];
    let own = corners(face);
    if least_height(own) * tree.shrink < SLIVER {
        return None;
    }
    let room = Vec3::repeat(thin);
    let low = own[0].inf(&own[1]).inf(&own[2]) - room;
    let high = own[0].sup(&own[1]).sup(&own[2]) + room;
    let has = |p: &Vec3, all: &[Vec3; 3]| {
        let is_same = |q: &Vec3| (p - q).norm() * tree.shrink <= SAME_CORNER;
        all.iter().any(is_same)
    };
    let mut across = [None; 3];
    for other in tree.slots_overlapping([low, high]) {
        if other as usize == slot {
            continue;
        }
        let all = corners(&tree.faces[other as usize]);
        let shared = own.map(|p| has(&p, &all));
        let joins = shared.contains(&true);
        let is_clear = match joins {
            true => !cross(&own, &all),
            false => are_apart(&own, &all, thin) || !may_touch(&own, &all, thin),
        };
        if !is_clear {
            return None;
        }
        for (side, beyond) in across.iter_mut().enumerate() {
            if shared[side] && shared[(side + 1) % 3] {
                *beyond = Some(beyond.map_or(other, |_| u32::MAX));
            }
        }
    }
    // Across a face that nothing else touches the number changes by one: what is empty in front is solid behind.
    let ahead = own.iter().sum::<Vec3>() / 3.0 + face.normal * thin;
    let is_bare = winding.number(tree, ahead).abs() <= UNSURE;
    is_bare.then(|| across.map(|other| other.unwrap_or(u32::MAX)))
}

/// Whether a plane along an edge of either triangle and square to that triangle parts them by more than `thin`.
fn are_apart(a: &[Vec3; 3], b: &[Vec3; 3], thin: f64) -> bool {
    let parts = |a: &[Vec3; 3], b: &[Vec3; 3]| {
        let normal = (a[1] - a[0]).cross(&(a[2] - a[0]));
        (0..3).any(|k| {
            let out = (a[(k + 1) % 3] - a[k]).cross(&normal).normalize();
            b.iter().all(|p| out.dot(&(p - a[k])) > thin)
        })
    };
    parts(a, b) || parts(b, a)
}

fn corners(face: &Face) -> [Vec3; 3] {
    [face.a, face.a + face.ab, face.a + face.ac]
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use crate::mesh::triangles::{Mesh, Vec3};
    use crate::solid::product::Product;
    use crate::solid::sign::Sign;
    use crate::tree::nearest::Pending;

    /// A closed tube of `sides` around a polyline of rings (center, radius), along z; where rings come back, it passes through itself.
    fn tube(rings: &[(Vec3, f64)], sides: u32) -> Mesh {
        let (mut points, mut triangles) = (Vec::new(), Vec::new());
        for (center, radius) in rings {
            for k in 0..sides {
                let turn = f64::from(k) / f64::from(sides) * std::f64::consts::TAU;
                points.push(center + Vec3::new(turn.cos(), turn.sin(), 0.0) * *radius);
            }
        }
        let last = rings.len() as u32 - 1;
        for ring in 0..last {
            for k in 0..sides {
                let (a, b) = (ring * sides + k, ring * sides + (k + 1) % sides);
                triangles.extend([[a, b, a + sides], [b, b + sides, a + sides]]);
            }
        }
        for (ring, turned) in [(0, true), (last, false)] {
            let middle = points.len() as u32;
            points.push(rings[ring as usize].0);
            for k in 0..sides {
                let (a, b) = (ring * sides + k, ring * sides + (k + 1) % sides);
                triangles.push(if turned {
                    [b, a, middle]
                } else {
                    [a, b, middle]
                });
            }
        }
        Mesh::new(points, triangles).unwrap()
    }

    fn together(meshes: &[Mesh]) -> Mesh {
        let (mut points, mut triangles) = (Vec::new(), Vec::new());
        for mesh in meshes {
            let first = points.len() as u32;
            points.extend_from_slice(mesh.positions());
            triangles.extend(mesh.triangles().iter().map(|t| t.map(|i| i + first)));
        }
        Mesh::new(points, triangles).unwrap()
    }

    /// Share of the faces that are plain, and of points whose side such a face says; every side is held against the winding number.
    fn shares(mesh: Mesh) -> [f64; 2] {
        let product = Product::new(mesh).unwrap();
        let Sign::Winding(winding, plain) = &product.sign else {
            unreachable!("parts that overlap are wound around")
        };
        let (tree, mut pending, mut over) = (&product.tree, Pending::default(), 0);
        let mut state = 7u64;
        let mut next = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            (state >> 11) as f64 / (1u64 << 53) as f64
        };
        let points = 20_000;
        for _ in 0..points {
            let face = &tree.faces[(next() * tree.faces.len() as f64) as usize];
            let (u, v) = (next(), next());
            let on = face.a + face.ab * (u * (1.0 - v)) + face.ac * (u * v);
            let off = Vec3::new(next() - 0.5, next() - 0.5, next() - 0.5);
            let query = tree.local_query(on + off * (20.0 * next().powi(4)));
            let hit = tree
                .nearest(&query, f64::INFINITY, &mut pending, |_, _| 1.0)
                .unwrap();
            over += usize::from(plain.outward((tree, winding), &hit).is_some());
            let is_inside = product.sign.is_inside(tree, query.point, &hit);
            // A part that passes through itself leaves holes, near which the number is none.
            let turns = winding.number(tree, query.point);
            if (turns - turns.round()).abs() < 0.25 {
                assert_eq!(is_inside, turns > 0.5, "{turns} at {:?}", query.point);
            }
        }
        let count = (0..tree.faces.len())
            .filter(|&slot| super::plain((tree, winding), plain.thin, slot).is_some())
            .count();
        [
            count as f64 / tree.faces.len() as f64,
            f64::from(over as u32) / f64::from(points),
        ]
    }

    #[test]
    fn the_side_over_a_plain_face_is_that_of_the_winding_number() {
        let straight = |x: f64, tilt: f64| {
            let at = |z: f64| (Vec3::new(x + tilt * z, 0.1 * z, z), 9.0 + 0.02 * z);
            tube(&[-30.0, -18.0, -7.0, 2.0, 13.0, 24.0, 31.0].map(at), 17)
        };
        let crossed = together(&[straight(0.0, 0.0), straight(4.0, 0.7), straight(-30.0, 0.2)]);
        let [plain, over] = shares(crossed);
        assert!(plain > 0.4 && over > 0.4, "{plain} {over}");
        // A part that passes through itself, next to another: its faces within itself are not plain.
        let rings = [
            (0.0, 8.0),
            (20.0, 8.0),
            (30.0, 14.0),
            (5.0, 5.0),
            (40.0, 3.0),
        ];
        let folded = tube(
            &rings.map(|(z, radius)| (Vec3::new(0.0, 0.0, z), radius)),
            16,
        );
        let [plain, _] = shares(together(&[folded, straight(6.0, 0.1)]));
        assert!(plain < 0.9, "{plain}");
    }
}
