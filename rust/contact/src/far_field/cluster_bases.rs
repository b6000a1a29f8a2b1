//! Clusters of a set of sites with their skeleton bases.

use rayon::prelude::*;
use thenar_surface::Vec3;

use super::cluster_tree::{Node, Tree};
use super::hierarchy::{Hierarchy, SEPARATION, SiteList, SkinResponse, TOLERANCE};
use super::skeletons::skeleton;
use crate::{ContactError, Control};

/// Clusters whose skeletons are found between two looks at the caller's wish to stop.
const AT_ONCE: usize = 256;
/// A cluster that looks smaller than this, in parts of its distance, is seen as a few sites.
const LOOKS_SMALL: f64 = 0.3;
/// Sites seen of a near cluster and of a farther one; the near ones lie within [`NEAR`] times the least distance.
const SEEN: (usize, usize) = (2, 1);
const NEAR: f64 = 2.0;

/// Skeleton basis of a cluster: chosen sites and the interpolation from them.
#[derive(Debug, Clone, Default)]
pub struct Basis {
    /// The chosen sites.
    pub chosen: Vec<u32>,
    /// Share of each chosen site in every candidate, row by row: a smallest cluster's members, or its halves' chosen sites.
    pub transfer: Vec<f32>,
}

/// Some of a cluster's sites.
#[derive(Debug, Clone)]
pub struct Cluster {
    /// The cluster of the tree.
    pub node: usize,
    /// Its part of [`Clusters::sites`].
    pub first: usize,
    pub last: usize,
    /// Clusters with its halves' members, where it has halves.
    pub children: Vec<usize>,
    /// None where no site is both far enough and in range.
    pub basis: Option<Basis>,
}

/// Clusters of some sites, each before its halves.
#[derive(Debug, Clone, Default)]
pub struct Clusters {
    /// The sites in the tree's order.
    pub sites: Vec<u32>,
    pub list: Vec<Cluster>,
}

impl Clusters {
    /// Finds the clusters of `members` (any order, no site twice) and their skeletons.
    ///
    /// # Errors
    /// [`ContactError::Cancelled`].
    pub fn new(
        hierarchy: &Hierarchy,
        members: &[u32],
        ground: SkinResponse<'_>,
        control: &Control,
    ) -> Result<Clusters, ContactError> {
        let tree = &hierarchy.tree;
        let mut is_member = vec![false; ground.sites.len()];
        members.iter().for_each(|&i| is_member[i as usize] = true);
        let mut clusters = Clusters::default();
        if !members.is_empty() {
            clusters.gather(tree, 0, &is_member);
        }
        let mut height = vec![0usize; clusters.list.len()];
        for c in (0..height.len()).rev() {
            let children = clusters.list[c].children.iter();
            height[c] = children.map(|&child| height[child] + 1).max().unwrap_or(0);
        }
        let mut order: Vec<usize> = (0..height.len()).collect();
        order.sort_by_key(|&c| height[c]);
        let mut done = 0;
        for level in order.chunk_by(|&a, &b| height[a] == height[b]) {
            for some in level.chunks(AT_ONCE) {
                control.step("response", 0.5 * done as f64 / order.len() as f64)?;
                let found: Vec<Option<Basis>> = some
                    .par_iter()
                    .map(|&c| clusters.basis(hierarchy, c, ground))
                    .collect();
                for (&c, basis) in some.iter().zip(found) {
                    clusters.list[c].basis = basis;
                }
                done += some.len();
            }
        }
        Ok(clusters)
    }

    /// First of each cluster's chosen sites in fields over all of them, and their number.
    pub fn offsets(&self) -> Vec<usize> {
        let mut offset = vec![0];
        for cluster in &self.list {
            let rank = cluster.basis.as_ref().map_or(0, |b| b.chosen.len());
            offset.push(offset[offset.len() - 1] + rank);
        }
        offset
    }

    fn gather(&mut self, tree: &Tree, node: usize, is_member: &[bool]) -> Option<usize> {
        let (own, first) = (self.list.len(), self.sites.len());
        self.list.push(Cluster {
            node,
            first,
            last: first,
            children: Vec::new(),
            basis: None,
        });
        match tree.nodes[node].children {
            Some(halves) => {
                let children = halves.map(|half| self.gather(tree, half, is_member));
                self.list[own].children = children.into_iter().flatten().collect();
            }
            None => {
                let all = &tree.order[tree.nodes[node].first..tree.nodes[node].last];
                self.sites
                    .extend(all.iter().filter(|&&i| is_member[i as usize]));
            }
        }
        self.list[own].last = self.sites.len();
        if self.sites.len() == first {
            self.list.truncate(own);
            return None;
        }
        Some(own)
    }

    /// Candidates for the skeleton of a cluster, in this order.
    fn candidates(&self, cluster: usize) -> Option<Vec<u32>> {
        let cluster = &self.list[cluster];
        if cluster.children.is_empty() {
            return Some(self.sites[cluster.first..cluster.last].to_vec());
        }
        let chosen = |&child: &usize| Some(&self.list[child].basis.as_ref()?.chosen);
        let lists: Option<Vec<&Vec<u32>>> = cluster.children.iter().map(chosen).collect();
        Some(lists?.into_iter().flatten().copied().collect())
    }

    fn basis(
        &self,
        hierarchy: &Hierarchy,
        cluster: usize,
        ground: SkinResponse<'_>,
    ) -> Option<Basis> {
        let candidates = self.candidates(cluster)?;
        let node = &hierarchy.tree.nodes[self.list[cluster].node];
        let seen = seen_from(hierarchy, node, ground);
        if seen.is_empty() {
            return None;
        }
        let listed = SiteList::new(&seen, ground.sites);
        let mut block = vec![0.0f32; candidates.len() * seen.len()];
        hierarchy.block(ground, &candidates, &listed, &mut block);
        let mut block: Vec<f64> = block.into_iter().map(f64::from).collect();
        let found = skeleton(&mut block, seen.len(), TOLERANCE);
        Some(Basis {
            chosen: found.chosen.iter().map(|&k| candidates[k]).collect(),
            // Rounding is far below the tolerance.
            transfer: found.transfer.iter().map(|share| *share as f32).collect(),
        })
    }
}

/// Sites that stand for all that is far from a cluster, and in its range.
fn seen_from(hierarchy: &Hierarchy, from: &Node, ground: SkinResponse<'_>) -> Vec<u32> {
    let tree = &hierarchy.tree;
    let least = (1.0 + SEPARATION) * from.radius;
    let place = |site: u32| ground.sites.rest[site as usize].position;
    let away = |p: Vec3| (p - from.center).norm();
    let (mut seen, mut open) = (Vec::new(), vec![0]);
    while let Some(next) = open.pop() {
        let node = &tree.nodes[next];
        let distance = away(node.center);
        if distance + node.radius < least || hierarchy.is_out_of_range(node, from) {
            continue;
        }
        let is_far = distance - node.radius >= least;
        let members = &tree.order[node.first..node.last];
        match node.children {
            Some([low, high]) if !is_far || node.radius > LOOKS_SMALL * distance => {
                open.extend([high, low]);
            }
            _ => {
                let count = if distance < NEAR * least {
                    SEEN.0
                } else {
                    SEEN.1
                };
                let at = |k: usize| members[(2 * k + 1) * members.len() / (2 * count)];
                let some = (0..count.min(members.len())).map(at);
                seen.extend(some.filter(|&i| away(place(i)) >= least));
            }
        }
    }
    seen
}
