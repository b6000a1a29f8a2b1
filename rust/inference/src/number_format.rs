//! Number formats of sentences and tables.

/// Three significant digits; `-` for what is not known.
pub fn number(value: f64) -> String {
    if value.is_nan() {
        return "\u{2013}".into();
    }
    if value.is_infinite() {
        return if value > 0.0 {
            "\u{221e}"
        } else {
            "\u{2212}\u{221e}"
        }
        .into();
    }
    let sign = if value < 0.0 { "\u{2212}" } else { "" };
    let size = value.abs();
    let power = if size > 0.0 {
        size.log10().floor() as i32
    } else {
        0
    };
    let text = match power {
        _ if size == 0.0 => "0".into(),
        5.. => exponential(size),
        ..=-5 => exponential(size),
        power => {
            let decimals = (2 - power).max(0) as usize;
            let unit = 10_f64.powi(power - 2);
            let rounded = (size / unit).round() * unit;
            let text = format!("{rounded:.decimals$}");
            match text.contains('.') {
                true => text.trim_end_matches('0').trim_end_matches('.').to_string(),
                false => text,
            }
        }
    };
    format!("{sign}{text}")
}

fn exponential(size: f64) -> String {
    let text = format!("{size:.2e}");
    let (digits, power) = text.split_once('e').unwrap_or((&text, "0"));
    format!("{digits}\u{00d7}10{}", raised(power))
}

fn raised(power: &str) -> String {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let digit = |letter: char| match letter.to_digit(10) {
        Some(digit) => DIGITS[digit as usize],
        None => '⁻',
    };
    power.chars().map(digit).collect()
}

/// A share in percent, two digits.
pub fn percent(share: f64) -> String {
    // Sums of nothing are -0.
    let percent = 100.0 * share + 0.0;
    match percent {
        _ if percent.is_nan() => "\u{2013}".into(),
        _ if percent.abs() >= 9.95 => format!("{percent:.0} %"),
        _ => format!("{percent:.1} %"),
    }
}

/// A probability: `p = 0.03`, `p < 0.001`.
pub fn chance(p: f64) -> String {
    match p {
        _ if p < 1e-3 => "p < 0.001".into(),
        _ if p < 0.1 => format!("p = {p:.3}"),
        _ => format!("p = {p:.2}"),
    }
}

/// With a capital in front.
pub fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| {
        first.to_uppercase().collect::<String>() + letters.as_str()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_three_digits() {
        let told = [
            0.0, 12.0, 123.4, 0.012345, 99.96, 1234.0, 54321.0, 3.2e-7, -0.5,
        ]
        .map(number);
        let wanted = [
            "0",
            "12",
            "123",
            "0.0123",
            "100",
            "1230",
            "54300",
            "3.20×10⁻⁷",
            "−0.5",
        ];
        assert_eq!(told, wanted);
        assert_eq!(number(f64::NAN), "–");
    }

    #[test]
    fn chances_and_shares_are_short() {
        assert_eq!(
            [0.0001, 0.012, 0.44].map(chance),
            ["p < 0.001", "p = 0.012", "p = 0.44"]
        );
        assert_eq!(
            [0.691, 0.0042, -0.0].map(percent),
            ["69 %", "0.4 %", "0.0 %"]
        );
    }
}
