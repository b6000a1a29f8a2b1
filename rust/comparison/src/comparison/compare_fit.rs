//! Conducts the comparison of a fit: measures, trends, frames and largest residuals of every recording.
//!
//! A mat is compared as its instrument would show it: what lies under its threshold counts as nothing on both sides, and
//! what clips counts as the ceiling on both sides. A map without calibration is compared by shape alone: the simulation is
//! scaled to the sum of the reading.

use crate::comparison::recording_fit::RecordingFit;
use crate::comparison::result::{Compared, Comparison, RecordingComparison};
use crate::comparison::trends::Trend;

/// Compares every recording of a fit with its simulation.
///
/// `sites` without the name of a recording's site leave its worst places without vertices.
pub fn compare_fit(compared: &Compared) -> Comparison {
    let fit = compared.fit;
    let recording_fits = RecordingFit::of(fit);
    let mut all_trends: Vec<Vec<Trend>> = recording_fits
        .iter()
        .map(crate::comparison::trends::of)
        .collect();
    let look_elsewhere_count = crate::comparison::trends::pay(all_trends.iter_mut().flatten());
    let recordings: Vec<RecordingComparison> = recording_fits
        .iter()
        .zip(all_trends)
        .enumerate()
        .map(|(number, (recording_fit, trends))| {
            recording(compared, (number, recording_fit), trends)
        })
        .collect();
    Comparison {
        title: compared.title.to_string(),
        sentence: crate::comparison::sentence::of_study(&recordings, fit, compared.location),
        recordings,
        estimates: fit.estimates.clone(),
        lack_of_fit_p: fit.lack_of_fit_p,
        look_elsewhere_count,
        location: compared.location.cloned(),
        notes: notes(compared),
    }
}

fn notes(compared: &Compared) -> Vec<String> {
    let located = compared.location.map(|location| &location.notes);
    let all = compared
        .fit
        .notes
        .iter()
        .chain(located.into_iter().flatten());
    all.cloned().collect()
}

fn recording(
    compared: &Compared,
    (number, recording_fit): (usize, &RecordingFit),
    trends: Vec<Trend>,
) -> RecordingComparison {
    let measured = recording_fit.measured;
    let frames = crate::comparison::shown_frames::shown(recording_fit);
    let series = crate::comparison::series::series(recording_fit);
    let mut comparison = RecordingComparison {
        name: measured.name.clone(),
        protocol: measured.protocol.clone(),
        indenter: measured.indenter.clone(),
        site: measured.site.clone(),
        sentence: String::new(),
        is_calibrated: measured.is_calibrated,
        has_noise: recording_fit.has_noise(),
        // A frame that is compared with a contact as it stands has the noise that was stated, or none.
        is_noise_told: compared.fit.lack_of_fit_p.is_some() || compared.fit.estimates.is_empty(),
        moments: measured.moments.clone(),
        measures: crate::comparison::measures::table(recording_fit, &series, &frames),
        trends,
        worst: crate::comparison::worst_places::places(compared, recording_fit),
        residual_kpa: crate::comparison::residual_on_skin::worst_frame(
            compared,
            recording_fit,
            &frames,
        ),
        series,
        mat: measured.mat.clone(),
        scan: crate::comparison::scan_heights::of(recording_fit),
        print: None,
        frames,
        unknown: measured.unknown.clone(),
    };
    if let Some(Some((print, table))) = compared.prints.get(number) {
        comparison.measures.extend(table.iter().cloned());
        comparison.worst.clone_from(&print.worst);
        comparison.print = Some(print.clone());
    }
    comparison.sentence = crate::comparison::sentence::of_recording(&comparison);
    comparison
}
