//! Candidate effects: every mechanism that is fitted alone, with its variants.

use thenar_contact::effects::Effect;

use crate::forward::surrogate::mechanism::{
    Clock, DeformationMeasure, Growth, Law, Mechanism, Scales, Stage, UseAtStart, WIDTHS,
};
use crate::forward::surrogate::relaxation_spectrum::Spectrum;
use crate::forward::tables::stiff_skin::THICKNESSES_MM;

/// Periods of a spectrum in travel, over the largest depth.
const TRAVELS: [f64; 3] = [0.08, 0.4, 2.0];

/// Travel after which 63 % of a softening is lost, over the largest depth.
pub const SOFTENING_TRAVELS: [f64; 3] = [0.25, 0.8, 2.5];

/// Depths at which skin lets go, over the largest depth: before the tool is out, as it leaves, above the skin, and not at all.
const LETS_GO: [f64; 6] = [0.12, 0.0, -0.1, -0.2, -0.35, -10.0];

/// Every mechanism that is tried alone, with its variants; the order decides ties.
pub fn singles(scales: Scales) -> Vec<Mechanism> {
    let mut all = instrument();
    let deepest = scales.deepest;
    let fades = |effect, clock, spectrum| Mechanism {
        effect,
        law: Law::Relaxation { clock, spectrum },
    };
    let [time, area] = WIDTHS.map(|widths| Spectrum::Smooth { widths });
    all.push(fades(Effect::Relaxation, Clock::Time, time));
    let clock = Clock::Area {
        reference_mm: scales.radius,
    };
    all.push(fades(Effect::Drainage, clock, area));
    let travels = Spectrum::Free(TRAVELS.map(|t| t * deepest).to_vec());
    all.push(fades(Effect::RateIndependentLoss, Clock::Travel, travels));
    all.extend(softening(scales));
    let one = |effect, law| Mechanism { effect, law };
    all.extend(LETS_GO.map(|lets_go| one(Effect::Adhesion, Law::Adhesion { lets_go })));
    if scales.has_bone {
        all.push(one(Effect::Bone, Law::Tabulated(0)));
    }
    all.push(one(Effect::Compressibility, Law::Tabulated(0)));
    let skins = 0..THICKNESSES_MM.len();
    all.extend(skins.map(|form| one(Effect::StiffSkin, Law::Tabulated(form))));
    for growth in [Growth::Exponential, Growth::Square] {
        let grows = |measure| one(Effect::StiffeningLaw, Law::Stiffening(measure, growth));
        all.extend(scales.has_strain.then(|| grows(DeformationMeasure::Strain)));
        all.push(grows(DeformationMeasure::Depth));
    }
    all
}

/// Softening by use; where no rest is stated between recordings, also of tissue that does not recover between them.
fn softening(scales: Scales) -> impl Iterator<Item = Mechanism> {
    let starts: &[UseAtStart] = match scales.carries_use {
        true => &[
            UseAtStart::Rested,
            UseAtStart::AfterProtocols,
            UseAtStart::AfterRecordings,
        ],
        false => &[UseAtStart::Rested],
    };
    let one = move |start: &UseAtStart, travel: f64| Mechanism {
        effect: Effect::CycleSoftening,
        law: Law::Softening {
            travel_mm: travel * scales.deepest,
            recovery_s: match start {
                UseAtStart::Rested => 60.0,
                _ => 1000.0,
            },
            start: *start,
        },
    };
    starts
        .iter()
        .flat_map(move |start| SOFTENING_TRAVELS.map(|travel| one(start, travel)))
}

fn instrument() -> Vec<Mechanism> {
    let one = |effect, law| Mechanism { effect, law };
    let mut all = vec![one(Effect::Offset, Law::Offset)];
    all.extend([1.0, 6.0].map(|time_s| one(Effect::Drift, Law::Drift { time_s })));
    let stages = [Stage::Last, Stage::First];
    all.extend(stages.map(|stage| one(Effect::Saturation, Law::Saturation(stage))));
    all.extend(stages.map(|stage| one(Effect::Threshold, Law::Floor(stage))));
    all.push(one(Effect::FixtureCompliance, Law::Compliance));
    all.push(one(Effect::Timing, Law::Delay));
    all
}
