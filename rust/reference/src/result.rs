//! What a reference solve found.

use rayon::prelude::*;
use thenar_surface::Vec3;

use crate::Tissue;
use crate::cut::Cut;
use crate::newton::{Equilibrium, Forces};

/// Contact of a reference solve; arrays by skin vertex.
#[derive(Debug, Clone)]
pub struct ReferenceContact {
    /// From the posed skin to the deformed skin (n), mm.
    pub displacement_mm: Vec<Vec3>,
    /// Of the product on the skin (n), N; with it what was added between vertices carries, so that the sum is the contact's.
    pub force_n: Vec<Vec3>,
    /// Force over the area of the deformed skin (n), MPa.
    pub pressure_mpa: Vec<f64>,
    /// Force of the skin on the product, N.
    pub total_force_n: Vec3,
    /// Sum of their magnitudes, N.
    pub normal_force_n: f64,
    /// Area of the deformed skin that touches, mm2; its edge lies between vertices.
    pub contact_area_mm2: f64,
    /// Largest mean pressure over 24 mm2 of deformed skin, about one cell of a mat, MPa.
    pub patch_peak_mpa: f64,
    /// Deepest skin vertex inside the product, mm: what the penalty gives way.
    pub penetration_mm: f64,
    /// How deep the product lies in the skin between its vertices, mm, where contact is not tested.
    pub cut_mm: f64,
    /// Volume that stays in the product between vertices over the volume of skin in it before the press, 0 to 1.
    pub cut_share: f64,
    /// Share of the force that pushes skin along itself and not back, as a tool does that is thinner than twice its depth: read no
    /// force where it is large.
    pub sideways_share: f64,
    /// Smallest and largest volume of a prism over its volume before.
    pub dilatation: [f64; 2],
    /// Norm of the residual over the contact forces.
    pub unbalanced: f64,
    /// Newton steps.
    pub steps: usize,
    /// Skin vertices at whose triangles tissue could not be meshed, because the columns to the bone cross, as in a crease.
    pub folded: Vec<u32>,
}

impl ReferenceContact {
    pub(crate) fn new(
        tissue: &Tissue,
        equilibrium: &Equilibrium<'_>,
        (forces, cut): (&Forces, Cut),
    ) -> ReferenceContact {
        let mesh = equilibrium.mesh;
        let n = tissue.skin.len();
        let place = |v: usize| equilibrium.places[mesh.skin_node(v)];
        let mut force_n = vec![Vec3::zeros(); n];
        let mut distance = vec![f64::INFINITY; n];
        let gaps = equilibrium.obstacle.readings(place);
        for (v, gap) in gaps {
            distance[v] = gap;
        }
        let (mut penetration, mut sideways, mut total) = (0.0_f64, 0.0, 0.0);
        for touch in &forces.touches {
            force_n[touch.vertex as usize] = touch.normal * touch.force;
            penetration = penetration.max(-touch.distance);
            total += touch.force;
            sideways += if touch.is_sideways { touch.force } else { 0.0 };
        }
        let mut nodal = vec![0.0; n];
        for triangle in &tissue.triangles {
            let corners = triangle.map(|v| v as usize);
            let [a, b, c] = corners.map(place);
            let whole = (b - a).cross(&(c - a)).norm() / 2.0;
            corners.iter().for_each(|v| nodal[*v] += whole / 3.0);
        }
        let pressure = |v: usize| {
            let force = force_n[v].norm();
            if force > 0.0 { force / nodal[v] } else { 0.0 }
        };
        let pressure_mpa: Vec<f64> = (0..n).map(pressure).collect();
        let touched = tissue.triangles.iter().map(|triangle| {
            let corners = triangle.map(|v| v as usize);
            let places = corners.map(place);
            let share = Corners {
                pressure: corners.map(|v| pressure_mpa[v]),
                gap: corners.map(|v| distance[v]),
                modulus: 4.0
                    * corners
                        .map(|v| tissue.shear_modulus_mpa[v])
                        .iter()
                        .sum::<f64>()
                    / 3.0,
                places,
            };
            share.share()
                * (places[1] - places[0])
                    .cross(&(places[2] - places[0]))
                    .norm()
                / 2.0
        });
        let area = touched.sum();
        let sizes = equilibrium.dilatations();
        ReferenceContact {
            displacement_mm: (0..n).map(|v| place(v) - tissue.skin[v]).collect(),
            pressure_mpa,
            total_force_n: -force_n.iter().sum::<Vec3>(),
            normal_force_n: force_n.iter().map(|f| f.norm()).sum(),
            contact_area_mm2: area,
            patch_peak_mpa: patch_peak(&force_n, &nodal, &(0..n).map(place).collect::<Vec<_>>()),
            penetration_mm: penetration,
            cut_mm: cut.depth_mm,
            cut_share: cut.share,
            sideways_share: if total > 0.0 { sideways / total } else { 0.0 },
            dilatation: sizes,
            force_n,
            unbalanced: forces.unbalanced(),
            steps: equilibrium.steps,
            folded: mesh.folded.clone(),
        }
    }
}

impl ReferenceContact {
    /// The same by the vertices that were given: what a vertex that was added carries goes to the two between which it lies, in equal
    /// parts. Totals stay those of the finer skin.
    pub(crate) fn without(mut self, count: usize, parents: &[[u32; 2]]) -> ReferenceContact {
        for (k, ends) in parents.iter().enumerate().rev() {
            let half = self.force_n[count + k] / 2.0;
            ends.iter().for_each(|v| self.force_n[*v as usize] += half);
        }
        self.force_n.truncate(count);
        self.displacement_mm.truncate(count);
        self.pressure_mpa.truncate(count);
        self.folded.retain(|v| (*v as usize) < count);
        self
    }
}

/// Area of the patch over which the largest mean pressure is taken, mm2: a cell of common mats.
const PATCH_MM2: f64 = 24.0;

/// Largest mean pressure over the nearest skin about any vertex in contact, MPa.
fn patch_peak(force_n: &[Vec3], areas: &[f64], places: &[Vec3]) -> f64 {
    let loaded: Vec<usize> = (0..areas.len())
        .filter(|v| force_n[*v] != Vec3::zeros())
        .collect();
    // A circle of the patch's area, and as much again for skin that is bent.
    let reach = 2.0 * (PATCH_MM2 / std::f64::consts::PI).sqrt();
    let about = |center: &usize| {
        let distance = |v: usize| (places[v] - places[*center]).norm();
        let mut near: Vec<(f64, usize)> = (0..areas.len())
            .map(|v| (distance(v), v))
            .filter(|(distance, _)| *distance < reach)
            .collect();
        near.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (mut area, mut force) = (0.0, 0.0);
        for (_, v) in near {
            let share = ((PATCH_MM2 - area) / areas[v].max(1e-12)).clamp(0.0, 1.0);
            area += share * areas[v];
            force += share * force_n[v].norm();
        }
        force / PATCH_MM2
    };
    loaded.par_iter().map(about).reduce(|| 0.0, f64::max)
}

/// Contact at the corners of a triangle.
struct Corners {
    /// Pressure, MPa; 0 outside the contact.
    pressure: [f64; 3],
    /// Gap outside the contact, mm.
    gap: [f64; 3],
    /// Contact modulus E* of incompressible tissue, 4 G, MPa.
    modulus: f64,
    places: [Vec3; 3],
}

impl Corners {
    /// Share of the triangle that touches. A corner that touches and one that does not tell where between them the edge lies.
    fn share(&self) -> f64 {
        let inside: Vec<usize> = (0..3).filter(|k| self.pressure[*k] > 0.0).collect();
        let outside: Vec<usize> = (0..3).filter(|k| self.pressure[*k] <= 0.0).collect();
        match (&inside[..], &outside[..]) {
            ([i], [a, b]) => self.reach(*i, *a) * self.reach(*i, *b),
            ([a, b], [o]) => 1.0 - (1.0 - self.reach(*a, *o)) * (1.0 - self.reach(*b, *o)),
            ([], _) => 0.0,
            _ => 1.0,
        }
    }

    /// Share of the way from a corner in the contact to one outside at which the contact ends. With x inside and y outside its edge,
    /// `p = k sqrt(x)` and `s = 4 k / (3 E*) y^(3/2)` (Johnson, Contact Mechanics 5.1).
    fn reach(&self, inside: usize, outside: usize) -> f64 {
        let length = (self.places[inside] - self.places[outside]).norm();
        let (p, s) = (self.pressure[inside], self.gap[outside].max(0.0));
        let x = |k: f64| (p / k).powi(2);
        let y = |k: f64| (0.75 * self.modulus * s / k).powf(2.0 / 3.0);
        // Both fall as k grows: the k at which they fill the edge lies between one that is too small and one too large.
        let (mut low, mut high) = (1e-12, 1e6);
        for _ in 0..90 {
            let middle = f64::sqrt(low * high);
            if x(middle) + y(middle) > length {
                low = middle;
            } else {
                high = middle;
            }
        }
        (x(high) / length).min(1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A straight edge of contact at 0.3 of a triangle's side, its pressure and gap as in Johnson 5.1.
    #[test]
    fn the_edge_is_found_from_pressure_and_gap_at_the_corners() {
        let (k, modulus, edge) = (0.02, 0.04, 0.6);
        let places = [
            Vec3::zeros(),
            Vec3::new(2.0, 0.0, 0.0),
            Vec3::new(2.0, 2.0, 0.0),
        ];
        let pressure = places.map(|p| k * f64::max(edge - p.x, 0.0).sqrt());
        let gap = places.map(|p| 4.0 * k / (3.0 * modulus) * f64::max(p.x - edge, 0.0).powf(1.5));
        let corners = Corners {
            pressure,
            gap,
            modulus,
            places,
        };
        assert!((corners.reach(0, 1) - 0.3).abs() < 1e-9);
        // Along the slanted side the same edge lies at 0.3 of it only where distances are measured across the edge; with lengths along
        // the side it is a little off.
        assert!((corners.share() - 0.09).abs() < 0.03);
    }
}
