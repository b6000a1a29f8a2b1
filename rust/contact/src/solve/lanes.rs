//! What products leave in the lanes of their registers, added up.

use std::ops::AddAssign;

/// The sum of all lanes, each half added to the other.
///
/// Called and not inlined: where it is, the compiler makes its pairs of the whole loop before it, a pair a register.
#[inline(never)]
pub fn total<T: Copy + AddAssign>(lanes: &[T; 32]) -> T {
    let mut sums = *lanes;
    for half in [16, 8, 4, 2, 1] {
        for lane in 0..half {
            let other = sums[lane + half];
            sums[lane] += other;
        }
    }
    sums[0]
}

#[cfg(test)]
mod tests {
    use super::total;

    #[test]
    fn every_lane_counts_once() {
        let lanes: [f64; 32] = std::array::from_fn(|lane| (1_u64 << lane) as f64);
        assert_eq!(total(&lanes), ((1_u64 << 32) - 1) as f64);
    }
}
