//! Largest residuals: sensel, place on the skin, and moment.

use nalgebra::Vector3;

use crate::comparison::quantities::{Kind, WorstPlace};
use crate::comparison::recording_fit::RecordingFit;
use crate::comparison::result::Compared;
use thenar_inference::observe::measured::{Mat, Quantity};

/// Rows of a recording.
const MOST: usize = 8;
/// Rows of one quantity are this part of the recording's duration apart, at least.
const APART: f64 = 0.1;
/// Rows of a quantity that has one value per moment.
const MOST_OF_ONE: usize = 3;

/// The worst places of a recording, one moment for each sensel, by standard deviations of the noise where it is known.
pub(crate) fn places(compared: &Compared, recording_fit: &RecordingFit) -> Vec<WorstPlace> {
    let size = |k: usize| match recording_fit.sigmas(k) {
        sigmas if sigmas.is_nan() => recording_fit.residual[k].abs(),
        sigmas => sigmas.abs(),
    };
    let mut order: Vec<usize> = (0..recording_fit.residual.len())
        .filter(|k| recording_fit.residual[*k] != 0.0)
        .collect();
    order.sort_by(|a, b| size(*b).total_cmp(&size(*a)).then(a.cmp(b)));
    let mut chosen: Vec<usize> = Vec::new();
    for k in order {
        if chosen.len() == MOST {
            break;
        }
        let quantity = |k: &usize| recording_fit.measured.samples[*k].quantity;
        let alike = chosen
            .iter()
            .filter(|other| quantity(other) == quantity(&k));
        let is_told = chosen.iter().any(|other| is_same(recording_fit, *other, k));
        if !is_told && alike.count() < MOST_OF_ONE {
            chosen.push(k);
        }
    }
    chosen
        .iter()
        .map(|k| row(compared, recording_fit, *k))
        .collect()
}

/// Whether two samples would tell the same: the same sensel at any time, or another quantity at about the same time.
fn is_same(recording_fit: &RecordingFit, a: usize, b: usize) -> bool {
    let samples = &recording_fit.measured.samples;
    if samples[a].quantity != samples[b].quantity {
        return false;
    }
    if matches!(
        samples[a].quantity,
        Quantity::Pressure(_) | Quantity::Scan(_)
    ) {
        return true;
    }
    let time = |k: usize| recording_fit.measured.moments[samples[k].moment as usize].time_s;
    let moments = &recording_fit.measured.moments;
    let duration = moments.last().map_or(0.0, |last| last.time_s) - moments[0].time_s;
    (time(a) - time(b)).abs() < APART * duration
}

fn row(compared: &Compared, recording_fit: &RecordingFit, k: usize) -> WorstPlace {
    let measured = recording_fit.measured;
    let sample = &measured.samples[k];
    let moment = &measured.moments[sample.moment as usize];
    let sensel = match sample.quantity {
        Quantity::Pressure(sensel) => Some(sensel),
        _ => None,
    };
    let on_mat = sensel
        .zip(measured.mat.as_ref())
        .and_then(|(sensel, mat)| Some((mat, *mat.centers.get(sensel as usize)?, sensel as usize)));
    let site = || {
        let mut sites = compared.sites.iter();
        sites
            .find(|(name, _)| *name == measured.site)
            .map(|(_, point)| *point)
    };
    let (position, reach) = match (on_mat, sample.quantity) {
        (Some((mat, center, sensel)), _) => (Some(center), reach(mat, sensel)),
        (None, Quantity::Scan(place)) => measured.scan.as_ref().map_or((None, 0.0), |scan| {
            let center = scan.places.get(place as usize).copied();
            (center, 0.5 * scan.spacing)
        }),
        _ => (site(), 0.0),
    };
    WorstPlace {
        kind: Kind::of(sample.quantity),
        moment: sample.moment,
        time_s: moment.time_s,
        depth_mm: moment.depth_mm,
        phase: moment.phase,
        sensel,
        place: on_mat.and_then(|(mat, _, sensel)| mat.places[sensel]),
        position_mm: position.map(Into::into),
        vertices: position.map_or_else(Vec::new, |at| vertices(compared.skin, at, reach)),
        measured: sample.value,
        simulated: recording_fit.simulated[k],
        residual: recording_fit.residual[k],
        sigmas: recording_fit.sigmas(k),
    }
}

/// Half the side of a sensel, mm.
fn reach(mat: &Mat, sensel: usize) -> f64 {
    0.5 * mat.areas[sensel].max(0.0).sqrt()
}

/// Vertices no farther from `at` than the nearest and `reach` more, the nearest first; of equals the lower number.
fn vertices(skin: &[Vector3<f64>], at: Vector3<f64>, reach: f64) -> Vec<u32> {
    let distance = |k: &usize| (skin[*k] - at).norm();
    let least = (0..skin.len())
        .map(|k| distance(&k))
        .fold(f64::INFINITY, f64::min);
    let mut near: Vec<usize> = (0..skin.len())
        .filter(|k| distance(k) <= least + reach)
        .collect();
    near.sort_by(|a, b| distance(a).total_cmp(&distance(b)).then(a.cmp(b)));
    near.into_iter().map(|k| k as u32).collect()
}
