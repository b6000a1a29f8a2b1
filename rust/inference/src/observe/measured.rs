//! An observed recording: moments of a protocol, and samples with what each of them measures.

use nalgebra::Vector3;

/// What a sample measures, and in which unit its value stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Quantity {
    /// Normal force along the site's direction, N.
    Force,
    /// Force across it, N.
    TangentialForce,
    /// Contact area, mm2; on a mat, the area of the sensels above its threshold.
    Area,
    /// Mean pressure over the sensel of this number, kPa.
    Pressure(u32),
    /// Height of the scanned surface over the skin at rest around the [`Scan`]'s place of this number, mm. Measured minus simulated is
    /// the distance of the scan from the simulated skin, > 0 outside.
    Scan(u32),
}

/// What an instrument's limits left of a value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Censoring {
    /// It is the value.
    Seen,
    /// The true value is this or more: the sensel clips.
    AtLeast,
    /// The true value is this or less: it lies under the instrument's threshold.
    AtMost,
}

/// One measured number. Missing cells are no samples.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// Number of its moment in the recording.
    pub moment: u32,
    /// What it measures.
    pub quantity: Quantity,
    /// In the quantity's unit; in counts on a mat that is not calibrated.
    pub value: f64,
    /// What the instrument's limits left of it.
    pub censoring: Censoring,
}

/// Part of a protocol.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Phase {
    /// The tool does not touch.
    Apart,
    /// It moves into the skin.
    Load,
    /// It stands still.
    Hold,
    /// It moves out.
    Unload,
    /// It moves along the skin.
    Slide,
}

impl Phase {
    /// Name in files and for people.
    pub fn name(self) -> &'static str {
        match self {
            Phase::Apart => "apart",
            Phase::Load => "load",
            Phase::Hold => "hold",
            Phase::Unload => "unload",
            Phase::Slide => "slide",
        }
    }
}

/// One instant of a recording, and where its protocol stands.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Moment {
    /// s, growing.
    pub time_s: f64,
    /// Travel beyond first touch along the site's direction, mm, as the operator judged the touch; NaN where only force is known.
    pub depth_mm: f64,
    /// Force that the protocol asks for where it gives no depth, N, of a mat in counts at one count per kPa; else NaN.
    pub demand_n: f64,
    /// Travel along the skin, mm.
    pub slide_mm: Vector3<f64>,
    /// Speed of `depth_mm`, mm/s.
    pub rate_mm_s: f64,
    /// Part of the protocol.
    pub phase: Phase,
    /// Loadings before this one in the recording.
    pub cycle: u32,
    /// Readings of which its samples are the means.
    pub readings: u32,
    /// Standard deviation of the depth over these readings, as of a straight motion, and over those of which each of their forces is a mean, mm.
    pub depth_spread_mm: f64,
    /// Step to which the force is rounded, N, where it is more than digits of a file and all readings of this instant are the same; else 0.
    pub force_step_n: f64,
}

/// Sensels of a placed mat, in skin coordinates at first touch.
#[derive(Debug, Clone, PartialEq)]
pub struct Mat {
    /// Centers, mm.
    pub centers: Vec<Vector3<f64>>,
    /// Unit normals out of the product.
    pub normals: Vec<Vector3<f64>>,
    /// Areas, mm2.
    pub areas: Vec<f64>,
    /// Row and column of each sensel, where the file numbers them.
    pub places: Vec<Option<[u32; 2]>>,
}

/// A scanned point that counts: on the skin, and away from the tool.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ScanPoint {
    /// Where it was seen, mm, skin coordinates, after the first laying.
    pub position: Vector3<f64>,
    /// Number of its place.
    pub place: u32,
    /// Triangle of the skin next to it.
    pub triangle: u32,
}

/// A scan, summed up around places of the skin that all scans of a site share.
#[derive(Debug, Clone, PartialEq)]
pub struct Scan {
    /// The places, mm: vertices of the skin at rest.
    pub places: Vec<Vector3<f64>>,
    /// Their vertices.
    pub vertices: Vec<u32>,
    /// Skin normals there.
    pub normals: Vec<Vector3<f64>>,
    /// Distance from a place to the next, mm.
    pub spacing: f64,
    /// What was seen around them.
    pub points: Vec<ScanPoint>,
    /// About which the scan turns, mm: the mean of the points as the file has them.
    pub center: Vector3<f64>,
    /// How it was first laid on the skin: shift (mm), and turn about the center as a rotation vector (rad).
    pub laid: [f64; 6],
    /// Standard deviation of a place's mean height as its points scatter, mm.
    pub scatter_mm: f64,
}

/// A recording as the comparison sees it.
#[derive(Debug, Clone, PartialEq)]
pub struct Measured {
    /// Name in the study.
    pub name: String,
    /// Protocol that its repeats share; its own name where the study gives none.
    pub protocol: String,
    /// Name of the tool.
    pub indenter: String,
    /// Name of the place.
    pub site: String,
    /// Instants, in their order.
    pub moments: Vec<Moment>,
    /// Numbers, ordered by moment and then by quantity.
    pub samples: Vec<Sample>,
    /// The mat whose sensels the samples number, if the recording is of one and placed.
    pub mat: Option<Mat>,
    /// The scan, if the recording is one.
    pub scan: Option<Scan>,
    /// False if values are counts: then only shape and relative size count.
    pub is_calibrated: bool,
    /// Standard deviation of what depths are still off by where rounded readings were taken as the lines of a motion, mm; 0 of others.
    pub depth_error_mm: f64,
    /// Whether forces are rounded to steps that are larger than their noise.
    pub is_coarse: bool,
    /// What cannot be known from this recording, a sentence each.
    pub unknown: Vec<String>,
}

impl Measured {
    /// Half of the step to which a force is rounded, N, where it is larger than the noise; 0 of other samples.
    pub(crate) fn half_step_n(&self, sample: &Sample) -> f64 {
        match self.is_coarse && sample.quantity == Quantity::Force {
            true => 0.5 * self.moments[sample.moment as usize].force_step_n,
            false => 0.0,
        }
    }

    /// True if some moment has no depth: it is simulated at the force that it asks for.
    pub(crate) fn asks_force(&self) -> bool {
        self.moments.iter().any(|moment| moment.depth_mm.is_nan())
    }
}
