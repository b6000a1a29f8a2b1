//! The finding of a misfit that no listed effect explains: variables it depends on, and an empirical correction.

use crate::wording::{phase_in_words, variable_in_words};
use thenar_inference::noise::periodic_component::Rhythm;
use thenar_inference::selection::empirical_factor::{Factors, VARIABLES};

/// What it may depend on, and units.
pub(crate) const NAMES: [(&str, &str); VARIABLES] = [
    ("depth", "mm"),
    ("force", "N"),
    ("contact_radius", "mm"),
    ("time", "s"),
    ("cycle", ""),
    ("rate", "mm/s"),
];

/// Something that is on no list.
#[derive(Debug, Clone, PartialEq)]
pub struct Unlisted {
    /// What it depends on, and what a correction by that removes on protocols it was not fitted to (0 to 1); the most first.
    pub depends_on: Vec<(&'static str, f64)>,
    /// By the first of these.
    pub correction: Option<Correction>,
    /// What beats, if repeats show that.
    pub rhythm: Option<Rhythm>,
    /// Where and in which phase most of it shows; None where repeats do not share it.
    pub place: Option<(String, &'static str)>,
}

/// A factor of the force that recordings ask for: empirical, and good for nothing that was not recorded.
#[derive(Debug, Clone, PartialEq)]
pub struct Correction {
    pub(crate) variable: usize,
    /// Over that variable.
    pub factors: Factors,
    /// Part of what repeats share of the misfit that it removes on protocols it was not fitted to.
    pub removed: f64,
}

impl Unlisted {
    /// In words, after "something that is not in the list: ".
    pub fn told(&self) -> String {
        let Some(correction) = &self.correction else {
            return match self.depends_on.is_empty() {
                true => "what it depends on cannot be told: no correction holds on a protocol that it was not fitted to".to_owned(),
                false => "no correction can be given, since it is another in every repeat".to_owned(),
            };
        };
        let (name, unit) = correction.by();
        let (least, most) = correction.extremes();
        // What is small beside the other end is the curve's own roundness.
        let counts = 0.1 * f64::max(-least.1, most.1);
        let part = |(at, change): (f64, f64), word: &str| {
            let told = format!("{:.0} % {word} at {at:.3} {unit}", 100.0 * change.abs());
            (change.abs() > counts).then_some(told)
        };
        let when = self.place.as_ref();
        let when = when.map_or(String::new(), |(_, phase)| {
            format!(" and shows most {}", phase_in_words(phase))
        });
        let mut ends = [(least, "smaller"), (most, "larger")];
        ends.sort_by(|a, b| a.0.0.total_cmp(&b.0.0));
        let ends = ends.map(|(end, word)| part(end, word));
        format!(
            "it goes with {}{when}: the force is {} than parameters have it, and an empirical correction by that alone removes {:.0} % of it on \
             protocols that it was not fitted to",
            variable_in_words(name),
            ends.into_iter().flatten().collect::<Vec<_>>().join(" and "),
            100.0 * correction.removed
        )
    }
}

impl Correction {
    /// Variable and unit.
    pub fn by(&self) -> (&'static str, &'static str) {
        NAMES[self.variable]
    }

    /// Where it takes most off the force and where it adds most, and what part.
    fn extremes(&self) -> ((f64, f64), (f64, f64)) {
        let each = || {
            let (at, sides) = (&self.factors.knots, self.factors.change.iter());
            sides.flat_map(|side| at.iter().copied().zip(side.iter().copied()))
        };
        let none = (0.0, 0.0);
        (
            each().fold(none, |a, b| if b.1 < a.1 { b } else { a }),
            each().fold(none, |a, b| if b.1 > a.1 { b } else { a }),
        )
    }
}
