//! Pose parameters of mats and scans.

use thenar_recordings::study::Instrument;

use crate::observe::measured::{Measured, Quantity};
use crate::observe::scan_registration::moved;
use crate::parameters::parameter::{Kind, Parameter};
use crate::parameters::target::Target;

/// Standard deviation of where a mat lies, mm, where the data sheet does not say; of where a scan lies that was laid on the skin.
const POSITION: f64 = 1.0;
/// Standard deviation of how a mat is turned, rad: 2 degrees, as mats that are taped on by hand; of a scan that was laid on the skin.
const TURN: f64 = 0.035;
/// A mat or scan may lie this many standard deviations off.
pub(crate) const MOST_POSITION: f64 = 4.0;

/// Numbers of a recording's mat, two shifts and a turn, or of its scan, three of each.
pub fn poses(recording: usize, measured: &Measured, sheet: Option<&Instrument>) -> Vec<Parameter> {
    let sd = sheet.and_then(|s| s.position_mm).unwrap_or(POSITION);
    let one = |(kind, name, sd, step): (Kind, &'static str, f64, f64)| Parameter {
        kind,
        name,
        target: Target::Recording(measured.name.clone()),
        start: 0.0,
        bounds: (-MOST_POSITION * sd, MOST_POSITION * sd),
        prior: Some(sd),
        step,
    };
    let mat = |axis: usize| Kind::Pose(recording, axis);
    let scan = |axis: usize| Kind::Scan(recording, axis);
    let of_mat = [
        (mat(0), "pose_x_mm", sd, 0.05),
        (mat(1), "pose_y_mm", sd, 0.05),
        (mat(2), "pose_turn_rad", TURN, 0.01),
    ];
    let of_scan = [
        (scan(0), "scan_x_mm", sd, 0.01),
        (scan(1), "scan_y_mm", sd, 0.01),
        (scan(2), "scan_z_mm", sd, 0.01),
        (scan(3), "scan_turn_x_rad", TURN, 1e-3),
        (scan(4), "scan_turn_y_rad", TURN, 1e-3),
        (scan(5), "scan_turn_z_rad", TURN, 1e-3),
    ];
    match (&measured.mat, &measured.scan) {
        (Some(_), _) => of_mat.map(one).to_vec(),
        (None, Some(_)) => of_scan.map(one).to_vec(),
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
