//! Choice of the mat frames to show: mean force, largest force, largest residual.

use crate::comparison::instrument_view::{self, Shown, force_of};
use crate::comparison::quantities::residual;
use crate::comparison::recording_fit::RecordingFit;
use crate::comparison::result::Frame;
use thenar_inference::observe::measured::Mat;

/// Why the frame of the largest residual is shown.
pub(crate) const WORST: &str = "frame of the largest residual";
const MEAN: &str = "frame of mean force";
const LARGEST: &str = "frame of largest force";
/// Why the only frame is shown.
const ONLY: &str = "frame compared";

/// The frames worth showing, in the order of time; a frame that is shown for several reasons stands once. A
/// recording of one frame shows that.
///
/// The mean is over the frames in which the mat carries anything; the frame is the one whose force is nearest to it.
pub(crate) fn shown(recording_fit: &RecordingFit) -> Vec<Frame> {
    let Some(mat) = &recording_fit.measured.mat else {
        return Vec::new();
    };
    let contact_from = instrument_view::contact_from(recording_fit);
    let all: Vec<(usize, f64, f64)> = (0..recording_fit.by_moment.len())
        .filter_map(|moment| summed(recording_fit, mat, (moment, contact_from)))
        .collect();
    let loaded: Vec<_> = all.iter().filter(|(_, force, _)| *force > 0.0).collect();
    if loaded.is_empty() {
        return Vec::new();
    }
    let mean = loaded.iter().map(|(_, force, _)| force).sum::<f64>() / loaded.len() as f64;
    let nearest = loaded
        .iter()
        .min_by(|a, b| (a.1 - mean).abs().total_cmp(&(b.1 - mean).abs()));
    let largest = loaded.iter().max_by(|a, b| a.1.total_cmp(&b.1));
    let worst = all.iter().max_by(|a, b| a.2.total_cmp(&b.2));
    if let ([only], true) = (loaded.as_slice(), all.len() == 1) {
        return vec![frame(
            recording_fit,
            (only.0, contact_from),
            vec![ONLY, WORST],
        )];
    }
    let mut chosen: Vec<(usize, Vec<&'static str>)> = Vec::new();
    let moments = [
        (nearest.map(|row| row.0), MEAN),
        (largest.map(|row| row.0), LARGEST),
        (worst.map(|row| row.0), WORST),
    ];
    for (moment, why) in moments {
        let Some(moment) = moment else { continue };
        match chosen.iter_mut().find(|(other, _)| *other == moment) {
            Some((_, reasons)) => reasons.push(why),
            None => chosen.push((moment, vec![why])),
        }
    }
    chosen.sort_by_key(|(moment, _)| *moment);
    chosen
        .into_iter()
        .map(|(moment, why)| frame(recording_fit, (moment, contact_from), why))
        .collect()
}

/// Force, or its like in counts, and sum of squared residuals of a moment that has pressures.
fn summed(recording_fit: &RecordingFit, mat: &Mat, at: (usize, f64)) -> Option<(usize, f64, f64)> {
    let shown = instrument_view::shown(recording_fit, at.0, at.1);
    let samples: Vec<usize> = shown.samples.iter().copied().flatten().collect();
    let square = |k: &usize| match recording_fit.sigmas(*k) {
        sigmas if sigmas.is_nan() => recording_fit.residual[*k].powi(2),
        sigmas => sigmas.powi(2),
    };
    let left = samples.iter().map(square).sum();
    (!samples.is_empty()).then(|| (at.0, force_of(&shown.measured, mat), left))
}

fn frame(recording_fit: &RecordingFit, at: (usize, f64), why: Vec<&'static str>) -> Frame {
    let Shown {
        measured,
        simulated,
        before,
        samples,
        ..
    } = instrument_view::shown(recording_fit, at.0, at.1);
    let of = |value: &dyn Fn(usize) -> f64| {
        let value = |sample: &Option<usize>| sample.map_or(f64::NAN, value);
        samples.iter().map(value).collect::<Vec<f64>>()
    };
    let left = |k: usize| {
        let sample = &recording_fit.measured.samples[k];
        residual(sample.value, recording_fit.simulated[k], sample.censoring)
    };
    Frame {
        moment: at.0 as u32,
        why,
        residual: of(&left),
        sigmas: of(&|k| recording_fit.sigmas(k)),
        measured,
        simulated,
        before,
        contact_from: at.1,
    }
}
