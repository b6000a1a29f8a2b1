//! Detection limits: the smallest amplitude of every effect that these recordings would have shown.

use thenar_contact::effects::Effect;

use crate::free_numbers::Free;
use crate::gates::decision::needed;
use thenar_inference::forward::surrogate::candidate_model::Model;
use thenar_inference::forward::surrogate::force_recording::ForceRecording;
use thenar_inference::forward::surrogate::mechanism::{Growth, Law, Mechanism};
use thenar_inference::forward::surrogate::prepared_study::PreparedStudy;
use thenar_inference::forward::surrogate::relaxation_spectrum::Spectrum;
use thenar_inference::forward::surrogate::surrogate_data::Surrogate;
use thenar_inference::least_squares::surrogate_fit::{covariance, left_by_fit};
use thenar_inference::selection::scored::{Rungs, Scored};

/// The smallest amplitude of every single effect that would have been detected; None where that is more than there can be.
///
/// Of a load that fades it is that of the spectrum with which a fit begins: where there is none, a fit ends at any.
pub fn smallest_seen(
    ready: &PreparedStudy,
    rungs: &Rungs,
) -> Vec<(&'static str, Option<f64>, &'static str)> {
    let mut found = Vec::new();
    for scored in &rungs.singles {
        let mechanism = &scored.mechanisms[0];
        let least = needed(mechanism) + mechanism.effective_parameters() as f64;
        let errors = (2.0 * least * rungs.overdispersion).sqrt();
        let size = match mechanism.law {
            Law::Relaxation {
                spectrum: Spectrum::Smooth { .. },
                ..
            } => errors * error_at_start(ready, rungs, mechanism),
            Law::Tabulated(_) if mechanism.effect == Effect::StiffSkin => {
                size_that_leaves(&ready.surrogate(), rungs, (mechanism, errors))
            }
            Law::Floor(_) => {
                let unread = unread(&ready.courses);
                let surrogate = Surrogate {
                    courses: &unread,
                    ..ready.surrogate()
                };
                size_that_leaves(&surrogate, rungs, (mechanism, errors)).max(surrogate.least_floor)
            }
            _ => errors * Free::of(ready, scored, 0).first().1,
        };
        let (value, unit, most) = in_words(ready, scored, size);
        let name = scored.mechanisms[0].effect.name();
        found.push((name, Some(value).filter(|v| *v <= most), unit));
    }
    found.sort_by_key(|(name, ..)| Effect::named(name));
    found
}

/// Standard error of a mechanism's first number, beside the base's as they were fitted and its others as a fit begins.
fn error_at_start(ready: &PreparedStudy, rungs: &Rungs, mechanism: &Mechanism) -> f64 {
    let surrogate = ready.surrogate();
    let model = Model::new(&surrogate, std::slice::from_ref(mechanism));
    let own = rungs.base.refit.at.len();
    let starts = model.coordinates[own..].iter().map(|c| c.start);
    let at: Vec<f64> = rungs.base.refit.at.iter().copied().chain(starts).collect();
    let known: Vec<usize> = (own + 1..at.len()).collect();
    covariance(&surrogate, &model, (at, &known))[(own, own)].sqrt()
}

/// The size from which a mechanism leaves so many standard deviations once the base is fitted to it; beyond its bounds if it does at none. Of a skin,
/// which adds little at first: a standard error at no skin at all would say that it is never seen. Of a floor likewise.
fn size_that_leaves(
    surrogate: &Surrogate<'_>,
    rungs: &Rungs,
    (mechanism, errors): (&Mechanism, f64),
) -> f64 {
    let model = Model::new(surrogate, std::slice::from_ref(mechanism));
    let base = &rungs.base.refit.at;
    let most = model.coordinates[base.len()].bounds.1;
    let sizes: Vec<f64> = (0..=SIZES)
        .map(|k| most * k as f64 / SIZES as f64)
        .collect();
    let of = |size: &f64| {
        surrogate.stacked(&surrogate.all_forces(&model, &[base, &[*size][..]].concat()))
    };
    let changed: Vec<Vec<f64>> = sizes.iter().map(of).collect();
    let squares = left_by_fit(surrogate, &Model::new(surrogate, &[]), (base, &changed));
    let left: Vec<f64> = squares.iter().map(|s| s.max(0.0).sqrt()).collect();
    let Some(k) = left.iter().position(|left| *left >= errors) else {
        return 2.0 * most;
    };
    let before = k.saturating_sub(1);
    let share = (errors - left[before]) / (left[k] - left[before]).max(f64::MIN_POSITIVE);
    sizes[before] + share.min(1.0) * (sizes[k] - sizes[before])
}

/// The same recordings before anything was read of them.
fn unread(courses: &[ForceRecording]) -> Vec<ForceRecording> {
    let mut all = courses.to_vec();
    for row in all.iter_mut().flat_map(|course| &mut course.rows) {
        row.force_n = f64::NAN;
    }
    all
}

/// Sizes at which a mechanism is tried.
const SIZES: usize = 24;

/// A size in the surrogate's own number as a person takes it, and the largest that there can be.
fn in_words(ready: &PreparedStudy, scored: &Scored, size: f64) -> (f64, &'static str, f64) {
    let (least, most) = ready.scales.forces;
    let deepest = ready.scales.deepest;
    match &scored.mechanisms[0].law {
        Law::Relaxation { .. } | Law::Softening { .. } => (size, "share of the force", 1.0),
        Law::Adhesion { .. } => (size, "share of the largest force", 1.0),
        Law::Tabulated(_) => match scored.mechanisms[0].effect {
            Effect::Bone => (libm::exp(size) - 1.0, "share of the thickness", 1.0),
            Effect::Compressibility => (size, "of Poisson's ratio", 0.5),
            _ => {
                let ratio = thenar_inference::forward::tables::stiff_skin::ratio(size);
                (
                    ratio,
                    "times as stiff as pulp",
                    thenar_inference::forward::tables::stiff_skin::MOST,
                )
            }
        },
        Law::Stiffening(_, Growth::Square) => (size, "share of the force", 1.0),
        Law::Stiffening(..)
        | Law::Saturation(_)
        | Law::GainStep { .. }
        | Law::DepthCurve { .. } => (libm::exp(size) - 1.0, "share of the force", 1.0),
        Law::Offset | Law::Drift { .. } => (size, "N", most),
        Law::Floor(_) => (size * least, "N", most),
        Law::Compliance => (size, "mm/N", deepest / most.max(1e-12)),
        Law::Delay => (size, "s", longest(ready)),
    }
}

/// Length of the longest recording, s.
fn longest(ready: &PreparedStudy) -> f64 {
    let last = |course: &ForceRecording| course.rows.last().map_or(0.0, |row| row.time_s);
    ready.courses.iter().map(last).fold(0.0, f64::max)
}
