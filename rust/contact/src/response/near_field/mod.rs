//! The near field of a live press: the response between nearby patches; farther sites keep their last effect.
//!
//! Bonded skin answers little beyond a few thicknesses, and what it answers there changes little from frame to frame. Columns are
//! all sites of some patches, so that the same serve while other sites of these are solved; rows are made as they are needed. The
//! sites of one patch feel the same others, and products run over their rows without gaps. Entries are those of the rounded rows:
//! reading them is what a product takes, and a press that the eye alone judges needs no more. Each row is rounded by its own
//! largest entry, so that the two entries of a pair agree but for that.

pub mod directional;
mod patch_rows;
mod row_kernels;

use rayon::prelude::*;
use thenar_surface::Vec3;

use crate::response::assembly::{Members, layout};
use crate::response::near_field::patch_rows::{PatchRows, slices};
use crate::response::near_field::row_kernels::{LANES, field_block, multiply_block, turn_row};
use crate::response::quantized_rows::QuantizedRows;
use crate::response::rows::Response;
use crate::skin::sites::Sites;
use crate::solve::Axes;

/// Entries from which products are worth several threads.
const PARALLEL_ENTRIES: usize = 6_000_000;
/// How many times as many sites as the patches of the zone hold may be columns: what was in it may soon be again. From 1 on any
/// serves.
const MOST_COLUMNS: f64 = 1.6;
const MISSING: usize = usize::MAX;

/// `K` (1/mm) between sites whose patches lie within a range of each other; symmetric but for rounding.
#[derive(Debug, Clone, Default)]
pub struct NearField {
    /// The sites that are solved, ascending; the patch and the column of each.
    sites: Vec<u32>,
    patches: Vec<u32>,
    places: Vec<u32>,
    /// What one of an entry is worth, by row, and the entry where the site meets itself, 1/mm.
    pub(super) units: Vec<f64>,
    pub(super) own: Vec<f64>,
    /// How far apart patches may lie, mm.
    range: f64,
    /// The sites of the columns, ascending, and where the row of each begins.
    columns: Vec<u32>,
    begins: Vec<usize>,
    /// By patch.
    homes: Vec<PatchRows>,
    /// Entries of the rows that were made; zero where a site meets itself.
    values: Vec<i16>,
    /// Where the entries of each site's row begin once they are turned, and where those of the last end.
    turned: Vec<usize>,
}

impl NearField {
    /// The sites between which it is, ascending.
    pub fn sites(&self) -> &[u32] {
        &self.sites
    }

    /// Whether it is between these sites, with nothing left out that is nearer than `range` (mm).
    pub fn matches(&self, sites: &[u32], range: f64) -> bool {
        self.sites == sites && self.range >= range
    }

    /// Makes it the coupling of `open`, whose `rows` are made, with patches nearer than `range` (mm).
    ///
    /// `zone`: what may be solved next; both ascending, and `open` within it.
    pub fn update(
        &mut self,
        (zone, open): (&[u32], &[u32]),
        rows: &QuantizedRows,
        (response, sites): (&Response, &Sites),
        range: f64,
    ) {
        let patch = |site: &u32| sites.patch[*site as usize];
        let patches = sites.patch_range.len();
        let wanted = |of: &[u32]| {
            let mut is_wanted = vec![false; patches];
            of.iter().for_each(|s| is_wanted[patch(s) as usize] = true);
            is_wanted
        };
        let is_known = self.range == range && self.homes.len() == patches;
        let is_there = |p: usize| is_known && self.homes[p].width > 0;
        let is_open = wanted(open);
        let serves = (0..patches).all(|p| !is_open[p] || is_there(p));
        if !serves {
            let of_zone = wanted(zone);
            let size = |p: &usize| (sites.patch_range[*p].1 - sites.patch_range[*p].0) as f64;
            let columns = |is_column: &[bool]| {
                let all = (0..patches).filter(|p| is_column[*p]);
                all.map(|p| size(&p)).sum::<f64>()
            };
            let both: Vec<bool> = (0..patches).map(|p| of_zone[p] || is_there(p)).collect();
            let are_few = columns(&both) <= MOST_COLUMNS * columns(&of_zone);
            self.range = range;
            self.couple(if are_few { &both } else { &of_zone }, (response, sites));
        }
        self.sites.clear();
        self.sites.extend_from_slice(open);
        self.patches = open.iter().map(patch).collect();
        let column = |site| self.columns.partition_point(|c| c < site) as u32;
        self.places = open.iter().map(column).collect();
        self.units = open.iter().map(|&s| f64::from(rows.row(s).unit)).collect();
        self.own = open.iter().map(|&s| f64::from(rows.row(s).own)).collect();
        for (&site, (&patch, &place)) in open.iter().zip(self.patches.iter().zip(&self.places)) {
            let begin = &mut self.begins[place as usize];
            if *begin == MISSING {
                *begin = self.values.len();
                let home = &self.homes[patch as usize];
                home.push_row(&rows.row(site).entries, &mut self.values);
            }
        }
        self.choose_chunks();
    }

    /// Finds the columns of the solved sites in the rows of each, and where rows begin that hold no others.
    fn choose_chunks(&mut self) {
        let solved = self.at_columns([&vec![1.0; self.sites.len()]]);
        self.turned = vec![0];
        for patches in self.patches.chunk_by(|a, b| a == b) {
            let home = &mut self.homes[patches[0] as usize];
            home.choose_chunks(&solved[0]);
            for _ in patches {
                let begin = self.turned[self.turned.len() - 1];
                self.turned.push(begin + home.chunks.len() * LANES);
            }
        }
    }

    /// Takes all sites of the coupled patches as columns; no row is made.
    fn couple(&mut self, is_coupled: &[bool], (response, sites): (&Response, &Sites)) {
        let ranges = sites.patch_range.iter().zip(is_coupled);
        let ranges = ranges.filter(|(_, is_coupled)| **is_coupled);
        self.columns = ranges.flat_map(|(&(first, last), _)| first..last).collect();
        self.begins = vec![MISSING; self.columns.len()];
        self.values.clear();
        let members = |&range| Members::new(&self.columns, range);
        let members: Vec<Members> = sites.patch_range.iter().map(members).collect();
        let home = |(patch, &is_coupled): (u32, &bool)| {
            if !is_coupled {
                return PatchRows::default();
            }
            let felt = response.bounds(patch).zip(response.near(patch));
            let felt = felt.filter(|((other, bound), _)| *bound < self.range || *other == patch);
            let felt: Vec<(u32, u32)> = felt.map(|(_, entry)| *entry).collect();
            PatchRows::new(layout(&felt, &members))
        };
        self.homes = (0..).zip(is_coupled).map(home).collect();
    }

    /// `sum_j K_ij load_j` at its sites; `loads` by site.
    pub fn field(&self, loads: &[Vec3]) -> Vec<Vec3> {
        let load = |axis: usize| loads.iter().map(|load| load[axis] as f32).collect();
        let load: [Vec<f32>; 3] = [0, 1, 2].map(load);
        let rows = self.all();
        let mut field = vec![Vec3::zeros(); loads.len()];
        let begin = |row| self.begin(row);
        self.by_home(begin, slices(&load), (&rows, &mut field), |rows, x, out| {
            field_block(&self.values, rows, x, out);
        });
        let rows = self.units.iter().zip(&self.own);
        for ((sum, (unit, own)), load) in field.iter_mut().zip(rows).zip(loads) {
            *sum = *sum * *unit + load * *own;
        }
        field
    }

    /// The entries times the cosines between the directions of their rows and columns, for its sites alone.
    pub fn turn(&self, axes: &Axes) -> Vec<i16> {
        let all: [Vec<f32>; 3] = axes.narrow();
        let columns = self.at_columns(slices(&all));
        let mut there = [(); 3].map(|()| Vec::new());
        let mut turned = Vec::with_capacity(self.turned[self.sites.len()]);
        let rows = self.all();
        for rows in rows.chunk_by(|a, b| self.patch(*a) == self.patch(*b)) {
            let home = self.home(rows[0]);
            home.gather_solved(slices(&columns), &mut there);
            for &row in rows {
                let own = all.each_ref().map(|axis| axis[row as usize]);
                let values = &self.values[self.begin(row)..][..home.width];
                turn_row(own, slices(&there), (values, &home.chunks), &mut turned);
            }
        }
        turned
    }

    /// Some `rows` (places among its sites, ascending) of turned `entries` times `x`, which is by site; the same bits for any
    /// number of threads and any other rows beside.
    pub(super) fn multiply(&self, entries: &[i16], rows: &[u32], x: &[f32], out: &mut [f64]) {
        let begin = |row| self.turned[row as usize];
        self.by_home(begin, [x], (rows, out), |(begins, _), [there], out| {
            multiply_block(entries, begins, there, out);
        });
        for (&row, sum) in rows.iter().zip(out) {
            let row = row as usize;
            *sum = *sum * self.units[row] + self.own[row] * f64::from(x[row]);
        }
    }

    /// All rows.
    pub(super) fn all(&self) -> Vec<u32> {
        (0..self.sites.len() as u32).collect()
    }

    fn patch(&self, row: u32) -> u32 {
        self.patches[row as usize]
    }

    fn home(&self, row: u32) -> &PatchRows {
        &self.homes[self.patch(row) as usize]
    }

    fn begin(&self, row: u32) -> usize {
        self.begins[self.places[row as usize] as usize]
    }

    /// Values by column from those by site; zero for what is not solved.
    fn at_columns<const N: usize>(&self, x: [&[f32]; N]) -> [Vec<f32>; N] {
        x.map(|x| {
            let mut columns = vec![0.0; self.columns.len()];
            for (&place, x) in self.places.iter().zip(x) {
                columns[place as usize] = *x;
            }
            columns
        })
    }

    /// Calls `block` with where some `rows` of one patch begin, their chunks, the values of `x` (by site) there, and the places of
    /// the rows in `out`.
    fn by_home<T: Send, const N: usize>(
        &self,
        begin: impl Fn(u32) -> usize + Sync,
        x: [&[f32]; N],
        (rows, mut out): (&[u32], &mut [T]),
        block: impl Fn((&[usize], &[u32]), [&[f32]; N], &mut [T]) + Sync,
    ) {
        let columns = self.at_columns(x);
        let mut blocks = Vec::with_capacity(self.homes.len());
        for rows in rows.chunk_by(|a, b| self.patch(*a) == self.patch(*b)) {
            let written;
            (written, out) = out.split_at_mut(rows.len());
            blocks.push((rows, written));
        }
        let block = |(begins, there): &mut (Vec<usize>, [Vec<f32>; N]),
                     (rows, written): (&[u32], _)| {
            let home = self.home(rows[0]);
            home.gather_solved(slices(&columns), there);
            begins.clear();
            begins.extend(rows.iter().map(|&row| begin(row)));
            block((&begins[..], &home.chunks), slices(there), written);
        };
        let none = || (Vec::new(), [(); N].map(|()| Vec::new()));
        if self.values.len() < PARALLEL_ENTRIES {
            let mut own = none();
            blocks.into_iter().for_each(|rows| block(&mut own, rows));
        } else {
            blocks.into_par_iter().for_each_init(none, block);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::response::assembly::coupling;
    use crate::response::test_sheet::{loads, most_off, near, sheet};
    use crate::solve::row_runs::RowRuns;

    #[test]
    fn without_a_range_fields_are_those_of_the_whole_coupling() {
        let (skin, workspace, zone) = sheet();
        let ground = (&skin, &workspace.quantized);
        let (near, loads) = (near(ground, &zone, f64::INFINITY), loads(zone.len()));
        let mut whole = RowRuns::new();
        coupling((&skin.response, &skin.sites), &zone, &mut whole);
        let field = near.field(&loads);
        let mut wanted = vec![0.0; zone.len()];
        for axis in 0..3 {
            let load: Vec<f64> = loads.iter().map(|load| load[axis]).collect();
            whole.times(&load, &mut wanted);
            let most = most_off(&near, &load);
            for (ours, wanted) in field.iter().zip(&wanted) {
                let off = (ours[axis] - wanted).abs();
                assert!(off < most, "{} {wanted}", ours[axis]);
            }
        }
    }

    #[test]
    fn a_range_leaves_out_what_lies_in_patches_beyond_it_and_nothing_else() {
        let (skin, workspace, zone) = sheet();
        let ground = (&skin, &workspace.quantized);
        let (range, loads) = (9.0, loads(zone.len()));
        let near = near(ground, &zone, range);
        let field = near.field(&loads);
        let (mut left_out, mut most) = (0, 0.0f64);
        for (&i, ours) in zone.iter().zip(&field) {
            let row = skin.response.row(i, &skin.sites);
            let home = skin.sites.patch[i as usize];
            let mut wanted = Vec3::zeros();
            for (&j, load) in zone.iter().zip(&loads) {
                let patch = skin.sites.patch[j as usize];
                let felt = skin
                    .response
                    .near(home)
                    .iter()
                    .find(|entry| entry.0 == patch);
                let bound = skin.response.bound(home, patch);
                match (felt, bound) {
                    (Some(entry), Some(bound)) if bound < range => {
                        let first = skin.sites.patch_range[patch as usize].0;
                        wanted += load * f64::from(row[(entry.1 + j - first) as usize]);
                    }
                    _ => left_out += 1,
                }
            }
            most = most.max((ours - wanted).norm());
        }
        let lengths: Vec<f64> = loads.iter().map(Vec3::norm).collect();
        assert!(most < most_off(&near, &lengths), "{most}");
        let pairs = zone.len() * zone.len();
        assert!(
            left_out > pairs / 10 && left_out < 9 * pairs / 10,
            "{left_out} of {pairs}"
        );
    }

    #[test]
    fn incremental_coupling_equals_full_rebuild() {
        let (skin, workspace, zone) = sheet();
        let (ground, own) = (
            (&skin, &workspace.quantized),
            (&*skin.response, &*skin.sites),
        );
        let mut kept = near(ground, &zone, 14.0);
        // A corner, the sheet without it, some sites of all patches, and all again.
        let corner: Vec<u32> = zone[..zone.len() / 5].to_vec();
        let others: Vec<u32> = zone[zone.len() / 5..].to_vec();
        let some: Vec<u32> = zone.iter().copied().step_by(3).collect();
        for open in [&corner, &others, &some, &zone] {
            kept.update((&zone, open), &workspace.quantized, own, 9.0);
            let fresh = near(ground, open, 9.0);
            let loads = loads(open.len());
            assert!(kept.matches(open, 9.0) && !kept.matches(open, 10.0));
            let (ours, wanted) = (kept.field(&loads), fresh.field(&loads));
            // Sums of as many terms in another order.
            let most = wanted.iter().map(Vec3::norm).fold(0.0, f64::max);
            for (ours, wanted) in ours.iter().zip(&wanted) {
                assert!((ours - wanted).norm() < 1e-5 * most, "{ours} {wanted}");
            }
        }
    }

    #[test]
    fn some_rows_are_those_of_all_to_the_bit() {
        let (skin, workspace, zone) = sheet();
        let ground = (&skin, &workspace.quantized);
        let near = near(ground, &zone, 12.0);
        let turned = near.turn(&Axes::new(&loads(zone.len())));
        let x: Vec<f32> = (0..zone.len()).map(|k| (k as f32).cos()).collect();
        let mut all = vec![0.0; zone.len()];
        near.multiply(&turned, &near.all(), &x, &mut all);
        let rows: Vec<u32> = near.all().into_iter().filter(|k| k % 7 < 3).collect();
        let mut some = vec![0.0; rows.len()];
        near.multiply(&turned, &rows, &x, &mut some);
        for (&row, some) in rows.iter().zip(&some) {
            assert_eq!(*some, all[row as usize]);
        }
    }
}
