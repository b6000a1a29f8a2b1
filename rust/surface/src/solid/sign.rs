//! Inside or outside: angle-weighted pseudo-normals, or the winding number where the surface is open or not manifold.

use crate::mesh::closest_point::Feature;
use crate::mesh::normals::add_angle_weighted;
use crate::mesh::triangles::{Standing, Vec3};
use crate::solid::orientation::Oriented;
use crate::solid::plain_faces::PlainFaces;
use crate::tree::bvh::Tree;
use crate::tree::nearest::Hit;
use crate::tree::winding_number::{Counted, Winding};

/// Part of the product's extent from which a point is clear of the surface: nearer, rounding decides on which side of a face it is.
const CLEAR: f64 = 1e-9;

/// How a product tells inside from outside.
#[derive(Debug, Clone)]
pub(crate) enum Sign {
    Normals(PseudoNormals),
    /// And the faces of the tree that need none.
    Winding(Winding, PlainFaces),
}

/// Normals of every face, edge and vertex that give the right sign (Baerentzen & Aanaes 2005).
#[derive(Debug, Clone)]
pub(crate) struct PseudoNormals {
    /// For each face of the tree, its vertices and the faces across its edges.
    corners: Vec<[u32; 3]>,
    across: Vec<[u32; 3]>,
    /// Angle-weighted sum of the normals around each vertex.
    vertices: Vec<Vec3>,
}

impl Sign {
    pub(crate) fn new(product: &Oriented, tree: &Tree) -> Sign {
        if product.is_simple {
            Sign::Normals(PseudoNormals::new(product, tree))
        } else {
            let has_body = tree.faces.iter().any(|f| !f.is_sheet);
            let counted = if has_body {
                Counted::Bodies
            } else {
                Counted::All
            };
            let winding = Winding::of(tree, counted);
            Sign::Winding(winding, PlainFaces::new(product, tree))
        }
    }

    /// Whether a point about the tree's center, whose nearest face is `hit`, is inside. A point on the surface is not.
    pub(crate) fn is_inside(&self, tree: &Tree, point: Vec3, hit: &Hit) -> bool {
        match self {
            Sign::Normals(normals) => (point - hit.on.point).dot(&normals.at(tree, hit)) < 0.0,
            Sign::Winding(winding, plain) => {
                let is_clear = hit.on.distance_squared > square(CLEAR / tree.shrink);
                if is_clear && let Some(outward) = plain.outward((tree, winding), hit) {
                    return (point - hit.on.point).dot(&outward) < 0.0;
                }
                hit.on.distance_squared > 0.0 && winding.number(tree, point) > 0.5
            }
        }
    }

    /// Outward direction at a point on the surface, not of unit length.
    pub(crate) fn normal(&self, tree: &Tree, hit: &Hit) -> Vec3 {
        match self {
            Sign::Normals(normals) => normals.at(tree, hit),
            Sign::Winding(..) => tree.faces[hit.slot as usize].normal,
        }
    }
}

fn square(x: f64) -> f64 {
    x * x
}

impl PseudoNormals {
    fn new(product: &Oriented, tree: &Tree) -> PseudoNormals {
        let mut across = vec![[u32::MAX; 3]; tree.faces.len()];
        for pair in product.sides.chunk_by(|a, b| a.edge == b.edge) {
            if let [a, b] = pair {
                let [slot_a, slot_b] = [a, b].map(|s| tree.slots[s.triangle as usize]);
                across[slot_a as usize][a.side as usize] = slot_b;
                across[slot_b as usize][b.side as usize] = slot_a;
            }
        }
        let mut vertices = vec![Vec3::zeros(); product.mesh.positions().len()];
        for (t, corners) in product
            .welded
            .iter()
            .enumerate()
            .filter(|(t, _)| product.standing[*t] == Standing::Sound)
        {
            add_angle_weighted(&mut vertices, *corners, product.mesh.corners(t));
        }
        let corners = tree
            .faces
            .iter()
            .map(|f| product.welded[f.id as usize])
            .collect();
        PseudoNormals {
            corners,
            across,
            vertices,
        }
    }

    fn at(&self, tree: &Tree, hit: &Hit) -> Vec3 {
        let slot = hit.slot as usize;
        let own = tree.faces[slot].normal;
        match hit.on.feature {
            Feature::Face => own,
            Feature::Edge(side) => match self.across[slot][side as usize] {
                u32::MAX => own,
                other => own + tree.faces[other as usize].normal,
            },
            Feature::Vertex(corner) => self.vertices[self.corners[slot][corner as usize] as usize],
        }
    }
}
