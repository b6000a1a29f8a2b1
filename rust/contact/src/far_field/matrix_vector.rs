//! The matrix-vector product of a zone's coupling, for three components at once.

use rayon::prelude::*;

use super::block_kernels::{Fields, add_product, add_transposed, part, part_mut, zeros};
use super::blocks::{Blocks, Strip};
use super::cluster_bases::{Cluster, Clusters};
use super::zone_coupling::ZoneCoupling;

/// Which clusters bear loads, and which are asked what comes of them.
type Awake<'a> = (&'a [bool], &'a [bool]);

impl ZoneCoupling {
    /// `K` times three fields over the zone, at every site whose cluster holds a place that is asked for (`to`); elsewhere
    /// what comes of it is not all.
    ///
    /// `x` must be zero outside `from`. The same bits for any number of threads.
    pub fn times(&self, x: &Fields, (from, to): (&[bool], &[bool])) -> Fields {
        let loads = self.gathered(x);
        let awake = (&*self.awake(from), &*self.awake(to));
        let list = &self.clusters.list;
        let up = raise(&self.clusters, &self.offset, &loads);
        let mut local = zeros(up[0].len());
        let chosen = |c: usize| (self.offset[c], self.offset[c + 1]);
        self.far.add((&up, awake), chosen, &mut local);
        let mut found = zeros(self.len());
        self.lower((&mut local, awake.1), &mut found);
        let members = |c: usize| (list[c].first, list[c].last);
        self.near.add((&loads, awake), members, &mut found);
        let mut out = zeros(self.len());
        for (out, found) in out.iter_mut().zip(&found) {
            for (&k, v) in self.place.iter().zip(found) {
                out[k as usize] = *v;
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

    /// Hands on what a cluster's chosen sites get: to those of its halves, and of the smallest to all members.
    fn lower(&self, (local, awake): (&mut Fields, &[bool]), found: &mut Fields) {
        for (c, cluster) in self.clusters.list.iter().enumerate() {
            let Some(basis) = cluster.basis.as_ref().filter(|_| awake[c]) else {
                continue;
            };
            let own = (self.offset[c], self.offset[c + 1]);
            if cluster.children.is_empty() {
                let out = part_mut(found, (cluster.first, cluster.last));
                add_product(&basis.transfer, part(local, own), out);
                continue;
            }
            for ((first, last), shares) in halves(cluster, &self.offset) {
                // A cluster's sites come before those of its halves.
                let [x, y, z] = local.each_mut().map(|axis| axis.split_at_mut(first));
                let from = [&*x.0, &*y.0, &*z.0].map(|axis| &axis[own.0..own.1]);
                let to = [x.1, y.1, z.1].map(|axis| &mut axis[..last - first]);
                add_product(shares, from, to);
            }
        }
    }
}

impl Blocks {
    /// Adds the blocks times `x` to `out`, from and to clusters that are awake for it; `range`: where each cluster is in them.
    fn add(
        &self,
        (x, awake): (&Fields, Awake),
        range: impl Fn(usize) -> (usize, usize) + Sync,
        out: &mut Fields,
    ) {
        // Strips are the same for any number of threads, and so is the order in which they are added up.
        let many = 2 * rayon::current_num_threads();
        for strips in self.strips.chunks(many) {
            let found: Vec<Fields> = strips
                .par_iter()
                .map(|strip| self.times_strip(strip, (x, awake), &range))
                .collect();
            for (strip, found) in strips.iter().zip(&found) {
                for &(cluster, first) in &strip.touched {
                    let own = range(cluster as usize);
                    let from = (first as usize, first as usize + own.1 - own.0);
                    let to = part_mut(out, own).into_iter().zip(part(found, from));
                    to.for_each(|(to, from)| to.iter_mut().zip(from).for_each(|(to, v)| *to += v));
                }
            }
        }
    }

    /// A strip's blocks times `x`, at the clusters that it touches.
    fn times_strip(
        &self,
        strip: &Strip,
        (x, (from, to)): (&Fields, Awake),
        range: impl Fn(usize) -> (usize, usize),
    ) -> Fields {
        let mut out = zeros(strip.length);
        for number in strip.pairs.clone() {
            let pair = self.pairs[number];
            let (is_read, is_read_back) = (from[pair.b] && to[pair.a], from[pair.a] && to[pair.b]);
            if !(is_read || is_read_back) {
                continue;
            }
            let (a, b) = (range(pair.a), range(pair.b));
            let place = |first: u32, (start, end)| (first as usize, first as usize + end - start);
            let block = self.block(number);
            if is_read {
                add_product(block, part(x, b), part_mut(&mut out, place(pair.to_a, a)));
            }
            if pair.a != pair.b && is_read_back {
                // The block is in the cache still.
                add_transposed(block, part(x, a), part_mut(&mut out, place(pair.to_b, b)));
            }
        }
        out
    }
}

/// Where the chosen sites of a cluster's halves are, and the shares of its own in them.
fn halves<'a>(
    cluster: &'a Cluster,
    offset: &'a [usize],
) -> impl Iterator<Item = ((usize, usize), &'a [f32])> {
    let basis = cluster.basis.as_ref();
    let mut rest = basis.map_or(&[][..], |basis| &basis.transfer);
    let rank = basis.map_or(0, |basis| basis.chosen.len());
    cluster.children.iter().map(move |&half| {
        let (first, last) = (offset[half], offset[half + 1]);
        let (shares, others) = rest.split_at((last - first) * rank);
        rest = others;
        ((first, last), shares)
    })
}

/// What the chosen sites of every cluster bear in place of its members' `loads` (in the clusters' order).
pub fn raise(clusters: &Clusters, offset: &[usize], loads: &Fields) -> Fields {
    let mut up = zeros(offset[offset.len() - 1]);
    for (c, cluster) in clusters.list.iter().enumerate().rev() {
        let Some(basis) = &cluster.basis else {
            continue;
        };
        let own = (offset[c], offset[c + 1]);
        if cluster.children.is_empty() {
            let loads = part(loads, (cluster.first, cluster.last));
            add_transposed(&basis.transfer, loads, part_mut(&mut up, own));
            continue;
        }
        for ((first, last), shares) in halves(cluster, offset) {
            let [x, y, z] = up.each_mut().map(|axis| axis.split_at_mut(first));
            let to = [x.0, y.0, z.0].map(|axis| &mut axis[own.0..own.1]);
            let from = [&*x.1, &*y.1, &*z.1].map(|axis| &axis[..last - first]);
            add_transposed(shares, from, to);
        }
    }
    up
}
