//! What stands for the inverse of a zone's compliance in conjugate gradients: sites of a smallest cluster answer each other exactly.
//!
//! Block Jacobi. A finer skin has smaller clusters, yet what stiffens fastest with the fineness lies within them.

use nalgebra::DMatrix;
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
    /// Its part of the clusters' sites.
    first: usize,
    last: usize,
    /// Row by row, mm.
    values: Vec<f32>,
}

impl Inverses {
    /// From the blocks of clusters with themselves.
    pub fn new(near: &Blocks, clusters: &[Cluster]) -> Inverses {
        let pairs = near.pairs.par_iter().enumerate();
        let own = pairs.filter(|(_, pair)| pair.a == pair.b);
        let inverses = own.map(|(number, pair)| {
            let (first, last) = (clusters[pair.a].first, clusters[pair.a].last);
            let values = inverse(near.block(number), last - first);
            Inverse {
                first,
                last,
                values,
            }
        });
        Inverses(inverses.collect())
    }
}

/// The inverse of a symmetric block; of its diagonal, where rounding has left it indefinite.
fn inverse(block: &[f32], columns: usize) -> Vec<f32> {
    let values = block.iter().map(|v| f64::from(*v));
    let matrix = DMatrix::from_iterator(columns, columns, values);
    let diagonal = matrix.diagonal();
    let inverse = match matrix.cholesky() {
        Some(factor) => factor.inverse(),
        None => DMatrix::from_diagonal(&diagonal.map(|k| 1.0 / k)),
    };
    inverse.iter().map(|v| *v as f32).collect()
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
            let mut places = coupled.place[inverse.first..inverse.last].iter();
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
        let (mut loads, mut found) = (Vec::new(), Vec::new());
        for inverse in &self.inverses {
            let places = &self.coupled.place[inverse.first..inverse.last];
            loads.clear();
            loads.extend(places.iter().map(|&k| all[k as usize]));
            found.resize(loads.len(), 0.0);
            multiply(&inverse.values, &loads, &mut found);
            for (&k, found) in places.iter().zip(&found) {
                all[k as usize] = *found;
            }
        }
        for ((&i, out), per) in self.set.iter().zip(out).zip(&self.per_length) {
            *out = all[i as usize] * per;
        }
    }
}

/// A square matrix (row by row) times `x`.
#[multiversion::multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2"))]
fn multiply(matrix: &[f32], x: &[f64], out: &mut [f64]) {
    let (x8, x_rest) = x.as_chunks::<8>();
    for (row, out) in matrix.chunks_exact(x.len()).zip(out) {
        let (row8, row_rest) = row.as_chunks::<8>();
        let mut sums = [0.0; 8];
        for (a, b) in row8.iter().zip(x8) {
            for lane in 0..8 {
                sums[lane] += f64::from(a[lane]) * b[lane];
            }
        }
        let rest = row_rest.iter().zip(x_rest);
        let tail: f64 = rest.map(|(a, b)| f64::from(*a) * b).sum();
        *out = sums.iter().sum::<f64>() + tail;
    }
}
