//! The compliance of a large zone along its press directions, for the solver, and its preconditioner on a contact set.

use super::block_kernels::zeros;
use super::preconditioner::FactorRows;
use super::zone_coupling::ZoneCoupling;
use crate::solve::{Compliance, Preconditioner, Submatrix, Symmetric};
use nalgebra::DVector;
use rayon::prelude::*;
use thenar_surface::Vec3;

/// Power steps that find the largest eigenvalue, and the factor that makes their result a bound.
const POWER_STEPS: usize = 24;
const MARGIN: f64 = 1.2;

/// `A_ij = K_ij v_i . v_j` (mm/N) for a vector at every site of a zone: response weight times direction.
pub struct DirectionalCoupling<'a> {
    coupled: &'a ZoneCoupling,
    along: &'a [Vec3],
    diagonal: Vec<f64>,
    is_active: Vec<bool>,
}

impl<'a> DirectionalCoupling<'a> {
    /// The compliance along the vectors, in the zone's order.
    pub fn new(coupled: &'a ZoneCoupling, along: &'a [Vec3]) -> Self {
        let own = coupled.own().iter().zip(along);
        DirectionalCoupling {
            coupled,
            along,
            diagonal: own.map(|(k, v)| k * v.norm_squared()).collect(),
            is_active: vec![true; along.len()],
        }
    }
}

impl Symmetric for DirectionalCoupling<'_> {
    fn diagonal(&self) -> &[f64] {
        &self.diagonal
    }

    fn times(&self, x: &[f64], out: &mut [f64]) {
        self.between((&self.is_active, &self.is_active), x, out);
    }

    fn preconditioner(&self, set: &[u32]) -> Box<dyn Preconditioner + '_> {
        Box::new(SetPreconditioner::new(self.coupled, self.along, set))
    }
}

impl DirectionalCoupling<'_> {
    /// The compliance times `x`, which is zero outside `from`, at the places of `to`.
    fn between(&self, (from, to): (&[bool], &[bool]), x: &[f64], out: &mut [f64]) {
        let mut loads = zeros(x.len());
        for (k, (x, along)) in x.iter().zip(self.along).enumerate() {
            for axis in 0..3 {
                loads[axis][k] = along[axis] * x;
            }
        }
        let [a, b, c] = self.coupled.times(&loads, (from, to));
        for (k, (out, along)) in out.iter_mut().zip(self.along).enumerate() {
            *out = along.x * a[k] + along.y * b[k] + along.z * c[k];
        }
    }
}

impl Compliance for DirectionalCoupling<'_> {
    fn times_rows(&self, rows: &[u32], x: &[f64], out: &mut [f64]) {
        let from: Vec<bool> = x.iter().map(|x| *x != 0.0).collect();
        let mut to = vec![false; x.len()];
        rows.iter().for_each(|&i| to[i as usize] = true);
        let mut all = vec![0.0; x.len()];
        self.between((&from, &to), x, &mut all);
        for (&i, out) in rows.iter().zip(out) {
            *out = all[i as usize];
        }
    }

    /// By the power method from a fixed start.
    fn norm_bound(&self) -> f64 {
        let n = self.along.len();
        let (mut x, mut image) = (vec![1.0 / (n as f64).sqrt(); n], vec![0.0; n]);
        let mut length = f64::MIN_POSITIVE;
        for _ in 0..POWER_STEPS {
            self.times(&x, &mut image);
            length = image
                .iter()
                .map(|v| v * v)
                .sum::<f64>()
                .sqrt()
                .max(f64::MIN_POSITIVE);
            x.iter_mut().zip(&image).for_each(|(x, v)| *x = v / length);
        }
        MARGIN * length
    }

    fn submatrix(&self, set: &[u32], _is_rough: bool) -> Submatrix<'_> {
        let mut is_active = vec![false; self.along.len()];
        set.iter().for_each(|&i| is_active[i as usize] = true);
        let part = DirectionalCoupling {
            coupled: self.coupled,
            along: self.along,
            diagonal: self.diagonal.clone(),
            is_active,
        };
        Submatrix::in_place(self.along.len(), set, Box::new(part))
    }

    fn is_narrow(&self, _is_rough: bool) -> bool {
        false
    }

    fn is_costly(&self) -> bool {
        true
    }
}

/// The approximate inverse of `A_ij = K_ij v_i . v_j` on a set: directions hardly differ over a cluster, lengths may.
pub struct SetPreconditioner<'a> {
    coupled: &'a ZoneCoupling,
    /// Places of the set's unknowns among the clusters' sites.
    places: Vec<u32>,
    /// Rows that see some of the set.
    rows: Vec<&'a FactorRows>,
    /// `1 / |v|` at the places of the set, N/mm^2.
    per_length: Vec<f64>,
}

impl<'a> SetPreconditioner<'a> {
    /// For the unknowns of `set`, vectors `along` the whole zone.
    pub fn new(coupled: &'a ZoneCoupling, along: &[Vec3], set: &[u32]) -> Self {
        let mut is_in = vec![false; coupled.len()];
        set.iter().for_each(|&i| is_in[i as usize] = true);
        let mut place = vec![0; coupled.len()];
        for (k, &i) in coupled.place.iter().enumerate() {
            place[i as usize] = k as u32;
        }
        let sees = |rows: &&FactorRows| {
            let mut columns = rows.columns.iter();
            columns.any(|&k| is_in[coupled.place[k as usize] as usize])
        };
        SetPreconditioner {
            coupled,
            places: set.iter().map(|&i| place[i as usize]).collect(),
            rows: coupled.sparse_inverse.0.iter().filter(sees).collect(),
            per_length: set
                .iter()
                .map(|&i| 1.0 / along[i as usize].norm())
                .collect(),
        }
    }
}

impl Preconditioner for SetPreconditioner<'_> {
    fn apply(&self, residual: &[f64], out: &mut [f64]) {
        let mut all = vec![0.0; self.coupled.len()];
        for ((&k, r), per) in self.places.iter().zip(residual).zip(&self.per_length) {
            all[k as usize] = r * per;
        }
        let found: Vec<DVector<f64>> = self.rows.par_iter().map(|rows| rows.times(&all)).collect();
        all.fill(0.0);
        // In one order, for any number of threads.
        for (rows, found) in self.rows.iter().zip(&found) {
            for (&k, found) in rows.columns.iter().zip(found) {
                all[k as usize] += found;
            }
        }
        for ((&k, out), per) in self.places.iter().zip(out).zip(&self.per_length) {
            *out = all[k as usize] * per;
        }
    }
}
