//! Robust scale: standard deviation from the median of sizes, of a series about a smooth course, and the median.

/// Standard deviation of a series' noise, from its third differences: a smooth course leaves almost none, and the median is
/// moved by neither turning points nor outliers. 0 for fewer than 5 values.
///
/// A third difference of independent noise has the variance (1 + 9 + 9 + 1) s^2.
pub(crate) fn noise_of(values: &[f64]) -> f64 {
    if values.len() < 5 {
        return 0.0;
    }
    let third = |w: &[f64]| (w[3] - 3.0 * w[2] + 3.0 * w[1] - w[0]).abs();
    let mut differences: Vec<f64> = values.windows(4).map(third).collect();
    median_deviation(&mut differences) / 20f64.sqrt()
}

/// Standard deviation of normal numbers from the median of their sizes, which sorts the list; NaN of none.
pub fn median_deviation(sizes: &mut [f64]) -> f64 {
    1.4826 * median(sizes)
}

/// Root mean square of the values within `most` deviations of 0, as the median of their sizes has it; NaN of none.
pub fn trimmed_deviation(values: &[f64], most: f64) -> f64 {
    let mut sizes: Vec<f64> = values.iter().map(|v| v.abs()).collect();
    let most = most * median_deviation(&mut sizes);
    let kept = values.iter().filter(|v| v.abs() <= most);
    let (sum, count) = kept.fold((0.0, 0.0), |(sum, n), v| (sum + v * v, n + 1.0));
    f64::sqrt(sum / count)
}

/// Median, which sorts the list; NaN of none.
pub fn median(values: &mut [f64]) -> f64 {
    if values.is_empty() {
        return f64::NAN;
    }
    values.sort_by(f64::total_cmp);
    let middle = values.len() / 2;
    match values.len() % 2 {
        1 => values[middle],
        _ => 0.5 * (values[middle - 1] + values[middle]),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    #[test]
    fn noise_on_a_curve_is_recovered() {
        let mut random = Random::new(1);
        let value = |k: i32| (f64::from(k) * 0.01).powf(1.5);
        let values: Vec<f64> = (0..1000)
            .map(|k| value(k) + 0.02 * random.normal())
            .collect();
        let noise = noise_of(&values);
        assert!((noise / 0.02 - 1.0).abs() < 0.1, "{noise}");
    }
}
