//! A recording beside its simulation: measures, residual against what it may depend on, frames, and the worst places.
//!
//! A mat is compared as its instrument would show it: what lies under its threshold counts as nothing on both sides, and
//! what clips counts as the ceiling on both sides. A map without calibration is compared by shape alone: the simulation is
//! scaled to the sum of the reading.

mod standing;
mod instrument;
mod series;
mod measures;
mod trends;
mod frames;
mod worst;
mod scanned;
mod surface;
mod sentence;
mod still;

use crate::prints::Printed;
use crate::{Censoring, Estimate, Fit, Location, Mat, Moment, Quantity};
use nalgebra::Vector3;
use standing::Standing;

pub use measures::Measure;
pub use scanned::Scanned;
pub use still::{Still, compare_still};
pub use surface::on_skin;
pub use trends::{Bin, Trend, Variable};
pub use worst::WorstPlace;

/// Chance at which a difference is called real.
pub const SIGNIFICANT: f64 = 0.01;

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
    pub looks: usize,
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

/// Compares every recording of a fit with its simulation.
///
/// `sites` without the name of a recording's site leave its worst places without vertices.
pub fn compare_fit(compared: &Compared) -> Comparison {
    let fit = compared.fit;
    let standings = Standing::of(fit);
    let mut all_trends: Vec<Vec<Trend>> = standings.iter().map(trends::of).collect();
    let looks = trends::pay(all_trends.iter_mut().flatten());
    let recordings: Vec<RecordingComparison> = standings
        .iter()
        .zip(all_trends)
        .enumerate()
        .map(|(number, (standing, trends))| recording(compared, (number, standing), trends))
        .collect();
    Comparison {
        title: compared.title.to_string(),
        sentence: sentence::of_study(&recordings, fit, compared.location),
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
    let frames = frames::shown(standing);
    let series = series::series(standing);
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
        measures: measures::table(standing, &series, &frames),
        trends,
        worst: worst::places(compared, standing),
        residual_kpa: surface::worst_frame(compared, standing, &frames),
        series,
        mat: measured.mat.clone(),
        scan: scanned::of(standing),
        print: None,
        frames,
        unknown: measured.unknown.clone(),
    };
    if let Some(Some((print, table))) = compared.prints.get(number) {
        comparison.measures.extend(table.iter().cloned());
        comparison.worst.clone_from(&print.worst);
        comparison.print = Some(print.clone());
    }
    comparison.sentence = sentence::of_recording(&comparison);
    comparison
}

impl Quantity {
    /// Whether two samples measure the same kind of thing.
    pub(crate) fn kind(self) -> Kind {
        match self {
            Quantity::Force => Kind::Force,
            Quantity::TangentialForce => Kind::TangentialForce,
            Quantity::Area => Kind::Area,
            Quantity::Pressure(_) => Kind::Pressure,
            Quantity::Scan(_) => Kind::Scan,
        }
    }
}

/// A kind of quantity.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    /// Normal force, N.
    Force,
    /// Force across it, N.
    TangentialForce,
    /// Contact area, mm2.
    Area,
    /// Mean pressure over a sensel, kPa or counts.
    Pressure,
    /// Height of the scanned surface over the skin at rest, mm.
    Scan,
}

impl Kind {
    const ALL: [Kind; 5] = [
        Kind::Force,
        Kind::TangentialForce,
        Kind::Area,
        Kind::Pressure,
        Kind::Scan,
    ];

    /// Name with its unit.
    pub fn name(self, is_calibrated: bool) -> &'static str {
        match (self, is_calibrated) {
            (Kind::Force, _) => "force_n",
            (Kind::TangentialForce, _) => "tangential_force_n",
            (Kind::Area, _) => "area_mm2",
            (Kind::Pressure, true) => "pressure_kpa",
            (Kind::Pressure, false) => "pressure_counts",
            (Kind::Scan, _) => "height_mm",
        }
    }

    /// Name for people.
    pub fn label(self) -> &'static str {
        match self {
            Kind::Force => "Force",
            Kind::TangentialForce => "Tangential force",
            Kind::Area => "Contact area",
            Kind::Pressure => "Pressure",
            Kind::Scan => "Scanned height over the skin at rest",
        }
    }

    /// Unit for people.
    pub fn unit(self, is_calibrated: bool) -> &'static str {
        match (self, is_calibrated) {
            (Kind::Force | Kind::TangentialForce, _) => "N",
            (Kind::Area, _) => "mm²",
            (Kind::Pressure, true) => "kPa",
            (Kind::Pressure, false) => "counts",
            (Kind::Scan, _) => "mm",
        }
    }
}

/// What is left of a value once the instrument's limits are taken into account: 0 where they hide the difference.
fn residual(measured: f64, simulated: f64, censoring: Censoring) -> f64 {
    match censoring {
        Censoring::AtLeast if simulated >= measured => 0.0,
        Censoring::AtMost if simulated <= measured => 0.0,
        _ => measured - simulated,
    }
}
