//! Response rows between sites, computed when first needed and kept for every later posture.
//!
//! A row holds `K(r_ij)` (1/mm), so that `u_i = s_i s_j K_ij P_j` with `s = sqrt((1 - nu) / (2 pi G))`. It depends on the rest
//! mesh and on thicknesses alone. The operator is symmetric: both members of a pair are computed by the same operations.

use std::sync::OnceLock;

use rayon::prelude::*;
use thenar_surface::SkinDistance;

use super::bonded_layer::Layer;
use super::kernel_grid::RANGE_IN_THICKNESSES;
use super::kernel_tables::KernelTables;
use super::stiff_skin_kernel::StiffSkin;
use super::tissue_geometry::{Cut, Geometry, Mix};
use crate::Model;
use crate::skin::arc_length::arc_lengths;
use crate::skin::sites::Sites;

/// Lattice self term: a point's own area A acts like a source at distance sqrt(A) / 3.9003, where 3.9003 is
/// -4 zeta(1/2) beta(1/2): the quadrature-corrected point rule on a square lattice.
const LATTICE: f64 = 3.900_264_920_001_956;
/// The paper's r0, mm: nearer pairs answer as at this distance (Xie 3.1).
pub const PAPER_R0: f64 = 0.5;
/// r0 over the vertex spacing on meshes finer than 1 mm: a vertex then answers to its own force the more the less area it has, as a half
/// space does, and the matrix stays definite.
const R0_IN_SPACINGS: f64 = 0.5;
/// Most distinct layers before thicknesses are interpolated.
const EXACT_LAYERS: usize = 4;
/// Ratio of neighboring thicknesses where they are interpolated.
const LADDER_RATIO: f64 = 1.3;

/// The response of a skin, and its rows that were needed so far.
///
/// Several presses may need rows at once: each row is made by the first that needs it, and is the same whoever makes it.
#[derive(Debug, Clone)]
pub struct Response {
    model: Model,
    /// By patch, mm.
    paper_r0: Vec<f64>,
    layers: Vec<Layer>,
    tables: KernelTables,
    /// Range of the response around each site, mm.
    pub(super) reach: Vec<f64>,
    /// Two layers and the first one's weight, by site.
    mix: Vec<Mix>,
    /// Patches within range of each patch, ascending, with the offset of their sites in a row.
    near: Vec<Vec<(u32, u32)>>,
    /// Lower bounds of skin distance to those patches, mm.
    pub(super) at_least: Vec<Vec<f64>>,
    pub(super) cuts: Vec<Cut>,
    pub(super) stiff: Option<StiffSkin>,
    rows: Vec<OnceLock<Box<[f32]>>>,
}

impl Response {
    /// Prepares tables and patch neighborhoods for the layers of the regions; no row yet.
    pub fn new(model: Model, geometry: &Geometry, sites: &Sites, metric: &SkinDistance) -> Self {
        let half_space = Layer {
            thickness: f64::INFINITY,
            poisson_ratio: 0.5,
        };
        let (layers, mix) = match model {
            Model::Paper => (vec![half_space], vec![(0, 0, 1.0); sites.len()]),
            Model::Layer => mix_layers(geometry, sites),
        };
        let reach_of = |&(a, b, w): &Mix| {
            let thickness = |layer: u16| layers[layer as usize].thickness;
            RANGE_IN_THICKNESSES
                * if a == b {
                    thickness(a)
                } else {
                    w * thickness(a) + (1.0 - w) * thickness(b)
                }
        };
        let reach: Vec<f64> = mix.iter().map(reach_of).collect();
        let most = |&(first, last): &(u32, u32)| {
            reach[first as usize..last as usize]
                .iter()
                .fold(0.0, |most, r| f64::max(most, *r))
        };
        let patch_reach: Vec<f64> = sites.patch_range.iter().map(most).collect();
        let (near, at_least) = neighborhoods(sites, metric, &patch_reach);
        let tables = KernelTables::new(&layers, extent(sites));
        let stiff = StiffSkin::new(&layers, (&geometry.sheets, sites), extent(sites));
        Response {
            model,
            paper_r0: paper_r0(sites),
            layers,
            tables,
            reach,
            mix,
            near,
            at_least,
            cuts: geometry.cuts.clone(),
            stiff,
            rows: vec![OnceLock::new(); sites.len()],
        }
    }

    /// Patches within range of `patch`, with the offset of their first site in its rows.
    pub fn near(&self, patch: u32) -> &[(u32, u32)] {
        &self.near[patch as usize]
    }

    /// The layers that sites are mixed of.
    pub fn layers(&self) -> &[Layer] {
        &self.layers
    }

    /// Two layers and the first one's weight, of a site.
    pub fn mix(&self, site: usize) -> Mix {
        self.mix[site]
    }

    /// Lower bound of the skin distance between two patches, mm; None if they are out of range.
    pub fn bound(&self, from: u32, to: u32) -> Option<f64> {
        let near = &self.near[from as usize];
        let place = near.binary_search_by_key(&to, |entry| entry.0).ok()?;
        Some(self.at_least[from as usize][place])
    }

    /// Length of a row of `patch`.
    pub(super) fn row_length(&self, patch: u32, sites: &Sites) -> usize {
        let end = |&(p, offset): &(u32, u32)| {
            let (first, last) = sites.patch_range[p as usize];
            (offset + last - first) as usize
        };
        self.near[patch as usize].last().map_or(0, end)
    }

    /// Makes the rows of `wanted` that are missing, several at once.
    pub fn make_rows(&self, wanted: &[u32], sites: &Sites) {
        let is_missing = |j: &u32| self.rows[*j as usize].get().is_none();
        let missing: Vec<u32> = wanted.iter().copied().filter(is_missing).collect();
        missing.par_iter().with_min_len(8).for_each(|&j| {
            self.row(j, sites);
        });
    }

    /// Row `j`, laid out as [`Response::near`] says; made here if it was not.
    pub fn row(&self, j: u32, sites: &Sites) -> &[f32] {
        self.rows[j as usize].get_or_init(|| self.row_of(j as usize, sites))
    }

    fn row_of(&self, j: usize, sites: &Sites) -> Box<[f32]> {
        let patch = sites.patch[j] as usize;
        let mut row = Vec::with_capacity(self.row_length(sites.patch[j], sites));
        let (mut distances, mut psi) = (Vec::new(), Vec::new());
        for (&(p, _), &bound) in self.near[patch].iter().zip(&self.at_least[patch]) {
            let (first, last) = sites.patch_range[p as usize];
            let there = first as usize..last as usize;
            distances.resize(there.len(), 0.0);
            psi.resize(there.len(), 0.0);
            arc_lengths(
                &sites.rest[there.clone()],
                &sites.rest[j],
                bound,
                &mut distances,
            );
            match self.model {
                Model::Paper => {
                    let same = |i: usize| sites.region[i] == sites.region[j];
                    let r0 = self.paper_r0[p as usize].min(self.paper_r0[patch]);
                    let entry = |(i, r): (usize, &f64)| match same(i) {
                        true => 1.0 / r.max(r0),
                        false => 0.0,
                    };
                    row.extend(there.zip(&distances).map(entry).map(|k| k as f32));
                }
                Model::Layer => {
                    self.find_psi(there.clone(), j, &distances, &mut psi);
                    for (i, (r, psi)) in there.zip(distances.iter().zip(&psi)) {
                        let entry = self.layer_entry((i, j), *r, *psi, sites);
                        row.push((entry * self.kept(i, j)) as f32);
                    }
                }
            }
        }
        row.into_boxed_slice()
    }

    /// Share of the response that cuts leave between two sites.
    #[inline]
    pub fn kept(&self, i: usize, j: usize) -> f64 {
        let share = |cut: &Cut| {
            if cut.block[i] == cut.block[j] {
                1.0
            } else {
                cut.kept
            }
        };
        self.cuts.iter().map(share).product()
    }

    /// `K_ii` of the layer at a site, 1/mm.
    pub fn own(&self, site: usize, sites: &Sites) -> f64 {
        self.layer_entry((site, site), 0.0, self.psi(site, site, 0.0), sites)
    }

    /// `K_ij` of the layer, 1/mm.
    #[inline]
    pub(super) fn layer_entry(
        &self,
        (i, j): (usize, usize),
        r: f64,
        psi: f64,
        sites: &Sites,
    ) -> f64 {
        if let Some(stiff) = &self.stiff {
            let is_near = r < 0.5 * (self.reach[i] + self.reach[j]);
            let distance = if i == j { None } else { Some(r) };
            let entry = stiff.entry(
                [(i, self.mix[i]), (j, self.mix[j])],
                (distance, sites.area[i]),
            );
            return if is_near { entry } else { 0.0 };
        }
        if i == j {
            LATTICE / sites.area[i].sqrt() - psi
        } else if r < 0.5 * (self.reach[i] + self.reach[j]) {
            1.0 / r - psi
        } else {
            0.0
        }
    }

    /// Psi between the sites `there` and `j`, 1/mm; one table where all are of one layer.
    pub(super) fn find_psi(
        &self,
        there: impl Iterator<Item = usize> + Clone,
        j: usize,
        distances: &[f64],
        out: &mut [f64],
    ) {
        let (a, b, _) = self.mix[j];
        let (c, d, _) = there.clone().next().map_or(self.mix[j], |i| self.mix[i]);
        let is_one = a == b
            && there
                .clone()
                .all(|i| self.mix[i].0 == c && self.mix[i].1 == c);
        if is_one && c == d {
            self.tables
                .psi_of_pair(a as usize, c as usize, distances, out);
            return;
        }
        for (i, (r, out)) in there.zip(distances.iter().zip(out)) {
            *out = self.psi(i, j, *r);
        }
    }

    fn psi(&self, i: usize, j: usize, r: f64) -> f64 {
        let ((a0, a1, wa), (b0, b1, wb)) = (self.mix[i], self.mix[j]);
        let psi = |a: u16, b: u16| self.tables.psi(a as usize, b as usize, r);
        if a0 == a1 && b0 == b1 {
            return psi(a0, b0);
        }
        // Summed in an order that does not change when i and j trade places.
        let (va, vb) = (1.0 - wa, 1.0 - wb);
        (wa * wb * psi(a0, b0) + va * vb * psi(a1, b1))
            + (wa * vb * psi(a0, b1) + va * wb * psi(a1, b0))
    }
}

/// Patches near each patch with row offsets, and lower bounds of skin distance to them, mm.
type Neighborhoods = (Vec<Vec<(u32, u32)>>, Vec<Vec<f64>>);

fn neighborhoods(sites: &Sites, metric: &SkinDistance, reach: &[f64]) -> Neighborhoods {
    let patches = sites.patch_range.len() as u32;
    let one = |a: u32| {
        let (mut list, mut bounds, mut offset) = (Vec::new(), Vec::new(), 0);
        for b in 0..patches {
            let (first, last) = sites.patch_range[b as usize];
            let bound = metric.lower_bound(a, b).max(metric.lower_bound(b, a));
            let range = 0.5 * (reach[a as usize] + reach[b as usize]);
            if first < last && bound < range && bound.is_finite() {
                list.push((b, offset));
                bounds.push(bound);
                offset += last - first;
            }
        }
        (list, bounds)
    };
    (0..patches).map(one).unzip()
}

/// A length that no two sites are farther apart along the skin, mm.
pub fn extent(sites: &Sites) -> f64 {
    let mut low = [f64::INFINITY; 3];
    let mut high = [f64::NEG_INFINITY; 3];
    for site in &sites.rest {
        for axis in 0..3 {
            low[axis] = low[axis].min(site.position[axis]);
            high[axis] = high[axis].max(site.position[axis]);
        }
    }
    let diagonal = (0..3)
        .map(|a| (high[a] - low[a]).powi(2))
        .sum::<f64>()
        .sqrt();
    // Along the skin it is farther than across: up to half the circumference of the enclosing ball.
    (diagonal * std::f64::consts::FRAC_PI_2).max(f64::MIN_POSITIVE)
}

/// The layers to tabulate and each site's mix of two of them, by the inverse 1/h of its thickness.
fn mix_layers(geometry: &Geometry, sites: &Sites) -> (Vec<Layer>, Vec<Mix>) {
    let of_region = &geometry.layers;
    let poisson: Vec<f64> = of_region.iter().map(|l| l.poisson_ratio).collect();
    let has_one_poisson = poisson.iter().all(|nu| *nu == poisson[0]);
    let curvature: Vec<f64> = of_region.iter().map(|l| 1.0 / l.thickness).collect();
    let (of_site, mut levels) = match &geometry.curvature {
        Some(field) => (field.clone(), field.clone()),
        None if has_one_poisson => (sites.blended(&curvature), curvature),
        None => return per_region(of_region, sites),
    };
    levels.sort_by(f64::total_cmp);
    levels.dedup();
    if levels.len() > EXACT_LAYERS {
        levels = ladder(&levels);
    }
    let mut ratios = poisson.clone();
    ratios.sort_by(f64::total_cmp);
    ratios.dedup();
    let layer = |nu: &f64, z: &f64| Layer {
        thickness: 1.0 / z,
        poisson_ratio: *nu,
    };
    let layers = ratios
        .iter()
        .flat_map(|nu| levels.iter().map(move |z| layer(nu, z)))
        .collect();
    let mix = of_site.iter().enumerate().map(|(site, &z)| {
        let nu = poisson[sites.home_region(site) as usize];
        let first = levels.len() * ratios.partition_point(|ratio| *ratio < nu);
        let (lower, upper, weight) = between(&levels, z);
        ((first + lower) as u16, (first + upper) as u16, weight)
    });
    (layers, mix.collect())
}

/// The levels around `z` and the weight of the first.
fn between(levels: &[f64], z: f64) -> (usize, usize, f64) {
    let upper = levels
        .partition_point(|level| *level < z)
        .min(levels.len() - 1);
    if levels[upper] <= z || upper == 0 {
        return (upper, upper, 1.0);
    }
    let weight = (levels[upper] - z) / (levels[upper] - levels[upper - 1]);
    (upper - 1, upper, weight)
}

/// Where Poisson's ratio differs too, each region is a layer of its own and a crease mixes its two largest shares.
fn per_region(of_region: &[Layer], sites: &Sites) -> (Vec<Layer>, Vec<Mix>) {
    let mix = sites.blend.iter().map(|share| {
        let mut share = share.clone();
        share.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
        match share[..] {
            [] => (0, 0, 1.0),
            [(a, _)] => (a as u16, a as u16, 1.0),
            [(a, wa), (b, wb), ..] => (a as u16, b as u16, wa / (wa + wb)),
        }
    });
    (of_region.to_vec(), mix.collect())
}

/// The paper's r0 (mm) by patch of a skin: as published down to a vertex spacing of 1 mm. The spacing is that of the upper quartile of the
/// vertices' areas, for those at a border have less.
fn paper_r0(sites: &Sites) -> Vec<f64> {
    let of_patch = |&(first, last): &(u32, u32)| {
        let mut areas = sites.area[first as usize..last as usize].to_vec();
        areas.sort_unstable_by(f64::total_cmp);
        // Of a lattice of equal triangles.
        let spacing = |area: &f64| (area * 2.0 / 3f64.sqrt()).sqrt();
        let spacing = areas
            .get(areas.len() * 3 / 4)
            .map_or(f64::INFINITY, spacing);
        PAPER_R0.min(R0_IN_SPACINGS * spacing)
    };
    sites.patch_range.iter().map(of_patch).collect()
}

/// Levels from the lowest to the highest positive one in equal ratios; zero (a half space) stays.
fn ladder(levels: &[f64]) -> Vec<f64> {
    let positive: Vec<f64> = levels.iter().copied().filter(|z| *z > 0.0).collect();
    let (low, high) = (positive[0], positive[positive.len() - 1]);
    let steps = ((high / low).ln() / LADDER_RATIO.ln()).ceil().max(1.0) as usize;
    let mut rungs: Vec<f64> = (0..=steps)
        .map(|i| low * (high / low).powf(i as f64 / steps as f64))
        .collect();
    rungs[steps] = high;
    if levels[0] == 0.0 {
        rungs.insert(0, 0.0);
    }
    rungs
}
