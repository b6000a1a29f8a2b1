//! Robust scale: roughness of a series about a smooth course, and the median.

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
    median(&mut differences) * 1.4826 / 20f64.sqrt()
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
