//! Interpolation between growing places: on straight lines, and by monotone cubics (Fritsch & Carlson 1980).

/// The interval between two of growing `places` that holds `at`, and the share of the way through it; beyond the places the first or
/// the last interval, with a share below 0 or above 1.
pub fn interval(places: &[f64], at: f64) -> (usize, f64) {
    let last = places.len() - 1;
    let next = places.partition_point(|place| *place <= at).clamp(1, last);
    let (from, to) = (places[next - 1], places[next]);
    (next - 1, (at - from) / (to - from))
}

/// A value on the straight line through an interval.
pub fn mixed(values: &[f64], (k, share): (usize, f64)) -> f64 {
    values[k] * (1.0 - share) + values[k + 1] * share
}

/// Values at other places, on straight lines; the ends are held.
pub fn linear(places: &[f64], values: &[f64], at: &[f64]) -> Vec<f64> {
    let last = places.len() - 1;
    let one = |at: &f64| match *at {
        at if at >= places[last] => values[last],
        at if at > places[0] => mixed(values, interval(places, at)),
        _ => values[0],
    };
    at.iter().map(one).collect()
}

/// Values at growing places, joined by cubics with continuous slope.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    places: Vec<f64>,
    values: Vec<f64>,
    slopes: Vec<f64>,
}

impl Table {
    /// Joins `values` at growing `places` (two or more).
    pub fn new(places: &[f64], values: Vec<f64>) -> Table {
        let n = places.len();
        let secant = |k: usize| (values[k + 1] - values[k]) / (places[k + 1] - places[k]);
        let slope = |k: usize| {
            let (before, after) = (secant(k - 1), secant(k));
            if before * after <= 0.0 {
                return 0.0;
            }
            // Three-point slope, held within what keeps a monotone table monotone.
            let (left, right) = (places[k] - places[k - 1], places[k + 1] - places[k]);
            let slope = (before * right + after * left) / (left + right);
            let most = 3.0 * before.abs().min(after.abs());
            slope.signum() * slope.abs().min(most)
        };
        // A parabola at the ends.
        let end = |near: f64, far: f64| {
            let slope = 2.0 * near - far;
            if slope * near <= 0.0 { 0.0 } else { slope }
        };
        let mut slopes: Vec<f64> = (0..n)
            .map(|k| if k == 0 || k + 1 == n { 0.0 } else { slope(k) })
            .collect();
        slopes[0] = end(secant(0), slopes[1]);
        slopes[n - 1] = end(secant(n - 2), slopes[n - 2]);
        Table {
            places: places.to_vec(),
            values,
            slopes,
        }
    }

    /// The value at a place; beyond the table on the straight line of its end.
    pub fn at(&self, place: f64) -> f64 {
        let last = self.places.len() - 1;
        if place <= self.places[0] {
            return self.values[0] + self.slopes[0] * (place - self.places[0]);
        }
        if place >= self.places[last] {
            return self.values[last] + self.slopes[last] * (place - self.places[last]);
        }
        let next = self.places.partition_point(|p| *p <= place).min(last);
        let k = next - 1;
        let step = self.places[next] - self.places[k];
        let t = (place - self.places[k]) / step;
        let (s, back) = (t * t * (3.0 - 2.0 * t), 1.0 - t);
        self.values[k] * (1.0 - s)
            + self.values[next] * s
            + step * t * back * (back * self.slopes[k] - t * self.slopes[next])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn straight_lines_meet_the_places_and_hold_the_ends() {
        let (places, values) = ([1.0, 2.0, 4.0], [10.0, 20.0, 0.0]);
        let at = [0.0, 1.0, 1.25, 2.0, 3.0, 4.0, 9.0];
        let wanted = [10.0, 10.0, 12.5, 20.0, 10.0, 0.0, 0.0];
        assert_eq!(linear(&places, &values, &at), wanted);
        assert_eq!(linear(&[3.0], &[7.0], &[2.0, 3.0, 4.0]), [7.0; 3]);
        assert_eq!(interval(&places, 0.0), (0, -1.0));
        assert_eq!(interval(&places, 8.0), (1, 3.0));
    }

    #[test]
    fn hertz_curve_is_interpolated_within_5e_4() {
        let roots: Vec<f64> = (0..=24).map(|k| f64::from(k) / 24.0).collect();
        let table = Table::new(&roots, roots.iter().map(|s| s.powi(3)).collect());
        for k in 1..200 {
            let s = f64::from(k) / 200.0;
            assert!((table.at(s) - s.powi(3)).abs() < 1e-4, "{s}");
        }
    }

    #[test]
    fn interpolation_is_monotone_with_continuous_slope() {
        let table = Table::new(&[0.0, 1.0, 2.0, 3.0], vec![0.0, 0.1, 5.0, 5.0]);
        let h = 1e-6;
        for k in 0..3000 {
            let x = f64::from(k) * 1e-3;
            assert!(table.at(x + 1e-3) >= table.at(x) - 1e-12);
        }
        for x in [1.0, 2.0] {
            let left = (table.at(x) - table.at(x - h)) / h;
            let right = (table.at(x + h) - table.at(x)) / h;
            assert!((left - right).abs() < 1e-4, "{x}: {left} {right}");
        }
    }
}
