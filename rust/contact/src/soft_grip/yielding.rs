//! How far every vertex of a grip yields under the forces of the skin.

use rayon::prelude::*;
use thenar_surface::{Gap, GapLimits, Product, Vec3};

use super::disc_kernel::DiscKernels;
use super::elastomer::{Elastomer, SoftGrip};
use crate::fields::result::Contact;

/// How far a vertex of the skin may lie from the product it presses on, mm.
const TOUCHING_MM: f64 = 1.0;

/// Depth of the core's surface, as a share of the grip's thickness, below which another wall of the product is clearly nearer.
const CORE_SHARE: f64 = 0.8;

/// A grip as it lies on its product.
pub(crate) struct Covered<'a> {
    grip: &'a SoftGrip,
    product: &'a Product,
    /// Outward, by vertex; zero within the solid.
    normals: Vec<Vec3>,
    /// Vertices of sheets without thickness, which have skin on either side.
    is_sheet: Vec<bool>,
    /// Vertices that yield.
    soft: Vec<u32>,
    /// By elastomer.
    kernels: Vec<DiscKernels>,
}

/// A force of the skin on a grip.
struct Touch {
    /// N.
    force: f64,
    /// Radius of a disc of the skin vertex's area, mm.
    radius: f64,
    /// On the grip as it was, mm, and its normal there.
    place: Vec3,
    normal: Vec3,
    elastomer: usize,
}

impl<'a> Covered<'a> {
    pub(crate) fn new(grip: &'a SoftGrip, product: &'a Product) -> Self {
        let mesh = product.mesh();
        let normals = product.boundary_normals();
        let mut is_sheet = vec![false; normals.len()];
        for (t, corners) in mesh.triangles().iter().enumerate() {
            if product.is_sheet(t) {
                corners.iter().for_each(|&v| is_sheet[v as usize] = true);
            }
        }
        let is_soft = |&v: &u32| grip.at(v).is_some() && normals[v as usize] != Vec3::zeros();
        let soft = (0..normals.len() as u32).filter(is_soft).collect();
        let corner = |pick: fn(f64, f64) -> f64, from: f64| {
            let ends = mesh.positions().iter();
            ends.fold(Vec3::repeat(from), |end, p| end.zip_map(p, pick))
        };
        let size = (corner(f64::max, f64::NEG_INFINITY) - corner(f64::min, f64::INFINITY)).norm();
        let kernels = grip.elastomers.iter();
        Covered {
            kernels: kernels.map(|e| DiscKernels::new(e.layer(), size)).collect(),
            grip,
            product,
            normals,
            is_sheet,
            soft,
        }
    }

    /// Vertices that yield, ascending.
    pub(crate) fn soft(&self) -> &[u32] {
        &self.soft
    }

    /// Thickness at each vertex that yields, mm.
    pub(crate) fn thickness(&self) -> Vec<f64> {
        let of = |&v: &u32| {
            self.grip
                .at(v)
                .map(|e| self.grip.elastomers[e].thickness_mm)
        };
        self.soft.iter().filter_map(of).collect()
    }

    /// Displacement of every vertex of the product (mm) where those that yield do so by `depth` (mm).
    pub(crate) fn displacement(&self, depth: &[f64]) -> Vec<Vec3> {
        let mut moved = vec![Vec3::zeros(); self.normals.len()];
        for (&vertex, depth) in self.soft.iter().zip(depth) {
            moved[vertex as usize] = self.normals[vertex as usize] * -depth;
        }
        moved
    }

    /// How much softer the grip is than the skin in waves as short as the skin's vertex spacing (mm): what its softest elastomer yields under
    /// one vertex's force, over what the hardest pressed region does.
    pub(crate) fn softness(&mut self, contact: &Contact, spacing: f64) -> f64 {
        let modulus = contact.regions.iter().filter(|region| region.force > 0.0);
        let hardest = modulus
            .map(|region| region.shear_modulus)
            .fold(0.0, f64::max);
        // A disc of the area of a vertex on a lattice of equal triangles.
        let radius = spacing * (3.0f64.sqrt() / (2.0 * std::f64::consts::PI)).sqrt();
        let yields = |(e, kernels): (&Elastomer, &mut DiscKernels)| {
            kernels.make([radius].into_iter());
            e.compliance() * kernels.at(0.0, radius)
        };
        let all = self.grip.elastomers.iter().zip(&mut self.kernels);
        let soft = all.filter(|(e, _)| e.is_soft()).map(yields);
        // Nearly incompressible skin: (1 - nu) / (2 pi G) times 2 / radius.
        let skin = 1.0 / (2.0 * std::f64::consts::PI * hardest * radius);
        soft.fold(0.0, f64::max) / skin
    }

    /// How far each soft vertex yields (mm) under the forces of a contact with `yielded`, the product as moved. `skin` are the
    /// posed positions (mm), `shift` (mm) is the way that the product went to carry its force.
    pub(crate) fn yielding(
        &mut self,
        contact: &Contact,
        skin: &[Vec3],
        (yielded, shift): (&Product, Vec3),
    ) -> Vec<f64> {
        let touches = self.touches(contact, skin, (yielded, shift));
        let mut depth = vec![0.0; self.soft.len()];
        for (e, elastomer) in self.grip.elastomers.iter().enumerate() {
            let here: Vec<&Touch> = touches.iter().filter(|t| t.elastomer == e).collect();
            if here.is_empty() {
                continue;
            }
            self.kernels[e].make(here.iter().map(|t| t.radius));
            let (covered, kernels) = (&*self, &self.kernels[e]);
            let compliance = elastomer.compliance();
            let yields = |(depth, &v): (&mut f64, &u32)| {
                if covered.grip.at(v) == Some(e) {
                    *depth = compliance * covered.at_vertex(v as usize, &here, kernels);
                }
            };
            depth.par_iter_mut().zip(&self.soft).for_each(yields);
        }
        depth
    }

    fn touches(
        &self,
        contact: &Contact,
        skin: &[Vec3],
        (yielded, shift): (&Product, Vec3),
    ) -> Vec<Touch> {
        let bearing: Vec<usize> = (0..skin.len())
            .filter(|&i| contact.nodal_force[i] > 0.0)
            .collect();
        let points: Vec<Vec3> = bearing
            .iter()
            .map(|&i| skin[i] + contact.displacement[i] - shift)
            .collect();
        let facing: Vec<Vec3> = bearing.iter().map(|&i| -contact.normal[i]).collect();
        let limits = GapLimits {
            cut_off_mm: TOUCHING_MM,
            max_depth_mm: TOUCHING_MM,
        };
        let gaps = yielded.gaps(&points, Some(&facing), limits);
        let touch = |(&i, gap): (&usize, &Option<Gap>)| {
            let gap = gap.as_ref()?;
            let corners = self.product.mesh().triangles()[gap.triangle as usize];
            // The share of the force that soft corners carry; the rest stands on the rigid core.
            let mut share = 0.0;
            let (mut elastomer, mut most) = (None, 0.0);
            let mut place = Vec3::zeros();
            for (corner, weight) in corners.into_iter().zip(gap.barycentric) {
                place += self.product.mesh().positions()[corner as usize] * weight;
                let Some(here) = self.grip.at(corner) else {
                    continue;
                };
                share += weight;
                if weight > most {
                    (elastomer, most) = (Some(here), weight);
                }
            }
            let area = contact.nodal_force[i] / contact.pressure[i];
            Some(Touch {
                force: contact.nodal_force[i] * share,
                radius: (area / std::f64::consts::PI).sqrt(),
                place,
                normal: contact.normal[i],
                elastomer: elastomer?,
            })
        };
        bearing.iter().zip(&gaps).filter_map(touch).collect()
    }

    /// Sum of the kernels of all touches at a vertex, 1/mm times N; those of another wall do not reach it.
    fn at_vertex(&self, vertex: usize, touches: &[&Touch], kernels: &DiscKernels) -> f64 {
        let (position, normal) = (
            &self.product.mesh().positions()[vertex],
            &self.normals[vertex],
        );
        let one = |touch: &&Touch| {
            let (r, along) = ((position - touch.place).norm(), normal.dot(&touch.normal));
            // The two sides of a sheet are one wall, and its normal may point either way.
            match (along > 0.0 || self.is_sheet[vertex]) && r < kernels.reach(touch.radius) {
                true => touch.force * along * kernels.at(r, touch.radius),
                false => 0.0,
            }
        };
        touches.iter().map(one).sum()
    }

    /// Whether a grip is thicker than half the product at a vertex that yields: then no rigid core is left there.
    pub(crate) fn is_too_thick(&self, vertex: u32) -> bool {
        let Some(elastomer) = self.grip.at(vertex) else {
            return false;
        };
        let thickness = self.grip.elastomers[elastomer].thickness_mm;
        if thickness.is_infinite() || self.is_sheet[vertex as usize] {
            return false;
        }
        let place = self.product.mesh().positions()[vertex as usize];
        let core = place - self.normals[vertex as usize] * thickness;
        let limits = GapLimits {
            cut_off_mm: f64::INFINITY,
            max_depth_mm: f64::INFINITY,
        };
        let gap = &self.product.gaps(&[core], None, limits)[0];
        gap.as_ref()
            .is_some_and(|gap| gap.distance > -CORE_SHARE * thickness)
    }
}
