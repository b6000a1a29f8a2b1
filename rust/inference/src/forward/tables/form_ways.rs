//! Ways in which the form of a model's force over depth may be off.

/// Number of ways.
pub(crate) const WAYS: usize = 7;

/// Part of the depth over which an error at first touch dies away.
const FIRST: f64 = 0.05;

/// Ways at a depth, as a share of the depth that they are for: the whole, tilt and bend over depth, first touch, and Legendre's
/// polynomials of third to fifth order.
pub(crate) fn ways(share: f64) -> [f64; WAYS] {
    let x = 2.0 * share - 1.0;
    let square = x * x;
    [
        1.0,
        x,
        6.0 * share * (share - 1.0) + 1.0,
        libm::exp(-share / FIRST),
        0.5 * x * (5.0 * square - 3.0),
        0.125 * ((35.0 * square - 30.0) * square + 3.0),
        0.125 * x * ((63.0 * square - 70.0) * square + 15.0),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// All but first touch are orthogonal over the depth, with the squares of Legendre's polynomials, 1 / (2 n + 1).
    #[test]
    fn ways_of_the_form_are_orthogonal() {
        let at: Vec<_> = (0..2000)
            .map(|k| ways((f64::from(k) + 0.5) / 2000.0))
            .collect();
        let product = |i: usize, j: usize| at.iter().map(|m| m[i] * m[j]).sum::<f64>() / 2000.0;
        let orders = [0, 1, 2, 4, 5, 6];
        for (n, i) in orders.into_iter().enumerate() {
            for j in orders.into_iter().take(n) {
                assert!(product(i, j).abs() < 1e-5, "{i} {j}");
            }
            assert!(
                (product(i, i) * (2 * n + 1) as f64 - 1.0).abs() < 1e-4,
                "{i}"
            );
        }
    }
}
