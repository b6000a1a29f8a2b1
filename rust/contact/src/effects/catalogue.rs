//! The list of effects, by the names that scripts, files and findings use.

use super::definition::entry::Entry;
use super::{adhesion, bone, compressibility, cycle_softening, drainage, friction, inclusion};
use super::{rate_independent_loss, region_coupling, relaxation, stiff_skin, stiffening_law};
use crate::instrument::{crosstalk, dead_cells, drift, fixture_compliance, gain, misregistration};
use crate::instrument::{offset, saturation, threshold, timing};

/// An effect of the catalogue.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Effect {
    /// Soft tissue of another thickness over bone.
    Bone,
    /// Tissue that gives up volume.
    Compressibility,
    /// A thin stiff skin over soft pulp.
    StiffSkin,
    /// Regions that answer each other's forces only in part.
    RegionCoupling,
    /// Another growth of the modulus.
    StiffeningLaw,
    /// A place where the tissue is stiffer or softer.
    Inclusion,
    /// Stiffness that falls with use and recovers in rest.
    CycleSoftening,
    /// Force that fades with time.
    Relaxation,
    /// Fluid that leaves the pressed tissue.
    Drainage,
    /// Energy lost per cycle at any speed.
    RateIndependentLoss,
    /// Skin that sticks to the product and slips over it.
    Friction,
    /// Skin that clings to the product.
    Adhesion,
    /// A fixture that yields in series with the skin.
    FixtureCompliance,
    /// A mat that lies beside where it is said to lie.
    Misregistration,
    /// Sensels that pass part of their reading on.
    Crosstalk,
    /// Readings too large or too small by a factor.
    Gain,
    /// A zero point that is not at zero.
    Offset,
    /// Readings that wander with time.
    Drift,
    /// Readings that stop at a ceiling.
    Saturation,
    /// Readings below a floor that are shown as nothing.
    Threshold,
    /// Sensels that show nothing.
    DeadCells,
    /// A channel whose clock is behind.
    Timing,
}

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

    /// Its place in the catalogue, and so in the order of composition.
    pub fn place(self) -> usize {
        self as usize
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn the_catalogue_stands_in_the_order_of_effects_and_stages() {
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
