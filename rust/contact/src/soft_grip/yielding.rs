//! How far every vertex of a grip yields under the forces of the skin.

use rayon::prelude::*;
use thenar_surface::{Gap, GapLimits, Product, Vec3, vertex_normals};

use super::disc_kernel::DiscKernels;
use super::elastomer::{Elastomer, SoftGrip};
use crate::fields::result::Contact;

/// How far a vertex of the skin may lie from the product it presses on, mm.
const TOUCHING_MM: f64 = 1.0;

/// A grip as it lies on its product.
pub(crate) struct Covered<'a> {
    grip: &'a SoftGrip,
    product: &'a Product,
    /// Outward, by vertex.
    normals: Vec<Vec3>,
    /// Vertices that yield.
    soft: Vec<u32>,
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
        let vertices = 0..product.mesh().positions().len() as u32;
        Covered {
            grip,
            product,
            normals: vertex_normals(product.mesh()),
            soft: vertices.filter(|&v| grip.at(v).is_some()).collect(),
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
    pub(crate) fn softness(&self, contact: &Contact, spacing: f64) -> f64 {
        let modulus = contact.regions.iter().filter(|region| region.force > 0.0);
        let hardest = modulus
            .map(|region| region.shear_modulus)
            .fold(0.0, f64::max);
        // A disc of the area of a vertex on a lattice of equal triangles.
        let radius = spacing * (3.0f64.sqrt() / (2.0 * std::f64::consts::PI)).sqrt();
        let yields =
            |e: &Elastomer| e.compliance() * DiscKernels::new(e.layer(), &[radius]).at(0.0, radius);
        let soft = self
            .grip
            .elastomers
            .iter()
            .filter(|e| e.is_soft())
            .map(yields);
        // Nearly incompressible skin: (1 - nu) / (2 pi G) times 2 / radius.
        let skin = 1.0 / (2.0 * std::f64::consts::PI * hardest * radius);
        soft.fold(0.0, f64::max) / skin
    }

    /// How far each soft vertex yields (mm) under the forces of a contact with `yielded`, the product as moved. `skin` are the
    /// posed positions (mm), `shift` (mm) is the way that the product went to carry its force.
    pub(crate) fn yielding(
        &self,
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
            let radii: Vec<f64> = here.iter().map(|t| t.radius).collect();
            let kernels = DiscKernels::new(elastomer.layer(), &radii);
            let compliance = elastomer.compliance();
            depth
                .par_iter_mut()
                .zip(&self.soft)
                .filter(|(_, v)| self.grip.at(**v) == Some(e))
                .for_each(|(depth, &v)| {
                    let position = &self.product.mesh().positions()[v as usize];
                    *depth = compliance
                        * at_vertex((position, &self.normals[v as usize]), &here, &kernels);
                });
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
}

/// Sum of the kernels of all touches at a vertex, 1/mm times N; those of another wall do not reach it.
fn at_vertex((position, normal): (&Vec3, &Vec3), touches: &[&Touch], kernels: &DiscKernels) -> f64 {
    let one = |touch: &&Touch| {
        let (r, along) = ((position - touch.place).norm(), normal.dot(&touch.normal));
        match along > 0.0 && r < kernels.reach(touch.radius) {
            true => touch.force * along * kernels.at(r, touch.radius),
            false => 0.0,
        }
    };
    touches.iter().map(one).sum()
}
