//! The product of a zone's coupling with fields over the zone.

use rayon::prelude::*;

use super::blocks::{Fields, add_product, add_transposed, part, part_mut, zeros};
use super::clusters::Clusters;
use super::coupled::{Blocks, Coupled};

impl Coupled {
    /// `K` times three fields over the zone, at every site whose cluster holds a place where `is_active`; zero elsewhere.
    ///
    /// `x` must be zero where it is not active. The same bits for any number of threads.
    pub fn times(&self, x: &Fields, is_active: &[bool]) -> Fields {
        let loads = self.gathered(x);
        let awake = self.awake(is_active);
        let up = raise(&self.clusters, &self.offset, &loads);
        let mut local = self.exchange(&up, &awake);
        self.lower(&mut local, &awake);
        let leaves: Vec<usize> = (0..awake.len())
            .filter(|&c| awake[c] && self.clusters.list[c].children.is_empty())
            .collect();
        let found: Vec<Fields> = leaves
            .par_iter()
            .with_min_len(4)
            .map(|&leaf| self.at_leaf(leaf, (&loads, &local), &awake))
            .collect();
        let mut out = zeros(self.len());
        for (&leaf, found) in leaves.iter().zip(&found) {
            let cluster = &self.clusters.list[leaf];
            for (k, &place) in self.place[cluster.first..cluster.last].iter().enumerate() {
                for axis in 0..3 {
                    out[axis][place as usize] = found[axis][k];
                }
            }
        }
        out
    }

    /// Fields over the zone in the order of the clusters.
    fn gathered(&self, x: &Fields) -> Fields {
        let gather = |axis: usize| self.place.iter().map(|&k| x[axis][k as usize]).collect();
        [0, 1, 2].map(gather)
    }

    fn awake(&self, is_active: &[bool]) -> Vec<bool> {
        let holds = |&k: &u32| is_active[k as usize];
        let list = self.clusters.list.iter();
        list.map(|c| self.place[c.first..c.last].iter().any(holds))
            .collect()
    }

    /// What the chosen sites of every cluster get from those of clusters far from it.
    fn exchange(&self, up: &Fields, awake: &[bool]) -> Fields {
        let of = |c: usize| (self.offset[c], self.offset[c + 1]);
        let found: Vec<Fields> = (0..awake.len())
            .into_par_iter()
            .with_min_len(16)
            .map(|c| {
                let (first, last) = of(c);
                let mut out = zeros(if awake[c] { last - first } else { 0 });
                if awake[c] {
                    self.far.add(c, (awake, |c| part(up, of(c))), &mut out);
                }
                out
            })
            .collect();
        let mut local = zeros(up[0].len());
        for (c, found) in found.iter().enumerate().filter(|(c, _)| awake[*c]) {
            for (axis, to) in part_mut(&mut local, of(c)).into_iter().enumerate() {
                to.copy_from_slice(&found[axis]);
            }
        }
        local
    }

    /// Hands on to the halves what a cluster's chosen sites get.
    fn lower(&self, local: &mut Fields, awake: &[bool]) {
        for (c, cluster) in self.clusters.list.iter().enumerate() {
            let Some(basis) = cluster.basis.as_ref().filter(|_| awake[c]) else {
                continue;
            };
            let (first, rank) = (self.offset[c], basis.chosen.len());
            let mut row = 0;
            for &child in &cluster.children {
                for to in self.offset[child]..self.offset[child + 1] {
                    let shares = &basis.transfer[row * rank..(row + 1) * rank];
                    for axis in local.iter_mut() {
                        let terms = shares.iter().zip(&axis[first..first + rank]);
                        let sum: f64 = terms.map(|(s, v)| s * v).sum();
                        axis[to] += sum;
                    }
                    row += 1;
                }
            }
        }
    }

    fn at_leaf(&self, leaf: usize, (loads, local): (&Fields, &Fields), awake: &[bool]) -> Fields {
        let list = &self.clusters.list;
        let cluster = &list[leaf];
        let mut out = zeros(cluster.last - cluster.first);
        if let Some(basis) = &cluster.basis {
            let rank = basis.chosen.len();
            let seen = part(local, (self.offset[leaf], self.offset[leaf + 1]));
            for (k, shares) in basis.transfer.chunks(rank.max(1)).enumerate() {
                for axis in 0..3 {
                    out[axis][k] = shares.iter().zip(seen[axis]).map(|(s, v)| s * v).sum();
                }
            }
        }
        let of = |c: usize| part(loads, (list[c].first, list[c].last));
        self.near.add(leaf, (awake, of), &mut out);
        out
    }
}

impl Blocks {
    /// Adds a cluster's blocks times what the other cluster of each bears.
    fn add<'a>(
        &self,
        cluster: usize,
        (awake, of): (&[bool], impl Fn(usize) -> [&'a [f64]; 3]),
        out: &mut Fields,
    ) {
        for &(number, is_second) in &self.of[cluster] {
            let pair = self.pairs[number as usize];
            let other = if is_second { pair.a } else { pair.b };
            if !awake[other] {
                continue;
            }
            let block = self.block(number as usize);
            let out = out.each_mut().map(|axis| &mut axis[..]);
            if is_second {
                add_transposed(block, of(other), out);
            } else {
                add_product(block, of(other), out);
            }
        }
    }
}

/// What the chosen sites of every cluster bear in place of its members' `loads` (in the clusters' order).
pub fn raise(clusters: &Clusters, offset: &[usize], loads: &Fields) -> Fields {
    let mut up = zeros(offset[offset.len() - 1]);
    for (c, cluster) in clusters.list.iter().enumerate().rev() {
        let Some(basis) = &cluster.basis else {
            continue;
        };
        let (first, rank) = (offset[c], basis.chosen.len());
        let own = cluster.first..cluster.last;
        let from = cluster
            .children
            .iter()
            .flat_map(|&child| offset[child]..offset[child + 1]);
        for axis in 0..3 {
            let mut sum = vec![0.0; rank];
            let mut add = |row: usize, load: f64| {
                let shares = &basis.transfer[row * rank..(row + 1) * rank];
                sum.iter_mut()
                    .zip(shares)
                    .for_each(|(s, share)| *s += share * load);
            };
            if cluster.children.is_empty() {
                own.clone()
                    .enumerate()
                    .for_each(|(row, k)| add(row, loads[axis][k]));
            } else {
                from.clone()
                    .enumerate()
                    .for_each(|(row, k)| add(row, up[axis][k]));
            }
            up[axis][first..first + rank].copy_from_slice(&sum);
        }
    }
    up
}
