//! Matrices of three by three, row by row.

pub type Matrix3 = [[f64; 3]; 3];

/// Cofactors: the determinant times the inverse's transpose.
#[inline(always)]
pub fn cofactors(m: &Matrix3) -> Matrix3 {
    std::array::from_fn(|i| {
        std::array::from_fn(|j| {
            let (a, b) = ((i + 1) % 3, (i + 2) % 3);
            let (c, d) = ((j + 1) % 3, (j + 2) % 3);
            m[a][c] * m[b][d] - m[a][d] * m[b][c]
        })
    })
}

/// Inverse and determinant.
pub fn inverse(m: &Matrix3) -> (Matrix3, f64) {
    let cofactors = cofactors(m);
    let determinant =
        m[0][0] * cofactors[0][0] + m[0][1] * cofactors[0][1] + m[0][2] * cofactors[0][2];
    let inverse = std::array::from_fn(|i| std::array::from_fn(|j| cofactors[j][i] / determinant));
    (inverse, determinant)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inverse_times_matrix_is_the_identity() {
        let m = [[2.0, -1.0, 0.5], [0.3, 1.5, -0.2], [-0.7, 0.4, 1.1]];
        let (inverse, determinant) = inverse(&m);
        for i in 0..3 {
            for j in 0..3 {
                let product: f64 = (0..3).map(|k| inverse[i][k] * m[k][j]).sum();
                assert!((product - f64::from(i == j)).abs() < 1e-14);
            }
        }
        let expected =
            2.0 * (1.5 * 1.1 + 0.2 * 0.4) + (0.3 * 1.1 - 0.2 * 0.7) + 0.5 * (0.3 * 0.4 + 1.5 * 0.7);
        assert!((determinant - expected).abs() < 1e-14);
    }
}
