//! The coupling of a zone: near blocks, far blocks between skeletons, preconditioner, and the memory they need.

use super::blocks::{Blocks, Pair};
use super::cluster_bases::Clusters;
use super::hierarchy::{Hierarchy, SEPARATION, SiteList, SkinResponse, gap};
use super::preconditioner::SparseInverse;
use crate::{ContactError, Control};

/// Most memory for the response of one zone, GiB; a zone that needs more is refused before any is taken.
pub const MOST_GIB: f64 = 12.0;

/// `K` between the sites of a zone, 1/mm.
#[derive(Debug, Clone, Default)]
pub struct ZoneCoupling {
    /// The zone's clusters.
    pub clusters: Clusters,
    /// Place in the zone of each of the clusters' sites.
    pub(super) place: Vec<u32>,
    /// First of each cluster's chosen sites in fields over all of them.
    pub(super) offset: Vec<usize>,
    pub(super) near: Blocks,
    pub(super) far: Blocks,
    /// `K_ii` in the zone's order.
    pub(super) own: Vec<f64>,
    /// The preconditioner.
    pub(super) sparse_inverse: SparseInverse,
}

impl ZoneCoupling {
    /// Makes the blocks of `zone` (ascending).
    ///
    /// # Errors
    /// [`ContactError::TooLarge`] before their memory is taken, or `Cancelled`.
    pub fn new(
        hierarchy: &Hierarchy,
        zone: &[u32],
        ground: SkinResponse<'_>,
        control: &Control,
    ) -> Result<ZoneCoupling, ContactError> {
        let mut coupled = ZoneCoupling::planned(hierarchy, zone, ground, control)?;
        coupled.check(MOST_GIB)?;
        coupled.fill(hierarchy, ground, control)?;
        coupled.own = coupled.diagonal();
        Ok(coupled)
    }

    /// Finds skeletons, pairs and the preconditioner's sparsity; no block yet.
    pub(super) fn planned(
        hierarchy: &Hierarchy,
        zone: &[u32],
        ground: SkinResponse<'_>,
        control: &Control,
    ) -> Result<ZoneCoupling, ContactError> {
        let clusters = Clusters::new(hierarchy, zone, ground, control)?;
        let find = |site: &u32| zone.partition_point(|z| z < site) as u32;
        let mut coupled = ZoneCoupling {
            place: clusters.sites.iter().map(find).collect(),
            offset: clusters.offsets(),
            clusters,
            ..ZoneCoupling::default()
        };
        if !zone.is_empty() {
            coupled.pair(hierarchy, 0, 0);
        }
        coupled.lay_out();
        let (near, clusters) = (&coupled.near, &coupled.clusters);
        coupled.sparse_inverse = SparseInverse::planned(near, clusters, ground);
        Ok(coupled)
    }

    /// Memory of the blocks, the inverse factor and the skeletons, GiB, known before the blocks are made.
    pub fn needed_gib(&self) -> f64 {
        let bases = self.clusters.list.iter().filter_map(|c| c.basis.as_ref());
        let transfers: usize = bases.map(|basis| basis.transfer.len()).sum();
        let singles = self.near.entries + self.far.entries + transfers;
        let doubles = self.sparse_inverse.entries();
        (singles * size_of::<f32>() + doubles * size_of::<f64>()) as f64 / f64::from(1 << 30)
    }

    /// # Errors
    /// [`ContactError::TooLarge`] if more than `limit_gib` is needed.
    pub fn check(&self, limit_gib: f64) -> Result<(), ContactError> {
        let needed_gib = self.needed_gib();
        if needed_gib > limit_gib {
            return Err(ContactError::TooLarge {
                vertices: self.len(),
                needed_gib,
                limit_gib,
            });
        }
        Ok(())
    }

    /// Number of sites.
    pub fn len(&self) -> usize {
        self.place.len()
    }

    /// `K_ii`, 1/mm.
    pub fn own(&self) -> &[f64] {
        &self.own
    }

    /// Sorts pairs of clusters into near and far ones; those out of range are left out.
    fn pair(&mut self, hierarchy: &Hierarchy, a: usize, b: usize) {
        let (one, other) = (&self.clusters.list[a], &self.clusters.list[b]);
        let nodes = &hierarchy.tree.nodes;
        let (left, right) = (&nodes[one.node], &nodes[other.node]);
        if a != b {
            if hierarchy.is_out_of_range(left, right) {
                return;
            }
            let is_far = gap(left, right) >= SEPARATION * left.radius.max(right.radius);
            if is_far && one.basis.is_some() && other.basis.is_some() {
                self.far.pairs.push(Pair::new(a, b));
                return;
            }
        }
        let cuts_first =
            other.children.is_empty() || (!one.children.is_empty() && left.radius >= right.radius);
        let halves = if cuts_first {
            &one.children
        } else {
            &other.children
        }
        .clone();
        if halves.is_empty() {
            self.near.pairs.push(Pair::new(a, b));
        } else if a == b {
            for (k, &low) in halves.iter().enumerate() {
                for &high in &halves[k..] {
                    self.pair(hierarchy, low, high);
                }
            }
        } else {
            for half in halves {
                let (a, b) = if cuts_first { (half, b) } else { (a, half) };
                self.pair(hierarchy, a, b);
            }
        }
    }

    /// Places of the blocks in memory.
    fn lay_out(&mut self) {
        let (list, offset) = (&self.clusters.list, &self.offset);
        let members = |c: usize| list[c].last - list[c].first;
        let rank = |c: usize| offset[c + 1] - offset[c];
        self.near.lay_out(members, list.len());
        self.far.lay_out(rank, list.len());
    }

    fn fill(
        &mut self,
        hierarchy: &Hierarchy,
        ground: SkinResponse<'_>,
        control: &Control,
    ) -> Result<(), ContactError> {
        let list = &self.clusters.list;
        let sites = &self.clusters.sites;
        let members = |c: usize| &sites[list[c].first..list[c].last];
        let chosen = |c: usize| list[c].basis.as_ref().map_or(&[][..], |b| &b.chosen);
        let make = |a: &[u32], b: &[u32], out: &mut [f32]| {
            hierarchy.block(ground, a, &SiteList::new(b, ground.sites), out);
        };
        let watched = |share: f64| control.step("response", share);
        self.near.fill(
            |p, out| make(members(p.a), members(p.b), out),
            |s| watched(0.5 + 0.3 * s),
        )?;
        self.far.fill(
            |p, out| make(chosen(p.a), chosen(p.b), out),
            |s| watched(0.8 + 0.15 * s),
        )?;
        let factor = &mut self.sparse_inverse;
        factor.fill(hierarchy, (&self.clusters, ground), |s| {
            watched(0.95 + 0.05 * s)
        })
    }

    fn diagonal(&self) -> Vec<f64> {
        let mut own = vec![0.0; self.len()];
        for pair in self.near.pairs.iter().filter(|p| p.a == p.b) {
            let cluster = &self.clusters.list[pair.a];
            let columns = cluster.last - cluster.first;
            for k in 0..columns {
                let value = self.near.values[pair.start + k * columns + k];
                own[self.place[cluster.first + k] as usize] = f64::from(value);
            }
        }
        own
    }
}
