//! Empirical factor on the force over one variable, and the share of misfit that it removes on held-out protocols.

use nalgebra::{DMatrix, DVector};

use crate::interpolation::interval;
use crate::observe::measured::Phase;

/// Variables of a point.
pub const VARIABLES: usize = 6;
/// Points of a correction's curve.
const KNOTS: usize = 10;
/// Part of its range within which values are one.
const ALIKE: f64 = 0.01;
/// Least misfit, over what noise leaves, of which a part can be told.
const LEAST: f64 = 0.2;
/// Weight of its bends, over that of the recordings.
const SMOOTH: f64 = 1e-3;

/// What repeats share at one row of a protocol.
pub struct Point {
    /// Its protocol, by number.
    pub protocol: usize,
    /// Variables that a curve may go over.
    pub x: [f64; VARIABLES],
    /// The first of its recordings, by number in the study.
    pub recording: usize,
    /// Of the motion.
    pub phase: Phase,
    /// Force with parameters alone, N; and what is measured more.
    pub base: f64,
    /// N.
    pub off: f64,
    /// One over the variance of `off`, 1/N2.
    pub weight: f64,
}

/// Part of what repeats share, beyond noise, that curves over a variable remove on the protocols that each was not fitted to; None of fewer
/// than two protocols, or where there is nothing to remove.
pub fn removed(points: &[Point], how: (usize, bool)) -> Option<f64> {
    let mut protocols: Vec<usize> = points.iter().map(|p| p.protocol).collect();
    protocols.dedup();
    if protocols.len() < 2 {
        return None;
    }
    let (mut before, mut after) = (0.0, 0.0);
    for held in protocols {
        let (out, used): (Vec<&Point>, Vec<&Point>) =
            points.iter().partition(|p| p.protocol == held);
        let curve = Factors::of(&used, how);
        for point in out {
            before += point.weight * point.off * point.off;
            after += point.weight
                * (point.off - point.base * curve.at(point.x[how.0], point.phase)).powi(2);
        }
    }
    let noise = points.len() as f64;
    let beyond = before - noise;
    (beyond > LEAST * noise).then(|| ((before - after) / beyond).min(1.0))
}

/// A factor less 1 over a variable.
#[derive(Debug, Clone, PartialEq)]
pub struct Factors {
    /// Values of the variable.
    pub knots: Vec<f64>,
    /// The factor less 1 there: going in and held, and going out.
    pub change: [Vec<f64>; 2],
}

impl Factors {
    /// By weighted least squares, with little weight on its bends; `how`: variable, and whether going out is apart.
    pub fn of(points: &[&Point], (variable, is_apart): (usize, bool)) -> Factors {
        let mut values: Vec<f64> = points.iter().map(|p| p.x[variable]).collect();
        values.sort_by(f64::total_cmp);
        // A hold is one depth, however many samples it has.
        let apart = ALIKE * (values[values.len() - 1] - values[0]);
        values.dedup_by(|b, a| *b - *a <= apart);
        let quantile = |k: usize| values[(values.len() - 1) * k / (KNOTS - 1)];
        let mut knots: Vec<f64> = (0..KNOTS).map(quantile).collect();
        knots.dedup();
        let side = |is_leaving: bool| {
            let own = |p: &&&Point| !is_apart || (p.phase == Phase::Unload) == is_leaving;
            let all: Vec<&Point> = points.iter().filter(own).copied().collect();
            fitted(&all, (&knots, variable))
        };
        let change = [side(false), side(true)];
        Factors { knots, change }
    }

    /// The factor less 1 at a value of the variable.
    pub fn at(&self, x: f64, phase: Phase) -> f64 {
        let hats = hats(&self.knots, x);
        let side = &self.change[usize::from(phase == Phase::Unload)];
        hats.iter().map(|(k, share)| share * side[*k]).sum()
    }
}

fn fitted(points: &[&Point], (knots, variable): (&[f64], usize)) -> Vec<f64> {
    let n = knots.len();
    let (mut gram, mut side) = (DMatrix::<f64>::zeros(n, n), DVector::<f64>::zeros(n));
    for point in points {
        let hats = hats(knots, point.x[variable]);
        for (i, a) in &hats {
            side[*i] += point.weight * point.base * a * point.off;
            for (j, b) in &hats {
                gram[(*i, *j)] += point.weight * (point.base * a) * (point.base * b);
            }
        }
    }
    let scale = SMOOTH * gram.trace().max(f64::MIN_POSITIVE);
    for k in 1..n.saturating_sub(1) {
        let bend = [(k - 1, 1.0), (k, -2.0), (k + 1, 1.0)];
        for (i, a) in bend {
            for (j, b) in bend {
                gram[(i, j)] += scale * a * b;
            }
        }
    }
    for k in 0..n {
        gram[(k, k)] += 1e-6 * scale;
    }
    let found = gram.cholesky().map(|root| root.solve(&side));
    found.map_or_else(|| vec![0.0; n], |found| found.as_slice().to_vec())
}

/// Knots that have a share in a value, which is held at the ends.
fn hats(knots: &[f64], x: f64) -> Vec<(usize, f64)> {
    let last = knots.len() - 1;
    let x = x.clamp(knots[0], knots[last]);
    if last == 0 {
        return vec![(0, 1.0)];
    }
    let (k, share) = interval(knots, x);
    vec![(k, 1.0 - share), (k + 1, share)]
}

#[cfg(test)]
mod tests {
    use super::hats;

    #[test]
    fn hat_functions_partition_unity() {
        let knots = [1.0, 2.0, 4.0];
        assert_eq!(hats(&knots, 3.0), [(1, 0.5), (2, 0.5)]);
        assert_eq!(hats(&knots, 9.0), [(1, 0.0), (2, 1.0)]);
        assert_eq!(hats(&knots, 0.0), [(0, 1.0), (1, 0.0)]);
        assert_eq!(hats(&[1.0], 5.0), [(0, 1.0)]);
    }
}
