//! What a mesh is like: closed, manifold, in how many parts, which way out.

use crate::mesh::edges::{Side, joins, sides};
use crate::mesh::triangles::{Mesh, Standing, Vec3, standings};

/// Counts that say how far a mesh can be trusted. Coincident vertices count as different ones.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Audit {
    /// Triangles without area.
    pub degenerate_triangles: usize,
    /// Triangles with the vertices of an earlier one, in any order.
    pub duplicate_triangles: usize,
    /// Vertices that no triangle names.
    pub isolated_vertices: usize,
    /// Edges with one triangle.
    pub boundary_edges: usize,
    /// Edges with more than two triangles.
    pub non_manifold_edges: usize,
    /// Edges whose two triangles run the same way, so that one of them is flipped.
    pub inconsistent_edges: usize,
    /// Pieces of surface not joined by a vertex.
    pub parts: usize,
    /// Enclosed volume, mm3, negative where the triangles face inward; for open meshes that of the cone to the middle of the mesh.
    pub signed_volume_mm3: f64,
}

impl Audit {
    /// Whether every edge has exactly two triangles.
    pub fn is_closed(&self) -> bool {
        self.boundary_edges == 0 && self.non_manifold_edges == 0
    }

    /// Whether a closed, consistently turned mesh faces inward.
    pub fn is_inside_out(&self) -> bool {
        self.is_closed() && self.inconsistent_edges == 0 && self.signed_volume_mm3 < 0.0
    }

    /// One sentence for each thing worth telling, about the mesh called `name`.
    pub fn warnings(&self, name: &str) -> Vec<String> {
        let counted = [
            (
                self.degenerate_triangles,
                "triangles without area, which are ignored",
            ),
            (
                self.duplicate_triangles,
                "duplicated triangles, which are ignored",
            ),
            (self.isolated_vertices, "vertices without a triangle"),
            (
                self.boundary_edges,
                "open edges: inside and outside are estimated near the holes",
            ),
            (
                self.non_manifold_edges,
                "edges with more than two triangles",
            ),
            (
                self.inconsistent_edges,
                "edges between triangles that face opposite ways; recalculate the normals",
            ),
        ];
        let told = counted.iter().filter(|(n, _)| *n > 0);
        let mut all: Vec<String> = told
            .map(|(n, what)| format!("{name} has {n} {what}"))
            .collect();
        if self.is_inside_out() {
            all.push(format!("{name} is inside out; flip its normals"));
        }
        all
    }
}

impl Mesh {
    /// Looks the mesh over; nothing is changed.
    pub fn audit(&self) -> Audit {
        let standing = standings(self.positions(), self.triangles());
        let all = sides(self.positions().len(), self.triangles(), |t| {
            joins(standing[t])
        });
        audit_of(self, self.triangles(), &standing, &all)
    }
}

/// Audit of a mesh whose triangles may name other vertices at the same places; `all` are the sides of those that join.
pub(crate) fn audit_of(
    mesh: &Mesh,
    triangles: &[[u32; 3]],
    standing: &[Standing],
    all: &[Side],
) -> Audit {
    let mut audit = Audit {
        parts: parts(mesh, triangles, standing),
        ..Audit::default()
    };
    for s in standing {
        match s {
            Standing::Sound | Standing::Within => {}
            Standing::Duplicate => audit.duplicate_triangles += 1,
            Standing::Flat | Standing::Collapsed => audit.degenerate_triangles += 1,
        }
    }
    audit.isolated_vertices = used(mesh).iter().filter(|used| !**used).count();
    for group in all.chunk_by(|a, b| a.edge == b.edge) {
        match group {
            [_] => audit.boundary_edges += 1,
            [a, b] => audit.inconsistent_edges += usize::from(a.ascends == b.ascends),
            _ => audit.non_manifold_edges += 1,
        }
    }
    audit.signed_volume_mm3 =
        signed_volume(mesh, (0..standing.len()).filter(|&t| joins(standing[t])));
    audit
}

/// The part of each vertex, counted from 0 in order of first vertex, and how many there are.
///
/// Vertices that some triangle names together are in one part; an isolated vertex is a part of its own.
pub fn connected_parts(mesh: &Mesh) -> (Vec<u32>, usize) {
    parts_by_vertex(mesh.positions().len(), mesh.triangles())
}

fn parts_by_vertex(vertices: usize, triangles: &[[u32; 3]]) -> (Vec<u32>, usize) {
    let mut root: Vec<u32> = (0..vertices as u32).collect();
    for corners in triangles {
        join(&mut root, corners[0], corners[1]);
        join(&mut root, corners[0], corners[2]);
    }
    let mut part = vec![u32::MAX; root.len()];
    let mut count = 0;
    for i in 0..root.len() {
        let r = find(&mut root, i as u32) as usize;
        if part[r] == u32::MAX {
            part[r] = count;
            count += 1;
        }
        part[i] = part[r];
    }
    (part, count as usize)
}

/// Middle of the vertices that have a triangle; loose ones would turn the sign of an open mesh's volume.
fn middle(mesh: &Mesh) -> Vec3 {
    let is_used = used(mesh);
    let counted = || {
        mesh.positions()
            .iter()
            .zip(&is_used)
            .filter(|(_, used)| **used)
    };
    counted().map(|(p, _)| p).sum::<Vec3>() / counted().count() as f64
}

/// Volume enclosed by the given triangles, mm3: the sum of their cones.
pub(crate) fn signed_volume(mesh: &Mesh, triangles: impl Iterator<Item = usize>) -> f64 {
    triangles.map(cone_volumes(mesh)).sum()
}

/// Volume of the cone over each triangle, mm3, about the [`middle`] of the mesh so that far meshes keep their digits.
pub(crate) fn cone_volumes(mesh: &Mesh) -> impl Fn(usize) -> f64 + '_ {
    let middle = middle(mesh);
    move |t| {
        let [a, b, c] = mesh.corners(t).map(|p| p - middle);
        a.dot(&b.cross(&c)) / 6.0
    }
}

/// Whether a triangle names each vertex.
fn used(mesh: &Mesh) -> Vec<bool> {
    let mut is_used = vec![false; mesh.positions().len()];
    let corners = mesh.triangles().iter().flatten();
    corners.for_each(|&i| is_used[i as usize] = true);
    is_used
}

fn parts(mesh: &Mesh, triangles: &[[u32; 3]], standing: &[Standing]) -> usize {
    let (part, count) = parts_by_vertex(mesh.positions().len(), triangles);
    let mut has_triangle = vec![false; count];
    for (corners, _) in triangles.iter().zip(standing).filter(|(_, s)| joins(**s)) {
        has_triangle[part[corners[0] as usize] as usize] = true;
    }
    has_triangle.iter().filter(|has| **has).count()
}

pub(crate) fn join(root: &mut [u32], a: u32, b: u32) {
    let (a, b) = (find(root, a), find(root, b));
    root[a.max(b) as usize] = a.min(b);
}

pub(crate) fn find(root: &mut [u32], mut i: u32) -> u32 {
    while root[i as usize] != i {
        root[i as usize] = root[root[i as usize] as usize];
        i = root[i as usize];
    }
    i
}
