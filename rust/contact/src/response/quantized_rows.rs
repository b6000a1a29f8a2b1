//! Response rows quantized to int16 for Live; row reads are the bottleneck, and these are half as long.
//!
//! The rounding error of an entry is 1/64000 of the largest of its row; diagonal entries are stored separately in full.

use multiversion::target::target_cfg_f;
use thenar_surface::Vec3;

use super::assembly::{Load, own_offset};
use super::rows::Response;
use crate::skin::sites::Sites;

/// The largest entry of a row as a whole number.
const MOST: f32 = 32_000.0;
/// Rows that are summed at once.
const AT_ONCE: usize = 4;

/// A row, laid out as [`Response::near`] says; empty until it is made.
#[derive(Debug, Clone, Default)]
pub struct Row {
    /// Entries over `unit`; zero where the site meets itself.
    pub entries: Box<[i16]>,
    /// What one of an entry is worth, 1/mm.
    pub unit: f32,
    /// The entry where the site meets itself, 1/mm: some times larger than any other.
    pub own: f32,
}

/// Rows that were needed so far.
#[derive(Debug, Clone, Default)]
pub struct QuantizedRows {
    rows: Vec<Row>,
}

impl QuantizedRows {
    /// Makes the rows of `wanted` that are missing, of those of the response.
    pub fn make(
        &mut self,
        wanted: impl Iterator<Item = u32>,
        (response, sites): (&Response, &Sites),
    ) {
        self.rows.resize(sites.len(), Row::default());
        for site in wanted {
            let row = &mut self.rows[site as usize];
            if row.entries.is_empty() {
                let patch = sites.patch[site as usize];
                let own = own_offset(response, patch) + site - sites.patch_range[patch as usize].0;
                *row = Row::new(response.row(site, sites), own as usize);
            }
        }
    }

    /// The row of a site, which was made.
    pub fn row(&self, site: u32) -> &Row {
        &self.rows[site as usize]
    }

    /// What [`displacements`](super::assembly::displacements) are by these rows.
    pub fn displacements(
        &self,
        (response, sites): (&Response, &Sites),
        loads: &[Load],
    ) -> Vec<Vec3> {
        let mut field = [(); 3].map(|()| vec![0.0f32; sites.len()]);
        let patch = |load: &Load| sites.patch[load.site as usize];
        let range = |patch: u32| sites.patch_range[patch as usize];
        // Summed along whole rows, so that loops are long, and then put where the sites of the row are.
        let mut sums: [Vec<f32>; 3] = Default::default();
        for loads in loads.chunk_by(|a, b| patch(a) == patch(b)) {
            self.sum_rows(loads, &mut sums);
            let near = response.near(patch(&loads[0]));
            // Patches that follow one another are one piece.
            for piece in near.chunk_by(|a, b| range(a.0).1 == range(b.0).0) {
                let (first, last) = (piece[0], piece[piece.len() - 1]);
                let there = range(first.0).0 as usize..range(last.0).1 as usize;
                let along = first.1 as usize..first.1 as usize + there.len();
                for (field, sums) in field.iter_mut().zip(&sums) {
                    let pairs = field[there.clone()].iter_mut().zip(&sums[along.clone()]);
                    pairs.for_each(|(field, sum)| *field += sum);
                }
            }
        }
        let [x, y, z] = field;
        let all = x.into_iter().zip(y).zip(z);
        let mut field: Vec<Vec3> = all
            .map(|((x, y), z)| Vec3::new(f64::from(x), f64::from(y), f64::from(z)))
            .collect();
        for load in loads {
            field[load.site as usize] += load.load * f64::from(self.row(load.site).own);
        }
        field
    }

    /// Writes the sum of rows of one patch, each times its load, to `sums`, by axis.
    fn sum_rows(&self, loads: &[Load], sums: &mut [Vec<f32>; 3]) {
        let length = self.row(loads[0].site).entries.len();
        for axis in &mut *sums {
            axis.clear();
            axis.resize(length, 0.0);
        }
        for some in loads.chunks(AT_ONCE) {
            // Where there are fewer, the first stands in with no load.
            let of = |k: usize| some.get(k).unwrap_or(&some[0]);
            let rows = std::array::from_fn(|k| self.row(of(k).site));
            let weight = |axis: usize, k: usize| {
                let load = some.get(k).map_or(0.0, |load| load.load[axis]);
                load as f32 * rows[k].unit
            };
            let weights = [0, 1, 2].map(|axis| std::array::from_fn(|k| weight(axis, k)));
            let [x, y, z] = sums;
            add_rows(rows.map(|row| &*row.entries), weights, [x, y, z]);
        }
    }
}

/// Adds rows, each times its weights, to the sums of three axes.
#[multiversion::multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2+fma"))]
fn add_rows(rows: [&[i16]; AT_ONCE], weights: [[f32; AT_ONCE]; 3], [x, y, z]: [&mut [f32]; 3]) {
    const IS_FUSED: bool = target_cfg_f!(any(target_feature = "fma", target_feature = "avx512f"));
    let length = x.len();
    let rows = rows.map(|row| &row[..length]);
    let (y, z) = (&mut y[..length], &mut z[..length]);
    for i in 0..length {
        // Sums of their own: the compiler cannot know that what is written to one axis does not change another.
        let mut sums = [x[i], y[i], z[i]];
        for k in 0..AT_ONCE {
            let entry = f32::from(rows[k][i]);
            for axis in 0..3 {
                sums[axis] = plus::<IS_FUSED>(sums[axis], entry, weights[axis][k]);
            }
        }
        [x[i], y[i], z[i]] = sums;
    }
}

/// `sum` and a product, rounded once where the processor does both at once: elsewhere that would take a call.
#[inline(always)]
pub(super) fn plus<const IS_FUSED: bool>(sum: f32, a: f32, b: f32) -> f32 {
    match IS_FUSED {
        true => a.mul_add(b, sum),
        false => sum + a * b,
    }
}

impl Row {
    /// A row with the site itself at the place `own`.
    fn new(row: &[f32], own: usize) -> Self {
        let others = row.iter().enumerate().filter(|(k, _)| *k != own);
        let most = others.fold(0.0, |most, (_, entry)| f32::max(most, entry.abs()));
        let unit = most.max(1e-30) / MOST;
        let mut entries: Box<[i16]> = row.iter().map(|entry| rounded(entry / unit)).collect();
        entries[own] = 0;
        Row {
            entries,
            unit,
            own: row[own],
        }
    }
}

/// The whole number nearest to `value`, of less than 2^15: the last bits of its sum with 1.5 times 2^23.
#[inline(always)]
pub fn rounded(value: f32) -> i16 {
    (value + 12_582_912.0).to_bits() as i16
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::response::assembly::displacements;
    use crate::response::test_sheet::sheet;

    #[test]
    fn a_product_is_added_on_every_processor() {
        assert_eq!(plus::<true>(0.5, 3.0, -2.0), -5.5);
        assert_eq!(plus::<false>(0.5, 3.0, -2.0), -5.5);
        // The square of 1 + 2^-12 has a last bit that a product alone would lose.
        let x = 1.0 + 2.0f32.powi(-12);
        assert_eq!(plus::<true>(-x, x, x), 2.0f32.powi(-12) + 2.0f32.powi(-24));
    }

    #[test]
    fn numbers_are_rounded_to_the_nearest() {
        for k in -320..=320 {
            let value = k as f32 * 99.83;
            assert_eq!(
                i32::from(rounded(value)),
                value.round_ties_even() as i32,
                "{value}"
            );
        }
    }

    #[test]
    fn fields_are_those_of_the_rows_but_for_the_rounding_of_entries() {
        let (skin, _, pressed) = sheet();
        let ground = (&*skin.response, &*skin.sites);
        let mut rows = QuantizedRows::default();
        rows.make(pressed.iter().copied(), ground);
        let load = |&site: &u32| {
            let site_f64 = f64::from(site);
            Load {
                site,
                load: Vec3::new(site_f64.sin(), (0.3 * site_f64).cos(), 1.0),
            }
        };
        let loads: Vec<Load> = pressed.iter().map(load).collect();
        let ours = rows.displacements(ground, &loads);
        let wanted = displacements(&skin.response, &loads, &skin.sites);
        // Three and a half times the deviation that rounding every entry makes.
        let errors = loads.iter().map(|load| {
            let unit = f64::from(rows.row(load.site).unit);
            (unit * load.load.norm()).powi(2)
        });
        let most_off = errors.sum::<f64>().sqrt();
        let most = wanted.iter().map(Vec3::norm).fold(0.0, f64::max);
        assert!(most_off < 1e-3 * most, "{most_off} of {most}");
        let off = ours.iter().zip(&wanted).map(|(a, b)| (a - b).norm());
        let off = off.fold(0.0, f64::max);
        assert!(off > 0.0 && off < most_off, "{off} of {most_off}");
    }
}
