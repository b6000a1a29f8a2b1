//! What the contact model says a mat reads of a grasp: nodal forces by region over that region's posture.

use std::collections::BTreeMap;

use nalgebra::Vector3;
use thenar_contact::instrument::{Mat, Placement, PointLoad};
use thenar_contact::{Contact, Control, Press, Start, Unsolved, Workspace};
use thenar_recordings::Study;
use thenar_recordings::study::Shape;
use thenar_surface::{GapLimits, Mesh, Product, Vec3};

use crate::errors::InferenceError;
use crate::forward::setup::study_skin::{Tissue, tissue};

/// Shifts of all regions toward the product from the middle one, mm.
pub const SHIFTS_MM: [f64; 5] = [-1.0, -0.5, 0.0, 0.5, 1.0];
/// Skin farther above the most inward part of its region than this does not say where the region meets the product, mm.
const FOREMOST_MM: f64 = 1.0;
/// Farthest that the product is looked for, mm.
const REACH_MM: f64 = 30.0;

/// A vertex under load.
#[derive(Debug, Clone, Copy)]
struct Node {
    /// Where it lies on the product, mm, by shift.
    position: [Vec3; SHIFTS_MM.len()],
    /// N, by shift.
    force_n: [f64; SHIFTS_MM.len()],
    /// mm2.
    area_mm2: f64,
    /// The product's outward normal.
    normal: Vec3,
}

/// Forces of every region over its shift toward the product, around a posture.
#[derive(Debug, Clone)]
pub struct RegionForces {
    /// Shift of each region from the posture as given, at which the tables have their middle, mm.
    pub middle_mm: Vec<f64>,
    /// Shifts, mm, at which the contact did not converge: forces there are those of the last iteration.
    pub unsettled_mm: Vec<f64>,
    nodes: Vec<Vec<Node>>,
}

/// The model of a held product.
pub struct HeldProduct {
    tissue: Tissue,
    product: Product,
    positions: Vec<Vec3>,
    region: Vec<i32>,
    /// Unit vector toward the product of each region.
    ways: Vec<Vec3>,
}

impl HeldProduct {
    /// Prepares skin and product of a study's grasps.
    ///
    /// # Errors
    /// [`InferenceError`] for a skin or product that cannot be pressed, or grasps of two products.
    pub fn new(study: &Study, control: &Control<'_>) -> Result<HeldProduct, InferenceError> {
        let mut names: Vec<&str> = study
            .recordings
            .iter()
            .map(|r| r.indenter.as_str())
            .collect();
        names.dedup();
        let named = |name: &str| study.indenters.iter().find(|i| i.name == name);
        let (Some(indenter), 1) = (names.first().and_then(|n| named(n)), names.len()) else {
            return Err(InferenceError::Grasps {
                problem: "they hold more than one product; make a study of each".to_owned(),
            });
        };
        let refused = |source| InferenceError::Indenter {
            indenter: indenter.name.clone(),
            source,
        };
        let Shape::Mesh(file) = &indenter.shape else {
            return Err(InferenceError::Grasps {
                problem: "the held product is no mesh".to_owned(),
            });
        };
        let mesh = Mesh::new(file.positions.clone(), file.triangles.clone()).map_err(refused)?;
        let product = Product::new(mesh).map_err(refused)?;
        let tissue = tissue(&study.skin, control)?;
        let positions = study.skin.mesh.positions.clone();
        let region = match study.skin.regions.as_slice() {
            [] => vec![0; positions.len()],
            regions => regions.to_vec(),
        };
        let ways = ways(&product, &positions, (&region, tissue.regions.len()));
        Ok(HeldProduct {
            tissue,
            product,
            positions,
            region,
            ways,
        })
    }

    /// Names of the regions.
    pub fn regions(&self) -> &[String] {
        &self.tissue.regions
    }

    /// Shear moduli of a region as given, MPa: at first touch, and where it stops growing.
    pub fn moduli_mpa(&self, region: usize) -> (f64, f64) {
        let material = &self.tissue.materials[region];
        (material.g0_mpa, material.g_lim_mpa)
    }

    /// Thickness of a region's tissue as given, mm.
    pub fn thickness_mm(&self, region: usize) -> f64 {
        self.tissue.materials[region].thickness_mm
    }

    /// What is to be said of the skin.
    pub fn notes(&self) -> &[String] {
        &self.tissue.notes
    }

    /// Numbers of the skin's vertices in a region.
    pub fn vertices(&self, region: usize) -> Vec<u32> {
        let own = (0..self.region.len()).filter(|v| self.region[*v] == region as i32);
        own.map(|v| v as u32).collect()
    }

    /// The forces of every region over its shift, around the shifts `middle_mm`; `thinner` multiplies the tissue's thickness.
    ///
    /// # Errors
    /// What the contact model says of a press, or `Cancelled`.
    pub fn forces(
        &self,
        middle_mm: &[f64],
        thinner: f64,
        control: &Control<'_>,
    ) -> Result<RegionForces, InferenceError> {
        let failed = || InferenceError::of_contact("the grasp as the study has it");
        let mut materials = self.tissue.materials.clone();
        materials.iter_mut().for_each(|m| m.thickness_mm *= thinner);
        let skin = match thinner == 1.0 {
            true => self.tissue.skin.clone(),
            false => {
                let other = self.tissue.skin.with_materials(&materials, control);
                other.map_err(failed())?
            }
        };
        let mut workspace = Workspace::default();
        let mut nodes: BTreeMap<(usize, usize), Node> = BTreeMap::new();
        let mut unsettled_mm = Vec::new();
        for (number, shift) in SHIFTS_MM.iter().enumerate() {
            let posed = self.posed(middle_mm, *shift);
            let press = Press {
                product: &self.product,
                posed: Some(&posed),
                force: None,
                drag: None,
                start: if number == 0 {
                    Start::Fresh
                } else {
                    Start::Warm
                },
                unsolved: Unsolved::Keep,
            };
            let contact = workspace
                .on(&skin)
                .press(&press, control)
                .map_err(failed())?;
            if !contact.convergence.has_converged {
                unsettled_mm.push(*shift);
            }
            self.add(&mut nodes, number, (&contact, &posed));
        }
        let mut by_region = vec![Vec::new(); self.ways.len()];
        for ((region, _), node) in nodes {
            by_region[region].push(node);
        }
        Ok(RegionForces {
            middle_mm: middle_mm.to_vec(),
            unsettled_mm,
            nodes: by_region,
        })
    }

    fn posed(&self, middle_mm: &[f64], shift: f64) -> Vec<Vec3> {
        let moved = |(p, r): (&Vec3, &i32)| match usize::try_from(*r) {
            Ok(r) => p + self.ways[r] * (middle_mm[r] + shift),
            Err(_) => *p,
        };
        self.positions.iter().zip(&self.region).map(moved).collect()
    }

    fn add(
        &self,
        nodes: &mut BTreeMap<(usize, usize), Node>,
        number: usize,
        (contact, posed): (&Contact, &[Vec3]),
    ) {
        for (vertex, &force) in contact.nodal_force.iter().enumerate() {
            let Ok(region) = usize::try_from(self.region[vertex]) else {
                continue;
            };
            if force <= 0.0 {
                continue;
            }
            let position = posed[vertex] + contact.displacement[vertex];
            let node = nodes.entry((region, vertex)).or_insert(Node {
                position: [position; SHIFTS_MM.len()],
                force_n: [0.0; SHIFTS_MM.len()],
                area_mm2: force / contact.pressure[vertex].max(1e-12),
                normal: contact.normal[vertex],
            });
            node.position[number..].fill(position);
            node.force_n[number] = force;
        }
    }
}

impl RegionForces {
    /// Whether no region touches the product at any shift.
    pub fn is_bare(&self) -> bool {
        self.nodes.iter().all(Vec::is_empty)
    }

    /// Number of regions.
    pub fn len(&self) -> usize {
        self.nodes.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// Sum of normal forces of a region at a shift, N; and of their components across a direction, where one is given.
    pub fn force_n(&self, region: usize, shift_mm: f64, across: Option<Vector3<f64>>) -> f64 {
        let (k, share) = self.between(region, shift_mm);
        let of = |node: &Node| {
            let force = node.at(k, share);
            across.map_or(force, |way| 0.5 * force * node.normal.dot(&way).abs())
        };
        self.nodes[region].iter().map(of).sum()
    }

    /// What a mat reads of a region at a shift, kPa.
    pub fn read(
        &self,
        region: usize,
        shift_mm: f64,
        (mat, placement): (&Mat, &Placement),
    ) -> Vec<f64> {
        let (k, share) = self.between(region, shift_mm);
        let load = |node: &Node| {
            let force_n = node.at(k, share);
            (force_n > 0.0).then(|| PointLoad {
                position: node.position[if share < 0.5 { k } else { k + 1 }],
                force_n,
                area_mm2: node.area_mm2,
            })
        };
        let loads: Vec<PointLoad> = self.nodes[region].iter().filter_map(load).collect();
        mat.read_at(&loads, placement)
    }

    /// Least and largest shift of a region that the tables hold, mm.
    pub fn range(&self, region: usize) -> (f64, f64) {
        let middle = self.middle_mm[region];
        (
            middle + SHIFTS_MM[0],
            middle + SHIFTS_MM[SHIFTS_MM.len() - 1],
        )
    }

    fn between(&self, region: usize, shift_mm: f64) -> (usize, f64) {
        let at = shift_mm - self.middle_mm[region];
        let last = SHIFTS_MM.len() - 2;
        let k = SHIFTS_MM[1..=last].iter().filter(|s| at >= **s).count();
        let share = (at - SHIFTS_MM[k]) / (SHIFTS_MM[k + 1] - SHIFTS_MM[k]);
        (k, share.clamp(0.0, 1.0))
    }
}

impl Node {
    fn at(&self, k: usize, share: f64) -> f64 {
        (1.0 - share) * self.force_n[k] + share * self.force_n[k + 1]
    }
}

/// Mean way toward the product of the part of each region that comes to touch first.
fn ways(product: &Product, positions: &[Vec3], (region, count): (&[i32], usize)) -> Vec<Vec3> {
    let limits = GapLimits {
        cut_off_mm: REACH_MM,
        max_depth_mm: REACH_MM,
    };
    let gaps = product.gaps(positions, None, limits);
    let mut least = vec![f64::INFINITY; count];
    let of = |vertex: usize| {
        usize::try_from(region[vertex])
            .ok()
            .zip(gaps[vertex].as_ref())
    };
    for vertex in 0..positions.len() {
        if let Some((r, gap)) = of(vertex) {
            least[r] = least[r].min(gap.distance);
        }
    }
    let mut sums = vec![Vec3::zeros(); count];
    for vertex in 0..positions.len() {
        if let Some((r, gap)) = of(vertex)
            && gap.distance < least[r] + FOREMOST_MM
        {
            sums[r] -= gap.normal;
        }
    }
    sums.iter()
        .map(|s| s.try_normalize(1e-9).unwrap_or_else(Vec3::zeros))
        .collect()
}
