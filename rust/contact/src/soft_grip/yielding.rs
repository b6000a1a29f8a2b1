//! How far a grip yields under the forces of the skin: at places of a contact problem, and at the product's vertices.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use rayon::prelude::*;
use thenar_surface::{Gap, GapLimits, Product, Vec3};

use super::disc_kernel::DiscKernels;
use super::elastomer::SoftGrip;
use super::joint_compliance::GripRows;

/// Depth of the core's surface, as a share of the grip's thickness, below which another wall of the product is clearly nearer.
const CORE_SHARE: f64 = 0.8;

/// A grip as it lies on its product, and what presses have found of it so far.
#[derive(Debug)]
pub(crate) struct Covered {
    grip: SoftGrip,
    product: Arc<Product>,
    /// Outward, by vertex; zero within the solid.
    normals: Vec<Vec3>,
    /// Vertices of sheets without thickness, which have skin on either side.
    is_sheet: Vec<bool>,
    /// Vertices that yield.
    soft: Vec<u32>,
    /// By elastomer.
    kernels: Mutex<Vec<DiscKernels>>,
    /// By vertex of the product, 1 where the grip is linear: what is left of it where it is pressed as thin as it gets.
    give: Mutex<Vec<f64>>,
    /// By site of the skin, mm: how far the grip yields there, as the skin's moduli take it, and in the last press.
    yields: Mutex<Yields>,
}

/// How far the grip yields where sites of the skin lie, by site; empty for not at all. Depths in mm.
#[derive(Debug, Default, Clone)]
pub(crate) struct Yields {
    /// As taken by the skin's moduli.
    pub taken: Vec<f64>,
    /// Of the last press; no more than the site is deep, since nothing more can be taken from its depth.
    pub found: Vec<f64>,
    /// Where each site met the product in the last press.
    pub met: Vec<Option<Gap>>,
    /// Where each is taken to meet it in the presses to come; empty where that is not held.
    pub held: Vec<Option<Gap>>,
}

/// A place on a grip, and a vertex area that a force on it is spread over.
pub(crate) struct Place {
    /// mm.
    at: Vec3,
    /// Outward.
    normal: Vec3,
    /// Of a disc of the area, mm.
    radius: f64,
    /// The elastomer, where there is one.
    elastomer: Option<usize>,
    /// Share that soft corners carry, times what is left of them; the rest stands on the rigid core.
    share: f64,
    is_sheet: bool,
}

impl Covered {
    pub(crate) fn new(grip: &SoftGrip, product: &Arc<Product>) -> Self {
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
        let kernels = kernels.map(|e| DiscKernels::new(e.layer(), size)).collect();
        Covered {
            kernels: Mutex::new(kernels),
            give: Mutex::new(vec![1.0; normals.len()]),
            yields: Mutex::default(),
            grip: grip.clone(),
            product: Arc::clone(product),
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

    pub(crate) fn yields(&self) -> MutexGuard<'_, Yields> {
        self.yields.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// What is left of the grip's give, by vertex of the product.
    pub(crate) fn give(&self) -> MutexGuard<'_, Vec<f64>> {
        self.give.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The place on the grip that a gap was measured to, for a vertex area in mm2.
    pub(crate) fn place(&self, gap: &Gap, area: f64) -> Place {
        let corners = self.product.mesh().triangles()[gap.triangle as usize];
        let give = self.give();
        let (mut share, mut elastomer, mut most) = (0.0, None, 0.0);
        for (corner, weight) in corners.into_iter().zip(gap.barycentric) {
            if let Some(here) = self.grip.at(corner) {
                share += weight * give[corner as usize];
                if weight > most {
                    (elastomer, most) = (Some(here), weight);
                }
            }
        }
        Place {
            at: gap.closest,
            normal: gap.normal,
            radius: (area / std::f64::consts::PI).sqrt(),
            elastomer,
            share,
            is_sheet: self.product.is_sheet(gap.triangle as usize),
        }
    }

    /// The kernels, with tables for discs of these places.
    fn kernels_for<'p>(
        &self,
        places: impl Iterator<Item = &'p Place> + Clone,
    ) -> MutexGuard<'_, Vec<DiscKernels>> {
        let mut all = self.kernels.lock().unwrap_or_else(PoisonError::into_inner);
        for (e, kernels) in all.iter_mut().enumerate() {
            let here = places.clone().filter(|p| p.elastomer == Some(e));
            kernels.make(here.map(|p| p.radius).filter(|r| *r > 0.0));
        }
        all
    }

    /// The grip's compliance between places, mm/N.
    pub(crate) fn rows(&self, places: &[Place]) -> GripRows {
        let kernels = self.kernels_for(places.iter());
        let row = |i: usize| {
            let to = &places[i];
            let entry = |(j, from): (usize, &Place)| {
                let value = self.entry(to, from, &kernels);
                (value != 0.0).then_some((j as u32, value as f32))
            };
            places.iter().enumerate().filter_map(entry).collect()
        };
        let all: Vec<Vec<(u32, f32)>> = (0..places.len()).into_par_iter().map(row).collect();
        let mut rows = GripRows::default();
        all.iter().for_each(|row| rows.push(row));
        rows
    }

    /// How far the grip yields at places (mm) under forces (N) at others.
    pub(crate) fn yield_at(&self, places: &[Place], loads: &[(Place, f64)]) -> Vec<f64> {
        let kernels = self.kernels_for(places.iter().chain(loads.iter().map(|load| &load.0)));
        let one = |to: &Place| -> f64 {
            let terms = loads.iter();
            let terms = terms.map(|(from, force)| force * self.entry(to, from, &kernels));
            terms.sum()
        };
        places.par_iter().map(one).collect()
    }

    /// How far a unit force at one place moves another, mm/N: the same either way. Places of another wall do not reach it.
    fn entry(&self, to: &Place, from: &Place, kernels: &[DiscKernels]) -> f64 {
        let (Some(e), true) = (to.elastomer, to.elastomer == from.elastomer) else {
            return 0.0;
        };
        let (r, along) = ((to.at - from.at).norm(), to.normal.dot(&from.normal));
        // The two sides of a sheet are one wall.
        let is_one_wall = along > 0.0 || (to.is_sheet && from.is_sheet);
        let radius = to.radius.max(from.radius);
        if !is_one_wall || r >= kernels[e].reach(radius) {
            return 0.0;
        }
        let compliance = self.grip.elastomers[e].compliance();
        compliance * along * to.share * from.share * kernels[e].at(r, radius)
    }

    /// How far each soft vertex yields (mm) under the forces (N) at these places.
    pub(crate) fn depth(&self, loads: &[(Place, f64)]) -> Vec<f64> {
        let give = self.give().clone();
        let vertex = |&v: &u32| Place {
            at: self.product.mesh().positions()[v as usize],
            normal: self.normals[v as usize],
            radius: 0.0,
            elastomer: self.grip.at(v),
            share: give[v as usize],
            is_sheet: self.is_sheet[v as usize],
        };
        let places: Vec<Place> = self.soft.iter().map(vertex).collect();
        self.yield_at(&places, loads)
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
