//! The checked triangle mesh and what can be wrong with its input.

use std::sync::Arc;

use crate::mesh::bucket_sort::sort_by_bucket;

/// A point or direction, f64, mm where it is a length.
pub type Vec3 = nalgebra::Vector3<f64>;

/// Largest coordinate accepted, mm: squares of squares of it stay finite in f64, and beyond it (10^6 km) no skin detail survives rounding.
const LARGEST_COORDINATE: f64 = 1e12;

/// A triangle whose height is below this part of its longest edge has no direction. Tests pass from 1e-14 to 1e-8.
const FLAT: f64 = 1e-11;

/// Why a mesh, or a field on it, was refused.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum MeshError {
    /// There is nothing to work on.
    #[error("the mesh has no vertices; evaluate its modifiers or choose another object")]
    NoVertices,
    /// There are only loose vertices or edges.
    #[error("the mesh has no triangles; convert curves and loose edges to a surface")]
    NoTriangles,
    /// Every triangle has zero area.
    #[error("all {triangles} triangles have zero area; check the object's scale")]
    AllDegenerate {
        /// How many there are.
        triangles: usize,
    },
    /// A coordinate is NaN or infinite.
    #[error(
        "vertex {vertex} has a coordinate that is not a number; remove it or check the modifier that made it"
    )]
    NonFinite {
        /// The first such vertex.
        vertex: usize,
    },
    /// A coordinate is too large for distances to mean anything.
    #[error("vertex {vertex} lies more than 1e12 mm from the origin; check the unit scale")]
    TooFar {
        /// The first such vertex.
        vertex: usize,
    },
    /// A triangle names a vertex that is not there.
    #[error(
        "triangle {triangle} names vertex {index}, but there are {vertices}; export the mesh anew"
    )]
    TriangleOutOfRange {
        /// The first such triangle.
        triangle: usize,
        /// The index it names.
        index: u32,
        /// How many vertices there are.
        vertices: usize,
    },
    /// An array does not match the mesh.
    #[error("expected {expected} {what}, found {found}; give one for each vertex")]
    LengthMismatch {
        /// What is counted.
        what: &'static str,
        /// Length the mesh asks for.
        expected: usize,
        /// Length given.
        found: usize,
    },
}

/// A triangle mesh that is not empty, finite, and whose triangles name existing vertices.
///
/// Triangles may still be degenerate, duplicated, open or inside out: [`Mesh::audit`] tells.
#[derive(Debug, Clone, PartialEq)]
pub struct Mesh {
    positions: Vec<Vec3>,
    /// Shared by all postures.
    triangles: Arc<[[u32; 3]]>,
    /// Triangles that repeat an earlier one or name a vertex twice; shared by all postures.
    is_repeat: Arc<[bool]>,
}

impl Mesh {
    /// Checks and keeps a mesh.
    ///
    /// `positions` (n), mm; `triangles` (m), counter-clockwise seen from outside, indices into `positions`.
    ///
    /// # Errors
    /// [`MeshError`] where it is empty, has a coordinate that is not finite or beyond 1e12 mm, or names a vertex that is not there.
    pub fn new(positions: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Result<Mesh, MeshError> {
        check_positions(&positions)?;
        if triangles.is_empty() {
            return Err(MeshError::NoTriangles);
        }
        let vertices = positions.len();
        for (triangle, corners) in triangles.iter().enumerate() {
            if let Some(&index) = corners.iter().find(|&&i| i as usize >= vertices) {
                return Err(MeshError::TriangleOutOfRange {
                    triangle,
                    index,
                    vertices,
                });
            }
        }
        let is_repeat = repeats(vertices, &triangles);
        Ok(Mesh {
            positions,
            triangles: triangles.into(),
            is_repeat,
        })
    }

    /// Vertices (n), mm.
    pub fn positions(&self) -> &[Vec3] {
        &self.positions
    }

    /// Triangles (m), indices into [`Mesh::positions`].
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// The same triangles on other positions (n), mm.
    ///
    /// # Errors
    /// [`MeshError::LengthMismatch`], [`MeshError::NonFinite`] or [`MeshError::TooFar`].
    pub fn with_positions(&self, positions: Vec<Vec3>) -> Result<Mesh, MeshError> {
        let (expected, found) = (self.positions.len(), positions.len());
        if expected != found {
            return Err(MeshError::LengthMismatch {
                what: "positions",
                expected,
                found,
            });
        }
        check_positions(&positions)?;
        Ok(Mesh {
            positions,
            triangles: Arc::clone(&self.triangles),
            is_repeat: Arc::clone(&self.is_repeat),
        })
    }

    /// Corners of one triangle, mm.
    pub fn corners(&self, triangle: usize) -> [Vec3; 3] {
        self.triangles[triangle].map(|i| self.positions[i as usize])
    }

    /// Vertices and corners (mm) of every triangle with an area of its own: the sound ones.
    pub(crate) fn sound_triangles(&self) -> impl Iterator<Item = ([u32; 3], [Vec3; 3])> {
        self.sound_triangles_where(|_| true)
    }

    /// The sound ones of the triangles whose vertices are `wanted`, in the same order.
    pub(crate) fn sound_triangles_where(
        &self,
        wanted: impl Fn(&[u32; 3]) -> bool,
    ) -> impl Iterator<Item = ([u32; 3], [Vec3; 3])> {
        let all = self.triangles.iter().zip(self.is_repeat.iter());
        all.filter(move |(t, is_repeat)| wanted(t) && !**is_repeat && !self.is_flat(**t))
            .map(|(t, _)| (*t, t.map(|i| self.positions[i as usize])))
    }

    /// Whether a triangle is too thin for a normal; the same however its vertices are ordered.
    fn is_flat(&self, mut triangle: [u32; 3]) -> bool {
        triangle.sort_unstable();
        is_flat(triangle.map(|i| self.positions[i as usize]))
    }

    /// Same mesh with other triangles, which name existing vertices.
    pub(crate) fn with_triangles(self, triangles: Vec<[u32; 3]>) -> Mesh {
        debug_assert!(
            triangles
                .iter()
                .flatten()
                .all(|&i| (i as usize) < self.positions.len())
        );
        let is_repeat = repeats(self.positions.len(), &triangles);
        Mesh {
            triangles: triangles.into(),
            is_repeat,
            ..self
        }
    }
}

/// For each triangle, whether it repeats an earlier one or names a vertex twice.
fn repeats(vertices: usize, triangles: &[[u32; 3]]) -> Arc<[bool]> {
    let mut is_repeat = vec![false; triangles.len()];
    for group in alike(vertices, triangles).chunk_by(|a, b| a.0 == b.0) {
        let [a, b, c] = group[0].0;
        let kept = usize::from(a != b && b != c);
        for (_, triangle) in &group[kept..] {
            is_repeat[*triangle as usize] = true;
        }
    }
    is_repeat.into()
}

/// Sorted vertices and index of every triangle, those with the same vertices together.
fn alike(vertices: usize, triangles: &[[u32; 3]]) -> Vec<([u32; 3], u32)> {
    let mut keyed: Vec<([u32; 3], u32)> = triangles.iter().copied().zip(0..).collect();
    keyed
        .iter_mut()
        .for_each(|(corners, _)| corners.sort_unstable());
    sort_by_bucket(vertices, keyed, |k| k.0[0], |k| *k)
}

/// For each triangle, whether derived data counts it.
pub(crate) fn standings(positions: &[Vec3], triangles: &[[u32; 3]]) -> Vec<Standing> {
    let keyed = alike(positions.len(), triangles);
    let mut standings = vec![Standing::Sound; triangles.len()];
    for group in keyed.chunk_by(|a, b| a.0 == b.0) {
        let [a, b, c] = group[0].0;
        group[1..]
            .iter()
            .for_each(|g| standings[g.1 as usize] = Standing::Duplicate);
        if a == b || b == c {
            group
                .iter()
                .for_each(|g| standings[g.1 as usize] = Standing::Collapsed);
        } else if is_flat([a, b, c].map(|i| positions[i as usize])) {
            standings[group[0].1 as usize] = Standing::Flat;
        }
    }
    standings
}

/// How a triangle counts: only sound ones have area, sound and flat ones join their neighbors.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Standing {
    Sound,
    /// Three different vertices on one line, or two of them at one place.
    Flat,
    /// Names a vertex twice.
    Collapsed,
    /// Has the vertices of an earlier triangle, in any order.
    Duplicate,
    /// Stands within a solid, which it does not bound.
    Within,
}

/// Whether a triangle is too thin to have a normal.
pub(crate) fn is_flat([a, b, c]: [Vec3; 3]) -> bool {
    let (ab, ac, bc) = (b - a, c - a, c - b);
    let longest = ab
        .norm_squared()
        .max(ac.norm_squared())
        .max(bc.norm_squared());
    // `!(>)` is also true for an underflow to 0 / 0.
    !(ab.cross(&ac).norm() > FLAT * longest && longest > f64::MIN_POSITIVE)
}

/// Least height of a triangle, in units of its corners.
pub(crate) fn least_height([a, b, c]: [Vec3; 3]) -> f64 {
    let (ab, ac, bc) = (b - a, c - a, c - b);
    let longest = ab.norm().max(ac.norm()).max(bc.norm());
    ab.cross(&ac).norm() / longest.max(f64::MIN_POSITIVE)
}

fn check_positions(positions: &[Vec3]) -> Result<(), MeshError> {
    if positions.is_empty() {
        return Err(MeshError::NoVertices);
    }
    for (vertex, p) in positions.iter().enumerate() {
        if !p.iter().all(|x| x.is_finite()) {
            return Err(MeshError::NonFinite { vertex });
        }
        if p.amax() > LARGEST_COORDINATE {
            return Err(MeshError::TooFar { vertex });
        }
    }
    Ok(())
}
