//! The table of measures of a recording: what was read, and what the simulation shows before and after the fit.

use crate::center_of_pressure;
use crate::comparison::instrument_view::{
    self, N_PER_KPA_MM2, Shown, area_of, force_noise, force_of, peak_of,
};
use crate::comparison::quantities::Measure;
use crate::comparison::recording_fit::RecordingFit;
use crate::comparison::result::{Frame, Series};
use thenar_inference::observe::measured::Mat;

/// Every measure of the recording.
pub(crate) fn table(
    recording_fit: &RecordingFit,
    series: &[Series],
    frames: &[Frame],
) -> Vec<Measure> {
    let mut table: Vec<Measure> = series.iter().flat_map(of_series).collect();
    table.extend(crate::comparison::scan_heights::measures(recording_fit));
    let Some(mat) = &recording_fit.measured.mat else {
        return table;
    };
    for frame in frames {
        let shown =
            instrument_view::shown(recording_fit, frame.moment as usize, frame.contact_from);
        let mut reasons = frame
            .why
            .iter()
            .filter(|why| **why != crate::comparison::shown_frames::WORST);
        if let Some(why) = reasons.next() {
            let rows = match recording_fit.measured.is_calibrated {
                true => of_frame(&shown, mat),
                false => of_shape(&shown, mat),
            };
            table.extend(rows.into_iter().map(|row| Measure { of: why, ..row }));
        }
    }
    table
}

fn of_series(series: &Series) -> [Measure; 2] {
    let largest =
        |values: &[f64]| told(values, &|values| values.iter().copied().fold(0.0, f64::max));
    let at = (0..series.measured.len())
        .max_by(|a, b| series.measured[*a].total_cmp(&series.measured[*b]));
    let measure = |name, label, measured, before, after, noise| Measure {
        name,
        label,
        unit: series.unit,
        of: "whole recording",
        measured,
        before,
        after,
        noise,
    };
    let (peak_name, peak_label, rest_name) = match series.name {
        "force_n" => ("largest_force_n", "Largest force", "force_rms_residual_n"),
        "mat_force_n" => (
            "largest_mat_force_n",
            "Largest force on the mat",
            "mat_force_rms_residual_n",
        ),
        "tangential_force_n" => (
            "largest_tangential_force_n",
            "Largest tangential force",
            "tangential_force_rms_residual_n",
        ),
        "area_mm2" => (
            "largest_area_mm2",
            "Largest contact area",
            "area_rms_residual_mm2",
        ),
        _ => (
            "largest_mat_area_mm2",
            "Largest contact area on the mat",
            "mat_area_rms_residual_mm2",
        ),
    };
    let rest_label = match series.name {
        "force_n" => "Residual of the force, rms",
        "mat_force_n" => "Residual of the force on the mat, rms",
        "tangential_force_n" => "Residual of the tangential force, rms",
        _ => "Residual of the contact area, rms",
    };
    let rms = |simulated: &[f64]| {
        let squares = series.measured.iter().zip(simulated);
        (squares.map(|(m, s)| (m - s).powi(2)).sum::<f64>() / series.measured.len() as f64).sqrt()
    };
    let noise = (series.sigma.iter().map(|sigma| sigma * sigma).sum::<f64>()
        / series.sigma.len() as f64)
        .sqrt();
    [
        measure(
            peak_name,
            peak_label,
            largest(&series.measured),
            largest(&series.before),
            largest(&series.simulated),
            at.map_or(f64::NAN, |at| series.sigma[at]),
        ),
        measure(
            rest_name,
            rest_label,
            f64::NAN,
            rms(&series.before),
            rms(&series.simulated),
            noise,
        ),
    ]
}

/// Peak, mean, force, area, center and overlap of a calibrated frame.
fn of_frame(shown: &Shown, mat: &Mat) -> Vec<Measure> {
    let row = |name, label, unit, of: &dyn Fn(&[f64]) -> f64, noise| Measure {
        name,
        label,
        unit,
        of: "",
        measured: of(&shown.measured),
        before: told(&shown.before, of),
        after: of(&shown.simulated),
        noise,
    };
    let mean = |values: &[f64]| force_of(values, mat) / (N_PER_KPA_MM2 * area_of(values, mat));
    let touching = area_of(&shown.measured, mat);
    let mean_noise = force_noise(shown, mat) / (N_PER_KPA_MM2 * touching);
    let mut rows = vec![
        row(
            "peak_kpa",
            "Peak pressure",
            "kPa",
            &peak_of,
            peak_noise(shown),
        ),
        row("mean_kpa", "Mean pressure", "kPa", &mean, mean_noise),
        row(
            "force_n",
            "Force",
            "N",
            &|values| force_of(values, mat),
            force_noise(shown, mat),
        ),
        row(
            "area_mm2",
            "Contact area",
            "mm²",
            &|values| area_of(values, mat),
            f64::NAN,
        ),
    ];
    rows.extend(of_place(shown, mat));
    rows
}

/// What a frame without calibration tells: peak over mean, area, center and overlap.
fn of_shape(shown: &Shown, mat: &Mat) -> Vec<Measure> {
    let ratio = |values: &[f64]| {
        peak_of(values) * N_PER_KPA_MM2 * area_of(values, mat) / force_of(values, mat)
    };
    let row = |name, label, unit, of: &dyn Fn(&[f64]) -> f64| Measure {
        name,
        label,
        unit,
        of: "",
        measured: of(&shown.measured),
        before: told(&shown.before, of),
        after: of(&shown.simulated),
        noise: f64::NAN,
    };
    let mut rows = vec![
        row("peak_over_mean", "Peak over mean", "", &ratio),
        row("area_mm2", "Contact area", "mm²", &|values| {
            area_of(values, mat)
        }),
    ];
    rows.extend(of_place(shown, mat));
    rows
}

/// Distance of the centers of pressure and overlap of the areas of contact.
fn of_place(shown: &Shown, mat: &Mat) -> [Measure; 4] {
    let center = center_of_pressure::center(&shown.measured, mat);
    let apart = |values: &[f64]| (center_of_pressure::center(values, mat) - center).norm();
    let row = |name, label, unit, of: &dyn Fn(&[f64]) -> f64, noise| Measure {
        name,
        label,
        unit,
        of: "",
        measured: f64::NAN,
        before: told(&shown.before, of),
        after: of(&shown.simulated),
        noise,
    };
    let shares = |values: &[f64]| Shares::of(&shown.measured, values, mat);
    [
        row(
            "center_distance_mm",
            "Distance of the centers of pressure",
            "mm",
            &apart,
            center_of_pressure::noise((&shown.measured, &shown.sigma), mat, center),
        ),
        row(
            "overlap",
            "Overlap of the contact areas (both / either)",
            "",
            &|values| shares(values).both / shares(values).either,
            f64::NAN,
        ),
        row(
            "overlap_of_measured",
            "Share of the measured area that is simulated too",
            "",
            &|values| shares(values).both / shares(values).measured,
            f64::NAN,
        ),
        row(
            "overlap_of_simulated",
            "Share of the simulated area that is measured too",
            "",
            &|values| shares(values).both / shares(values).simulated,
            f64::NAN,
        ),
    ]
}

/// Areas in contact, mm2.
struct Shares {
    both: f64,
    either: f64,
    measured: f64,
    simulated: f64,
}

impl Shares {
    fn of(measured: &[f64], simulated: &[f64], mat: &Mat) -> Shares {
        let area = |is_in: &dyn Fn(usize) -> bool| {
            (0..measured.len())
                .filter(|k| !measured[*k].is_nan() && is_in(*k))
                .map(|k| mat.areas[k])
                .sum()
        };
        Shares {
            both: area(&|k| measured[k] > 0.0 && simulated[k] > 0.0),
            either: area(&|k| measured[k] > 0.0 || simulated[k] > 0.0),
            measured: area(&|k| measured[k] > 0.0),
            simulated: area(&|k| simulated[k] > 0.0),
        }
    }
}

/// A measure of values; NaN where there are none.
fn told(values: &[f64], of: &dyn Fn(&[f64]) -> f64) -> f64 {
    match values.iter().all(|value| value.is_nan()) {
        true => f64::NAN,
        false => of(values),
    }
}

fn peak_noise(shown: &Shown) -> f64 {
    let at = (0..shown.measured.len())
        .filter(|k| !shown.measured[*k].is_nan())
        .max_by(|a, b| shown.measured[*a].total_cmp(&shown.measured[*b]));
    at.map_or(f64::NAN, |at| shown.sigma[at])
}
