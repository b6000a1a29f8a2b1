//! What a comparison is given and what it returns: measures, residuals, frames and worst places of every recording.

use nalgebra::Vector3;

use crate::comparison::quantities::{Measure, WorstPlace};
use crate::comparison::scan_heights::Scanned;
use crate::comparison::trends::Trend;
use crate::location::mismatch::Location;
use crate::prints::printed::Printed;
use thenar_inference::fit::result::Fit;
use thenar_inference::observe::measured::{Mat, Moment};
use thenar_inference::parameters::estimate::Estimate;

/// What is compared: a fit, and the places that its recordings name.
#[derive(Debug, Clone, Copy)]
pub struct Compared<'a> {
    /// Title of the study.
    pub title: &'a str,
    /// Vertices of the skin before contact, mm.
    pub skin: &'a [Vector3<f64>],
    /// Name and point of first touch of every site, mm.
    pub sites: &'a [(String, Vector3<f64>)],
    /// The fit.
    pub fit: &'a Fit,
    /// What was located in it, if that was done.
    pub location: Option<&'a Location>,
    /// By recording, what a handprint shows and its measures; empty: there is none.
    pub prints: &'a [Option<(Printed, Vec<Measure>)>],
}

/// What separates simulation and recordings.
#[derive(Debug, Clone)]
pub struct Comparison {
    /// Title of the study.
    pub title: String,
    /// What a designer reads first.
    pub sentence: String,
    /// Recordings in the study's order.
    pub recordings: Vec<RecordingComparison>,
    /// Fitted numbers.
    pub estimates: Vec<Estimate>,
    /// Probability that noise alone leaves as much as is left; None where no repeats tell the noise.
    pub lack_of_fit_p: Option<f64>,
    /// Ranges of values that were tested; every probability is multiplied by this.
    pub look_elsewhere_count: usize,
    /// Where and when the mismatch lies that parameters cannot absorb; None if it was not looked for.
    pub location: Option<Location>,
    /// What a reader should be told, a sentence each.
    pub notes: Vec<String>,
}

/// One recording beside its simulation.
#[derive(Debug, Clone)]
pub struct RecordingComparison {
    /// Name in the study.
    pub name: String,
    /// Name that its repeats share.
    pub protocol: String,
    /// Name of the tool.
    pub indenter: String,
    /// Name of the place.
    pub site: String,
    /// What a designer reads first.
    pub sentence: String,
    /// False if only shape and relative size could be compared.
    pub is_calibrated: bool,
    /// True if the noise has a number, be it only the recording's own roughness.
    pub has_noise: bool,
    /// True if repeats, or the user, tell the noise.
    pub is_noise_told: bool,
    /// Instants.
    pub moments: Vec<Moment>,
    /// Quantities of which the recording has one value per moment.
    pub series: Vec<Series>,
    /// The mat, if the recording is of one.
    pub mat: Option<Mat>,
    /// Frames of the mat that are shown.
    pub frames: Vec<Frame>,
    /// Heights of a scan, place by place.
    pub scan: Option<Scanned>,
    /// Contact of a handprint, cell by cell of `mat`.
    pub print: Option<Printed>,
    /// Table of measures.
    pub measures: Vec<Measure>,
    /// Residual against what it may depend on.
    pub trends: Vec<Trend>,
    /// Where and when the residual is largest, the worst first; of a handprint the patches where only ink or only the simulation touches.
    pub worst: Vec<WorstPlace>,
    /// Residual per skin vertex in the worst frame, kPa; NaN away from the mat. Empty without a mat or calibration.
    pub residual_kpa: Vec<f64>,
    /// What cannot be known, a sentence each.
    pub unknown: Vec<String>,
}

/// A quantity over the moments of a recording; lists are aligned.
#[derive(Debug, Clone, Default)]
pub struct Series {
    /// Name with its unit, `force_n`.
    pub name: &'static str,
    /// Name for people, `Force`.
    pub label: &'static str,
    /// Unit.
    pub unit: &'static str,
    /// Number of the moment of each value.
    pub moments: Vec<u32>,
    /// As read.
    pub measured: Vec<f64>,
    /// At the estimates.
    pub simulated: Vec<f64>,
    /// With the parameters at which the fit began.
    pub before: Vec<f64>,
    /// Standard deviation of the noise; NaN where it is not known.
    pub sigma: Vec<f64>,
}

/// One frame of a mat; lists have a value per sensel, NaN where the cell is missing.
#[derive(Debug, Clone)]
pub struct Frame {
    /// Number of the moment.
    pub moment: u32,
    /// Why it is shown: `mean force`, `largest force`, `largest residual`.
    pub why: Vec<&'static str>,
    /// kPa, or counts.
    pub measured: Vec<f64>,
    /// At the estimates, in the same unit.
    pub simulated: Vec<f64>,
    /// With the parameters at which the fit began, in the same unit.
    pub before: Vec<f64>,
    /// Measured minus simulated, 0 where the instrument's limits hide the difference.
    pub residual: Vec<f64>,
    /// The residual in standard deviations of the noise; NaN where it is not known.
    pub sigmas: Vec<f64>,
    /// Readings of this much and more count as contact.
    pub contact_from: f64,
}
