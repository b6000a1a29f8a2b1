//! A recording beside its simulation: measures, residual against what it may depend on, frames, and the worst places.
//!
//! A mat is compared as its instrument would show it: what lies under its threshold counts as nothing on both sides, and
//! what clips counts as the ceiling on both sides. A map without calibration is compared by shape alone: the simulation is
//! scaled to the sum of the reading.

use crate::comparison::recording_fit::Standing;
use crate::comparison::result::{Compared, Comparison, RecordingComparison};
use crate::comparison::trends::Trend;

/// Compares every recording of a fit with its simulation.
///
/// `sites` without the name of a recording's site leave its worst places without vertices.
pub fn compare_fit(compared: &Compared) -> Comparison {
    let fit = compared.fit;
    let standings = Standing::of(fit);
    let mut all_trends: Vec<Vec<Trend>> = standings
        .iter()
        .map(crate::comparison::trends::of)
        .collect();
    let looks = crate::comparison::trends::pay(all_trends.iter_mut().flatten());
    let recordings: Vec<RecordingComparison> = standings
        .iter()
        .zip(all_trends)
        .enumerate()
        .map(|(number, (standing, trends))| recording(compared, (number, standing), trends))
        .collect();
    Comparison {
        title: compared.title.to_string(),
        sentence: crate::comparison::sentence::of_study(&recordings, fit, compared.location),
        recordings,
        estimates: fit.estimates.clone(),
        lack_of_fit_p: fit.lack_of_fit_p,
        looks,
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
    (number, standing): (usize, &Standing),
    trends: Vec<Trend>,
) -> RecordingComparison {
    let measured = standing.measured;
    let frames = crate::comparison::shown_frames::shown(standing);
    let series = crate::comparison::series::series(standing);
    let mut comparison = RecordingComparison {
        name: measured.name.clone(),
        protocol: measured.protocol.clone(),
        indenter: measured.indenter.clone(),
        site: measured.site.clone(),
        sentence: String::new(),
        is_calibrated: measured.is_calibrated,
        has_noise: standing.has_noise(),
        // A frame that is compared with a contact as it stands has the noise that was stated, or none.
        is_noise_told: compared.fit.lack_of_fit_p.is_some() || compared.fit.estimates.is_empty(),
        moments: measured.moments.clone(),
        measures: crate::comparison::measures::table(standing, &series, &frames),
        trends,
        worst: crate::comparison::worst_places::places(compared, standing),
        residual_kpa: crate::comparison::residual_on_skin::worst_frame(compared, standing, &frames),
        series,
        mat: measured.mat.clone(),
        scan: crate::comparison::scan_heights::of(standing),
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
