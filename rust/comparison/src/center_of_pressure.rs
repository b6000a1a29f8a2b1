//! The center of pressure of a mat: mean place of its cells, weighted by force; and its noise.

use nalgebra::Vector3;
use thenar_inference::observe::measured::Mat;

/// Center of pressure of values by cell, mm in the mat's frame; NaN where no cell bears.
pub fn center(values: &[f64], mat: &Mat) -> Vector3<f64> {
    let (mut sum, mut weight) = (Vector3::zeros(), 0.0);
    for (k, value) in values.iter().enumerate().filter(|(_, value)| **value > 0.0) {
        sum += mat.centers[k] * (value * mat.areas[k]);
        weight += value * mat.areas[k];
    }
    sum / weight
}

/// Standard deviation of the center, mm, from the noise `sigma` of the cells that bear.
pub fn noise((measured, sigma): (&[f64], &[f64]), mat: &Mat, center: Vector3<f64>) -> f64 {
    let touching = || (0..measured.len()).filter(|k| measured[*k] > 0.0);
    let total: f64 = touching().map(|k| measured[k] * mat.areas[k]).sum();
    let squares =
        touching().map(|k| ((mat.centers[k] - center) * (sigma[k] * mat.areas[k])).norm_squared());
    squares.sum::<f64>().sqrt() / total
}
