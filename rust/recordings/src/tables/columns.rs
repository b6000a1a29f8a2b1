//! Column names with their units: `time_s`, `force_mN`, `Load (N)`, `Engineering Strain [-]`.

use crate::fault::Fault;
use crate::fault::shown;
use crate::fields::Separator;
use crate::lines::Line;
use crate::units::{Quantity, Unit, unit};

/// A column: what it holds, and its unit if that is known.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Column {
    /// The name without its unit, in lower case with underscores; a known quantity by its name here.
    pub base: String,
    /// The unit as written, empty if there is none.
    pub unit_text: String,
    pub unit: Option<Unit>,
}

/// Names that files use, the name here, and what it must measure.
const KNOWN: &[(&str, &str, Option<Quantity>)] = &[
    ("time", "time", Some(Quantity::Time)),
    ("t", "time", Some(Quantity::Time)),
    ("test_time", "time", Some(Quantity::Time)),
    ("temps_d'essai", "time", Some(Quantity::Time)),
    ("temps", "time", Some(Quantity::Time)),
    ("prüfzeit", "time", Some(Quantity::Time)),
    ("zeit", "time", Some(Quantity::Time)),
    ("depth", "depth", Some(Quantity::Length)),
    ("compression", "depth", Some(Quantity::Length)),
    ("travel", "travel", Some(Quantity::Length)),
    ("displacement", "travel", Some(Quantity::Length)),
    ("length", "travel", Some(Quantity::Length)),
    ("force", "force", Some(Quantity::Force)),
    ("load", "force", Some(Quantity::Force)),
    ("standard_force", "force", Some(Quantity::Force)),
    ("force_standard", "force", Some(Quantity::Force)),
    ("standardkraft", "force", Some(Quantity::Force)),
    ("kraft", "force", Some(Quantity::Force)),
    ("tool_separation", "tool_gap", Some(Quantity::Length)),
    (
        "ecartement_entre_outils",
        "tool_gap",
        Some(Quantity::Length),
    ),
    (
        "écartement_entre_outils",
        "tool_gap",
        Some(Quantity::Length),
    ),
    ("werkzeugabstand", "tool_gap", Some(Quantity::Length)),
    ("allongement", "elongation", Some(Quantity::Length)),
    ("area", "area", Some(Quantity::Area)),
    ("slide", "slide", Some(Quantity::Length)),
    (
        "tangential_force",
        "tangential_force",
        Some(Quantity::Force),
    ),
    ("pressure", "pressure", Some(Quantity::Pressure)),
    ("row", "row", None),
    ("col", "column", None),
    ("column", "column", None),
    ("phase", "phase", None),
    ("segment", "segment", None),
];

impl Column {
    /// Reads a name such as `force_mN` or `Load (N)`.
    pub fn of(text: &str) -> Column {
        let text = text.trim().trim_matches('"').trim();
        for (open, close) in [('(', ')'), ('[', ']')] {
            if let Some((base, unit_text)) = text
                .strip_suffix(close)
                .and_then(|text| text.rsplit_once(open))
            {
                return Column::new(base, unit_text);
            }
        }
        if let Some((base, _)) = text.to_ascii_lowercase().split_once("_n_per_") {
            return Column::new(&text[..base.len()], &text[base.len() + 1..]);
        }
        match text.rsplit_once('_') {
            Some((base, suffix))
                if unit(suffix).is_some()
                    || known(base).is_some_and(|(_, what)| what.is_some()) =>
            {
                Column::new(base, suffix)
            }
            _ => Column::new(text, ""),
        }
    }

    pub fn new(base: &str, unit_text: &str) -> Column {
        let base = normal(base);
        let (name, _) = known(&base).unwrap_or((&base, None));
        Column {
            base: name.to_string(),
            unit_text: unit_text.trim().to_string(),
            unit: unit(unit_text),
        }
    }

    /// What the column must measure, if its name is known.
    pub fn quantity(&self) -> Option<Quantity> {
        KNOWN
            .iter()
            .find(|(_, name, _)| *name == self.base)
            .and_then(|(_, _, quantity)| *quantity)
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

fn normal(text: &str) -> String {
    let lower = text.trim().to_lowercase();
    lower
        .split([' ', '_', '\u{a0}'])
        .filter(|part| !part.is_empty())
        .collect::<Vec<_>>()
        .join("_")
}

fn known(base: &str) -> Option<(&'static str, Option<Quantity>)> {
    let base = normal(base);
    KNOWN
        .iter()
        .find(|(name, ..)| *name == base)
        .map(|(_, name, quantity)| (*name, *quantity))
}

/// The columns that a line names; empty if the line is no line of names.
pub(crate) fn names(text: &str, separator: Separator) -> Vec<Column> {
    if separator == Separator::Blank || text.starts_with('#') || text.len() > 4096 {
        return Vec::new();
    }
    separator.split(text).map(Column::of).collect()
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
        ] {
            let column = Column::of(text);
            assert_eq!(
                (column.base.as_str(), column.unit_text.as_str()),
                (base, unit_text),
                "{text}"
            );
        }
        assert!(!Column::of("depth_furlong").is_sound());
        assert!(!Column::of("depth_s").is_sound());
        assert!(Column::of("auxiliary").is_sound());
    }
}
