//! Comparison of one mat frame with one contact that was solved elsewhere; nothing is fitted.

use nalgebra::{DMatrix, Vector3};
use thenar_contact::instrument::{Mat as Sensels, MatLayout, PointLoad};

use crate::comparison::compare_fit::compare_fit;
use crate::comparison::result::{Compared, Comparison};
use thenar_inference::errors::InferenceError;
use thenar_inference::fit::result::Fit;
use thenar_inference::observe::measured::{
    Censoring, Mat, Measured, Moment, Phase, Quantity, Sample,
};

/// A frame, the mat it was read from, and the contact it is compared with; all in one frame of coordinates, mm.
#[derive(Debug, Clone)]
pub struct Still<'a> {
    /// Name of the recording.
    pub name: &'a str,
    /// Name of the product.
    pub product: &'a str,
    /// Name of the hand.
    pub hand: &'a str,
    /// Positions of the skin in contact, one per vertex.
    pub positions: &'a [Vector3<f64>],
    /// Area of each vertex, mm2.
    pub areas: &'a [f64],
    /// Normal force on each vertex, N.
    pub force_n: &'a [f64],
    /// The mat as it lies on the product.
    pub mat: Mat,
    /// One value per sensel, kPa or counts; NaN for missing cells.
    pub values: &'a [f64],
    /// Whether the values are kPa.
    pub is_calibrated: bool,
    /// Readings up to this are not passed on, in the values' unit.
    pub threshold: Option<f64>,
    /// Readings from this on are clipped, in the values' unit.
    pub clipped_from: Option<f64>,
    /// Standard deviation of a reading, in the values' unit, if known.
    pub noise: Option<f64>,
    /// When the frame was taken, s.
    pub time_s: f64,
    /// What cannot be known, a sentence each.
    pub unknown: Vec<String>,
}

/// Compares a frame with a contact, sensel by sensel.
///
/// A sensel reads the force that falls on it over its area. `positions`, `areas` and `force_n` are of one length.
///
/// # Errors
/// [`InferenceError::Contact`] if the mat has no sensel, or one without area or normal, or two in one place.
pub fn compare_still(still: Still<'_>) -> Result<Comparison, InferenceError> {
    let layout = MatLayout {
        centers: still.mat.centers.clone(),
        normals: still.mat.normals.clone(),
        areas: still.mat.areas.clone(),
        along: None,
    };
    let sensels = Sensels::new(layout).map_err(InferenceError::of_contact("the mat"))?;
    let load = |(k, force): (usize, &f64)| PointLoad {
        position: still.positions[k],
        force_n: *force,
        area_mm2: still.areas[k],
    };
    let loads: Vec<PointLoad> = still.force_n.iter().enumerate().map(load).collect();
    let read = sensels.read(&loads);
    let samples = samples(&still);
    let simulated: Vec<f64> = samples
        .iter()
        .map(|sample| match sample.quantity {
            Quantity::Pressure(sensel) => read[sensel as usize],
            _ => f64::NAN,
        })
        .collect();
    let count = samples.len();
    let sigma = vec![still.noise.unwrap_or(f64::NAN); count];
    let projected = samples.iter().zip(&simulated).zip(&sigma);
    let projected = projected
        .map(|((sample, simulated), sigma)| {
            crate::comparison::quantities::residual(sample.value, *simulated, sample.censoring)
                / sigma
        })
        .collect();
    let fit = Fit {
        before: vec![vec![f64::NAN; count]],
        simulated: vec![simulated],
        sigma: vec![sigma],
        projected: vec![projected],
        absorbed: DMatrix::zeros(count, 0),
        measured: vec![measured(&still, samples)],
        estimates: Vec::new(),
        lack_of_fit_p: None,
        notes: notes(
            &still,
            read.iter()
                .zip(&still.mat.areas)
                .map(|(p, a)| 1e-3 * p * a)
                .sum(),
        ),
    };
    Ok(compare_fit(&Compared {
        title: &format!("{} on {}", still.hand, still.product),
        skin: still.positions,
        sites: &[],
        fit: &fit,
        location: None,
        prints: &[],
    }))
}

fn samples(still: &Still<'_>) -> Vec<Sample> {
    let values = still.values.iter().enumerate();
    let is_at_most = |value: f64| still.threshold.is_some_and(|threshold| value <= threshold);
    let is_at_least = |value: f64| still.clipped_from.is_some_and(|clipped| value >= clipped);
    let sample = |(sensel, value): (usize, &f64)| Sample {
        moment: 0,
        quantity: Quantity::Pressure(sensel as u32),
        value: match still.threshold {
            Some(threshold) if *value <= threshold => threshold,
            _ => *value,
        },
        censoring: match *value {
            value if is_at_most(value) => Censoring::AtMost,
            value if is_at_least(value) => Censoring::AtLeast,
            _ => Censoring::Seen,
        },
    };
    values
        .filter(|(_, value)| !value.is_nan())
        .map(sample)
        .collect()
}

fn measured(still: &Still<'_>, samples: Vec<Sample>) -> Measured {
    Measured {
        name: still.name.to_string(),
        protocol: still.name.to_string(),
        indenter: still.product.to_string(),
        site: still.hand.to_string(),
        moments: vec![Moment {
            time_s: still.time_s,
            depth_mm: f64::NAN,
            demand_n: f64::NAN,
            slide_mm: Vector3::zeros(),
            rate_mm_s: f64::NAN,
            phase: Phase::Hold,
            cycle: 0,
            readings: 1,
            depth_spread_mm: 0.0,
            force_step_n: 0.0,
        }],
        samples,
        mat: Some(still.mat.clone()),
        scan: None,
        is_calibrated: still.is_calibrated,
        depth_error_mm: 0.0,
        is_coarse: false,
        unknown: still.unknown.clone(),
    }
}

fn notes(still: &Still<'_>, on_mat: f64) -> Vec<String> {
    let mut notes =
        vec!["Nothing was fitted: the simulation is the contact as it was solved.".to_string()];
    let whole: f64 = still.force_n.iter().sum();
    if whole - on_mat > 0.02 * whole {
        notes.push(format!(
            "Of the simulated {} N, {} N press beside the mat and are not compared.",
            thenar_inference::number_format::number(whole),
            thenar_inference::number_format::number(whole - on_mat)
        ));
    }
    if still.noise.is_none() {
        notes.push("One frame without repeats tells no noise: what is small cannot be told from what is real.".into());
    }
    notes
}
