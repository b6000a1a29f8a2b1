//! The symmetric tangential compliance of contact sites: one 2 x 2 block a pair, stored once.

use thenar_surface::Vec3;

use crate::solve::row_runs::Entry;

/// A vector field in tangent planes, `n` first components and then `n` second ones.
pub type Planar = Vec<f64>;

/// Compliance `u = A q`, mm/N: blocks (i, j) for j > i row by row, as runs of xx, xy, yx and yy.
#[derive(Debug, Clone)]
pub struct ShearMatrix<T> {
    len: usize,
    values: Vec<T>,
    /// xx, xy, yy of the blocks (i, i).
    own: Vec<[f64; 3]>,
}

impl<T: Entry> ShearMatrix<T> {
    /// Mean of the two diagonal entries of a site, mm/N.
    pub fn own(&self, site: usize) -> f64 {
        0.5 * (self.own[site][0] + self.own[site][2])
    }

    /// `A q`.
    pub fn times(&self, q: &[f64], out: &mut [f64]) {
        let (x, y) = q.split_at(self.len);
        let (out_x, out_y) = out.split_at_mut(self.len);
        for (i, [xx, xy, yy]) in self.own.iter().enumerate() {
            out_x[i] = xx * x[i] + xy * y[i];
            out_y[i] = xy * x[i] + yy * y[i];
        }
        multiply(&self.values, [x, y], [out_x, out_y]);
    }

    /// Largest absolute row sum: a bound of the largest eigenvalue, mm/N.
    pub fn norm_bound(&self) -> f64 {
        let n = self.len;
        let mut sums = vec![0.0; 2 * n];
        for (i, [xx, xy, yy]) in self.own.iter().enumerate() {
            sums[i] = xx.abs() + xy.abs();
            sums[n + i] = xy.abs() + yy.abs();
        }
        let mut rest = &self.values[..];
        for i in 0..n {
            let m = n - 1 - i;
            let (row, after) = rest.split_at(4 * m);
            rest = after;
            for k in 0..m {
                let [xx, xy, yx, yy] = [0, 1, 2, 3].map(|c| row[c * m + k].wide().abs());
                sums[i] += xx + xy;
                sums[n + i] += yx + yy;
                sums[i + 1 + k] += xx + yx;
                sums[n + i + 1 + k] += xy + yy;
            }
        }
        sums.into_iter().fold(f64::MIN_POSITIVE, f64::max)
    }

    /// The matrix in single precision.
    pub fn narrow(&self) -> ShearMatrix<f32> {
        ShearMatrix {
            len: self.len,
            values: self.values.iter().map(|v| v.narrow()).collect(),
            own: self.own.clone(),
        }
    }
}

impl ShearMatrix<f32> {
    /// The matrix of `n` sites from their own compliance (mm/N, every direction) and `block(i, j)` (xx, xy, yx, yy), j > i.
    pub fn from_blocks(own: &[f64], mut block: impl FnMut(usize, usize) -> [f64; 4]) -> Self {
        let n = own.len();
        let mut values = vec![0.0f32; 2 * n * n.saturating_sub(1)];
        let mut rest = &mut values[..];
        for i in 0..n {
            let m = n - 1 - i;
            let (row, after) = rest.split_at_mut(4 * m);
            rest = after;
            for k in 0..m {
                for (c, value) in block(i, i + 1 + k).into_iter().enumerate() {
                    row[c * m + k] = value as f32;
                }
            }
        }
        ShearMatrix {
            len: n,
            values,
            own: own.iter().map(|d| [*d, 0.0, *d]).collect(),
        }
    }
}

impl ShearMatrix<f64> {
    /// The matrix from a dense one (2n, 2n), row by row, both components of a site next to each other; its upper half is read.
    pub fn from_dense(dense: &[f64], n: usize) -> Self {
        let entry = |row: usize, column: usize| dense[row * 2 * n + column];
        let mut values = Vec::with_capacity(2 * n * n.saturating_sub(1));
        for i in 0..n {
            for (a, b) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                values.extend((i + 1..n).map(|j| entry(2 * i + a, 2 * j + b)));
            }
        }
        let own = |i| [(0, 0), (0, 1), (1, 1)].map(|(a, b)| entry(2 * i + a, 2 * i + b));
        ShearMatrix {
            len: n,
            values,
            own: (0..n).map(own).collect(),
        }
    }
}

/// Adds what the off-diagonal blocks give, each used for both its sites.
#[multiversion::multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2"))]
fn multiply<T: Entry>(values: &[T], q: [&[f64]; 2], out: [&mut [f64]; 2]) {
    const LANES: usize = 16;
    let ([x, y], [out_x, out_y]) = (q, out);
    let n = x.len();
    let mut rest = values;
    for i in 0..n {
        let m = n - 1 - i;
        let (row, after) = rest.split_at(4 * m);
        rest = after;
        let (xx, row) = row.split_at(m);
        let (xy, row) = row.split_at(m);
        let (yx, yy) = row.split_at(m);
        let (xi, yi) = (x[i], y[i]);
        let (xs, ys) = (&x[i + 1..], &y[i + 1..]);
        let (mut sum_x, mut sum_y) = ([0.0; LANES], [0.0; LANES]);
        let whole = m - m % LANES;
        {
            let (to_x, to_y) = (&mut out_x[i + 1..], &mut out_y[i + 1..]);
            for k in (0..whole).step_by(LANES) {
                let part = k..k + LANES;
                let [a, b] = [&xx[part.clone()], &xy[part.clone()]];
                let [c, d] = [&yx[part.clone()], &yy[part.clone()]];
                let [px, py] = [&xs[part.clone()], &ys[part.clone()]];
                let (ox, oy) = (&mut to_x[part.clone()], &mut to_y[part]);
                for l in 0..LANES {
                    let (a, b, c, d) = (a[l].wide(), b[l].wide(), c[l].wide(), d[l].wide());
                    sum_x[l] += a * px[l] + b * py[l];
                    sum_y[l] += c * px[l] + d * py[l];
                    ox[l] += a * xi + c * yi;
                    oy[l] += b * xi + d * yi;
                }
            }
            for k in whole..m {
                let (a, b, c, d) = (xx[k].wide(), xy[k].wide(), yx[k].wide(), yy[k].wide());
                sum_x[0] += a * xs[k] + b * ys[k];
                sum_y[0] += c * xs[k] + d * ys[k];
                to_x[k] += a * xi + c * yi;
                to_y[k] += b * xi + d * yi;
            }
        }
        for half in [8, 4, 2, 1] {
            for l in 0..half {
                sum_x[l] += sum_x[l + half];
                sum_y[l] += sum_y[l + half];
            }
        }
        out_x[i] += sum_x[0];
        out_y[i] += sum_y[0];
    }
}

/// Two unit vectors in the plane across `normal`, right-handed with it.
pub fn tangents(normal: &Vec3) -> [Vec3; 2] {
    // Frisvad 2012, as revised by Duff et al. 2017: continuous but for one place.
    let sign = 1f64.copysign(normal.z);
    let a = -1.0 / (sign + normal.z);
    let b = normal.x * normal.y * a;
    [
        Vec3::new(
            1.0 + sign * normal.x * normal.x * a,
            sign * b,
            -sign * normal.x,
        ),
        Vec3::new(b, sign + normal.y * normal.y * a, -normal.y),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stored_once_multiplies_like_the_dense_matrix() {
        for n in [1usize, 2, 19, 40] {
            let entry = |i: usize, j: usize| {
                let (i, j) = (i.min(j) as f64, i.max(j) as f64);
                (i * 0.37 + j * 0.11).sin()
            };
            let dense: Vec<f64> = (0..4 * n * n)
                .map(|k| entry(k / (2 * n), k % (2 * n)))
                .collect();
            let matrix = ShearMatrix::from_dense(&dense, n);
            let q: Vec<f64> = (0..2 * n).map(|i| (i as f64 * 0.7).cos()).collect();
            let mut out = vec![0.0; 2 * n];
            matrix.times(&q, &mut out);
            for i in 0..n {
                for a in 0..2 {
                    let expected: f64 = (0..2 * n)
                        .map(|c| dense[(2 * i + a) * 2 * n + c] * q[(c % 2) * n + c / 2])
                        .sum();
                    assert!((out[a * n + i] - expected).abs() < 1e-12, "{n} {i} {a}");
                }
            }
        }
    }

    #[test]
    fn tangents_are_orthonormal_everywhere() {
        for (x, y, z) in [
            (0.0, 0.0, 1.0),
            (0.0, 0.0, -1.0),
            (0.6, 0.0, 0.8),
            (0.48, -0.6, -0.64),
        ] {
            let n = Vec3::new(x, y, z);
            let [a, b] = tangents(&n);
            for (value, wanted) in [
                (a.dot(&b), 0.0),
                (a.dot(&n), 0.0),
                (b.dot(&n), 0.0),
                (a.norm(), 1.0),
                (b.norm(), 1.0),
            ] {
                assert!((value - wanted).abs() < 1e-14);
            }
            assert!((a.cross(&b) - n).norm() < 1e-14);
        }
    }
}
