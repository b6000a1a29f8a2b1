//! Round numbers on an axis.

/// Power of ten of a last digit below which ticks are written with one.
const SMALLEST_POWER: i32 = -4;

/// Places of round ticks (1, 2 or 5 times a power of ten) within a range, at most about `most` of them, and their texts.
pub fn ticks(low: f64, high: f64, most: usize) -> Vec<(f64, String)> {
    if !(low.is_finite() && high.is_finite() && high > low) {
        return Vec::new();
    }
    let (step, power) = step((high - low) / most.max(1) as f64);
    let decimals = (-power).max(0) as usize;
    // Beyond this the digits leave no room for the axis: a power of ten says it.
    let is_small = power < SMALLEST_POWER;
    let (first, last) = (
        (low / step - 1e-9).ceil() as i64,
        (high / step + 1e-9).floor() as i64,
    );
    let tick = |k: i64| {
        let value = k as f64 * step;
        let text = match is_small && k != 0 {
            true => in_powers(value.abs()),
            false if is_small => "0".into(),
            false => format!("{:.decimals$}", value.abs()),
        };
        let sign = if k < 0 { "\u{2212}" } else { "" };
        (value, format!("{sign}{text}"))
    };
    (first..=last).map(tick).collect()
}

/// A tick as a power of ten, `5×10⁻⁹`: its digits are few, since ticks are round.
fn in_powers(value: f64) -> String {
    let text = thenar_inference::number_format::number(value);
    match text.split_once('\u{00d7}') {
        Some((digits, power)) if digits.contains('.') => {
            let digits = digits.trim_end_matches('0').trim_end_matches('.');
            format!("{digits}\u{00d7}{power}")
        }
        _ => text,
    }
}

/// The next round step that is no smaller, and the power of ten of its last digit.
fn step(least: f64) -> (f64, i32) {
    let power = least.log10().floor() as i32;
    let ten = 10_f64.powi(power);
    for digit in [1.0, 2.0, 5.0] {
        if digit * ten >= least * (1.0 - 1e-9) {
            return (digit * ten, power);
        }
    }
    (10.0 * ten, power + 1)
}

/// The least round number (1, 2, 2.5, 5 times a power of ten) that is no smaller, for the top of a color scale.
pub fn round_up(value: f64) -> f64 {
    if !(value.is_finite() && value > 0.0) {
        return 1.0;
    }
    let ten = 10_f64.powf(value.log10().floor());
    let steps = [1.0, 1.2, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0];
    let found = steps
        .iter()
        .find(|digit| *digit * ten >= value * (1.0 - 1e-9));
    found.map_or(10.0 * ten, |digit| digit * ten)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn ticks_are_round() {
        let texts = |low, high, most| {
            ticks(low, high, most)
                .into_iter()
                .map(|(_, text)| text)
                .collect::<Vec<_>>()
        };
        assert_eq!(
            texts(0.0, 1.0, 5),
            ["0.0", "0.2", "0.4", "0.6", "0.8", "1.0"]
        );
        assert_eq!(texts(-3.0, 3.0, 4), ["−2", "0", "2"]);
        assert_eq!(
            texts(0.0, 260.0, 6),
            ["0", "50", "100", "150", "200", "250"]
        );
        assert_eq!(
            texts(-1e-8, 1e-8, 4),
            ["−1×10⁻⁸", "−5×10⁻⁹", "0", "5×10⁻⁹", "1×10⁻⁸"]
        );
        assert!(ticks(1.0, 1.0, 5).is_empty() && ticks(f64::NAN, 1.0, 5).is_empty());
    }

    proptest! {
        #[test]
        fn ticks_stay_inside(low in -1e6..1e6_f64, size in 1e-6..1e6_f64, most in 2_usize..9) {
            let (high, found) = (low + size, ticks(low, low + size, most));
            let slack = 1e-6 * size + 1e-9 * low.abs();
            prop_assert!(found.len() <= most + 1);
            prop_assert!(found.iter().all(|(value, _)| *value >= low - slack && *value <= high + slack));
        }

        #[test]
        fn scales_hold_their_value(value in 1e-9..1e9_f64) {
            let top = round_up(value);
            prop_assert!(top >= value * (1.0 - 1e-9) && top <= 1.5 * value);
        }
    }
}
