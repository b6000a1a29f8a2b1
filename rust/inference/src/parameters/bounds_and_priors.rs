//! Bounds, priors and sources of every parameter that the mesh model's fit may change.

use thenar_recordings::study::Instrument;

use crate::forward::setup::study_skin::Tissue;
use crate::noise::estimate::Noise;
use crate::observe::measured::{Measured, Phase, Quantity};
use crate::parameters::parameter::{Kind, Number, Parameter};
use crate::parameters::priors::{
    BEYOND_START, COUNTS, DEEPEST_TOUCH, FORCE_ZERO, LIMIT_DEPTH, MODULUS, MOST, MOST_POSITION,
    THICKNESS, TOUCH, UNKNOWN_TOUCH, gain,
};
use crate::parameters::sensor_pose::poses;

/// What the parameters are chosen for.
#[derive(Clone, Copy)]
pub struct Case<'a> {
    /// The skin.
    pub tissue: &'a Tissue,
    /// The recordings.
    pub measured: &'a [Measured],
    /// By recording: whether first touch was judged by somebody.
    pub is_touch_known: &'a [bool],
    /// By recording: number of its tool at its site.
    pub place_of: &'a [usize],
    /// By recording: whether it is fitted.
    pub is_used: &'a [bool],
    /// Its noise.
    pub noise: &'a Noise,
    /// The data sheet.
    pub instrument: Option<&'a Instrument>,
}

/// False if all that is fitted are counts without a depth: a softer skin under a smaller force looks the same.
pub(crate) fn tells_moduli((measured, is_used): (&[Measured], &[bool])) -> bool {
    let used = measured.iter().zip(is_used).filter(|(_, used)| **used);
    let mut used = used.filter(|(one, _)| !one.samples.is_empty());
    used.any(|(one, _)| one.is_calibrated || !one.asks_force())
}

/// Everything that the recordings of a study call for.
pub fn parameters(case: Case<'_>) -> Vec<Parameter> {
    let mut all = match tells_moduli((case.measured, case.is_used)) {
        true => of_tissue(case.tissue),
        false => Vec::new(),
    };
    let sheet = case.instrument;
    if let Some(percent) = sheet.and_then(|s| s.gain_percent) {
        all.push(gain(Kind::InstrumentGain, percent / 100.0));
    }
    for (recording, measured) in case.measured.iter().enumerate() {
        if !case.is_used[recording] || measured.samples.is_empty() {
            continue;
        }
        all.extend(touch(case, recording));
        let found = match case.is_touch_known[recording] {
            // Free without need it takes up what a spot in the skin does.
            true => case
                .noise
                .force_zero_n
                .filter(|_| case.noise.has_clear_zeros),
            false => None,
        };
        if found.is_some() || !case.is_touch_known[recording] {
            all.extend(force_zero(recording, measured, found));
        }
        let is_scaled = measured.is_calibrated && carries_force(measured);
        if is_scaled && case.noise.gain > 0.0 {
            all.push(gain(Kind::Gain(recording), case.noise.gain));
        }
        if !measured.is_calibrated {
            all.push(Parameter {
                kind: Kind::Counts(recording),
                start: 0.0,
                bounds: (-COUNTS, COUNTS),
                prior: None,
                step: 1e-4,
            });
        }
        all.extend(poses(recording, measured, sheet));
    }
    all
}

/// What the load cell shows without load: about what was taken off where the file gives no first touch, else with the standard deviation (N)
/// that repeats show.
pub(crate) fn force_zero(
    recording: usize,
    measured: &Measured,
    found: Option<f64>,
) -> Option<Parameter> {
    let forces = measured
        .samples
        .iter()
        .filter(|s| s.quantity == Quantity::Force);
    let most = forces.fold(0.0, |most, s| f64::max(most, s.value.abs()));
    let sd = found.unwrap_or(FORCE_ZERO * most);
    (sd > 0.0 && most > 0.0)
        .then(|| Parameter::about(Kind::ForceZero(recording), (sd, MOST_POSITION), sd))
}

pub(crate) fn carries_force(measured: &Measured) -> bool {
    let is_force = |q: Quantity| !matches!(q, Quantity::Area | Quantity::Scan(_));
    measured.samples.iter().any(|s| is_force(s.quantity))
}

/// First touch of a recording, and before it that of its tool at its site where this is the first of its recordings.
///
/// Repeats tell how first touch differs between them, but not by how much it is off in all of them.
pub(crate) fn touch(case: Case<'_>, recording: usize) -> Vec<Parameter> {
    let deepest = |r: usize| {
        let depths = case.measured[r].moments.iter().map(|m| m.depth_mm);
        depths.filter(|d| d.is_finite()).fold(0.0, f64::max)
    };
    let deep = deepest(recording);
    if deep <= 0.0 {
        return Vec::new();
    }
    let sheet = case
        .instrument
        .and_then(|s| s.first_touch_mm.or(s.position_mm));
    let judged = match case.is_touch_known[recording] {
        true => sheet.unwrap_or(TOUCH).min(DEEPEST_TOUCH * deep),
        false => UNKNOWN_TOUCH * deep,
    };
    let one = |kind: Kind, sd: f64| {
        let mut one = Parameter::about(kind, (sd, MOST), 1e-3 * deep);
        one.bounds.1 = one.bounds.1.min(0.8 * deep);
        one
    };
    let place = case.place_of[recording];
    let shares = |r: usize| {
        case.is_used[r] && case.is_touch_known[r] && case.place_of[r] == place && deepest(r) > 0.0
    };
    let sharing: Vec<usize> = (0..case.measured.len()).filter(|&r| shares(r)).collect();
    let between = case
        .noise
        .zero_mm
        .filter(|_| sharing.len() > 1 && sharing.contains(&recording));
    match between {
        None => vec![one(Kind::Zero(recording), judged)],
        Some(between) if sharing[0] == recording => {
            vec![
                one(Kind::Touch(place), judged),
                one(Kind::Zero(recording), between),
            ]
        }
        Some(between) => vec![one(Kind::Zero(recording), between)],
    }
}

/// Credible values of a number of a material, wider where the study starts outside of them.
fn credible(number: Number, start: f64) -> (f64, f64) {
    match number {
        Number::G0 | Number::GLim => (
            MODULUS.0.min(start / BEYOND_START),
            MODULUS.1.max(start * BEYOND_START),
        ),
        Number::DLim => (
            LIMIT_DEPTH.0.min(start / 4.0),
            LIMIT_DEPTH.1.max(start * 4.0),
        ),
        Number::Thickness => (THICKNESS.0.min(start / 4.0), THICKNESS.1.max(start * 4.0)),
    }
}

pub(crate) fn of_tissue(tissue: &Tissue) -> Vec<Parameter> {
    let mut all = Vec::new();
    for (region, fitted) in tissue.fitted.iter().enumerate() {
        for fitted in fitted {
            let Some(number) = Number::named(fitted) else {
                continue;
            };
            let mut material = tissue.materials[region];
            let start = *number.of(&mut material);
            if !start.is_finite() {
                continue;
            }
            let (low, high) = credible(number, start);
            all.push(Parameter {
                kind: Kind::Tissue(region, number),
                start: libm::log(start),
                bounds: (libm::log(low), libm::log(high)),
                prior: None,
                step: 5e-3,
            });
        }
    }
    all
}

/// True if some sample was taken with the tool on the skin, or is of the skin alone.
pub fn touches(measured: &Measured) -> bool {
    measured.scan.is_some() || measured.moments.iter().any(|m| m.phase != Phase::Apart)
}
