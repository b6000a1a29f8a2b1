//! Assembly: from response rows to the compliance matrix of a zone, and from forces to displacements.

use std::ops::Range;

use rayon::prelude::*;
use thenar_surface::Vec3;

use super::rows::Response;
use crate::skin::sites::Sites;
use crate::solve::row_runs::{RowRuns, Run};

/// Values of a row that are copied at a time.
pub const SHORT: usize = 16;

/// `K` between the sites of `zone` (ascending): symmetric, 1/mm. Written to `matrix`, whose storage is used again.
pub fn coupling((response, sites): (&Response, &Sites), zone: &[u32], matrix: &mut RowRuns<f32>) {
    let members: Vec<Members> = sites
        .patch_range
        .iter()
        .map(|&(first, last)| Members::new(zone, (first, last)))
        .collect();
    matrix.clear();
    let patch = |site: &u32| sites.patch[*site as usize];
    let mut values = vec![0.0; zone.len() + SHORT];
    for home in zone.chunk_by(|a, b| patch(a) == patch(b)) {
        let (runs, pieces) = layout(response.near(patch(&home[0])), &members);
        let (first, own) = (
            sites.patch_range[patch(&home[0]) as usize].0,
            own_offset(response, patch(&home[0])),
        );
        for &site in home {
            let row = response.row(site, sites);
            let taken = take(row, &pieces, &mut values);
            let diagonal = f64::from(row[(own + site - first) as usize]);
            matrix.push(runs.iter().copied(), taken.iter().copied(), diagonal);
        }
    }
}

/// The `pieces` (first, number) of a row, one after the other, in `out`, which has room for them and [`SHORT`] more.
pub fn take<'a, T: Copy>(row: &[T], pieces: &[(u32, u32)], out: &'a mut [T]) -> &'a [T] {
    let mut at = 0;
    for &(from, len) in pieces {
        let (from, len) = (from as usize, len as usize);
        let (there, here) = (&row[from..], &mut out[at..]);
        // Most pieces are short: copies of one length need no call, and the next piece covers what was too much.
        match (there.first_chunk::<SHORT>(), here.first_chunk_mut()) {
            (Some(there), Some(here)) if len <= SHORT => *here = *there,
            _ => here[..len].copy_from_slice(&there[..len]),
        }
        at += len;
    }
    &out[..at]
}

/// Runs of columns in the rows of one patch, and where their values lie there: first and number.
pub fn layout(near: &[(u32, u32)], members: &[Members]) -> (Vec<Run>, Vec<(u32, u32)>) {
    let (mut runs, mut pieces): (Vec<Run>, Vec<(u32, u32)>) = (Vec::new(), Vec::new());
    for &(patch, offset) in near {
        let members = &members[patch as usize];
        if members.len == 0 {
            continue;
        }
        match runs.last_mut() {
            Some(run) if run.start + run.len == members.from => run.len += members.len,
            _ => runs.push(Run {
                start: members.from,
                len: members.len,
            }),
        }
        for &(first, len) in &members.pieces {
            match pieces.last_mut() {
                Some(last) if last.0 + last.1 == offset + first => last.1 += len,
                _ => pieces.push((offset + first, len)),
            }
        }
    }
    (runs, pieces)
}

/// Where a patch's own sites begin in its rows.
pub fn own_offset(response: &Response, patch: u32) -> u32 {
    let near = response.near(patch);
    let own = near.binary_search_by_key(&patch, |entry| entry.0);
    own.map_or(0, |k| near[k].1)
}

/// What a zone holds of a patch.
pub struct Members {
    /// Place of the first in the zone.
    from: u32,
    pub len: u32,
    /// First, counted in the patch, and number of those that follow one another.
    pieces: Vec<(u32, u32)>,
}

impl Members {
    /// Of a `zone` (ascending), those from `first` to before `last`.
    pub fn new(zone: &[u32], (first, last): (u32, u32)) -> Self {
        let from = zone.partition_point(|&z| z < first);
        let to = zone.partition_point(|&z| z < last);
        let following = zone[from..to].chunk_by(|a, b| a + 1 == *b);
        Members {
            from: from as u32,
            len: (to - from) as u32,
            pieces: following
                .map(|piece| (piece[0] - first, piece.len() as u32))
                .collect(),
        }
    }
}

/// The compliance (mm/N) along directions: `A_ij = w_i w_j K_ij t_i.t_j`, for weights `w` and unit directions `t`.
///
/// Written to `out`, whose storage is used again.
pub fn compliance(
    coupling: &RowRuns<f32>,
    (weight, direction): (&[f64], &[Vec3]),
    out: &mut RowRuns<f32>,
) {
    let weighted: Vec<[f64; 3]> = weight
        .iter()
        .zip(direction)
        .map(|(w, t)| [w * t.x, w * t.y, w * t.z])
        .collect();
    coupling.map_runs(out, |i, start, values, out| {
        scale_run(
            &weighted[start..start + values.len()],
            weighted[i],
            values,
            out,
        )
    });
}

#[multiversion::multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2"))]
fn scale_run(columns: &[[f64; 3]], row: [f64; 3], values: &[f32], out: &mut [f32]) {
    for ((b, value), out) in columns.iter().zip(values).zip(out) {
        *out = (f64::from(*value) * (row[0] * b[0] + row[1] * b[1] + row[2] * b[2])) as f32;
    }
}

/// One pressed site.
#[derive(Debug, Clone, Copy)]
pub struct Load {
    /// The site.
    pub site: u32,
    /// Force times the response weight s of the site, along its direction.
    pub load: Vec3,
}

/// Patches whose field is summed at a time: it stays in the cache, and the pieces of the rows are long.
const BLOCK: u32 = 32;

/// `sum_j K_ij load_j` at every site; zero out of range. Multiply by the response weight s of the site for mm.
///
/// `loads` in ascending order of sites.
pub fn displacements(response: &Response, loads: &[Load], sites: &Sites) -> Vec<Vec3> {
    let patch = |load: &Load| sites.patch[load.site as usize];
    let homes: Vec<&[Load]> = loads.chunk_by(|a, b| patch(a) == patch(b)).collect();
    let patches = sites.patch_range.len() as u32;
    let fields: Vec<Vec<Vec3>> = (0..patches.div_ceil(BLOCK))
        .into_par_iter()
        .map(|block| {
            let block = block * BLOCK..patches.min((block + 1) * BLOCK);
            block_field(response, &homes, (block, sites))
        })
        .collect();
    fields.concat()
}

/// The field on a block of patches.
fn block_field(
    response: &Response,
    homes: &[&[Load]],
    (block, sites): (Range<u32>, &Sites),
) -> Vec<Vec3> {
    let begin = sites.patch_range[block.start as usize].0 as usize;
    let end = sites.patch_range[block.end as usize - 1].1 as usize;
    let mut field = [(); 3].map(|()| vec![0.0; end - begin]);
    for loads in homes {
        let near = response.near(sites.patch[loads[0].site as usize]);
        let from = near.partition_point(|entry| entry.0 < block.start);
        let to = near.partition_point(|entry| entry.0 < block.end);
        // Patches that follow one another are one piece of a row.
        for piece in near[from..to]
            .chunk_by(|a, b| sites.patch_range[a.0 as usize].1 == sites.patch_range[b.0 as usize].0)
        {
            let (first, last) = (piece[0], piece[piece.len() - 1]);
            let there = sites.patch_range[first.0 as usize].0 as usize - begin
                ..sites.patch_range[last.0 as usize].1 as usize - begin;
            let row = first.1 as usize..first.1 as usize + there.len();
            let field = field.each_mut().map(|axis| &mut axis[there.clone()]);
            add_loads(field, loads, |site| &response.row(site, sites)[row.clone()]);
        }
    }
    let [x, y, z] = field;
    (0..end - begin)
        .map(|i| Vec3::new(x[i], y[i], z[i]))
        .collect()
}

/// Adds the fields of `loads`, four at a time.
fn add_loads<'a>(mut field: [&mut [f64]; 3], loads: &[Load], row: impl Fn(u32) -> &'a [f32]) {
    let mut fours = loads.chunks_exact(4);
    for four in &mut fours {
        let load = [0, 1, 2].map(|axis| [0, 1, 2, 3].map(|k| four[k].load[axis]));
        let rows = [0, 1, 2, 3].map(|k| row(four[k].site));
        accumulate(field.each_mut().map(|axis| &mut axis[..]), rows, load);
    }
    for one in fours.remainder() {
        let load = [0, 1, 2].map(|axis| [one.load[axis]]);
        accumulate(
            field.each_mut().map(|axis| &mut axis[..]),
            [row(one.site)],
            load,
        );
    }
}

#[multiversion::multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2"))]
fn accumulate<const N: usize>(field: [&mut [f64]; 3], rows: [&[f32]; N], load: [[f64; N]; 3]) {
    let n = field[0].len();
    let rows = rows.map(|row| &row[..n]);
    let [x, y, z] = field;
    let (y, z) = (&mut y[..n], &mut z[..n]);
    for i in 0..n {
        // Sums of their own: the compiler cannot know that what is written to one axis does not change another.
        let mut sums = [x[i], y[i], z[i]];
        for k in 0..N {
            let value = f64::from(rows[k][i]);
            for axis in 0..3 {
                sums[axis] += value * load[axis][k];
            }
        }
        [x[i], y[i], z[i]] = sums;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pieces_of_any_length_are_taken_up_to_the_end_of_a_row() {
        let row: Vec<f32> = (0..90_u8).map(f32::from).collect();
        let pieces = [
            (0, 3),
            (7, 1),
            (9, 16),
            (30, 17),
            (50, 33),
            (84, 2),
            (87, 3),
        ];
        let wanted: Vec<f32> = pieces
            .iter()
            .flat_map(|&(from, len)| row[from as usize..(from + len) as usize].to_vec())
            .collect();
        let mut values = vec![f32::NAN; wanted.len() + SHORT];
        assert_eq!(take(&row, &pieces, &mut values), wanted);
    }
}
