//! Skeletons: the interpolative decomposition of a block by pivoted orthogonalization.
//!
//! Cheng, Gimbutas, Martinsson & Rokhlin 2005, by Gram-Schmidt with row pivoting.

/// Chosen rows, and every row as a sum of them.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Skeleton {
    /// Rows that were chosen.
    pub chosen: Vec<usize>,
    /// Share of each chosen row in every row, row by row; what is left out of a row is at most the tolerance.
    pub transfer: Vec<f64>,
}

/// Chooses rows of a block (`columns` entries each), until what is left of each is within `tolerance` of the largest.
///
/// The block is used up.
pub fn skeleton(block: &mut [f64], columns: usize, tolerance: f64) -> Skeleton {
    let rows = block.len() / columns.max(1);
    let mut left: Vec<f64> = block.chunks(columns).map(|row| dot(row, row)).collect();
    let enough = tolerance * tolerance * left.iter().fold(0.0, |most, v| f64::max(most, *v));
    // shares[k]: what every row has of the k-th direction.
    let mut shares: Vec<Vec<f64>> = Vec::new();
    let mut chosen: Vec<usize> = Vec::new();
    let mut is_chosen = vec![false; rows];
    while chosen.len() < rows {
        let open = (0..rows).filter(|&i| !is_chosen[i]);
        let Some(pivot) = open.max_by(|&a, &b| left[a].total_cmp(&left[b]).then(b.cmp(&a))) else {
            break;
        };
        if left[pivot] <= enough {
            break;
        }
        let length = dot(row(block, columns, pivot), row(block, columns, pivot)).sqrt();
        let scaled = row(block, columns, pivot).iter().map(|v| v / length);
        let direction: Vec<f64> = scaled.collect();
        let mut share = vec![0.0; rows];
        share[pivot] = length;
        is_chosen[pivot] = true;
        chosen.push(pivot);
        for i in (0..rows).filter(|&i| !is_chosen[i]) {
            let other = &mut block[i * columns..(i + 1) * columns];
            share[i] = dot(other, &direction);
            subtract(other, &direction, share[i]);
            left[i] -= share[i] * share[i];
        }
        shares.push(share);
    }
    let transfer = transfer(&chosen, &shares, rows);
    Skeleton { chosen, transfer }
}

/// Solves the triangular systems that turn shares of directions into shares of chosen rows.
fn transfer(chosen: &[usize], shares: &[Vec<f64>], rows: usize) -> Vec<f64> {
    let rank = chosen.len();
    let mut transfer = vec![0.0; rows * rank];
    for (i, x) in transfer.chunks_mut(rank.max(1)).enumerate() {
        if let Some(own) = chosen.iter().position(|&c| c == i) {
            x[own] = 1.0;
            continue;
        }
        for k in (0..rank).rev() {
            let known: f64 = (k + 1..rank).map(|m| shares[k][chosen[m]] * x[m]).sum();
            x[k] = (shares[k][i] - known) / shares[k][chosen[k]];
        }
    }
    transfer
}

fn row(block: &[f64], columns: usize, i: usize) -> &[f64] {
    &block[i * columns..(i + 1) * columns]
}

#[multiversion::multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2"))]
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let (a16, a_rest) = a.as_chunks::<16>();
    let (b16, b_rest) = b.as_chunks::<16>();
    let mut sums = [0.0; 16];
    for (a, b) in a16.iter().zip(b16) {
        for lane in 0..16 {
            sums[lane] += a[lane] * b[lane];
        }
    }
    let tail: f64 = a_rest.iter().zip(b_rest).map(|(a, b)| a * b).sum();
    sums.iter().sum::<f64>() + tail
}

#[multiversion::multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2"))]
fn subtract(row: &mut [f64], direction: &[f64], share: f64) {
    for (v, d) in row.iter_mut().zip(direction) {
        *v -= share * d;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_row_is_interpolated_from_the_skeleton() {
        // 1/r between two separate stretches of a line.
        let (rows, columns) = (60, 80);
        let entry = |i: usize, j: usize| 1.0 / (20.0 + i as f64 * 0.1 + j as f64 * 0.7);
        let full: Vec<f64> = (0..rows * columns)
            .map(|k| entry(k / columns, k % columns))
            .collect();
        let found = skeleton(&mut full.clone(), columns, 1e-6);
        assert!(found.chosen.len() < 8, "{}", found.chosen.len());
        let largest = (0..columns).map(|j| full[j].powi(2)).sum::<f64>().sqrt();
        for i in 0..rows {
            let share = &found.transfer[i * found.chosen.len()..][..found.chosen.len()];
            let off = (0..columns).map(|j| {
                let told: f64 = found
                    .chosen
                    .iter()
                    .zip(share)
                    .map(|(&c, s)| s * entry(c, j))
                    .sum();
                (told - entry(i, j)).powi(2)
            });
            assert!(off.sum::<f64>().sqrt() < 2e-6 * largest, "{i}");
        }
    }

    #[test]
    fn rows_of_nothing_need_none() {
        let found = skeleton(&mut [0.0; 12], 4, 1e-6);
        assert!(found.chosen.is_empty() && found.transfer.is_empty());
    }
}
