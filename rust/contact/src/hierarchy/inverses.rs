//! What stands for the inverse of a zone's compliance in conjugate gradients: sites of a smallest cluster answer each other exactly.
//!
//! Block Jacobi. A finer skin has smaller clusters, yet what stiffens fastest with the fineness lies within them.

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;
use thenar_surface::Vec3;

use super::clusters::Cluster;
use super::coupled::{Blocks, Coupled};
use crate::solve::Preconditioner;

/// Inverses of the response within the smallest clusters of a zone.
#[derive(Debug, Clone, Default)]
pub struct Inverses(Vec<Inverse>);

/// That of one cluster.
#[derive(Debug, Clone)]
struct Inverse {
    /// The first of the clusters' sites that are its own.
    first: usize,
    /// mm.
    matrix: DMatrix<f64>,
}

impl Inverse {
    /// Its part of what is listed by the clusters' sites.
    fn part<'a, T>(&self, all: &'a [T]) -> &'a [T] {
        &all[self.first..self.first + self.matrix.nrows()]
    }
}

impl Inverses {
    /// From the blocks of clusters with themselves.
    pub fn new(near: &Blocks, clusters: &[Cluster]) -> Inverses {
        let pairs = near.pairs.par_iter().enumerate();
        let own = pairs.filter(|(_, pair)| pair.a == pair.b);
        let inverses = own.map(|(number, pair)| {
            let (first, last) = (clusters[pair.a].first, clusters[pair.a].last);
            Inverse {
                first,
                matrix: inverse(near.block(number), last - first),
            }
        });
        Inverses(inverses.collect())
    }

    /// Number of entries.
    #[cfg(test)]
    pub fn entries(&self) -> usize {
        self.0.iter().map(|inverse| inverse.matrix.len()).sum()
    }
}

/// The inverse of a symmetric block; of its diagonal, where rounding has left it indefinite.
fn inverse(block: &[f32], columns: usize) -> DMatrix<f64> {
    let values = block.iter().map(|v| f64::from(*v));
    let matrix = DMatrix::from_iterator(columns, columns, values);
    let diagonal = matrix.diagonal();
    match matrix.cholesky() {
        Some(factor) => factor.inverse(),
        None => DMatrix::from_diagonal(&diagonal.map(|k| 1.0 / k)),
    }
}

/// The approximate inverse of `A_ij = K_ij v_i . v_j` on a set: directions hardly differ within a cluster, lengths may.
pub struct OnSet<'a> {
    coupled: &'a Coupled,
    /// Places in the zone.
    set: &'a [u32],
    /// Clusters that hold some of the set.
    inverses: Vec<&'a Inverse>,
    /// `1 / |v|` at the places of the set, N/mm^2.
    per_length: Vec<f64>,
}

impl<'a> OnSet<'a> {
    /// For the unknowns of `set`, vectors `along` the whole zone.
    pub fn new(coupled: &'a Coupled, along: &[Vec3], set: &'a [u32]) -> Self {
        let mut is_in = vec![false; coupled.len()];
        set.iter().for_each(|&i| is_in[i as usize] = true);
        let holds = |inverse: &&Inverse| {
            let mut places = inverse.part(&coupled.place).iter();
            places.any(|&k| is_in[k as usize])
        };
        let per_length = set.iter().map(|&i| 1.0 / along[i as usize].norm());
        OnSet {
            coupled,
            set,
            inverses: coupled.inverses.0.iter().filter(holds).collect(),
            per_length: per_length.collect(),
        }
    }
}

impl Preconditioner for OnSet<'_> {
    fn apply(&self, residual: &[f64], out: &mut [f64]) {
        let mut all = vec![0.0; self.coupled.len()];
        for ((&i, r), per) in self.set.iter().zip(residual).zip(&self.per_length) {
            all[i as usize] = r * per;
        }
        // A cluster reads and writes its own places alone.
        for inverse in &self.inverses {
            let places = inverse.part(&self.coupled.place);
            let loads = places.iter().map(|&k| all[k as usize]);
            let found = &inverse.matrix * DVector::from_iterator(places.len(), loads);
            for (&k, found) in places.iter().zip(&found) {
                all[k as usize] = *found;
            }
        }
        for ((&i, out), per) in self.set.iter().zip(out).zip(&self.per_length) {
            *out = all[i as usize] * per;
        }
    }
}
