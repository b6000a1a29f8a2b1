//! Result of the location: mismatches with place, time, size and significance.

use nalgebra::Vector3;

use thenar_inference::observe::measured::Phase;

/// What of a recording differs, in which unit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shown {
    /// Normal force, N.
    Force,
    /// Force along the skin, N.
    TangentialForce,
    /// Contact area, mm2.
    Area,
    /// Height of scanned points, mm.
    Scan,
    /// Pressure on a calibrated mat, kPa.
    Pressure,
    /// Reading of a mat that is not calibrated, counts.
    Counts,
}

impl Shown {
    /// Unit of its size.
    pub fn unit(self) -> &'static str {
        match self {
            Shown::Force | Shown::TangentialForce => "N",
            Shown::Area => "mm2",
            Shown::Scan => "mm",
            Shown::Pressure => "kPa",
            Shown::Counts => "counts",
        }
    }

    /// What it is called in a sentence.
    pub fn words(self) -> &'static str {
        match self {
            Shown::Force => "force",
            Shown::TangentialForce => "force along the skin",
            Shown::Area => "contact area",
            Shown::Scan => "scanned height",
            Shown::Pressure => "pressure",
            Shown::Counts => "reading",
        }
    }
}

/// What a local mismatch stays with when the mat is shifted or turned.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Carrier {
    /// It stays with the skin.
    Skin,
    /// It stays with the sensels.
    Sensor,
    /// The recordings cannot tell: they show one pose, or too little.
    CannotTell,
}

/// A place on the sensor and on the skin. Of several poses it is told in that of the recording named first.
#[derive(Debug, Clone, PartialEq)]
pub struct Place {
    /// Center on the sensor, in skin coordinates at first touch, mm.
    pub center_mm: Vector3<f64>,
    /// Row and column of the sensel next to the center, where the file numbers them.
    pub row_column: Option<[u32; 2]>,
    /// Point of the undeformed skin next to the center, mm; None if no skin was given.
    pub on_skin_mm: Option<Vector3<f64>>,
    /// Vertices of the skin within the radius of that point; the nearest one if there is none.
    pub vertices: Vec<u32>,
    /// Radius, mm: not the extent of what causes it, but of the disc that shows most.
    pub radius_mm: f64,
    /// Two places nearer to each other than this cannot be told apart, mm.
    pub resolution_mm: f64,
    /// Sensels that hold the center with a probability of 90 %, by number on the mat: the most probable middles of a disc, and what
    /// lies within the resolution of the center.
    pub sensels_90: Vec<u32>,
    /// Their area, mm2.
    pub area_90_mm2: f64,
    /// Skin or sensor.
    pub carrier: Carrier,
}

/// When it shows.
#[derive(Debug, Clone, PartialEq)]
pub struct When {
    /// Recordings, by name.
    pub recordings: Vec<String>,
    /// Phases of the protocol, each once.
    pub phases: Vec<Phase>,
    /// First and last time, s; None over several recordings.
    pub time_s: Option<[f64; 2]>,
    /// Smallest and largest depth, mm; None if unknown.
    pub depth_mm: Option<[f64; 2]>,
    /// First and last cycle, counted from 0.
    pub cycles: [u32; 2],
    /// Slowest and fastest, mm/s; None where the tool stands or no depth is known.
    pub rate_mm_s: Option<[f64; 2]>,
}

/// A mismatch that parameters cannot absorb and noise does not explain.
#[derive(Debug, Clone, PartialEq)]
pub struct Mismatch {
    /// What differs.
    pub shown: Shown,
    /// Where; None if it shows everywhere that is recorded, or the recording has no places.
    pub place: Option<Place>,
    /// When.
    pub when: When,
    /// Measured minus simulated, mean over place and time, in the unit of what is shown; of maps with what parameters absorb taken out.
    pub size: f64,
    /// Lower end of the 90 % interval; that the largest was picked makes sizes near the threshold too large.
    pub low: f64,
    /// Upper end of it.
    pub high: f64,
    /// Size over its standard deviation.
    pub score: f64,
    /// Probability that noise alone shows as much anywhere that was looked at.
    pub p: f64,
    /// Share of its signature that parameters cannot imitate, 0 to 1.
    pub kept: f64,
    /// All of it in a sentence.
    pub sentence: String,
}

/// What was found, the strongest first.
#[derive(Debug, Clone, PartialEq)]
pub struct Location {
    /// Mismatches, no two of which share a sample; empty if none stands out.
    pub mismatches: Vec<Mismatch>,
    /// Probability that noise alone shows as much as the strongest look; None if there was nothing to look at.
    pub p: Option<f64>,
    /// Places and times that were looked at.
    pub look_elsewhere_count: usize,
    /// The answer in a sentence.
    pub sentence: String,
    /// What a reader should be told besides, a sentence each.
    pub notes: Vec<String>,
}
