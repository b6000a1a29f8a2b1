//! The near-field compliance along press directions, for the solver of a live press.

use super::NearField;
use crate::solve::{Compliance, Submatrix, Symmetric};

/// The near compliance along directions, `A_ij = w_i w_j K_ij t_i.t_j`, mm/N: entries with the cosines in them, weights outside.
pub struct DirectionalNearField<'a> {
    near: &'a NearField,
    entries: &'a [i16],
    weight: &'a [f64],
    diagonal: Vec<f64>,
}

impl<'a> DirectionalNearField<'a> {
    /// Of `near`, with the `entries` that [`NearField::turn`] gave, and `weight` by unknown.
    pub fn new(near: &'a NearField, entries: &'a [i16], weight: &'a [f64]) -> Self {
        let diagonal = weight.iter().zip(&near.own).map(|(w, own)| own * w * w);
        DirectionalNearField {
            near,
            entries,
            weight,
            diagonal: diagonal.collect(),
        }
    }
}

impl DirectionalNearField<'_> {
    /// Some rows (ascending) times `x`, each written to the same place of `out`.
    fn multiply(&self, rows: &[u32], x: &[f64], out: &mut [f64]) {
        let weighted = |(x, w): (&f64, &f64)| (x * w) as f32;
        let weighted: Vec<f32> = x.iter().zip(self.weight).map(weighted).collect();
        self.near.multiply(self.entries, rows, &weighted, out);
        for (&i, out) in rows.iter().zip(out) {
            *out *= self.weight[i as usize];
        }
    }
}

impl Symmetric for DirectionalNearField<'_> {
    fn diagonal(&self) -> &[f64] {
        &self.diagonal
    }

    fn times(&self, x: &[f64], out: &mut [f64]) {
        self.multiply(&self.near.all(), x, out);
    }
}

impl Compliance for DirectionalNearField<'_> {
    fn times_rows(&self, rows: &[u32], x: &[f64], out: &mut [f64]) {
        self.multiply(rows, x, out);
    }

    /// Gershgorin's.
    fn norm_bound(&self) -> f64 {
        let mut sums = vec![0.0; self.weight.len()];
        let entries: Vec<i16> = self.entries.iter().map(|entry| entry.abs()).collect();
        let weight: Vec<f32> = self.weight.iter().map(|w| *w as f32).collect();
        self.near
            .multiply(&entries, &self.near.all(), &weight, &mut sums);
        let rows = sums.iter().zip(self.weight).map(|(sum, w)| sum * w);
        rows.fold(f64::MIN_POSITIVE, f64::max)
    }

    fn submatrix(&self, set: &[u32], _is_rough: bool) -> Submatrix<'_> {
        let of_set = OfSet {
            all: self,
            set: set.to_vec(),
        };
        Submatrix::in_place(self.weight.len(), set, Box::new(of_set))
    }

    fn is_narrow(&self, _is_rough: bool) -> bool {
        false
    }
}

/// The same for some unknowns alone: elsewhere products are zero.
struct OfSet<'a> {
    all: &'a DirectionalNearField<'a>,
    set: Vec<u32>,
}

impl Symmetric for OfSet<'_> {
    fn diagonal(&self) -> &[f64] {
        &self.all.diagonal
    }

    fn times(&self, x: &[f64], out: &mut [f64]) {
        let mut image = vec![0.0; self.set.len()];
        self.all.multiply(&self.set, x, &mut image);
        out.fill(0.0);
        for (&i, image) in self.set.iter().zip(image) {
            out[i as usize] = image;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::response::assembly::coupling;
    use crate::response::test_sheet::{loads, most_off, near, sheet};
    use crate::solve::row_runs::RowRuns;
    use crate::solve::{Axes, DirectionalCompliance, Part};
    use thenar_surface::Vec3;

    #[test]
    fn without_a_range_products_are_those_of_the_whole_coupling() {
        let (skin, workspace, zone) = sheet();
        let ground = (&skin, &workspace.quantized);
        let (near, loads) = (near(ground, &zone, f64::INFINITY), loads(zone.len()));
        let mut whole = RowRuns::new();
        coupling((&skin.response, &skin.sites), &zone, &mut whole);
        let mut wanted = vec![0.0; zone.len()];
        let directions: Vec<Vec3> = loads.iter().map(Vec3::normalize).collect();
        let weight: Vec<f64> = (0..zone.len())
            .map(|k| 1.0 + 0.1 * (k % 7) as f64)
            .collect();
        let (axes, part, likely) = (
            Axes::new(&directions),
            Part::default(),
            vec![true; zone.len()],
        );
        let entries = near.turn(&axes);
        let ours = DirectionalNearField::new(&near, &entries, &weight);
        let theirs = DirectionalCompliance::new((&whole, &axes), (&weight, &likely), &part);
        let x: Vec<f64> = (0..zone.len()).map(|k| (0.3 * k as f64).cos()).collect();
        let mut product = vec![0.0; zone.len()];
        ours.times(&x, &mut product);
        theirs.times(&x, &mut wanted);
        // Entries are rounded once more when they are turned.
        let most = 2.0 * 1.6 * 1.6 * most_off(&near, &x);
        for (ours, wanted) in product.iter().zip(&wanted) {
            assert!((ours - wanted).abs() < most, "{ours} {wanted}");
        }
        let largest = wanted.iter().fold(0.0, |m, x| f64::max(m, x.abs()));
        assert!(most < 5e-3 * largest, "{most} of {largest}");
        let set: Vec<u32> = (0..zone.len() as u32).filter(|k| k % 5 > 1).collect();
        let mut some = vec![f64::NAN; zone.len()];
        let kept = ours.submatrix(&set, true);
        kept.matrix.times(&x, &mut some);
        assert!(kept.holds(&set) && !kept.holds(&[0]));
        for (k, (some, all)) in some.iter().zip(&product).enumerate() {
            let wanted = if k % 5 > 1 { *all } else { 0.0 };
            assert_eq!(*some, wanted, "{k}");
        }
        for (ours, wanted) in ours.diagonal().iter().zip(theirs.diagonal()) {
            assert!((ours / wanted - 1.0).abs() < 1e-6, "{ours} {wanted}");
        }
    }
}
