//! Pose parameters of mats and scans.

use thenar_recordings::study::Instrument;

use crate::observe::measured::{Measured, Quantity};
use crate::observe::scan_registration::moved;
use crate::parameters::parameter::{Kind, Parameter};
use crate::parameters::priors::{MOST_POSITION, POSITION, TURN};

/// Numbers of a recording's mat, two shifts and a turn, or of its scan, three of each.
pub fn poses(recording: usize, measured: &Measured, sheet: Option<&Instrument>) -> Vec<Parameter> {
    let sd = sheet.and_then(|s| s.position_mm).unwrap_or(POSITION);
    let mat = |axis: usize| {
        let (sd, step) = if axis < 2 { (sd, 0.05) } else { (TURN, 0.01) };
        Parameter::about(Kind::Pose(recording, axis), (sd, MOST_POSITION), step)
    };
    let scan = |axis: usize| {
        let (sd, step) = if axis < 3 { (sd, 0.01) } else { (TURN, 1e-3) };
        Parameter::about(Kind::Scan(recording, axis), (sd, MOST_POSITION), step)
    };
    match (&measured.mat, &measured.scan) {
        (Some(_), _) => (0..3).map(mat).collect(),
        (None, Some(_)) => (0..6).map(scan).collect(),
        (None, None) => Vec::new(),
    }
}

/// Tells heights of scans as they are with the scan in its fitted place, measured and simulated alike; residuals stay.
pub fn settle(
    measured: &mut [Measured],
    told: [&mut Vec<Vec<f64>>; 2],
    (parameters, at): (&[Parameter], &[f64]),
) {
    let [simulated, before] = told;
    for (recording, one) in measured.iter_mut().enumerate() {
        let Some(scan) = &one.scan else { continue };
        let mut pose = [0.0; 6];
        for (parameter, at) in parameters.iter().zip(at) {
            match parameter.kind {
                Kind::Scan(r, axis) if r == recording => pose[axis] = *at,
                _ => {}
            }
        }
        let mut lifts = vec![(0.0, 0.0); scan.places.len()];
        for point in &scan.points {
            let by = moved(point.position, &pose, scan.center) - point.position;
            let lift: &mut (f64, f64) = &mut lifts[point.place as usize];
            *lift = (
                lift.0 + by.dot(&scan.normals[point.place as usize]),
                lift.1 + 1.0,
            );
        }
        for (k, sample) in one.samples.iter_mut().enumerate() {
            if let Quantity::Scan(place) = sample.quantity {
                let (sum, count) = lifts[place as usize];
                sample.value += sum / count;
                simulated[recording][k] += sum / count;
                before[recording][k] += sum / count;
            }
        }
    }
}
