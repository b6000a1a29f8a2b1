//! The response among sites near each other, as a live press solves with it: what lies farther off answers as it did last.
//!
//! Bonded skin answers little beyond a few thicknesses, and what it answers there changes little from frame to frame. The sites
//! of one patch feel the same others, so that their rows are a dense block, and products run over it without gaps. Entries are
//! those of the rounded rows: reading them is what a product takes, and a press that the eye alone judges needs no more. Each row
//! is rounded by its own largest entry, so that the two entries of a pair agree but for that.

use rayon::prelude::*;
use thenar_surface::Vec3;

use super::assembly::{Members, SHORT, layout, take};
use super::rounded::{Rounded, rounded};
use super::rows::Response;
use crate::sites::Sites;
use crate::solve::Axes;
use crate::solve::operator::Run;

/// Rows are filled up with zeros to a multiple of this: products need no remainder.
const LANES: usize = 32;
/// Entries from which products are worth several threads.
const PARALLEL_ENTRIES: usize = 6_000_000;

/// Rows of one patch.
#[derive(Debug, Clone, Copy)]
struct Home {
    rows: u32,
    /// Entries of each, a multiple of [`LANES`].
    width: u32,
    /// How many runs its columns are.
    runs: u32,
}

/// `K` (1/mm) between sites whose patches lie within a range of each other; symmetric but for rounding.
#[derive(Debug, Clone, Default)]
pub struct Near {
    /// The sites, ascending.
    pub sites: Vec<u32>,
    /// How far apart patches may lie, mm.
    pub range: f64,
    homes: Vec<Home>,
    /// Places of the sites of the columns, home by home; zeros follow.
    runs: Vec<Run>,
    /// Entries, row by row; zero where a site meets itself.
    values: Vec<i16>,
    /// What one of an entry is worth, by row, and the entry where the site meets itself, 1/mm.
    pub(super) units: Vec<f64>,
    pub(super) own: Vec<f64>,
}

/// The coupling of the first round of a solve, which often serves the next solve, and that of the rounds after it, of few sites.
#[derive(Debug, Clone, Default)]
pub struct Nears {
    of_rounds: [Near; 2],
    now: usize,
}

impl Nears {
    /// Takes the one of a `round`, from 1.
    pub fn turn_to(&mut self, round: usize) {
        self.now = usize::from(round > 1);
    }

    /// The one of this round.
    pub fn now(&self) -> &Near {
        &self.of_rounds[self.now]
    }

    /// The same, to be made anew.
    pub fn now_mut(&mut self) -> &mut Near {
        &mut self.of_rounds[self.now]
    }
}

impl Near {
    /// Makes it anew for `zone` (ascending), whose `rows` are made, from patches nearer than `range` (mm).
    pub fn renew(
        &mut self,
        zone: &[u32],
        rows: &Rounded,
        (response, sites): (&Response, &Sites),
        range: f64,
    ) {
        self.range = range;
        self.sites.clear();
        self.sites.extend_from_slice(zone);
        self.homes.clear();
        self.runs.clear();
        self.values.clear();
        self.units.clear();
        self.own.clear();
        let patch = |site: &u32| sites.patch[*site as usize];
        let members: Vec<Members> = sites
            .patch_range
            .iter()
            .map(|&range| Members::new(zone, range))
            .collect();
        for home in zone.chunk_by(|a, b| patch(a) == patch(b)) {
            self.push_home(home, rows, (response, sites), &members);
        }
    }

    /// Appends the rows of one patch's sites. `members`: what of every patch is coupled.
    fn push_home(
        &mut self,
        home: &[u32],
        rows: &Rounded,
        (response, sites): (&Response, &Sites),
        members: &[Members],
    ) {
        let patch = sites.patch[home[0] as usize];
        let felt = response.bounds(patch).zip(response.near(patch));
        let felt = felt.filter(|((other, bound), _)| *bound < self.range || *other == patch);
        let felt: Vec<(u32, u32)> = felt.map(|(_, entry)| *entry).collect();
        let (runs, pieces) = layout(&felt, members);
        let width: u32 = runs.iter().map(|run| run.len).sum();
        let width = width.next_multiple_of(LANES as u32);
        self.homes.push(Home {
            rows: home.len() as u32,
            width,
            runs: runs.len() as u32,
        });
        self.runs.extend(runs);
        for &site in home {
            let row = rows.row(site);
            let begin = self.values.len();
            let end = begin + width as usize;
            self.values.resize(end + SHORT, 0);
            let taken = take(&row.entries, &pieces, &mut self.values[begin..]).len();
            self.values.truncate(end);
            self.values[begin + taken..].fill(0);
            self.units.push(f64::from(row.unit));
            self.own.push(f64::from(row.own));
        }
    }

    /// `sum_j K_ij load_j` at its sites; `loads` by site.
    pub fn field(&self, loads: &[Vec3]) -> Vec<Vec3> {
        let load = [0, 1, 2].map(|axis| loads.iter().map(|load| load[axis] as f32).collect());
        let load: [Vec<f32>; 3] = load;
        let mut field = vec![Vec3::zeros(); loads.len()];
        let load = load.each_ref().map(|axis| &axis[..]);
        self.by_home(&self.values, load, &mut field, field_block);
        let rows = self.units.iter().zip(&self.own);
        for ((sum, (unit, own)), load) in field.iter_mut().zip(rows).zip(loads) {
            *sum = *sum * *unit + load * *own;
        }
        field
    }

    /// The entries times the cosines between the directions of their rows and columns, written to `out`.
    pub fn turn(&self, axes: &Axes, out: &mut Vec<i16>) {
        out.resize(self.values.len(), 0);
        let all: [Vec<f32>; 3] = axes.narrow();
        let (mut row, mut at, mut there) = (0, 0, [(); 3].map(|()| Vec::new()));
        for (home, columns) in self.homes() {
            columns.gather(all.each_ref().map(|axis| &axis[..]), &mut there);
            for _ in 0..home.rows {
                let own = all.each_ref().map(|axis| axis[row]);
                let entries = at..at + home.width as usize;
                turn_row(
                    own,
                    &there,
                    (&self.values[entries.clone()], &mut out[entries]),
                );
                (at, row) = (at + home.width as usize, row + 1);
            }
        }
    }

    /// A matrix of this pattern, with `entries`, times `x`; the same bits for any number of threads.
    pub(super) fn multiply(&self, entries: &[i16], x: &[f32], out: &mut [f64]) {
        self.by_home(entries, [x], out, |entries, [x], out| {
            multiply_block(entries, x, out);
        });
        let rows = self.units.iter().zip(&self.own);
        for ((sum, (unit, own)), x) in out.iter_mut().zip(rows).zip(x) {
            *sum = *sum * unit + own * f64::from(*x);
        }
    }

    /// Homes with their columns.
    fn homes(&self) -> impl Iterator<Item = (&Home, Columns<'_>)> {
        let mut runs = &self.runs[..];
        self.homes.iter().map(move |home| {
            let own;
            (own, runs) = runs.split_at(home.runs as usize);
            let width = home.width as usize;
            (home, Columns { runs: own, width })
        })
    }

    /// Calls `block` with the entries of every home, the values of `x` at its columns and its places in `out`.
    fn by_home<T: Send, const N: usize>(
        &self,
        mut entries: &[i16],
        x: [&[f32]; N],
        mut out: &mut [T],
        block: impl Fn(&[i16], [&[f32]; N], &mut [T]) + Sync,
    ) {
        let mut blocks = Vec::with_capacity(self.homes.len());
        for (home, columns) in self.homes() {
            let (own, written);
            (own, entries) = entries.split_at((home.rows * home.width) as usize);
            (written, out) = out.split_at_mut(home.rows as usize);
            blocks.push((own, columns, written));
        }
        let block = |there: &mut [Vec<f32>; N], (own, columns, written): (_, Columns<'_>, _)| {
            columns.gather(x, there);
            block(own, there.each_ref().map(|x| &x[..]), written);
        };
        let none = || [(); N].map(|()| Vec::new());
        if self.values.len() < PARALLEL_ENTRIES {
            let mut there = none();
            blocks.into_iter().for_each(|home| block(&mut there, home));
        } else {
            blocks.into_par_iter().for_each_init(none, block);
        }
    }
}

/// The columns of a home.
#[derive(Clone, Copy)]
struct Columns<'a> {
    runs: &'a [Run],
    width: usize,
}

impl Columns<'_> {
    /// Writes the values of `all` there to `there`, filled up with zeros.
    fn gather<const N: usize>(&self, all: [&[f32]; N], there: &mut [Vec<f32>; N]) {
        for (all, there) in all.into_iter().zip(there) {
            there.clear();
            for run in self.runs {
                there.extend_from_slice(&all[run.start as usize..][..run.len as usize]);
            }
            there.resize(self.width, 0.0);
        }
    }
}

/// Entries of a row along `row` times their cosines with the directions of their columns, which both of a pair share.
#[multiversion::multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2"))]
fn turn_row(row: [f32; 3], columns: &[Vec<f32>; 3], (values, out): (&[i16], &mut [i16])) {
    let [x, y, z] = columns;
    for ((((value, x), y), z), out) in values.iter().zip(x).zip(y).zip(z).zip(out) {
        *out = rounded(f32::from(*value) * (row[0] * x + row[1] * y + row[2] * z));
    }
}

/// A dense block times `x`, as long as its rows: a multiple of [`LANES`].
#[multiversion::multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2"))]
fn multiply_block(entries: &[i16], x: &[f32], out: &mut [f64]) {
    let (x, _) = x.as_chunks::<LANES>();
    for (row, out) in entries.chunks_exact(x.len() * LANES).zip(out) {
        let (row, _) = row.as_chunks::<LANES>();
        let mut sums = [0.0; LANES];
        for (entries, x) in row.iter().zip(x) {
            for lane in 0..LANES {
                sums[lane] += f32::from(entries[lane]) * x[lane];
            }
        }
        *out = f64::from(total(&sums));
    }
}

/// [`multiply_block`] of the three axes of a vector at once.
#[multiversion::multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2"))]
fn field_block(entries: &[i16], [x, y, z]: [&[f32]; 3], out: &mut [Vec3]) {
    let (x, _) = x.as_chunks::<LANES>();
    let (y, _) = y.as_chunks::<LANES>();
    let (z, _) = z.as_chunks::<LANES>();
    for (row, out) in entries.chunks_exact(x.len() * LANES).zip(out) {
        let (row, _) = row.as_chunks::<LANES>();
        let (mut along_x, mut along_y, mut along_z) = ([0.0; LANES], [0.0; LANES], [0.0; LANES]);
        for (((entries, x), y), z) in row.iter().zip(x).zip(y).zip(z) {
            for lane in 0..LANES {
                let entry = f32::from(entries[lane]);
                along_x[lane] += entry * x[lane];
                along_y[lane] += entry * y[lane];
                along_z[lane] += entry * z[lane];
            }
        }
        *out = Vec3::from([along_x, along_y, along_z].map(|sums| f64::from(total(&sums))));
    }
}

/// The sum of all lanes, each half added to the other.
///
/// Called and not inlined: where it is, the compiler makes pairs of the whole loop before it.
#[inline(never)]
fn total(lanes: &[f32; LANES]) -> f32 {
    let mut sums = *lanes;
    for half in [16, 8, 4, 2, 1] {
        for lane in 0..half {
            sums[lane] += sums[lane + half];
        }
    }
    sums[0]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::response::assembly::coupling;
    use crate::response::test_sheet::{loads, most_off, near, sheet};
    use crate::solve::operator::Rows;

    #[test]
    fn without_a_range_fields_are_those_of_the_whole_coupling() {
        let (skin, zone) = sheet();
        let (near, loads) = (near(&skin, &zone, f64::INFINITY), loads(zone.len()));
        let mut whole = Rows::new();
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
        let (skin, zone) = sheet();
        let (range, loads) = (9.0, loads(zone.len()));
        let near = near(&skin, &zone, range);
        let field = near.field(&loads);
        let (mut left_out, mut most) = (0, 0.0f64);
        for (&i, ours) in zone.iter().zip(&field) {
            let row = skin.response.row(i);
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
}
