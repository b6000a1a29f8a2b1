//! The property files of a JPK archive: `key=value` lines.

use crate::text::fields::value;
use std::collections::BTreeMap;

/// Keys and values as text.
#[derive(Debug, Default)]
pub(super) struct Properties(BTreeMap<String, String>);

impl Properties {
    pub fn of(text: &str) -> Properties {
        let pairs = text.lines().filter(|line| !line.starts_with('#'));
        Properties(
            pairs
                .filter_map(|line| line.split_once('='))
                .map(|(key, value)| (key.trim().into(), value.trim().into()))
                .collect(),
        )
    }

    pub fn text(&self, key: &str) -> Option<&str> {
        self.0.get(key).map(String::as_str)
    }

    pub fn number(&self, key: &str) -> Result<f64, String> {
        let text = self
            .text(key)
            .ok_or_else(|| format!("{key} is not stated"))?;
        value(text).map_err(|problem| format!("{key}: {problem}"))
    }

    /// Multiplier and offset under a prefix; a raw float has none.
    pub fn scaling(&self, prefix: &str) -> Result<[f64; 2], String> {
        if self.text(&format!("{prefix}scaling.type")).is_none() {
            return Ok([1.0, 0.0]);
        }
        Ok([
            self.number(&format!("{prefix}scaling.multiplier"))?,
            self.number(&format!("{prefix}scaling.offset"))?,
        ])
    }
}
