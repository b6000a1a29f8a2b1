//! The preconditioner of large zones: a sparse approximate inverse (FSAI), one block of rows per leaf cluster.
//!
//! A sparse factor `G` with `G' G` near the inverse (Kolotilina & Yeremin 1993). The rows of a cluster are those that the exact factor
//! has if only the nearest sites of earlier clusters are in the way (Vecchia 1988; Schaefer, Katzfuss & Owhadi 2021): what lies farther
//! off is screened by them.

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;
use thenar_surface::Vec3;

use super::blocks::Blocks;
use super::cluster_bases::Clusters;
use super::hierarchy::{Hierarchy, SiteList, SkinResponse};
use crate::ContactError;

/// Clusters whose rows are made between two looks at the caller's wish to stop.
const AT_ONCE: usize = 256;
/// Sites of earlier clusters that a cluster's rows see. 64 and 128 serve.
const BESIDE: usize = 64;

/// The factor of a zone, by its smallest clusters.
#[derive(Debug, Clone, Default)]
pub struct SparseInverse(pub(super) Vec<FactorRows>);

/// Rows of one cluster.
#[derive(Debug, Clone)]
pub(super) struct FactorRows {
    /// Places among the clusters' sites: conditioning neighbors, then its own.
    pub columns: Vec<u32>,
    /// How many are its own.
    own: usize,
    /// The rows, transposed, mm^(1/2); empty until they are filled.
    transposed: DMatrix<f64>,
}

impl SparseInverse {
    /// Finds the conditioning neighbors of each cluster; no rows yet.
    pub fn planned(near: &Blocks, clusters: &Clusters, ground: SkinResponse<'_>) -> SparseInverse {
        let mut earlier: Vec<Vec<usize>> = vec![Vec::new(); clusters.list.len()];
        for pair in near.pairs.iter().filter(|pair| pair.a != pair.b) {
            let (a, b) = (pair.a.min(pair.b), pair.a.max(pair.b));
            earlier[b].push(a);
        }
        let smallest = (0..earlier.len()).filter(|&c| clusters.list[c].children.is_empty());
        let rows = smallest.map(|c| FactorRows::planned(c, &mut earlier[c], clusters, ground));
        SparseInverse(rows.collect())
    }

    /// Number of entries.
    pub fn entries(&self) -> usize {
        self.0
            .iter()
            .map(|rows| rows.columns.len() * rows.own)
            .sum()
    }

    /// Number of entries in memory.
    #[cfg(test)]
    pub fn made(&self) -> usize {
        self.0.iter().map(|rows| rows.transposed.len()).sum()
    }

    /// Makes the rows.
    ///
    /// # Errors
    /// That of `watch`, which gets the share that is done.
    pub fn fill(
        &mut self,
        hierarchy: &Hierarchy,
        (clusters, ground): (&Clusters, SkinResponse<'_>),
        watch: impl Fn(f64) -> Result<(), ContactError>,
    ) -> Result<(), ContactError> {
        let (mut done, all) = (0, self.0.len());
        for some in self.0.chunks_mut(AT_ONCE) {
            watch(done as f64 / all as f64)?;
            some.par_iter_mut().for_each(|rows| {
                let sites = rows.columns.iter().map(|&k| clusters.sites[k as usize]);
                let sites: Vec<u32> = sites.collect();
                let mut response = vec![0.0; sites.len() * sites.len()];
                let listed = SiteList::new(&sites, ground.sites);
                hierarchy.block(ground, &sites, &listed, &mut response);
                rows.transposed = last_rows(&response, rows.own);
            });
            done += some.len();
        }
        Ok(())
    }
}

impl FactorRows {
    fn planned(
        cluster: usize,
        earlier: &mut [usize],
        clusters: &Clusters,
        ground: SkinResponse<'_>,
    ) -> FactorRows {
        let members = |c: usize| clusters.list[c].first as u32..clusters.list[c].last as u32;
        let place = |k: u32| ground.sites.rest[clusters.sites[k as usize] as usize].position;
        earlier.sort_unstable();
        let own: Vec<Vec3> = members(cluster).map(place).collect();
        let distance = |k: u32| {
            let from = place(k);
            let all = own.iter().map(|p| (p - from).norm_squared());
            all.fold(f64::INFINITY, f64::min)
        };
        let beside = earlier.iter().flat_map(|&c| members(c));
        let mut beside: Vec<(f64, u32)> = beside.map(|k| (distance(k), k)).collect();
        if beside.len() > BESIDE {
            let order = |a: &(f64, u32), b: &(f64, u32)| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1));
            beside.select_nth_unstable_by(BESIDE - 1, order);
            beside.truncate(BESIDE);
        }
        let mut columns: Vec<u32> = beside.into_iter().map(|b| b.1).collect();
        columns.sort_unstable();
        columns.extend(members(cluster));
        FactorRows {
            columns,
            own: own.len(),
            transposed: DMatrix::default(),
        }
    }

    /// Its part of `G' G` times fields over the clusters' sites, at its columns.
    pub fn times(&self, all: &[f64]) -> DVector<f64> {
        let loads = self.columns.iter().map(|&k| all[k as usize]);
        let loads = DVector::from_iterator(self.columns.len(), loads);
        &self.transposed * self.transposed.tr_mul(&loads)
    }
}

/// The last rows, transposed, of the inverse of a symmetric matrix's lower Cholesky factor; where rounding has left it indefinite, of its
/// diagonal's.
fn last_rows(matrix: &[f32], rows: usize) -> DMatrix<f64> {
    let size = matrix.len().isqrt();
    let values = matrix.iter().map(|v| f64::from(*v));
    // Row by row is column by column, the upper half the lower.
    let matrix = DMatrix::from_iterator(size, size, values);
    let diagonal = matrix.diagonal();
    let mut last = DMatrix::zeros(size, rows);
    last.view_mut((size - rows, 0), (rows, rows))
        .fill_with_identity();
    match matrix.cholesky() {
        Some(factor) => {
            factor.l_dirty().tr_solve_lower_triangular_mut(&mut last);
        }
        None => {
            for k in 0..rows {
                last[(size - rows + k, k)] = 1.0 / diagonal[size - rows + k].sqrt();
            }
        }
    }
    last
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;
    use crate::Control;
    use crate::far_field::tests::{all, skin};
    use crate::far_field::{DirectionalCoupling, ZoneCoupling};
    use crate::solve::Symmetric;

    #[test]
    fn preconditioner_with_all_neighbors_is_the_inverse() {
        let skin = skin(24, [6.0; 3], Vec::new());
        let (ground, none) = (skin.ground(), Control::none());
        let from_corner = |&i: &u32| {
            let place = |i: u32| ground.sites.rest[i as usize].position;
            (place(i) - place(0)).norm()
        };
        let mut zone = all(&skin);
        zone.sort_by(|a, b| from_corner(a).total_cmp(&from_corner(b)));
        zone.truncate(60);
        zone.sort_unstable();
        let coupled = ZoneCoupling::new(&Hierarchy::of(ground), &zone, ground, &none).unwrap();
        let smallest = coupled.clusters.list.iter();
        let smallest = smallest.filter(|c| c.children.is_empty()).count();
        assert!(smallest > 2, "{smallest} clusters");
        // One direction, lengths that differ.
        let along: Vec<Vec3> = (0..zone.len())
            .map(|k| Vec3::new(0.3, -0.2, 0.9).normalize() * (1.0 + 0.1 * (k % 5) as f64))
            .collect();
        let directed = DirectionalCoupling::new(&coupled, &along);
        let right: Vec<f64> = (0..zone.len()).map(|k| (0.7 * k as f64).sin()).collect();
        let (mut x, mut image) = (vec![0.0; zone.len()], vec![0.0; zone.len()]);
        let set: Vec<u32> = (0..zone.len() as u32).collect();
        directed.preconditioner(&set).apply(&right, &mut x);
        directed.times(&x, &mut image);
        for (image, right) in image.iter().zip(&right) {
            assert!((image - right).abs() < 1e-4, "{image} {right}");
        }
    }

    /// A linear map of `n` unknowns, written out.
    fn written(n: usize, map: impl Fn(&[f64], &mut [f64])) -> DMatrix<f64> {
        let mut columns = DMatrix::zeros(n, n);
        for j in 0..n {
            let (mut unit, mut image) = (vec![0.0; n], vec![0.0; n]);
            unit[j] = 1.0;
            map(&unit, &mut image);
            columns.set_column(j, &DVector::from_vec(image));
        }
        (&columns + columns.transpose()) / 2.0
    }

    #[test]
    fn the_preconditioned_compliance_is_near_the_identity_within_a_contact() {
        let skin = skin(26, [6.0; 3], Vec::new());
        let (ground, none) = (skin.ground(), Control::none());
        let zone = all(&skin);
        let coupled = ZoneCoupling::new(&Hierarchy::of(ground), &zone, ground, &none).unwrap();
        let along = vec![Vec3::z(); zone.len()];
        let directed = DirectionalCoupling::new(&coupled, &along);
        // A round contact in the middle of the zone.
        let from_middle = |&k: &u32| ground.sites.rest[zone[k as usize] as usize].position.norm();
        let places = 0..zone.len() as u32;
        let set: Vec<u32> = places.filter(|k| from_middle(k) < 4.5).collect();
        let compliance = written(set.len(), |x, out| {
            let (mut all, mut image) = (vec![0.0; zone.len()], vec![0.0; zone.len()]);
            set.iter().zip(x).for_each(|(&i, x)| all[i as usize] = *x);
            directed.times(&all, &mut image);
            out.iter_mut()
                .zip(&set)
                .for_each(|(out, &i)| *out = image[i as usize]);
        });
        let spread = |map: &DMatrix<f64>| {
            let root = compliance.clone().cholesky().unwrap().l();
            let between = root.transpose() * map * &root;
            let eigenvalues = between.symmetric_eigenvalues();
            eigenvalues.max() / eigenvalues.min()
        };
        let map = directed.preconditioner(&set);
        let found = spread(&written(set.len(), |x, out| map.apply(x, out)));
        let jacobi = spread(&DMatrix::from_diagonal(
            &compliance.diagonal().map(|a| 1.0 / a),
        ));
        assert!(found < 2.0, "{found}");
        assert!(jacobi > 5.0, "{jacobi}: too small a contact to tell");
    }

    #[test]
    fn the_preconditioner_is_symmetric_and_positive_on_any_set() {
        let skin = skin(72, [3.0, 6.0, 11.0], Vec::new());
        let (ground, none) = (skin.ground(), Control::none());
        let zone = all(&skin);
        let coupled = ZoneCoupling::new(&Hierarchy::of(ground), &zone, ground, &none).unwrap();
        let along: Vec<Vec3> = (0..zone.len())
            .map(|k| Vec3::new((0.01 * k as f64).sin(), 0.3, 1.0) * 0.4)
            .collect();
        let directed = DirectionalCoupling::new(&coupled, &along);
        let set: Vec<u32> = (0..zone.len() as u32).filter(|k| k % 11 < 8).collect();
        let map = directed.preconditioner(&set);
        let field =
            |pace: f64| -> Vec<f64> { (0..set.len()).map(|k| (pace * k as f64).sin()).collect() };
        let dot = |a: &[f64], b: &[f64]| -> f64 { a.iter().zip(b).map(|(a, b)| a * b).sum() };
        let (x, y) = (field(0.9), field(2.3));
        let (mut of_x, mut of_y) = (vec![0.0; set.len()], vec![0.0; set.len()]);
        map.apply(&x, &mut of_x);
        map.apply(&y, &mut of_y);
        let size = (dot(&x, &of_x) * dot(&y, &of_y)).sqrt();
        assert!(dot(&x, &of_x) > 0.0 && dot(&y, &of_y) > 0.0);
        assert!((dot(&x, &of_y) - dot(&y, &of_x)).abs() < 1e-5 * size);
    }
}
