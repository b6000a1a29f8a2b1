//! Quantities of which a recording has one value per moment: those that were sampled, and the sums over a mat.

use crate::comparison::instrument_view;
use crate::comparison::instrument_view::{area_of, force_noise, force_of};
use crate::comparison::quantities::Kind;
use crate::comparison::recording_fit::RecordingFit;
use crate::comparison::result::Series;
use thenar_inference::observe::measured::Quantity;

/// Quantities of which the recording has one value per moment: those that were sampled, and the sums over a mat.
pub(crate) fn series(recording_fit: &RecordingFit) -> Vec<Series> {
    let mut all = Vec::new();
    for kind in [Kind::Force, Kind::TangentialForce, Kind::Area] {
        let mut series = Series {
            name: kind.name(true),
            label: kind.label(),
            unit: kind.unit(true),
            ..Series::default()
        };
        for (k, sample) in recording_fit.measured.samples.iter().enumerate() {
            if Kind::of(sample.quantity) == kind {
                series.moments.push(sample.moment);
                series.measured.push(sample.value);
                series.simulated.push(recording_fit.simulated[k]);
                series.before.push(recording_fit.before[k]);
                series.sigma.push(recording_fit.sigma[k]);
            }
        }
        if !series.moments.is_empty() {
            all.push(series);
        }
    }
    all.extend(sums(recording_fit));
    all
}

/// Force and area of contact on a mat over its frames; without calibration only the area.
fn sums(recording_fit: &RecordingFit) -> Vec<Series> {
    let Some(mat) = &recording_fit.measured.mat else {
        return Vec::new();
    };
    let is_pressure = |sample: &thenar_inference::observe::measured::Sample| {
        matches!(sample.quantity, Quantity::Pressure(_))
    };
    if !recording_fit.measured.samples.iter().any(is_pressure) {
        return Vec::new();
    }
    let mut force = Series {
        name: "mat_force_n",
        label: "Force on the mat",
        unit: "N",
        ..Series::default()
    };
    let mut area = Series {
        name: "mat_area_mm2",
        label: "Contact area on the mat",
        unit: "mm²",
        ..Series::default()
    };
    let contact_from = instrument_view::contact_from(recording_fit);
    for moment in 0..recording_fit.by_moment.len() {
        let shown = instrument_view::shown(recording_fit, moment, contact_from);
        if shown.samples.iter().all(Option::is_none) {
            continue;
        }
        let push = |series: &mut Series, of: &dyn Fn(&[f64]) -> f64, sigma: f64| {
            series.moments.push(moment as u32);
            series.measured.push(of(&shown.measured));
            series.simulated.push(of(&shown.simulated));
            series.before.push(of(&shown.before));
            series.sigma.push(sigma);
        };
        push(
            &mut force,
            &|values| force_of(values, mat),
            force_noise(&shown, mat),
        );
        push(&mut area, &|values| area_of(values, mat), f64::NAN);
    }
    match recording_fit.measured.is_calibrated {
        true => vec![force, area],
        false => vec![area],
    }
}
