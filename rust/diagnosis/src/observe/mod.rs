//! Stage 6a: a study's recordings as moments of a protocol and samples in the recording's own terms.

pub(crate) mod phases;
pub(crate) mod scatter;
mod curve;
mod map;
mod measured;
pub(crate) mod laying;
mod scan;
mod thinning;
mod touch;

pub(crate) use map::interpolated;
pub use measured::{Censoring, Mat, Measured, Moment, Phase, Quantity, Sample, Scan, ScanPoint};

use nalgebra::Vector3;
use thenar_recordings::Study;
use thenar_recordings::study::{Data, StudyRecording};

use crate::replay::tool_at;

/// Moments of an indentation that are compared; one that has not half more keeps them all.
pub const MOST_MOMENTS: usize = 100;
/// The same of frames of a map.
pub const MOST_FRAMES: usize = 40;

/// Extent of a tool that only tells the normals of sensels on it, mm: more than a mat's.
const FAR: f64 = 500.0;

/// A study's recordings, and what the fit must know of them besides.
#[derive(Debug, Clone)]
pub struct Observed {
    /// The recordings, in the study's order.
    pub measured: Vec<Measured>,
    /// By recording: false where the depth of first touch is a guess from the force.
    pub is_touch_known: Vec<bool>,
}

/// Turns every recording of a study into moments and samples; long ones are thinned to means ([`MOST_MOMENTS`], [`MOST_FRAMES`]).
pub fn observe(study: &Study) -> Observed {
    let mut observed = Observed {
        measured: Vec::new(),
        is_touch_known: Vec::new(),
    };
    for recording in &study.recordings {
        let (measured, is_touch_known) = observe_one(study, recording);
        observed.measured.push(measured);
        observed.is_touch_known.push(is_touch_known);
    }
    observed
}

fn observe_one(study: &Study, recording: &StudyRecording) -> (Measured, bool) {
    let mut measured = Measured {
        name: recording.name.clone(),
        protocol: match recording.protocol.as_str() {
            "" => recording.name.clone(),
            named => named.to_owned(),
        },
        indenter: recording.indenter.clone(),
        site: recording.site.clone(),
        moments: Vec::new(),
        samples: Vec::new(),
        mat: None,
        scan: None,
        is_calibrated: true,
        unknown: Vec::new(),
    };
    let site = study.sites.iter().find(|site| site.name == recording.site);
    let direction = site.map_or(-Vector3::z(), |site| site.direction.into());
    match &recording.data {
        Data::Indentation(curve) => {
            let seen = curve::observe(curve, across(direction), MOST_MOMENTS);
            measured.moments = seen.moments;
            measured.samples = seen.samples;
            measured.unknown = seen.unknown;
            if curve.unknown.iter().any(|text| text.contains("of the tip")) {
                measured.unknown.push(format!(
                    "the tool '{}' is the study's assumption and not the recording's: the moduli hold for that tool alone",
                    recording.indenter
                ));
            }
            (measured, seen.is_touch_known)
        }
        Data::PressureMap {
            map,
            sensels,
            motion,
        } => {
            let lacks = sensels
                .iter()
                .flatten()
                .flatten()
                .any(|s| s.normal.is_none());
            let indenter = study
                .indenters
                .iter()
                .find(|i| lacks && i.name == recording.indenter);
            // A tool that cannot be is refused where it presses.
            let tool = indenter
                .zip(site)
                .and_then(|(indenter, site)| tool_at(indenter, site, FAR).ok());
            let seen = map::Seen {
                tool: tool.as_ref(),
                map,
                sensels: sensels.as_deref(),
                motion: motion.as_deref(),
                saturation: study.instrument.as_ref().and_then(|i| i.saturation_kpa),
                threshold: study.instrument.as_ref().and_then(|i| i.threshold_kpa),
                across: across(direction),
                direction,
            };
            let is_touch_known = map::observe(&seen, &mut measured, MOST_FRAMES);
            (measured, is_touch_known)
        }
        Data::Scan {
            mesh,
            at_time_s,
            depth_mm,
            motion,
        } => {
            let seen = scan::Seen {
                points: &mesh.positions,
                when: (*at_time_s, *depth_mm, motion.as_deref()),
                across: across(direction),
                direction,
                site,
                indenter: study
                    .indenters
                    .iter()
                    .find(|i| i.name == recording.indenter),
            };
            scan::observe(&seen, &study.skin.mesh, &mut measured);
            (measured, true)
        }
        Data::Handprint { print, ink_kpa, .. } => {
            // No samples: no fit sees it.
            measured.unknown.extend(print.unknown.iter().cloned());
            measured.unknown.push(
                "no parameter is fitted to it: it is compared with the model that the other recordings give, pressed as hard as the study says"
                    .to_owned(),
            );
            measured.unknown.push(match *ink_kpa > 0.0 {
                true => format!("skin is taken to leave ink where it presses with more than {ink_kpa} kPa"),
                false => "skin is taken to leave ink wherever it touches; give ink_kpa if ink asks for more".to_owned(),
            });
            (measured, true)
        }
    }
}

/// The direction in which a slide counts: the skin's x, laid across the travel; y where x is the travel.
///
/// The study gives a slide's length only, and friction on an even skin does not ask for more.
pub(crate) fn across(direction: Vector3<f64>) -> Vector3<f64> {
    let lay = |axis: Vector3<f64>| axis - direction * direction.dot(&axis);
    let along_x = lay(Vector3::x());
    match along_x.norm() > 0.1 {
        true => along_x.normalize(),
        false => lay(Vector3::y()).normalize(),
    }
}
