//! The hierarchy of a large skin: cluster tree, bounds of distance, blocks of the response between site lists.

use super::cluster_tree::{Node, Tree};
use crate::Model;
use crate::response::entries::{Group, Scratch};
use crate::response::rows::Response;
use crate::skin::arc_length::Site;
use crate::skin::sites::Sites;

/// Sites from which on a skin is large: below, rows in memory are as fast, and exact.
pub const LEAST_SITES: usize = 40_000;
/// What a skeleton may leave out of a row, in parts of the largest row. From 1e-4 to 1e-7 the certificate follows it.
pub(super) const TOLERANCE: f64 = 1e-5;
/// Clusters are far from one another where the gap between their balls is at least so many radii of the larger. 0.7 to 2 serve.
pub(super) const SEPARATION: f64 = 1.0;

/// What the response of a large skin is cut up by; made once for every zone and posture.
#[derive(Debug, Clone)]
pub struct Hierarchy {
    pub(super) tree: Tree,
    /// Lower bound of the skin distance by pair of patches, mm; infinite where they are out of range.
    bounds: Vec<f32>,
    patches: usize,
    /// Largest range of any site's response, mm.
    reach: f64,
}

/// The skin and its response.
#[derive(Clone, Copy)]
pub struct SkinResponse<'a> {
    pub response: &'a Response,
    pub sites: &'a Sites,
}

impl Hierarchy {
    /// None where rows in memory serve: in small skins, and in model paper, whose response has no far field of its own.
    pub fn new(model: Model, ground: SkinResponse<'_>) -> Option<Hierarchy> {
        let is_large = ground.sites.len() >= LEAST_SITES;
        (model == Model::Layer && is_large).then(|| Hierarchy::of(ground))
    }

    /// The hierarchy of a skin of any size.
    pub(super) fn of(SkinResponse { response, sites }: SkinResponse<'_>) -> Hierarchy {
        let patches = sites.patch_range.len();
        let mut bounds = vec![f32::INFINITY; patches * patches];
        for a in 0..patches as u32 {
            for (b, bound) in response.bounds(a) {
                // Bounds come from single precision.
                bounds[a as usize * patches + b as usize] = bound as f32;
            }
        }
        Hierarchy {
            tree: Tree::new(sites),
            bounds,
            patches,
            reach: response.most_reach(),
        }
    }

    pub(super) fn bound(&self, a: u32, b: u32) -> f64 {
        f64::from(self.bounds[a as usize * self.patches + b as usize])
    }

    /// Whether every site of one cluster is out of every other one's range.
    pub(super) fn is_out_of_range(&self, a: &Node, b: &Node) -> bool {
        gap(a, b) >= self.reach
    }
}

/// Distance between the balls of two clusters, mm; negative where they overlap.
pub(super) fn gap(a: &Node, b: &Node) -> f64 {
    (a.center - b.center).norm() - a.radius - b.radius
}

/// A list of sites, their places at hand, cut where the patch changes.
pub(super) struct SiteList {
    pub(super) sites: Vec<u32>,
    pub(super) rest: Vec<Site>,
    /// Patch, and the end of its part of the list.
    pub(super) runs: Vec<(u32, usize)>,
}

impl SiteList {
    pub(super) fn new(list: &[u32], sites: &Sites) -> SiteList {
        let mut runs: Vec<(u32, usize)> = Vec::new();
        for (k, &site) in list.iter().enumerate() {
            let patch = sites.patch[site as usize];
            match runs.last_mut() {
                Some(run) if run.0 == patch => run.1 = k + 1,
                _ => runs.push((patch, k + 1)),
            }
        }
        SiteList {
            sites: list.to_vec(),
            rest: list.iter().map(|&i| sites.rest[i as usize]).collect(),
            runs,
        }
    }
}

impl Hierarchy {
    /// `K` between the sites of a list and one site, 1/mm.
    pub(super) fn fill(
        &self,
        ground: SkinResponse<'_>,
        list: &SiteList,
        j: u32,
        (scratch, out): (&mut Scratch, &mut [f32]),
    ) {
        let home = ground.sites.patch[j as usize];
        let mut first = 0;
        for &(patch, last) in &list.runs {
            let group = Group {
                sites: &list.sites[first..last],
                rest: &list.rest[first..last],
            };
            let seen = (j as usize, self.bound(patch, home));
            let out = &mut out[first..last];
            ground
                .response
                .entries(group, seen, (ground.sites, scratch), out);
            first = last;
        }
    }

    /// `K` between rows and the sites of a list, row by row, 1/mm.
    pub(super) fn block(
        &self,
        ground: SkinResponse<'_>,
        rows: &[u32],
        list: &SiteList,
        out: &mut [f32],
    ) {
        let mut scratch = Scratch::default();
        for (&i, out) in rows.iter().zip(out.chunks_mut(list.sites.len().max(1))) {
            self.fill(ground, list, i, (&mut scratch, out));
        }
    }
}
