//! Column names with their units: `time_s`, `force_mN`, `Load (N)`, `Engineering Strain [-]`.

use super::names::{known, quantity};
use crate::fault::{Fault, shown};
use crate::text::fields::Separator;
use crate::text::lines::Line;
use crate::text::units::{Quantity, Unit, unit};

/// A column: what it holds, and its unit if that is known.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Column {
    /// The name without its unit, in lower case with underscores; a known quantity by its name here.
    pub base: String,
    /// The unit as written, empty if there is none.
    pub unit_text: String,
    pub unit: Option<Unit>,
    /// The name as it stands in the file.
    pub header: String,
    /// The numbers count away from what their name says, as a user states.
    pub is_reversed: bool,
}

/// Longest line of names, bytes.
const LONGEST_HEAD: usize = 1 << 14;
/// Words between a name and its unit: `Kraft in N`, `Force / N`, `Fz, gf`.
const BEFORE_UNITS: &[&str] = &[", ", " in ", " / "];

impl Column {
    /// Reads a name such as `force_mN`, `Load (N)` or `Fz, gf`.
    pub fn of(text: &str) -> Column {
        let text = text.trim().trim_matches('"').trim();
        let of_parts = |base: &str, unit_text: &str| Column {
            header: text.to_string(),
            ..Column::new(base, unit_text)
        };
        for (open, close) in [('(', ')'), ('[', ']')] {
            if let Some((base, unit_text)) = text
                .strip_suffix(close)
                .and_then(|text| text.rsplit_once(open))
            {
                return of_parts(base, unit_text);
            }
        }
        if let Some((base, _)) = text.to_ascii_lowercase().split_once("_n_per_") {
            return of_parts(&text[..base.len()], &text[base.len() + 1..]);
        }
        for word in BEFORE_UNITS {
            if let Some((base, unit_text)) = text.rsplit_once(word) {
                let column = of_parts(base, unit_text);
                if column.unit.is_some() {
                    return column;
                }
            }
        }
        match text.rsplit_once('_') {
            Some((base, suffix))
                if unit(suffix).is_some()
                    || known(&normal(base)).is_some_and(|(_, what)| what.is_some()) =>
            {
                of_parts(base, suffix)
            }
            _ => of_parts(text, ""),
        }
    }

    /// A column of this name whose unit stands apart from it, in brackets or without.
    pub fn new(base: &str, unit_text: &str) -> Column {
        let header = base.trim().to_string();
        let base = normal(base);
        let (name, what) = known(&base).unwrap_or((&base, None));
        let unit_text = bare_unit(unit_text);
        // Texture analysers and balances write grams where they mean the weight of so many.
        let meant = match (what, unit_text) {
            (Some(Quantity::Force), "g") => "gf",
            _ => unit_text,
        };
        Column {
            base: name.to_string(),
            unit_text: unit_text.to_string(),
            unit: unit(meant),
            header,
            is_reversed: false,
        }
    }

    /// What the column must measure, if its name is known.
    pub fn quantity(&self) -> Option<Quantity> {
        quantity(&self.base)
    }

    /// Whether a known quantity has a unit of its kind.
    pub fn is_sound(&self) -> bool {
        self.quantity()
            .is_none_or(|quantity| self.unit.is_some_and(|unit| unit.quantity == quantity))
    }

    /// The fault of a known quantity whose unit is not of its kind.
    pub fn unit_fault(&self, line: usize) -> Option<Fault> {
        let quantity = self.quantity().filter(|_| !self.is_sound())?;
        let problem = match self.unit_text.as_str() {
            "" => format!("column {} has no unit", shown(self.base.as_bytes())),
            text => format!("{} is not a unit of {}", shown(text.as_bytes()), self.base),
        };
        let remedy = format!("name the column {}_{}", self.base, quantity.suffix());
        Some(Fault::line(line, problem, remedy))
    }
}

/// A name in lower case, its words parted by underscores.
pub(super) fn normal(text: &str) -> String {
    let lower = text.trim().to_lowercase();
    lower
        .split([' ', '_', '\u{a0}'])
        .filter(|part| !part.is_empty())
        .collect::<Vec<_>>()
        .join("_")
}

/// A unit without brackets around it.
pub(super) fn bare_unit(text: &str) -> &str {
    let text = text.trim();
    [('(', ')'), ('[', ']')]
        .into_iter()
        .find_map(|(open, close)| text.strip_prefix(open)?.strip_suffix(close))
        .map_or(text, str::trim)
}

/// The columns that a line names; empty if the line is no line of names.
pub(crate) fn names(text: &str, separator: Separator) -> Vec<Column> {
    if separator == Separator::Blank || text.starts_with('#') || text.len() > LONGEST_HEAD {
        return Vec::new();
    }
    let line = Line { number: 0, text };
    let fields = fields(&line, separator);
    fields.iter().map(|field| Column::of(field)).collect()
}

/// Whether these are the columns of an indentation: two known quantities at least.
pub(crate) fn is_curve(columns: &[Column]) -> bool {
    let curve = ["time", "depth", "travel", "force", "tool_gap"];
    let known = |name: &&&str| columns.iter().any(|column| column.base == **name);
    curve.iter().filter(known).count() >= 2
}

/// Whether these are the columns of a pressure table.
pub(crate) fn is_map(columns: &[Column]) -> bool {
    let has = |name: &str| columns.iter().any(|column| column.base == name);
    has("row")
        && has("column")
        && columns
            .iter()
            .any(|column| column.base.starts_with("pressure"))
}

/// The fields of a row; quotes are taken off, and a comma in quotes does not separate.
pub(crate) fn fields(line: &Line, separator: Separator) -> Vec<String> {
    if separator == Separator::Comma && line.text.contains('"') {
        let mut reader = csv::ReaderBuilder::new()
            .has_headers(false)
            .from_reader(line.text.as_bytes());
        if let Some(Ok(record)) = reader.records().next() {
            return record
                .iter()
                .map(|field| field.trim().to_string())
                .collect();
        }
    }
    separator
        .split(line.text)
        .map(|field| field.trim_matches('"').to_string())
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_every_style_give_quantity_and_unit() {
        for (text, base, unit_text) in [
            ("time_s", "time", "s"),
            ("Time (s)", "time", "s"),
            ("Load (uN)", "force", "uN"),
            ("force_mN", "force", "mN"),
            ("area_mm2", "area", "mm2"),
            ("tangential_force_n", "tangential_force", "n"),
            ("Engineering Strain [-]", "engineering_strain", "-"),
            ("piezo_height_m", "piezo_height", "m"),
            ("spring_constant_N_per_m", "spring_constant", "N_per_m"),
            ("depth_furlong", "depth", "furlong"),
            ("\"Temps d'essai\"", "time", ""),
            ("Auxiliary", "auxiliary", ""),
            ("Standardkraft in N", "force", "N"),
            ("Position (z), mm", "position_(z)", "mm"),
            ("Distance / mm", "travel", "mm"),
            ("Fn [mN]", "force", "mN"),
        ] {
            let column = Column::of(text);
            assert_eq!(
                (column.base.as_str(), column.unit_text.as_str()),
                (base, unit_text),
                "{text}"
            );
        }
        // 1 g of force is 9.80665 mN; 1 g of anything else is no force.
        assert_eq!(
            Column::of("Force (g)").unit.map(|unit| unit.factor),
            Some(9.80665e-3)
        );
        assert_eq!(Column::of("Sample (g)").unit, None);
        assert!(!Column::of("depth_furlong").is_sound());
        assert!(!Column::of("depth_s").is_sound());
        assert!(Column::of("auxiliary").is_sound());
    }
}
