//! One effect switched on: amplitude, shape numbers, choices, regions, painted values.

use super::entry::Effect;
use super::entry::Entry;
use crate::{ContactError, Model};
use std::fmt;

/// An effect that a user, or a diagnosis, has switched on.
///
/// ```
/// use thenar_contact::ActiveEffect;
/// let bone = ActiveEffect::named("bone", 1.0).unwrap().with("thickness_mm", 5.0).unwrap();
/// assert_eq!(bone.number("thickness_mm"), 5.0);
/// ```
#[derive(Clone)]
pub struct ActiveEffect {
    /// Which.
    pub effect: Effect,
    /// What the catalogue says of it.
    pub(crate) entry: &'static Entry,
    /// How much of it; 0 is the base model, bit for bit.
    pub amplitude: f64,
    /// Its numbers, in the order of [`Entry::shape`].
    pub shape: Vec<f64>,
    /// Option chosen of each of [`Entry::choices`].
    pub chosen: Vec<usize>,
    /// Regions it acts on; None: all.
    pub regions: Option<Vec<u32>>,
    /// Values painted per vertex of the mesh as given, where [`Entry::painted`] allows it; NaN where nothing is painted.
    pub painted: Option<Vec<f64>>,
}

impl ActiveEffect {
    /// True if both act alike: equal, and painted at the same vertices. (Unpainted vertices are NaN, which equals nothing.)
    pub fn acts_as(&self, other: &ActiveEffect) -> bool {
        let bits = |effect: &ActiveEffect| -> Option<Vec<u64>> {
            let painted = effect.painted.as_ref()?;
            Some(painted.iter().map(|value| value.to_bits()).collect())
        };
        let bare = |effect: &ActiveEffect| ActiveEffect {
            painted: None,
            ..effect.clone()
        };
        bare(self) == bare(other) && bits(self) == bits(other)
    }

    /// The same with one number changed.
    ///
    /// # Errors
    /// [`ContactError::Effect`] with the names that there are.
    pub fn with(mut self, name: &str, value: f64) -> Result<ActiveEffect, ContactError> {
        let entry = self.entry();
        match entry.shape.iter().position(|number| number.name == name) {
            Some(place) => {
                self.shape[place] = value;
                Ok(self)
            }
            None => Err(self.refuse(unknown("number", name, entry.shape.iter().map(|n| n.name)))),
        }
    }

    /// The same with one form chosen.
    ///
    /// # Errors
    /// [`ContactError::Effect`] with the names or the options that there are.
    pub fn choose(mut self, name: &str, option: &str) -> Result<ActiveEffect, ContactError> {
        let entry = self.entry();
        let Some(place) = entry.choices.iter().position(|choice| choice.name == name) else {
            return Err(self.refuse(unknown(
                "choice",
                name,
                entry.choices.iter().map(|c| c.name),
            )));
        };
        let options = entry.choices[place].options;
        match options.iter().position(|o| *o == option) {
            Some(chosen) => {
                self.chosen[place] = chosen;
                Ok(self)
            }
            None => {
                let options = joined(options.iter().copied());
                Err(self.refuse(format!(
                    "{name} is {option:?}, but must be one of {options}"
                )))
            }
        }
    }

    /// The same on some regions only.
    pub fn in_regions(mut self, regions: &[u32]) -> ActiveEffect {
        self.regions = Some(regions.to_vec());
        self
    }

    /// The same with values painted per vertex.
    pub fn painted(mut self, values: Vec<f64>) -> ActiveEffect {
        self.painted = Some(values);
        self
    }

    /// What the catalogue says of it.
    pub fn entry(&self) -> &'static Entry {
        self.entry
    }

    /// A shape number by its name; NaN if there is none of that name.
    pub fn number(&self, name: &str) -> f64 {
        let place = self.entry().shape.iter().position(|n| n.name == name);
        debug_assert!(place.is_some(), "{name}");
        place.map_or(f64::NAN, |place| self.shape[place])
    }

    /// True if it acts on `region`.
    pub fn acts_on(&self, region: u32) -> bool {
        self.regions
            .as_ref()
            .is_none_or(|regions| regions.contains(&region))
    }

    /// Its amplitude on `region`.
    pub fn amplitude_on(&self, region: u32) -> f64 {
        if self.acts_on(region) {
            self.amplitude
        } else {
            0.0
        }
    }

    /// Checks amplitude, numbers, regions and painting for a skin of `regions` regions and `vertices` vertices.
    ///
    /// # Errors
    /// [`ContactError::Effect`] in one sentence: which number, and what is admissible.
    pub fn validate(
        &self,
        model: Model,
        (regions, vertices): (usize, usize),
    ) -> Result<(), ContactError> {
        if self.entry().is_instrument() {
            return Err(self.refuse(
                "it acts on readings, not on the skin; give it to what reads the contact"
                    .to_owned(),
            ));
        }
        if model == Model::Paper {
            return Err(self
                .refuse("it needs model layer; the paper's model stays as published".to_owned()));
        }
        self.check_numbers()?;
        self.check_place(regions, vertices)?;
        let Some(check) = self.entry.check else {
            return Ok(());
        };
        let painted = self.painted.as_deref().unwrap_or_default();
        check(&self.shape, painted).map_err(|problem| self.refuse(problem))
    }

    /// Checks amplitude and numbers.
    pub(crate) fn check_numbers(&self) -> Result<(), ContactError> {
        let entry = self.entry();
        if !(self.amplitude >= 0.0 && self.amplitude <= entry.most) {
            let range = range([0.0, entry.most], "1");
            return Err(self.refuse(format!(
                "amplitude is {}, but must be {range}",
                self.amplitude
            )));
        }
        if self.shape.len() != entry.shape.len() || self.chosen.len() != entry.choices.len() {
            return Err(self.refuse(format!(
                "it has {} numbers, not {}",
                entry.shape.len(),
                self.shape.len()
            )));
        }
        for (number, value) in entry.shape.iter().zip(&self.shape) {
            let [low, high] = number.admissible;
            if !(*value >= low && *value <= high) {
                let range = range(number.admissible, number.unit);
                return Err(self.refuse(format!("{} is {value}, but must be {range}", number.name)));
            }
        }
        Ok(())
    }

    fn check_place(&self, regions: usize, vertices: usize) -> Result<(), ContactError> {
        let stray = self
            .regions
            .iter()
            .flatten()
            .find(|region| **region as usize >= regions);
        if let Some(region) = stray {
            return Err(self.refuse(format!(
                "there is no region {region}; the skin has regions 0 to {}",
                regions - 1
            )));
        }
        let Some(painted) = &self.painted else {
            return Ok(());
        };
        if self.entry().painted.is_none() {
            return Err(self.refuse("it cannot be painted; give its numbers".to_owned()));
        }
        if painted.len() != vertices {
            return Err(self.refuse(format!(
                "{} values are painted for {vertices} vertices; paint one per vertex, NaN where there is none",
                painted.len()
            )));
        }
        Ok(())
    }

    pub(crate) fn refuse(&self, problem: String) -> ContactError {
        ContactError::Effect {
            effect: self.entry.name,
            problem,
        }
    }
}

impl PartialEq for ActiveEffect {
    fn eq(&self, other: &ActiveEffect) -> bool {
        // An effect has one entry.
        self.effect == other.effect
            && self.amplitude == other.amplitude
            && self.shape == other.shape
            && self.chosen == other.chosen
            && self.regions == other.regions
            && self.painted == other.painted
    }
}

impl fmt::Debug for ActiveEffect {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("ActiveEffect")
            .field("effect", &self.effect)
            .field("amplitude", &self.amplitude)
            .field("shape", &self.shape)
            .field("chosen", &self.chosen)
            .field("regions", &self.regions)
            .field("painted", &self.painted)
            .finish()
    }
}

/// The effects that do anything, in the order of the catalogue; equal ones stay in the order given.
pub fn in_order(effects: &[ActiveEffect]) -> Vec<&ActiveEffect> {
    let mut acting: Vec<&ActiveEffect> = effects.iter().filter(|e| e.amplitude > 0.0).collect();
    acting.sort_by_key(|e| e.effect.place());
    acting
}

fn unknown<'a>(what: &str, name: &str, known: impl Iterator<Item = &'a str>) -> String {
    let known = joined(known);
    if known.is_empty() {
        format!("there is no {what} {name:?}; it has none")
    } else {
        format!("there is no {what} {name:?}; there are {known}")
    }
}

pub(crate) fn joined<'a>(names: impl Iterator<Item = &'a str>) -> String {
    names.collect::<Vec<_>>().join(", ")
}

fn range([low, high]: [f64; 2], unit: &str) -> String {
    let unit = if unit == "1" {
        String::new()
    } else {
        format!(" {unit}")
    };
    if high.is_infinite() {
        format!("at least {low}{unit}")
    } else {
        format!("from {low} to {high}{unit}")
    }
}
