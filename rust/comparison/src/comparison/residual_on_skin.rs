//! Residual of a mat frame interpolated to the skin's vertices.

use nalgebra::Vector3;

use crate::comparison::recording_fit::RecordingFit;
use crate::comparison::result::{Compared, Frame};
use crate::comparison::shown_frames;
use thenar_inference::observe::measured::Mat;

/// How far the skin may lie from the mat across it, beyond the depth of the contact, mm: as far as soft skin is drawn along.
const SLACK: f64 = 3.0;

/// Values of sensels (one each, NaN for missing) at the vertices of a skin.
///
/// A vertex takes the mean of the sensels whose center is nearer than their side, measured along the mat, with weights that
/// fall linearly to that distance; NaN away from the mat. `depth` is how far the mat has traveled into the skin, mm.
pub fn on_skin(skin: &[Vector3<f64>], mat: &Mat, values: &[f64], depth: f64) -> Vec<f64> {
    let reach = depth.max(0.0) + SLACK;
    let sensels: Vec<usize> = (0..values.len()).filter(|k| !values[*k].is_nan()).collect();
    let (low, high) = bounds(mat, &sensels, reach);
    let at_vertex = |position: &Vector3<f64>| {
        let is_off = (0..3).any(|axis| position[axis] < low[axis] || position[axis] > high[axis]);
        if is_off {
            return f64::NAN;
        }
        let (mut sum, mut weights) = (0.0, 0.0);
        for k in &sensels {
            let (out, apart) = (mat.normals[*k], position - mat.centers[*k]);
            let across = apart.dot(&out);
            if across.abs() > reach {
                continue;
            }
            let weight = 1.0 - (apart - out * across).norm() / mat.areas[*k].sqrt();
            if weight > 0.0 {
                sum += weight * values[*k];
                weights += weight;
            }
        }
        if weights > 0.0 {
            sum / weights
        } else {
            f64::NAN
        }
    };
    skin.iter().map(at_vertex).collect()
}

fn bounds(mat: &Mat, sensels: &[usize], reach: f64) -> (Vector3<f64>, Vector3<f64>) {
    let mut low = Vector3::repeat(f64::INFINITY);
    let mut high = Vector3::repeat(f64::NEG_INFINITY);
    for k in sensels {
        let margin = Vector3::repeat(reach + mat.areas[*k].sqrt());
        low = low.inf(&(mat.centers[*k] - margin));
        high = high.sup(&(mat.centers[*k] + margin));
    }
    (low, high)
}

/// Residual per skin vertex in the frame of the largest residual.
pub(crate) fn worst_frame(
    compared: &Compared,
    recording_fit: &RecordingFit,
    shown: &[Frame],
) -> Vec<f64> {
    let worst = shown
        .iter()
        .find(|frame| frame.why.contains(&shown_frames::WORST));
    let (Some(mat), Some(frame)) = (&recording_fit.measured.mat, worst) else {
        return Vec::new();
    };
    if !recording_fit.measured.is_calibrated {
        return Vec::new();
    }
    let depth = recording_fit.measured.moments[frame.moment as usize].depth_mm;
    on_skin(compared.skin, mat, &frame.residual, depth.max(0.0))
}
