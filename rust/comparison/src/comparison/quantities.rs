//! Kinds of measured quantity, measures of them, and places of large residuals: the rows of a comparison's tables.

use thenar_inference::observe::measured::{Censoring, Phase, Quantity};

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
    /// The kind of thing that a sample measures.
    pub(crate) fn of(quantity: Quantity) -> Kind {
        match quantity {
            Quantity::Force => Kind::Force,
            Quantity::TangentialForce => Kind::TangentialForce,
            Quantity::Area => Kind::Area,
            Quantity::Pressure(_) => Kind::Pressure,
            Quantity::Scan(_) => Kind::Scan,
        }
    }

    pub(crate) const ALL: [Kind; 5] = [
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
pub(crate) fn residual(measured: f64, simulated: f64, censoring: Censoring) -> f64 {
    match censoring {
        Censoring::AtLeast if simulated >= measured => 0.0,
        Censoring::AtMost if simulated <= measured => 0.0,
        _ => measured - simulated,
    }
}

/// One measure, in its unit; NaN where it has no value.
#[derive(Debug, Clone, PartialEq)]
pub struct Measure {
    /// Name with its unit, `peak_kpa`.
    pub name: &'static str,
    /// Name for people.
    pub label: &'static str,
    /// Unit for people, empty for a share.
    pub unit: &'static str,
    /// `whole recording`, or which frame.
    pub of: &'static str,
    /// As read; NaN for what compares reading and simulation, such as overlap.
    pub measured: f64,
    /// Simulated with the parameters at which the fit began.
    pub before: f64,
    /// Simulated at the estimates.
    pub after: f64,
    /// Standard deviation that the noise gives the measured value, if that of every sample is independent; NaN if not known.
    pub noise: f64,
}

/// One place and moment.
#[derive(Debug, Clone, PartialEq)]
pub struct WorstPlace {
    /// What was measured.
    pub kind: Kind,
    /// Number of the moment.
    pub moment: u32,
    /// s.
    pub time_s: f64,
    /// mm; NaN where only force is known.
    pub depth_mm: f64,
    /// Part of the protocol.
    pub phase: Phase,
    /// Number of the sensel, for pressures.
    pub sensel: Option<u32>,
    /// Row and column of the sensel, where the file numbers them.
    pub place: Option<[u32; 2]>,
    /// Where, mm, skin coordinates: the sensel at first touch, or the site; None where it is not known.
    pub position_mm: Option<[f64; 3]>,
    /// Vertices of the skin there, the nearest first.
    pub vertices: Vec<u32>,
    /// As read.
    pub measured: f64,
    /// At the estimates.
    pub simulated: f64,
    /// Measured minus simulated.
    pub residual: f64,
    /// The residual in standard deviations of the noise; NaN where it is not known.
    pub sigmas: f64,
}
