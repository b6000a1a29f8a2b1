//! A frame of a mat as its instrument would show it, measured and simulated alike.

use crate::comparison::recording_fit::RecordingFit;
use thenar_inference::observe::measured::{Censoring, Mat, Quantity};

/// One frame through the instrument's limits; NaN where the cell is missing.
pub(crate) struct Shown {
    pub measured: Vec<f64>,
    pub simulated: Vec<f64>,
    pub before: Vec<f64>,
    pub sigma: Vec<f64>,
    /// Number of the sample of each sensel.
    pub samples: Vec<Option<usize>>,
}

/// Readings of this much and more count as contact: the instrument's threshold, or where it has none, the smallest reading
/// above zero in the recording.
pub(crate) fn contact_from(recording_fit: &RecordingFit) -> f64 {
    let pressures = || {
        let samples = recording_fit.measured.samples.iter();
        samples.filter(|sample| matches!(sample.quantity, Quantity::Pressure(_)))
    };
    let threshold = pressures()
        .filter(|sample| sample.censoring == Censoring::AtMost)
        .fold(0.0_f64, |most, sample| most.max(sample.value));
    if threshold > 0.0 {
        return threshold;
    }
    let smallest = pressures()
        .filter(|sample| sample.censoring != Censoring::AtMost && sample.value > 0.0)
        .fold(f64::INFINITY, |least, sample| least.min(sample.value));
    if smallest.is_finite() { smallest } else { 0.0 }
}

/// The frame of a moment.
pub(crate) fn shown(recording_fit: &RecordingFit, moment: usize, contact_from: f64) -> Shown {
    let sensels = recording_fit
        .measured
        .mat
        .as_ref()
        .map_or(0, |mat| mat.centers.len());
    let missing = || vec![f64::NAN; sensels];
    let mut shown = Shown {
        measured: missing(),
        simulated: missing(),
        before: missing(),
        sigma: missing(),
        samples: vec![None; sensels],
    };
    for k in recording_fit.by_moment[moment].clone() {
        let sample = &recording_fit.measured.samples[k];
        let Quantity::Pressure(sensel) = sample.quantity else {
            continue;
        };
        let at = sensel as usize;
        if at >= sensels {
            continue;
        }
        let through = |value: f64| match sample.censoring {
            _ if value < contact_from => 0.0,
            Censoring::AtLeast => value.min(sample.value),
            Censoring::AtMost if value <= sample.value => 0.0,
            _ => value,
        };
        shown.measured[at] = through(sample.value);
        shown.simulated[at] = through(recording_fit.simulated[k]);
        shown.before[at] = through(recording_fit.before[k]);
        shown.sigma[at] = recording_fit.sigma[k];
        shown.samples[at] = Some(k);
    }
    shown
}

pub(crate) const N_PER_KPA_MM2: f64 = 1e-3;

pub(crate) fn peak_of(values: &[f64]) -> f64 {
    values.iter().copied().fold(0.0, f64::max)
}

/// Sum of pressure times area, N, with the pressures in kPa.
pub(crate) fn force_of(values: &[f64], mat: &Mat) -> f64 {
    let pairs = values
        .iter()
        .zip(&mat.areas)
        .filter(|(value, _)| !value.is_nan());
    N_PER_KPA_MM2 * pairs.map(|(value, area)| value * area).sum::<f64>()
}

pub(crate) fn area_of(values: &[f64], mat: &Mat) -> f64 {
    let pairs = values
        .iter()
        .zip(&mat.areas)
        .filter(|(value, _)| **value > 0.0);
    pairs.map(|(_, area)| area).sum()
}

pub(crate) fn force_noise(shown: &Shown, mat: &Mat) -> f64 {
    let touching = (0..shown.measured.len()).filter(|k| shown.measured[*k] > 0.0);
    let squares = touching.map(|k| (shown.sigma[k] * mat.areas[k]).powi(2));
    N_PER_KPA_MM2 * squares.sum::<f64>().sqrt()
}
