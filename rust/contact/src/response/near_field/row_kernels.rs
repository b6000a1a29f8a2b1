//! Vectorized loops over near-field rows.

use multiversion::target::target_cfg_f;
use thenar_surface::Vec3;

use crate::response::quantized_rows::{plus, rounded};

/// Rows are filled up with zeros to a multiple of this: products need no remainder.
pub(super) const LANES: usize = 16;
/// Rows that are multiplied at once.
const AT_ONCE: usize = 4;

/// Appends the entries of a row in some `chunks`, along `row` times their cosines with the directions of their columns, which both
/// of a pair share.
#[multiversion::multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2"))]
pub(super) fn turn_row(
    row: [f32; 3],
    columns: [&[f32]; 3],
    (values, chunks): (&[i16], &[u32]),
    turned: &mut Vec<i16>,
) {
    let (values, _) = values.as_chunks::<LANES>();
    let [x, y, z] = columns.map(|axis| axis.as_chunks::<LANES>().0);
    for (((&at, x), y), z) in chunks.iter().zip(x).zip(y).zip(z) {
        let values = &values[at as usize];
        let entry = |lane: usize| {
            let cosine = row[0] * x[lane] + row[1] * y[lane] + row[2] * z[lane];
            rounded(f32::from(values[lane]) * cosine)
        };
        turned.extend_from_slice(&std::array::from_fn::<i16, LANES, _>(entry));
    }
}

/// Rows that begin at `begins` times `x`, as long as they: a multiple of [`LANES`].
#[multiversion::multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2+fma"))]
pub(super) fn multiply_block(entries: &[i16], begins: &[usize], x: &[f32], out: &mut [f64]) {
    const IS_FUSED: bool = target_cfg_f!(any(target_feature = "fma", target_feature = "avx512f"));
    let (x, _) = x.as_chunks::<LANES>();
    for (begins, out) in begins.chunks(AT_ONCE).zip(out.chunks_mut(AT_ONCE)) {
        // Where there are fewer, the first stands in.
        let row = |k: usize| {
            let begin = begins.get(k).copied().unwrap_or(begins[0]);
            entries[begin..].as_chunks::<LANES>().0
        };
        let [a, b, c, d]: [_; AT_ONCE] = std::array::from_fn(row);
        let mut sums = [[0.0; LANES]; AT_ONCE];
        for ((((x, a), b), c), d) in x.iter().zip(a).zip(b).zip(c).zip(d) {
            for (sums, row) in sums.iter_mut().zip([a, b, c, d]) {
                for lane in 0..LANES {
                    sums[lane] = plus::<IS_FUSED>(sums[lane], f32::from(row[lane]), x[lane]);
                }
            }
        }
        for (out, sums) in out.iter_mut().zip(&sums) {
            *out = f64::from(total(sums));
        }
    }
}

/// Some `chunks` of the rows that begin at `begins` times vectors there, by axis.
#[multiversion::multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2"))]
pub(super) fn field_block(
    entries: &[i16],
    (begins, chunks): (&[usize], &[u32]),
    vectors: [&[f32]; 3],
    out: &mut [Vec3],
) {
    let [x, y, z] = vectors.map(|axis| axis.as_chunks::<LANES>().0);
    for (&begin, out) in begins.iter().zip(out) {
        let (row, _) = entries[begin..].as_chunks::<LANES>();
        let (mut along_x, mut along_y, mut along_z) = ([0.0; LANES], [0.0; LANES], [0.0; LANES]);
        for (((&at, x), y), z) in chunks.iter().zip(x).zip(y).zip(z) {
            let entries = &row[at as usize];
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
    for half in [8, 4, 2, 1] {
        for lane in 0..half {
            sums[lane] += sums[lane + half];
        }
    }
    sums[0]
}
