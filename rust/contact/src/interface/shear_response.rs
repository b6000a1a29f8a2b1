//! Tangential response between sites: the shear kernel rotated into their tangent planes.
//!
//! The kernel acts on vectors in space and is seen in the tangent planes of both sites. For nu = 1/2 and straight chords it is
//! twice Kelvin's tensor, so the matrix is definite for any arrangement of sites and planes, not only on flat skin.

use thenar_surface::Vec3;

use super::shear_kernel::{LATTICE, ShearKernel, ShearTables};
use super::shear_matrix::ShearMatrix;
use crate::response::rows::Response;
use crate::response::tissue_geometry::Mix;
use crate::skin::arc_length::arc_length;
use crate::skin::sites::Sites;

/// A site of the skin where it is now.
#[derive(Debug, Clone, Copy)]
pub struct Place {
    /// The site.
    pub site: u32,
    /// Position, mm.
    pub position: Vec3,
    /// Response weight `sqrt(1 / (2 pi G))`.
    pub weight: f64,
}

/// The kernel between the sites in contact, kept from row to row: postures and pressures come and go, it stays.
#[derive(Debug, Clone, Default)]
pub struct Pairs {
    /// Ascending.
    sites: Vec<u32>,
    /// Mean and deviator of the pairs (i, j), j > i, row by row.
    values: Vec<[f32; 2]>,
}

impl Pairs {
    /// Mean and deviator of the `i`th and the `j`th site, j > i.
    fn get(&self, i: usize, j: usize) -> [f32; 2] {
        let n = self.sites.len();
        self.values[i * (2 * n - i - 1) / 2 + (j - i - 1)]
    }
}

/// The response of a skin to shear.
pub struct ShearResponse<'a> {
    /// Kernels of its layers.
    pub tables: &'a ShearTables,
    /// Its response to pressure, which knows layers, distances and cuts.
    pub response: &'a Response,
    /// Its sites.
    pub sites: &'a Sites,
}

impl ShearResponse<'_> {
    /// Compliance of the places in their planes, mm/N; `pairs` are those of their sites.
    pub fn matrix(
        &self,
        places: &[Place],
        tangents: &[[Vec3; 2]],
        pairs: &Pairs,
    ) -> ShearMatrix<f32> {
        let own: Vec<f64> = places.iter().map(|p| self.own(p)).collect();
        ShearMatrix::from_blocks(&own, |i, j| {
            let (from, to) = (&places[i], &places[j]);
            let Some((alike, along, chord)) = turned(pairs.get(i, j), (from, to)) else {
                return [0.0; 4];
            };
            let block =
                |a: &Vec3, b: &Vec3| alike * a.dot(b) + along * a.dot(&chord) * b.dot(&chord);
            let ([ax, ay], [bx, by]) = (&tangents[i], &tangents[j]);
            [block(ax, bx), block(ax, by), block(ay, bx), block(ay, by)]
        })
    }

    /// The kernel between all pairs of ascending `sites`; what `before` holds of them is taken from there.
    pub fn pairs(&self, sites: &[u32], before: &Pairs) -> Pairs {
        if sites == before.sites {
            return before.clone();
        }
        let known = |site: &u32| before.sites.binary_search(site).ok();
        let known: Vec<Option<usize>> = sites.iter().map(known).collect();
        let n = sites.len();
        let mut values = Vec::with_capacity(n * n.saturating_sub(1) / 2);
        for i in 0..n {
            for j in i + 1..n {
                values.push(match (known[i], known[j]) {
                    (Some(a), Some(b)) => before.get(a, b),
                    _ => self.kernel(sites[i], sites[j]),
                });
            }
        }
        Pairs {
            sites: sites.to_vec(),
            values,
        }
    }

    /// Displacement of `place` under `forces` (N) at `loaded`, mm.
    pub fn displacement(&self, place: &Place, loaded: &[Place], forces: &[Vec3]) -> Vec3 {
        let mut sum = Vec3::zeros();
        for (from, force) in loaded.iter().zip(forces) {
            if let Some((alike, along, chord)) = self.pair(place, from) {
                sum += force * alike + chord * (along * chord.dot(force));
            }
        }
        sum
    }

    /// Compliance of a site for its own force, mm/N.
    fn own(&self, place: &Place) -> f64 {
        let i = place.site as usize;
        let (a, b, w) = self.response.mix(i);
        let soft = mixed((a, b, w), (a, b, w), |a, b| self.tables.softness(a, b));
        let held = mixed((a, b, w), (a, b, w), |a, b| {
            self.tables.held(a, b, 0.0).mean
        });
        let point = 0.5 * (1.0 + soft) * LATTICE / self.sites.area[i].sqrt();
        place.weight * place.weight * (point - held)
    }

    /// Coefficients of the force itself and of its part along the unit chord, mm/N; None out of range.
    fn pair(&self, a: &Place, b: &Place) -> Option<(f64, f64, Vec3)> {
        turned(self.kernel(a.site, b.site), (a, b))
    }

    /// Mean and deviator of the kernel between two sites, 1/mm; zero out of range. No posture changes it.
    fn kernel(&self, a: u32, b: u32) -> [f32; 2] {
        let (i, j) = (a as usize, b as usize);
        let (p, q) = (self.sites.patch[i], self.sites.patch[j]);
        let Some(at_least) = self.response.bound(p.min(q), p.max(q)) else {
            return [0.0; 2];
        };
        let r = arc_length(&self.sites.rest[i], &self.sites.rest[j], at_least);
        let (mine, other) = (self.response.mix(i), self.response.mix(j));
        let soft = mixed(mine, other, |a, b| self.tables.softness(a, b));
        let held = ShearKernel {
            mean: mixed(mine, other, |a, b| self.tables.held(a, b, r).mean),
            deviator: mixed(mine, other, |a, b| self.tables.held(a, b, r).deviator),
        };
        let kept = self.response.kept(i, j);
        let mean = kept * (0.5 * (1.0 + soft) / r - held.mean);
        let deviator = kept * (0.5 * (1.0 - soft) / r - held.deviator);
        [mean as f32, deviator as f32]
    }
}

/// The kernel's mean and deviator at two places as they are: coefficients of the force and of its part along the unit chord.
fn turned([mean, deviator]: [f32; 2], (a, b): (&Place, &Place)) -> Option<(f64, f64, Vec3)> {
    if mean == 0.0 && deviator == 0.0 {
        return None;
    }
    let chord = (b.position - a.position).try_normalize(0.0)?;
    let (mean, deviator, scale) = (f64::from(mean), f64::from(deviator), a.weight * b.weight);
    Some((scale * (mean - deviator), scale * 2.0 * deviator, chord))
}

/// `value` over the layers of two sites, mixed; the same when they trade places.
fn mixed((a0, a1, wa): Mix, (b0, b1, wb): Mix, value: impl Fn(usize, usize) -> f64) -> f64 {
    let value = |a: u16, b: u16| value(a as usize, b as usize);
    if a0 == a1 && b0 == b1 {
        return value(a0, b0);
    }
    let (va, vb) = (1.0 - wa, 1.0 - wb);
    (wa * wb * value(a0, b0) + va * vb * value(a1, b1))
        + (wa * vb * value(a0, b1) + va * wb * value(a1, b0))
}
