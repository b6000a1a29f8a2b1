//! Which column of a table is what, as a user says: `travel_mm = "-Extension"`.

use super::columns::{Column, normal};
use super::names::quantity;
use crate::fault::shown;
use crate::text::units::{Unit, unit};

/// What a column can be named as.
const NAMED: &[&str] = &[
    "time",
    "depth",
    "travel",
    "force",
    "tangential_force",
    "slide",
    "area",
];
/// The same, for messages.
const KEYS: &str = "time, depth, travel, force, tangential_force, slide or area, with a unit behind it \
                    (travel_mm) where the file states none";

/// Columns of a table that a user names, because the file calls them otherwise or does not say what they are.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Columns(Vec<Named>);

/// One column, named.
#[derive(Debug, Clone, PartialEq)]
struct Named {
    what: &'static str,
    /// The unit in the key, where there is one.
    unit: Option<Unit>,
    unit_text: String,
    /// As the file calls it.
    header: String,
    /// A minus before the name: the numbers count the other way.
    is_reversed: bool,
}

impl Columns {
    /// Adds a column: `key` is what it holds, such as `travel` or `force_n`, `header` its name in the file; a minus before the name turns
    /// the sign.
    ///
    /// # Errors
    /// What is wrong with the key, with a remedy: it is not known, its unit does not fit, or it was given before.
    pub fn add(&mut self, key: &str, header: &str) -> Result<(), String> {
        let column = Column::of(key);
        let base = normal(key);
        let found = NAMED
            .iter()
            .find(|what| **what == column.base || **what == base);
        let Some(what) = found else {
            return Err(format!(
                "{} is nothing that a column can hold; use {KEYS}",
                shown(key.as_bytes())
            ));
        };
        let has_unit = column.base == *what && !column.unit_text.is_empty();
        let unit = unit(&column.unit_text).filter(|_| has_unit);
        if has_unit && unit.map(|unit| unit.quantity) != quantity(what) {
            return Err(format!(
                "{} is not a unit of {what}; use {KEYS}",
                shown(column.unit_text.as_bytes())
            ));
        }
        if self.0.iter().any(|named| named.what == *what) {
            return Err(format!("{what} is given twice; leave one of them out"));
        }
        let (header, is_reversed) = match header.trim().strip_prefix('-') {
            Some(rest) => (rest.trim(), true),
            None => (header.trim(), false),
        };
        if header.is_empty() {
            return Err(format!("{what} names no column; give its name in the file"));
        }
        self.0.push(Named {
            what,
            unit,
            unit_text: column.unit_text,
            header: header.to_string(),
            is_reversed,
        });
        Ok(())
    }

    /// Whether nothing is named.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// The names that the file must have, for messages.
    pub(crate) fn headers(&self) -> String {
        let headers: Vec<String> = self
            .0
            .iter()
            .map(|named| shown(named.header.as_bytes()))
            .collect();
        headers.join(", ")
    }

    /// Names the columns of a head, in each run that stands side by side. Whether all that a user named are there.
    pub(crate) fn apply(&self, columns: &mut [Column]) -> bool {
        let found: Option<Vec<usize>> = self.0.iter().map(|named| named.find(columns)).collect();
        let Some(found) = found else { return false };
        let width = run_width(columns);
        for (named, &at) in self.0.iter().zip(&found) {
            for (k, column) in columns.iter_mut().enumerate() {
                if k % width == at % width {
                    column.base = named.what.to_string();
                    column.is_reversed = named.is_reversed;
                    if column.unit.is_none() && named.unit.is_some() {
                        column.unit = named.unit;
                        column.unit_text.clone_from(&named.unit_text);
                    }
                } else if column.base == named.what && found.iter().all(|f| k % width != f % width)
                {
                    // What the user did not name is kept under the file's own name.
                    column.base = format!("file_{}", normal(&column.header));
                }
            }
        }
        true
    }
}

/// Columns of each run where runs of the same names stand side by side, or all.
fn run_width(columns: &[Column]) -> usize {
    let count = columns.len();
    let is_repeated = |width: &usize| {
        let mut rest = columns.iter().zip(columns.iter().skip(*width));
        count.is_multiple_of(*width) && rest.all(|(a, b)| a.header == b.header)
    };
    (2..count).find(is_repeated).unwrap_or(count.max(1))
}

impl Named {
    fn find(&self, columns: &[Column]) -> Option<usize> {
        let wanted = normal(&self.header);
        let whole = columns
            .iter()
            .position(|column| normal(&column.header) == wanted);
        let named = || columns.iter().position(|column| column.base == wanted);
        whole.or_else(named).or_else(|| {
            let bare = |column: &&Column| {
                normal(column.header.split(['(', '[']).next().unwrap_or("")) == wanted
            };
            let mut bare = columns
                .iter()
                .enumerate()
                .filter(|(_, column)| bare(column));
            bare.next()
                .filter(|_| bare.next().is_none())
                .map(|(k, _)| k)
        })
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn a_column_is_found_by_its_name_with_or_without_unit() {
        for (key, header) in [
            ("travel", "Extension (mm)"),
            ("travel_mm", "extension"),
            ("travel", "-Extension"),
        ] {
            let mut named = Columns::default();
            named.add(key, header).unwrap();
            let mut columns = [Column::of("Extension (mm)"), Column::of("Distance (mm)")];
            assert!(named.apply(&mut columns), "{key} {header}");
            assert_eq!(columns[0].base, "travel");
            assert_eq!(columns[1].base, "file_distance_(mm)");
            assert_eq!(columns[0].is_reversed, header.starts_with('-'));
        }
        let mut named = Columns::default();
        named.add("travel", "Weg").unwrap();
        assert!(!named.apply(&mut [Column::of("Extension (mm)")]));
    }

    #[test]
    fn a_key_that_is_not_known_or_does_not_fit_is_refused() {
        for (key, expected) in [
            (
                "thickness",
                "'thickness' is nothing that a column can hold; use time, depth",
            ),
            ("travel_n", "'n' is not a unit of travel; use"),
            ("force_furlong", "'furlong' is not a unit of force; use"),
        ] {
            let found = Columns::default().add(key, "x").unwrap_err();
            assert!(found.starts_with(expected), "{found}");
        }
        let mut named = Columns::default();
        named.add("force_n", "a").unwrap();
        assert!(
            named
                .add("force", "b")
                .unwrap_err()
                .starts_with("force is given twice")
        );
        assert!(
            named
                .add("time", "-")
                .unwrap_err()
                .starts_with("time names no column")
        );
    }
}
