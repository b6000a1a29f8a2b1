//! The catalogue of effects: one line each, in the order in which they compose.

use super::definition::entry::Entry;
use super::{adhesion, bone, compressibility, cycle_softening, drainage, friction, inclusion};
use super::{rate_independent_loss, region_coupling, relaxation, stiff_skin, stiffening_law};
use crate::ContactError;
use crate::effects::definition::active::{ActiveEffect, joined};
use crate::effects::definition::entry::Effect;
use crate::instrument::{crosstalk, dead_cells, drift, fixture_compliance, gain, misregistration};
use crate::instrument::{offset, saturation, threshold, timing};

/// Every effect with what is known of it, in the order in which they compose.
pub const CATALOGUE: [(Effect, &Entry); 22] = [
    (Effect::Bone, &bone::ENTRY),
    (Effect::Compressibility, &compressibility::ENTRY),
    (Effect::StiffSkin, &stiff_skin::ENTRY),
    (Effect::RegionCoupling, &region_coupling::ENTRY),
    (Effect::StiffeningLaw, &stiffening_law::ENTRY),
    (Effect::Inclusion, &inclusion::ENTRY),
    (Effect::CycleSoftening, &cycle_softening::ENTRY),
    (Effect::Relaxation, &relaxation::ENTRY),
    (Effect::Drainage, &drainage::ENTRY),
    (Effect::RateIndependentLoss, &rate_independent_loss::ENTRY),
    (Effect::Friction, &friction::ENTRY),
    (Effect::Adhesion, &adhesion::ENTRY),
    (Effect::FixtureCompliance, &fixture_compliance::ENTRY),
    (Effect::Misregistration, &misregistration::ENTRY),
    (Effect::Crosstalk, &crosstalk::ENTRY),
    (Effect::Gain, &gain::ENTRY),
    (Effect::Offset, &offset::ENTRY),
    (Effect::Drift, &drift::ENTRY),
    (Effect::Saturation, &saturation::ENTRY),
    (Effect::Threshold, &threshold::ENTRY),
    (Effect::DeadCells, &dead_cells::ENTRY),
    (Effect::Timing, &timing::ENTRY),
];

impl Effect {
    /// The effect of that name.
    pub fn named(name: &str) -> Option<Effect> {
        CATALOGUE
            .iter()
            .find(|(_, entry)| entry.name == name)
            .map(|(effect, _)| *effect)
    }

    /// What the catalogue says of it.
    pub fn entry(self) -> &'static Entry {
        CATALOGUE[self.place()].1
    }

    /// Its name.
    pub fn name(self) -> &'static str {
        self.entry().name
    }
}

impl ActiveEffect {
    /// An effect with the catalogue's numbers, on all regions.
    pub fn new(effect: Effect, amplitude: f64) -> ActiveEffect {
        let entry = effect.entry();
        ActiveEffect {
            effect,
            entry,
            amplitude,
            shape: entry.shape.iter().map(|number| number.default).collect(),
            chosen: vec![0; entry.choices.len()],
            regions: None,
            painted: None,
        }
    }

    /// The effect of that name, with the catalogue's numbers, on all regions.
    ///
    /// # Errors
    /// [`ContactError::UnknownEffect`] with the names that there are.
    pub fn named(name: &str, amplitude: f64) -> Result<ActiveEffect, ContactError> {
        match Effect::named(name) {
            Some(effect) => Ok(ActiveEffect::new(effect, amplitude)),
            None => Err(ContactError::UnknownEffect {
                name: name.to_owned(),
                known: joined(CATALOGUE.iter().map(|(_, entry)| entry.name)),
            }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn catalogue_order_is_that_of_effects_and_stages() {
        for (place, (effect, entry)) in CATALOGUE.iter().enumerate() {
            assert_eq!(effect.place(), place, "{}", entry.name);
            assert_eq!(Effect::named(entry.name), Some(*effect));
        }
        assert!(CATALOGUE.windows(2).all(|w| w[0].1.stage <= w[1].1.stage));
        let names: BTreeSet<&str> = CATALOGUE.iter().map(|(_, e)| e.name).collect();
        assert_eq!(names.len(), CATALOGUE.len());
    }

    #[test]
    fn every_number_has_a_source_and_a_default_within_its_ranges() {
        for (_, entry) in CATALOGUE {
            assert!(!entry.consequences.is_empty() && !entry.source.is_empty());
            for number in entry.shape {
                let within =
                    |range: [f64; 2]| range[0] <= number.default && number.default <= range[1];
                let what = format!("{} {}", entry.name, number.name);
                assert!(
                    within(number.admissible) && within(number.physiological),
                    "{what}"
                );
                assert!(number.admissible[0] <= number.physiological[0], "{what}");
                assert!(number.admissible[1] >= number.physiological[1], "{what}");
                assert!(number.source.len() > 8 && !number.unit.is_empty(), "{what}");
            }
        }
    }
}
