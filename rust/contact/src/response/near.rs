//! The response among sites near each other, as a live press solves with it: what lies farther off answers as it did last.
//!
//! Bonded skin answers little beyond a few thicknesses, and what it answers there changes little from frame to frame. The sites
//! of one patch feel the same others, so that their rows are a dense block, and products run over it without gaps.

use rayon::prelude::*;
use thenar_surface::Vec3;

use super::rows::Response;
use crate::sites::Sites;
use crate::solve::{Axes, Compliance, Kept, Symmetric, turn_entries};

/// Rows are filled up with zeros to a multiple of this: products need no remainder.
const LANES: usize = 16;
/// Entries from which products are worth several threads.
const PARALLEL_ENTRIES: usize = 3_000_000;

/// Rows of one patch.
#[derive(Debug, Clone, Copy)]
struct Home {
    rows: u32,
    /// Entries of each, a multiple of [`LANES`].
    width: u32,
}

/// `K` (1/mm) between sites whose patches lie within a range of each other; symmetric.
#[derive(Debug, Clone, Default)]
pub struct Near {
    /// The sites, ascending.
    pub sites: Vec<u32>,
    /// How far apart patches may lie, mm.
    pub range: f64,
    homes: Vec<Home>,
    /// Place of the site of each column, home by home; any where the entries are zero.
    columns: Vec<u32>,
    /// Entries, row by row.
    values: Vec<f32>,
    own: Vec<f64>,
}

impl Near {
    /// Makes it anew for `zone` (ascending), whose rows of the response are made, from patches nearer than `range` (mm).
    pub fn renew(&mut self, zone: &[u32], (response, sites): (&Response, &Sites), range: f64) {
        self.range = range;
        self.sites.clear();
        self.sites.extend_from_slice(zone);
        self.homes.clear();
        self.columns.clear();
        self.values.clear();
        self.own.clear();
        let patch = |site: &u32| sites.patch[*site as usize];
        let starts = sites
            .patch_range
            .iter()
            .map(|&(first, _)| zone.partition_point(|site| *site < first) as u32);
        let mut starts: Vec<u32> = starts.collect();
        starts.push(zone.len() as u32);
        for home in zone.chunk_by(|a, b| patch(a) == patch(b)) {
            self.push_home(home, (response, sites), &starts);
        }
    }

    /// Appends the rows of one patch's sites. `starts`: place of the first site of every patch.
    fn push_home(&mut self, home: &[u32], (response, sites): (&Response, &Sites), starts: &[u32]) {
        let patch = sites.patch[home[0] as usize];
        let offsets = response.near(patch).iter().map(|entry| entry.1);
        let range = self.range;
        let felt = response
            .bounds(patch)
            .zip(offsets)
            .filter(|((other, bound), _)| *bound < range || *other == patch);
        let begun = self.columns.len();
        // Where in a row of the response each column stands.
        let mut taken: Vec<u32> = Vec::new();
        let mut own = 0;
        for ((other, _), offset) in felt {
            let (first, _) = sites.patch_range[other as usize];
            let places = starts[other as usize]..starts[other as usize + 1];
            if other == patch {
                own = offset + home[0] - first;
            }
            let members = &self.sites[places.start as usize..places.end as usize];
            taken.extend(members.iter().map(|site| offset + site - first));
            self.columns.extend(places);
        }
        let width = taken.len().next_multiple_of(LANES);
        self.columns.resize(begun + width, starts[patch as usize]);
        for &site in home {
            let row = response.row(site);
            let begin = self.values.len();
            self.values.extend(taken.iter().map(|&k| row[k as usize]));
            self.values.resize(begin + width, 0.0);
            self.own
                .push(f64::from(row[(own + site - home[0]) as usize]));
        }
        self.homes.push(Home {
            rows: home.len() as u32,
            width: width as u32,
        });
    }

    /// `sum_j K_ij load_j` at its sites; `loads` by site.
    pub fn field(&self, loads: &[Vec3]) -> Vec<Vec3> {
        let mut out = vec![0.0; loads.len()];
        let mut field = vec![Vec3::zeros(); loads.len()];
        for axis in 0..3 {
            let load: Vec<f64> = loads.iter().map(|load| load[axis]).collect();
            self.multiply(&self.values, &load, &mut out);
            for (sum, out) in field.iter_mut().zip(&out) {
                sum[axis] = *out;
            }
        }
        field
    }

    /// The entries times the cosines between the directions of their rows and columns, written to `out`.
    pub fn turn(&self, axes: &Axes, out: &mut Vec<f32>) {
        out.resize(self.values.len(), 0.0);
        let (mut row, mut from, mut at) = (0, 0, 0);
        for home in &self.homes {
            let width = home.width as usize;
            let there = axes.of(&self.columns[from..from + width]);
            for _ in 0..home.rows {
                let entries = (&self.values[at..at + width], &mut out[at..at + width]);
                turn_entries(axes.at(row), there.columns(0, width), entries);
                (at, row) = (at + width, row + 1);
            }
            from += width;
        }
    }

    /// A matrix of this pattern, with `entries`, times `x`; the same bits for any number of threads.
    fn multiply(&self, mut entries: &[f32], x: &[f64], mut out: &mut [f64]) {
        let mut columns = &self.columns[..];
        let mut blocks = Vec::with_capacity(self.homes.len());
        for home in &self.homes {
            let (there, own, written);
            (there, columns) = columns.split_at(home.width as usize);
            (own, entries) = entries.split_at((home.rows * home.width) as usize);
            (written, out) = out.split_at_mut(home.rows as usize);
            blocks.push((own, there, written));
        }
        let block = |(own, there, written): (&[f32], &[u32], &mut [f64])| {
            let x: Vec<f64> = there.iter().map(|&k| x[k as usize]).collect();
            multiply_block(own, &x, written);
        };
        if self.values.len() < PARALLEL_ENTRIES {
            blocks.into_iter().for_each(block);
        } else {
            blocks.into_par_iter().for_each(block);
        }
    }
}

/// A dense block times `x`, as long as its rows: a multiple of [`LANES`].
#[multiversion::multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2"))]
fn multiply_block(entries: &[f32], x: &[f64], out: &mut [f64]) {
    let (x, _) = x.as_chunks::<LANES>();
    for (row, out) in entries.chunks_exact(x.len() * LANES).zip(out) {
        let (row, _) = row.as_chunks::<LANES>();
        let mut sums = [0.0; LANES];
        for (entries, x) in row.iter().zip(x) {
            for lane in 0..LANES {
                sums[lane] += f64::from(entries[lane]) * x[lane];
            }
        }
        for half in [8, 4, 2, 1] {
            (0..half).for_each(|lane| sums[lane] += sums[lane + half]);
        }
        *out = sums[0];
    }
}

/// The near compliance along directions, `A_ij = w_i w_j K_ij t_i.t_j`, mm/N: entries with the cosines in them, weights outside.
pub struct NearAlong<'a> {
    near: &'a Near,
    entries: &'a [f32],
    weight: &'a [f64],
    diagonal: Vec<f64>,
}

impl<'a> NearAlong<'a> {
    /// Of `near`, with the `entries` that [`Near::turn`] gave, and `weight` by unknown.
    pub fn new(near: &'a Near, entries: &'a [f32], weight: &'a [f64]) -> Self {
        let diagonal = weight.iter().zip(&near.own).map(|(w, own)| own * w * w);
        NearAlong {
            near,
            entries,
            weight,
            diagonal: diagonal.collect(),
        }
    }
}

impl Symmetric for NearAlong<'_> {
    fn diagonal(&self) -> &[f64] {
        &self.diagonal
    }

    fn times(&self, x: &[f64], out: &mut [f64]) {
        let weighted: Vec<f64> = x.iter().zip(self.weight).map(|(x, w)| x * w).collect();
        self.near.multiply(self.entries, &weighted, out);
        for (out, w) in out.iter_mut().zip(self.weight) {
            *out *= w;
        }
    }
}

impl Compliance for NearAlong<'_> {
    fn times_rows(&self, rows: &[u32], x: &[f64], out: &mut [f64]) {
        let mut all = vec![0.0; x.len()];
        self.times(x, &mut all);
        for (&i, out) in rows.iter().zip(out) {
            *out = all[i as usize];
        }
    }

    /// Gershgorin's.
    fn norm_bound(&self) -> f64 {
        let mut sums = vec![0.0; self.weight.len()];
        let entries: Vec<f32> = self.entries.iter().map(|entry| entry.abs()).collect();
        self.near.multiply(&entries, self.weight, &mut sums);
        let rows = sums.iter().zip(self.weight).map(|(sum, w)| sum * w);
        rows.fold(f64::MIN_POSITIVE, f64::max)
    }

    fn kept(&self, _set: &[u32], _is_rough: bool) -> Kept<'_> {
        let all = (0..self.weight.len() as u32).collect();
        Kept::of(all, Box::new(self))
    }

    fn is_narrow(&self, _is_rough: bool) -> bool {
        false
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::response::assembly::coupling;
    use crate::skin::Skin;
    use crate::solve::operator::Rows;
    use crate::solve::{Along, Part};
    use crate::{Control, Material, Model, SkinInput};
    use thenar_surface::Mesh;

    /// A bent sheet of 28 by 28 vertices with its rows made, and a zone of two thirds of its sites.
    fn sheet() -> (Skin, Vec<u32>) {
        let side = 28;
        let place = |k: u32| {
            let (x, y) = (1.3 * f64::from(k % side), 1.4 * f64::from(k / side));
            Vec3::new(x, y, 0.01 * (x * x + y * x))
        };
        let corners = |k: u32| [[k, k + 1, k + side], [k + 1, k + side + 1, k + side]];
        let cells = (0..side * (side - 1)).filter(|k| k % side != side - 1);
        let mesh = Mesh::new(
            (0..side * side).map(place).collect(),
            cells.flat_map(corners).collect(),
        );
        let input = SkinInput {
            mesh: mesh.unwrap(),
            regions: Vec::new(),
            materials: vec![Material::finger_layer()],
            model: Model::Layer,
        };
        let control = Control::none();
        let mut skin = Skin::prepare(input, &control).unwrap();
        let zone = (0..skin.sites.len() as u32).filter(|site| site % 3 != 1);
        let zone: Vec<u32> = zone.collect();
        skin.make_rows(&zone, &control).unwrap();
        (skin, zone)
    }

    fn near(skin: &Skin, zone: &[u32], range: f64) -> Near {
        let mut near = Near::default();
        near.renew(zone, (&skin.response, &skin.sites), range);
        near
    }

    fn loads(count: usize) -> Vec<Vec3> {
        let load = |k: usize| Vec3::new((k as f64).sin(), (0.7 * k as f64).cos(), 1.0);
        (0..count).map(load).collect()
    }

    #[test]
    fn without_a_range_products_are_those_of_the_whole_coupling() {
        let (skin, zone) = sheet();
        let (near, loads) = (near(&skin, &zone, f64::INFINITY), loads(zone.len()));
        let mut whole = Rows::new();
        coupling((&skin.response, &skin.sites), &zone, &mut whole);
        let field = near.field(&loads);
        let mut wanted = vec![0.0; zone.len()];
        for axis in 0..3 {
            let load: Vec<f64> = loads.iter().map(|load| load[axis]).collect();
            whole.times(&load, &mut wanted);
            for (ours, wanted) in field.iter().zip(&wanted) {
                assert!(
                    (ours[axis] - wanted).abs() < 1e-9,
                    "{} {wanted}",
                    ours[axis]
                );
            }
        }
        let directions: Vec<Vec3> = loads.iter().map(Vec3::normalize).collect();
        let weight: Vec<f64> = (0..zone.len())
            .map(|k| 1.0 + 0.1 * (k % 7) as f64)
            .collect();
        let (axes, part, likely) = (
            Axes::new(&directions),
            Part::default(),
            vec![true; zone.len()],
        );
        let mut entries = Vec::new();
        near.turn(&axes, &mut entries);
        let ours = NearAlong::new(&near, &entries, &weight);
        let theirs = Along::new((&whole, &axes), (&weight, &likely), &part);
        let x: Vec<f64> = (0..zone.len()).map(|k| (0.3 * k as f64).cos()).collect();
        let mut product = vec![0.0; zone.len()];
        ours.times(&x, &mut product);
        theirs.times(&x, &mut wanted);
        for (ours, wanted) in product.iter().zip(&wanted) {
            assert!((ours - wanted).abs() < 1e-9, "{ours} {wanted}");
        }
        for (ours, wanted) in ours.diagonal().iter().zip(theirs.diagonal()) {
            assert!((ours / wanted - 1.0).abs() < 1e-6, "{ours} {wanted}");
        }
    }

    #[test]
    fn a_range_leaves_out_what_lies_in_patches_beyond_it_and_nothing_else() {
        let (skin, zone) = sheet();
        let (range, loads) = (9.0, loads(zone.len()));
        let field = near(&skin, &zone, range).field(&loads);
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
        assert!(most < 1e-9, "{most}");
        let pairs = zone.len() * zone.len();
        assert!(
            left_out > pairs / 10 && left_out < 9 * pairs / 10,
            "{left_out} of {pairs}"
        );
    }
}
