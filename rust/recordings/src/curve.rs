//! An indenter's recording: numbers over time with their units, and what its header states.

use crate::check::Check;
use crate::source::Source;
use crate::text::units::{Quantity, Unit};

/// One column of numbers.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Channel {
    /// Name with its unit at the end: `time_s`, `force_n`, `depth_mm`, `travel_mm`. `depth_mm` counts from first touch as the
    /// operator judged it, `travel_mm` grows into the sample from a zero that is not the contact.
    pub name: String,
    /// Unit, empty for counts and numbers without one.
    pub unit: String,
    /// The numbers, finite.
    pub values: Vec<f64>,
}

impl Channel {
    /// A channel of a known quantity: `base` and the library's unit make the name, values are converted.
    pub(crate) fn converted(base: &str, unit: Unit, mut values: Vec<f64>) -> Channel {
        if unit.factor != 1.0 {
            values.iter_mut().for_each(|value| *value *= unit.factor);
        }
        Channel::named(base, unit.quantity, values)
    }

    /// A channel whose values are in the library's unit already.
    pub(crate) fn named(base: &str, quantity: Quantity, values: Vec<f64>) -> Channel {
        Channel {
            name: format!("{base}_{}", quantity.suffix()),
            unit: quantity.unit().into(),
            values,
        }
    }
}

/// A number that a header states, in the library's unit.
#[derive(Debug, Clone, PartialEq)]
pub struct Fact {
    /// Name with its unit at the end: `tip_radius_mm`.
    pub name: String,
    /// Value.
    pub value: f64,
}

/// A part of a curve that the instrument ran as one step.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Segment {
    /// What the instrument calls it: `extend`, `pause`, `retract`.
    pub name: String,
    /// First sample.
    pub start: usize,
    /// One past the last sample.
    pub end: usize,
}

/// One run of an indenter.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Curve {
    /// Specimen or run, where the file holds several; else empty.
    pub name: String,
    /// Instrument.
    pub source: Source,
    /// Columns of equal length.
    pub channels: Vec<Channel>,
    /// Steps, in order; empty if the file does not divide the run.
    pub segments: Vec<Segment>,
    /// Numbers of the header.
    pub facts: Vec<Fact>,
    /// Steps of the protocol as the instrument was told, a line each.
    pub protocol: Vec<String>,
    /// The file's own counts against ours.
    pub checks: Vec<Check>,
    /// What cannot be known from this file, a sentence each.
    pub unknown: Vec<String>,
    /// What a reader should be told, a sentence each.
    pub warnings: Vec<String>,
}

impl Curve {
    /// A curve without samples.
    pub(crate) fn of(source: Source) -> Curve {
        Curve {
            source,
            ..Curve::default()
        }
    }

    /// The values of a channel by name.
    pub fn channel(&self, name: &str) -> Option<&[f64]> {
        let found = self.channels.iter().find(|channel| channel.name == name)?;
        Some(&found.values)
    }

    /// A number of the header by name.
    pub fn fact(&self, name: &str) -> Option<f64> {
        self.facts
            .iter()
            .find(|fact| fact.name == name)
            .map(|fact| fact.value)
    }

    /// Number of samples.
    pub fn samples(&self) -> usize {
        self.channels
            .first()
            .map_or(0, |channel| channel.values.len())
    }

    pub(crate) fn push_fact(&mut self, name: impl Into<String>, value: f64) {
        self.facts.push(Fact {
            name: name.into(),
            value,
        });
    }
}
