//! A TOML document whose tables know their lines and refuse keys that nobody asked for.

use crate::fault::{Fault, shown};
use std::ops::Range;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Name of the outermost table.
const ROOT: &str = "the file";

/// A parsed text.
pub(super) struct Document<'t> {
    /// Where its lines end, bytes, rising.
    line_ends: Vec<usize>,
    root: Spanned<DeTable<'t>>,
}

impl<'t> Document<'t> {
    pub fn parse(text: &'t str) -> Result<Document<'t>, Fault> {
        let line_ends: Vec<usize> = memchr::memchr_iter(b'\n', text.as_bytes()).collect();
        let root = DeTable::parse(text).map_err(|error| {
            let line = line_of(&line_ends, error.span().unwrap_or(0..0));
            let message = error
                .message()
                .split('\n')
                .next()
                .unwrap_or("")
                .trim()
                .to_string();
            Fault::line(line, message, "correct the TOML")
        })?;
        Ok(Document { line_ends, root })
    }

    pub fn root(&self) -> Section<'_> {
        Section {
            name: ROOT.into(),
            line: 1,
            line_ends: &self.line_ends,
            table: self.root.get_ref(),
            known: Vec::new(),
        }
    }
}

/// A table, and the keys that were asked of it.
pub(super) struct Section<'d> {
    /// As messages name it: `[sites.pad]`.
    pub name: String,
    pub line: usize,
    line_ends: &'d [usize],
    table: &'d DeTable<'d>,
    known: Vec<&'static str>,
}

/// A value with its line and what it belongs to.
#[derive(Clone)]
pub(super) struct Entry<'d> {
    pub line: usize,
    name: String,
    value: &'d DeValue<'d>,
}

impl<'d> Section<'d> {
    pub fn get(&mut self, key: &'static str) -> Option<Entry<'d>> {
        self.known.push(key);
        let value = self.table.get(key)?;
        Some(Entry {
            line: line_of(self.line_ends, value.span()),
            name: key.to_string(),
            value: value.get_ref(),
        })
    }

    pub fn fault(&self, problem: String, remedy: &'static str) -> Fault {
        Fault::line(self.line, problem, remedy)
    }

    /// The fault of a key that must be there.
    pub fn needs(&self, key: &str, remedy: &'static str) -> Fault {
        self.fault(format!("{} has no {key}", self.name), remedy)
    }

    pub fn text(&mut self, key: &'static str) -> Result<Option<String>, Fault> {
        self.get(key).map(|entry| entry.text()).transpose()
    }

    pub fn number(&mut self, key: &'static str) -> Result<Option<f64>, Fault> {
        self.get(key).map(|entry| entry.finite()).transpose()
    }

    /// A number above zero.
    pub fn positive(&mut self, key: &'static str) -> Result<Option<f64>, Fault> {
        let Some(entry) = self.get(key) else {
            return Ok(None);
        };
        let value = entry.finite()?;
        if value <= 0.0 {
            return Err(entry.fault(format!("is {value}"), "give a number above zero"));
        }
        Ok(Some(value))
    }

    pub fn vector(&mut self, key: &'static str) -> Result<Option<[f64; 3]>, Fault> {
        self.get(key).map(|entry| entry.vector()).transpose()
    }

    /// Two numbers.
    pub fn pair(&mut self, key: &'static str) -> Result<Option<[f64; 2]>, Fault> {
        self.get(key).map(|entry| entry.pair()).transpose()
    }

    /// A table of this table.
    pub fn section(&mut self, key: &'static str) -> Result<Option<Section<'d>>, Fault> {
        match self.get(key) {
            None => Ok(None),
            Some(Entry {
                line,
                value: DeValue::Table(table),
                ..
            }) => {
                let name = match self.name.as_str() {
                    ROOT => format!("[{key}]"),
                    outer => format!("[{}.{key}]", outer.trim_matches(['[', ']'])),
                };
                Ok(Some(Section {
                    name,
                    line,
                    line_ends: self.line_ends,
                    table,
                    known: Vec::new(),
                }))
            }
            Some(entry) => Err(entry.fault(
                "is no table".into(),
                "write it as a table in square brackets",
            )),
        }
    }

    /// Every key of a table whose keys are the user's, with its value.
    pub fn pairs(self) -> Vec<(String, Entry<'d>)> {
        let pairs = self.table.iter().map(|(key, value)| {
            let entry = Entry {
                line: line_of(self.line_ends, value.span()),
                name: key.get_ref().to_string(),
                value: value.get_ref(),
            };
            (key.get_ref().to_string(), entry)
        });
        pairs.collect()
    }

    /// The tables under this table, in the order of the file: key and table.
    pub fn sections(&self) -> Result<Vec<(String, Section<'d>)>, Fault> {
        let mut all = Vec::new();
        for (key, value) in self.table {
            let line = line_of(self.line_ends, key.span());
            let DeValue::Table(table) = value.get_ref() else {
                let problem = format!("{} is no table", shown(key.get_ref().as_bytes()));
                return Err(Fault::line(
                    line,
                    problem,
                    "write it as a table in square brackets",
                ));
            };
            let name = format!("[{}.{}]", self.name.trim_matches(['[', ']']), key.get_ref());
            let section = Section {
                name,
                line,
                line_ends: self.line_ends,
                table,
                known: Vec::new(),
            };
            all.push((key.span().start, key.get_ref().to_string(), section));
        }
        all.sort_by_key(|(start, ..)| *start);
        Ok(all
            .into_iter()
            .map(|(_, key, section)| (key, section))
            .collect())
    }

    /// The tables of an array of tables.
    pub fn list(&mut self, key: &'static str) -> Result<Vec<Section<'d>>, Fault> {
        let Some(entry) = self.get(key) else {
            return Ok(Vec::new());
        };
        let DeValue::Array(array) = entry.value else {
            return Err(entry.fault(
                "is no list of tables".into(),
                "write each as a table in double square brackets",
            ));
        };
        array
            .iter()
            .map(|item| match item.get_ref() {
                DeValue::Table(table) => {
                    let line = line_of(self.line_ends, item.span());
                    Ok(Section {
                        name: format!("[[{key}]]"),
                        line,
                        line_ends: self.line_ends,
                        table,
                        known: Vec::new(),
                    })
                }
                _ => Err(entry.fault(
                    "is no list of tables".into(),
                    "write each as a table in double square brackets",
                )),
            })
            .collect()
    }

    /// Refuses keys that are not among `known`.
    pub fn only(mut self, known: &[&'static str]) -> Result<(), Fault> {
        self.known.extend(known);
        self.finish()
    }

    /// Refuses keys that were not asked for, with the nearest one that is known.
    pub fn finish(self) -> Result<(), Fault> {
        let unknown = self
            .table
            .iter()
            .filter(|(key, _)| !self.known.contains(&key.get_ref().as_ref()));
        let Some((key, _)) = unknown.min_by_key(|(key, _)| key.span().start) else {
            return Ok(());
        };
        let line = line_of(self.line_ends, key.span());
        let problem = format!(
            "{} is no key of {}",
            shown(key.get_ref().as_bytes()),
            self.name
        );
        Err(Fault::line(
            line,
            problem,
            nearest(key.get_ref(), &self.known),
        ))
    }
}

impl Entry<'_> {
    pub fn fault(&self, problem: String, remedy: &'static str) -> Fault {
        Fault::line(self.line, format!("{} {problem}", self.name), remedy)
    }

    pub fn text(&self) -> Result<String, Fault> {
        match self.value {
            DeValue::String(text) if !text.chars().any(char::is_control) => Ok(text.to_string()),
            _ => Err(self.fault("is no plain text".into(), "write it in quotes, on one line")),
        }
    }

    pub fn boolean(&self) -> Result<bool, Fault> {
        match self.value {
            DeValue::Boolean(value) => Ok(*value),
            _ => Err(self.fault(
                "is neither true nor false".into(),
                "write true or false, without quotes",
            )),
        }
    }

    /// A number, infinite ones too.
    pub fn number(&self) -> Result<f64, Fault> {
        let number = match self.value {
            DeValue::Integer(integer) => i64::from_str_radix(integer.as_str(), integer.radix())
                .ok()
                .map(|value| value as f64),
            DeValue::Float(float) => float.as_str().parse::<f64>().ok(),
            _ => None,
        };
        match number {
            Some(number) if !number.is_nan() => Ok(number),
            Some(_) => Err(self.fault("is NaN".into(), "give a number")),
            None => Err(self.fault(
                "is no number".into(),
                "give a number, without quotes or unit",
            )),
        }
    }

    pub fn finite(&self) -> Result<f64, Fault> {
        let number = self.number()?;
        match number.is_finite() {
            true => Ok(number),
            false => Err(self.fault("is not finite".into(), "give a finite number")),
        }
    }

    pub fn vector(&self) -> Result<[f64; 3], Fault> {
        let parts: Vec<f64> = self
            .parts()?
            .iter()
            .map(Entry::finite)
            .collect::<Result<_, _>>()?;
        let wrong = |_| {
            self.fault(
                "is no list of three numbers".into(),
                "write it as [x, y, z]",
            )
        };
        parts.try_into().map_err(wrong)
    }

    pub fn pair(&self) -> Result<[f64; 2], Fault> {
        let parts = self.parts()?;
        let parts: Vec<f64> = parts.iter().map(Entry::finite).collect::<Result<_, _>>()?;
        let wrong = |_| self.fault("is no list of two numbers".into(), "write it as [u, v]");
        parts.try_into().map_err(wrong)
    }

    /// So many numbers.
    pub fn numbers<const N: usize>(&self) -> Result<[f64; N], Fault> {
        let parts = self.parts()?;
        let parts: Vec<f64> = parts.iter().map(Entry::finite).collect::<Result<_, _>>()?;
        let wrong = |_| {
            self.fault(
                format!("is no list of {N} numbers"),
                "write them in square brackets",
            )
        };
        parts.try_into().map_err(wrong)
    }

    /// Two pairs of numbers.
    pub fn two_pairs(&self) -> Result<[[f64; 2]; 2], Fault> {
        let parts = self.parts()?;
        let pairs: Vec<[f64; 2]> = parts.iter().map(Entry::pair).collect::<Result<_, _>>()?;
        let wrong = |_| {
            self.fault(
                "is no pair of points".into(),
                "write it as [[x, y], [x, y]]",
            )
        };
        pairs.try_into().map_err(wrong)
    }

    pub fn texts(&self) -> Result<Vec<String>, Fault> {
        self.parts()?.iter().map(Entry::text).collect()
    }

    pub fn is_text(&self) -> bool {
        matches!(self.value, DeValue::String(_))
    }

    fn parts(&self) -> Result<Vec<Entry<'_>>, Fault> {
        let DeValue::Array(array) = self.value else {
            return Err(self.fault("is no list".into(), "write it in square brackets"));
        };
        let part = |value| Entry {
            line: self.line,
            name: self.name.clone(),
            value,
        };
        Ok(array.iter().map(|item| part(item.get_ref())).collect())
    }
}

/// `did you mean 'radius_mm'`, or the keys there are.
pub(super) fn nearest(word: &str, known: &[&str]) -> String {
    let best = known
        .iter()
        .map(|key| (strsim::jaro_winkler(word, key), *key))
        .max_by(|a, b| a.0.total_cmp(&b.0));
    match best {
        Some((likeness, key)) if likeness > 0.8 => format!("did you mean '{key}'?"),
        Some(_) => format!("use one of {}", known.join(", ")),
        None => "take it out".to_string(),
    }
}

/// The line on which a span begins, from 1; a search, since a study asks once for every key.
fn line_of(line_ends: &[usize], span: Range<usize>) -> usize {
    1 + line_ends.partition_point(|end| *end < span.start)
}
