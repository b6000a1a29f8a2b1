//! Heights of a scan and of the simulated skin by place, and their measures.

use nalgebra::Vector3;

use crate::comparison::quantities::{Kind, Measure};
use crate::comparison::recording_fit::RecordingFit;
use thenar_inference::observe::measured::Quantity;

/// Share of places that differ by less than what is told of them.
const MOST_OF_THEM: f64 = 0.95;

/// Heights over the skin at rest, a value per place that was seen.
#[derive(Debug, Clone, PartialEq)]
pub struct Scanned {
    /// Number of the moment.
    pub moment: u32,
    /// Places, mm: vertices of the skin at rest.
    pub places: Vec<Vector3<f64>>,
    /// Their vertices.
    pub vertices: Vec<u32>,
    /// Skin normals there.
    pub normals: Vec<Vector3<f64>>,
    /// Distance from a place to the next, mm.
    pub spacing: f64,
    /// Mean height of the scan, mm.
    pub measured: Vec<f64>,
    /// At the estimates, the scan's pose among them, mm.
    pub simulated: Vec<f64>,
    /// Distance of the scan from the simulated skin, mm, > 0 outside.
    pub residual: Vec<f64>,
    /// Standard deviation of the noise, mm; NaN where it is not known.
    pub sigma: Vec<f64>,
}

/// The scan of a recording; None if it is of none.
pub(crate) fn of(recording_fit: &RecordingFit) -> Option<Scanned> {
    let scan = recording_fit.measured.scan.as_ref()?;
    let samples = of_scan(recording_fit);
    let place = |k: &usize| match recording_fit.measured.samples[*k].quantity {
        Quantity::Scan(place) => place as usize,
        _ => 0,
    };
    let at: Vec<usize> = samples.iter().map(place).collect();
    let of = |value: &dyn Fn(usize) -> f64| samples.iter().map(|k| value(*k)).collect();
    Some(Scanned {
        moment: samples
            .first()
            .map(|k| recording_fit.measured.samples[*k].moment)?,
        places: at.iter().map(|k| scan.places[*k]).collect(),
        vertices: at.iter().map(|k| scan.vertices[*k]).collect(),
        normals: at.iter().map(|k| scan.normals[*k]).collect(),
        spacing: scan.spacing,
        measured: of(&|k| recording_fit.measured.samples[k].value),
        simulated: of(&|k| recording_fit.simulated[k]),
        residual: of(&|k| recording_fit.residual[k]),
        sigma: of(&|k| recording_fit.sigma[k]),
    })
}

fn of_scan(recording_fit: &RecordingFit) -> Vec<usize> {
    let samples = recording_fit.measured.samples.iter().enumerate();
    samples
        .filter(|(_, sample)| Kind::of(sample.quantity) == Kind::Scan)
        .map(|(k, _)| k)
        .collect()
}

/// Distance of scan and simulated skin, and how high the skin rises.
pub(crate) fn measures(recording_fit: &RecordingFit) -> Vec<Measure> {
    let heights = of_scan(recording_fit);
    if heights.is_empty() {
        return Vec::new();
    }
    let value = |k: usize| recording_fit.measured.samples[k].value;
    let rms = |of: &dyn Fn(usize) -> f64| {
        let squares: f64 = heights.iter().map(|k| of(*k).powi(2)).sum();
        (squares / heights.len() as f64).sqrt()
    };
    let most_of = |of: &dyn Fn(usize) -> f64| {
        let mut sizes: Vec<f64> = heights.iter().map(|k| of(*k).abs()).collect();
        sizes.sort_by(f64::total_cmp);
        let at = (MOST_OF_THEM * sizes.len() as f64).ceil() as usize;
        sizes[at.clamp(1, sizes.len()) - 1]
    };
    let end = |of: &dyn Fn(usize) -> f64, sign: f64| {
        let all = heights.iter().map(|k| sign * of(*k));
        sign * all.fold(f64::NEG_INFINITY, f64::max)
    };
    let left = |k: usize| value(k) - recording_fit.simulated[k];
    let left_before = |k: usize| value(k) - recording_fit.before[k];
    let (after, before) = (
        |k: usize| recording_fit.simulated[k],
        |k: usize| recording_fit.before[k],
    );
    let noise = rms(&|k| recording_fit.sigma[k]);
    let row = |name, label, [measured, before, after]: [f64; 3], noise| Measure {
        name,
        label,
        unit: "mm",
        of: "whole recording",
        measured,
        before,
        after,
        noise,
    };
    let nan = f64::NAN;
    vec![
        row(
            "scan_rms_residual_mm",
            "Distance of scan and simulation, rms",
            [nan, rms(&left_before), rms(&left)],
            noise,
        ),
        row(
            "scan_95_percent_residual_mm",
            "Distance that 95 % of the places stay within",
            [nan, most_of(&left_before), most_of(&left)],
            nan,
        ),
        row(
            "scan_highest_mm",
            "Highest place over the skin at rest",
            [end(&value, 1.0), end(&before, 1.0), end(&after, 1.0)],
            noise,
        ),
        row(
            "scan_lowest_mm",
            "Lowest place under the skin at rest",
            [end(&value, -1.0), end(&before, -1.0), end(&after, -1.0)],
            noise,
        ),
    ]
}
