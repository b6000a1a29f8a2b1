//! A line of text to fields and numbers, with points or commas as decimals.

use crate::fault::{Fault, LARGEST, shown};
use crate::text::lines::Line;

/// Most numbers that one recording may hold: 2^26, half a gigabyte.
pub(crate) const MOST_VALUES: usize = 1 << 26;

/// What stands between two fields.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Separator {
    Comma,
    Semicolon,
    Tab,
    /// Any number of blanks or tabs.
    Blank,
}

impl Separator {
    /// The separator of a line: a tab before a semicolon before a comma before blanks.
    pub fn of(text: &str) -> Separator {
        [Separator::Tab, Separator::Semicolon, Separator::Comma]
            .into_iter()
            .find(|separator| text.contains(separator.letter()))
            .unwrap_or(Separator::Blank)
    }

    /// The fields of a line, without the blanks around them.
    pub fn split(self, text: &str) -> Fields<'_> {
        match self {
            Separator::Blank => Fields::Words(text.split_ascii_whitespace()),
            other => Fields::Parts(text.split(other.letter())),
        }
    }

    fn letter(self) -> char {
        match self {
            Separator::Comma => ',',
            Separator::Semicolon => ';',
            Separator::Tab => '\t',
            Separator::Blank => ' ',
        }
    }
}

/// Iterator of [`Separator::split`].
pub(crate) enum Fields<'a> {
    Words(std::str::SplitAsciiWhitespace<'a>),
    Parts(std::str::Split<'a, char>),
}

impl<'a> Iterator for Fields<'a> {
    type Item = &'a str;

    fn next(&mut self) -> Option<&'a str> {
        match self {
            Fields::Words(words) => words.next(),
            Fields::Parts(parts) => parts.next().map(str::trim),
        }
    }
}

/// A finite number; one comma may stand for the decimal point. Or what is wrong with it.
pub(crate) fn value(text: &str) -> Result<f64, String> {
    let parsed = match text.parse::<f64>() {
        Ok(value) => Some(value),
        Err(_) if !text.contains('.') && text.matches(',').count() == 1 => {
            text.replace(',', ".").parse().ok()
        }
        Err(_) => ungrouped(text).and_then(|text| text.parse().ok()),
    };
    match parsed {
        Some(value) if value.abs() > LARGEST && value.is_finite() => {
            Err(format!("{} is out of range", shown(text.as_bytes())))
        }
        Some(value) if value.is_finite() => Ok(value),
        Some(_) => Err(format!("{} is not a finite number", shown(text.as_bytes()))),
        None => Err(format!("{} is not a number", shown(text.as_bytes()))),
    }
}

/// `1,000.5` or `1.000,5` without what parts the thousands: groups of three digits before the other sign.
fn ungrouped(text: &str) -> Option<String> {
    let at = text.rfind([',', '.'])?;
    let (whole, fraction) = (&text[..at], &text[at + 1..]);
    let between = if text[at..].starts_with('.') {
        ','
    } else {
        '.'
    };
    let mut groups = whole.trim_start_matches(['-', '+']).split(between);
    let is_digits = |group: &str| group.bytes().all(|byte| byte.is_ascii_digit());
    let is_first = groups
        .next()
        .is_some_and(|first| (1..=3).contains(&first.len()) && is_digits(first));
    let is_grouped =
        whole.contains(between) && groups.all(|group| group.len() == 3 && is_digits(group));
    (is_first && is_grouped && is_digits(fraction))
        .then(|| format!("{}.{fraction}", whole.replace(between, "")))
}

/// How the rows of a table of numbers look.
pub(crate) struct Row {
    pub separator: Separator,
    /// Numbers in a row.
    pub columns: usize,
    /// What stands for "no sensel here".
    pub missing: Option<&'static str>,
}

impl Row {
    /// Appends the numbers of a row, NaN where one is missing; empty fields after the last are passed over.
    pub fn read(&self, line: Line, into: &mut Vec<f64>) -> Result<(), Fault> {
        let start = into.len();
        for field in self.separator.split(line.text) {
            let count = into.len() - start;
            if count == self.columns {
                if field.is_empty() {
                    continue;
                }
                let problem = format!("the row holds more than {count} values");
                return Err(line.fault(problem, DAMAGED));
            }
            if Some(field) == self.missing {
                into.push(f64::NAN);
                continue;
            }
            if field.is_empty() {
                break;
            }
            into.push(value(field).map_err(|problem| line.fault(problem, ODD))?);
        }
        let count = into.len() - start;
        if count < self.columns {
            let problem = format!("the row holds {count} values, expected {}", self.columns);
            return Err(line.fault(problem, DAMAGED));
        }
        if into.len() > MOST_VALUES {
            let problem = format!("the recording holds more than {MOST_VALUES} values");
            return Err(line.fault(problem, "export a shorter part of it"));
        }
        Ok(())
    }
}

/// What to do about a file that is not as its maker writes it.
pub(crate) const DAMAGED: &str = "the file is damaged or cut short; export it again";
/// What to do about a line that cannot be understood, although nothing is missing.
pub(crate) const ODD: &str =
    "this maker's exports are not known to hold such a line; export it again, or report the file";

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn points_and_commas_are_decimals_and_nothing_else_is_a_number() {
        for text in ["1.5", "1,5", "+1.5", "15e-1", "1,5"] {
            assert_eq!(value(text), Ok(1.5), "{text}");
        }
        for (text, expected) in [("1,000.5", 1000.5), ("-1.234.567,25", -1_234_567.25)] {
            assert_eq!(value(text), Ok(expected), "{text}");
        }
        for text in ["1,000,292", "1,00.5", "1000,000.5", "1.000.5", ",000.5"] {
            assert!(value(text).is_err(), "{text}");
        }
        for text in ["", "1,2,3", "1.2,3", "x", "--1", "1 5"] {
            assert!(
                value(text).unwrap_err().ends_with("is not a number"),
                "{text}"
            );
        }
        for text in ["nan", "inf", "-Infinity", "1e999"] {
            assert!(value(text).unwrap_err().ends_with("is not a finite number"));
        }
    }

    #[test]
    fn a_row_has_all_its_values_or_is_refused() {
        let row = Row {
            separator: Separator::Comma,
            columns: 3,
            missing: Some("B"),
        };
        let read = |text: &str| {
            let mut values = Vec::new();
            row.read(Line { number: 7, text }, &mut values)
                .map(|()| values)
        };
        let values = read("1, B,3,,,").unwrap();
        assert!(values[0] == 1.0 && values[1].is_nan() && values[2] == 3.0 && values.len() == 3);
        for (text, problem) in [
            ("1,2", "the row holds 2 values, expected 3"),
            ("1,,3", "the row holds 1 values, expected 3"),
            ("1,2,3,4", "the row holds more than 3 values"),
        ] {
            assert_eq!(read(text), Err(Fault::line(7, problem.into(), DAMAGED)));
        }
        // What is no number is not for that reason damaged.
        assert_eq!(
            read("1,b,3"),
            Err(Fault::line(7, "'b' is not a number".into(), ODD))
        );
    }
}
