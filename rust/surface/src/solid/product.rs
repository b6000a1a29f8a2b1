//! A product prepared for signed-distance queries, and the queries.

use std::collections::HashMap;
use std::sync::atomic::{AtomicU64, Ordering};

use crate::mesh::closest_point::{Feature, closest_point};
use crate::mesh::normals::{add_angle_weighted, vertex_areas};
use crate::mesh::triangles::{Mesh, MeshError, Standing, Vec3, least_height};
use crate::solid::gap::{Gap, Side};
use crate::solid::interior::{Interior, Place};
use crate::solid::orientation::{SLIVER, orient};
use crate::solid::sign::Sign;
use crate::solid::union::boundary;
use crate::tree::bvh::{Query, Source, Tree};
use crate::tree::face::Face;
use crate::tree::nearest::{Hit, Pending};
use crate::tree::winding_number::{Counted, Winding};

/// Distances below this part of the product's extent have no direction of their own; the surface's is used.
const TOUCHING: f64 = 1e-9;

/// Sine to the face's normal from which the way to a place on the rim of its piece is another than across the face.
const SAME_PLANE: f64 = 1e-6;

/// A mesh prepared for signed-distance queries.
///
/// Degenerate and duplicated triangles are left out. Triangles that face against their neighbors, and closed parts that are inside out, are
/// turned (cavities stay). Faces, and pieces of faces, with solid on both sides are left out, so that distances are measured to the
/// boundary of the union of all parts. Inside and outside follow angle-weighted pseudo-normals; where the surface is open, not manifold,
/// or made of parts that may overlap, the generalised winding number.
#[derive(Debug, Clone)]
pub struct Product {
    mesh: Mesh,
    number: u64,
    pub(crate) tree: Tree,
    pub(crate) sign: Sign,
    /// For surfaces without holes.
    interior: Option<Interior>,
    /// Whether some part is not a sheet.
    has_body: bool,
    /// The winding number of sheets, where the product has bodies too.
    sheets: Option<Winding>,
    vertex_areas: Vec<f64>,
    warnings: Vec<String>,
}

impl Product {
    /// Prepares a product.
    ///
    /// # Errors
    /// [`MeshError::AllDegenerate`] if no triangle has area.
    pub fn new(mesh: Mesh) -> Result<Product, MeshError> {
        let oriented = orient(mesh);
        let sound =
            (0..oriented.standing.len()).filter(|&t| oriented.standing[t] == Standing::Sound);
        let source = |t| Source {
            id: t as u32,
            corners: oriented.mesh.corners(t),
            is_sheet: oriented.is_sheet[t],
            piece_of: None,
        };
        let sound: Vec<Source> = sound.map(source).collect();
        if sound.is_empty() {
            return Err(MeshError::AllDegenerate {
                triangles: oriented.standing.len(),
            });
        }
        let mut tree = Tree::new(&sound, oriented.standing.len());
        let bare = match oriented.may_overlap {
            true => boundary(&oriented, &tree, &sound).filter(|bare| !bare.is_empty()),
            false => None,
        };
        if let Some(bare) = bare {
            tree = Tree::new(&bare, oriented.standing.len());
        }
        let sign = Sign::new(&oriented, &tree);
        let is_closed = !oriented.is_open;
        let has_body = tree.faces.iter().any(|f| !f.is_sheet);
        let has_sheet = tree.faces.iter().any(|f| f.is_sheet);
        let sheets = (has_body && has_sheet).then(|| Winding::of(&tree, Counted::Sheets));
        let (mesh, warnings) = (oriented.mesh, oriented.warnings);
        let vertex_areas = vertex_areas(&mesh);
        let mut product = Product {
            mesh,
            number: new_number(),
            vertex_areas,
            tree,
            sign,
            interior: None,
            has_body,
            sheets,
            warnings,
        };
        if is_closed {
            let mut pending = Pending::default();
            product.interior = Some(Interior::new(&product.tree, |p| {
                product.holds(p, &mut pending)
            }));
        }
        Ok(product)
    }

    /// The mesh queries refer to: as given, but with triangles turned outward.
    pub fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// What tells this product, and copies of it, from others of this process.
    pub(crate) fn number(&self) -> u64 {
        self.number
    }

    /// Area of each vertex, mm2, as [`vertex_areas`] gives it.
    pub fn vertex_areas(&self) -> &[f64] {
        &self.vertex_areas
    }

    /// What was wrong with the mesh and what was done about it, one sentence each.
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }

    /// Unit outward normal at each vertex of [`Product::mesh`], of the boundary of the union of all parts: vertices of the same place share
    /// one, and those that lie within the solid have none (zero).
    pub fn boundary_normals(&self) -> Vec<Vec3> {
        let key = |v: u32| self.mesh.positions()[v as usize].map(|c| (c + 0.0).to_bits());
        let mut at: HashMap<[u64; 3], Vec3> = HashMap::new();
        let mut sums = vec![Vec3::zeros(); self.mesh.positions().len()];
        for t in (0..self.mesh.triangles().len()).filter(|&t| self.is_bare(t)) {
            let corners = self.mesh.triangles()[t];
            add_angle_weighted(&mut sums, corners, self.mesh.corners(t));
        }
        for (v, sum) in (0..).zip(&sums) {
            *at.entry(key(v).into()).or_insert_with(Vec3::zeros) += sum;
        }
        let own = |v: u32| at[&<[u64; 3]>::from(key(v))].try_normalize(1e-12);
        let is_bare = |v: u32| sums[v as usize] != Vec3::zeros();
        (0..sums.len() as u32)
            .map(|v| own(v).filter(|_| is_bare(v)).unwrap_or_default())
            .collect()
    }

    /// Whether a triangle of [`Product::mesh`], or a piece of it, is part of the boundary of the union of all parts.
    fn is_bare(&self, triangle: usize) -> bool {
        let slot = self.tree.slots.get(triangle).copied();
        slot.is_some_and(|slot| (slot as usize) < self.tree.faces.len())
    }

    /// Whether a triangle of [`Product::mesh`] is of a sheet without thickness, which has two sides and no inside.
    pub fn is_sheet(&self, triangle: usize) -> bool {
        let slot = self.tree.slots.get(triangle).copied();
        let face = slot.and_then(|slot| self.tree.faces.get(slot as usize));
        face.is_some_and(|face| face.is_sheet)
    }

    /// Whether the surface has no holes, so that it has an inside everywhere.
    pub fn is_closed(&self) -> bool {
        self.interior.is_some()
    }

    /// Whether a point beyond the cut-off is inside; sheets have no inside.
    pub(crate) fn holds_far(&self, query: &Query, pending: &mut Pending) -> bool {
        match (&self.interior, &self.sign) {
            (Some(grid), _) => match grid.place(query.point) {
                Place::Outside => false,
                Place::Inside => true,
                Place::NearSurface => self.holds(query.point, pending),
            },
            (None, Sign::Winding(winding, _)) if self.has_body => {
                winding.number(&self.tree, query.point) > 0.5
            }
            _ => false,
        }
    }

    /// Whether an open product winds around a point more than it leaves open.
    pub(crate) fn winds_around(&self, point: Vec3) -> bool {
        let query = self.tree.query(point);
        let winding = match (&self.sheets, &self.sign) {
            (Some(sheets), _) => sheets,
            (None, Sign::Winding(winding, _)) => winding,
            (None, Sign::Normals(_)) => return false,
        };
        winding.number(&self.tree, query.point) > 0.5
    }

    /// Whether there is any sheet without thickness.
    pub(crate) fn has_sheets(&self) -> bool {
        self.sheets.is_some() || !self.has_body
    }

    /// Whether a point about the tree's center is inside.
    fn holds(&self, point: Vec3, pending: &mut Pending) -> bool {
        let query = self.tree.local_query(point);
        let hit = self
            .tree
            .nearest(&query, f64::INFINITY, pending, |_, _| 1.0);
        hit.is_some_and(|hit| self.sign.is_inside(&self.tree, query.point, &hit))
    }

    /// Whether a face has no normal that its corners could tell; there is none where pseudo-normals decide the side.
    pub(crate) fn is_sliver(&self, face: &Face) -> bool {
        let corners = [face.a, face.a + face.ab, face.a + face.ac];
        matches!(self.sign, Sign::Winding(..)) && least_height(corners) * self.tree.shrink < SLIVER
    }

    /// The gap to a face found, on the given side.
    pub(crate) fn reading(&self, query: &Query, hit: &Hit, side: Side) -> Gap {
        let face = &self.tree.faces[hit.slot as usize];
        let mut on = hit.on;
        if face.is_piece {
            // Weights and feature are those of the whole triangle.
            let corners = self
                .mesh
                .corners(face.id as usize)
                .map(|p| p - self.tree.center);
            let whole = closest_point(corners, on.point);
            (on.barycentric, on.feature) = (whole.barycentric, whole.feature);
        }
        let distance = hit.on.distance_squared.sqrt();
        let sign = if side == Side::Inside { -1.0 } else { 1.0 };
        let away = (query.point - hit.on.point) * sign;
        let normal = if distance * self.tree.shrink <= TOUCHING {
            self.sign
                .normal(&self.tree, hit)
                .try_normalize(0.0)
                .unwrap_or(face.normal)
        } else if (hit.on.feature == Feature::Face && !self.is_sliver(face))
            || (face.is_piece && is_along(away, face.normal))
        {
            // Over a face it is the face's own: the difference of two points that all but touch tells it badly.
            face.normal * away.dot(&face.normal).signum()
        } else {
            // Normalized anew: far from the product, the root of the square is not exactly its length.
            away.normalize()
        };
        let (closest, barycentric) = (on.point + self.tree.center, on.barycentric);
        Gap {
            distance: sign * distance,
            closest,
            normal,
            triangle: face.id,
            barycentric,
        }
    }
}

/// Whether the way to a place on the rim of a piece is along its face's normal: another piece of the same face goes on there. Else the
/// faces of two parts meet at that place.
fn is_along(way: Vec3, normal: Vec3) -> bool {
    way.cross(&normal).norm() <= SAME_PLANE * way.norm()
}

/// A number that no other product of this process has.
fn new_number() -> u64 {
    static LAST: AtomicU64 = AtomicU64::new(0);
    LAST.fetch_add(1, Ordering::Relaxed) + 1
}
