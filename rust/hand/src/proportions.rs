//! Published proportions of the hand as fractions of its length and breadth; numbers only.

/// Proportions of one finger, fractions of hand length (HL) and hand breadth (HB).
pub(crate) struct FingerProportions {
    /// Prefix of every name that belongs to the finger.
    pub name: &'static str,
    /// Metacarpal base, x in HB (Buchholz, Armstrong & Goldstein 1992).
    pub base_x: f64,
    /// Metacarpal head (MCP centre): x in HB, y in HL (same source).
    pub head: [f64; 2],
    /// Palmar height of the MCP centre, mm at the reference size: the transverse arch.
    pub arch_mm: f64,
    /// Phalanx lengths in HL, proximal to distal (same source), times `shorter`.
    pub phalanges: [f64; 3],
    /// Buchholz's ring and little finger are longer than the same survey that gives the hand's size allows
    /// (Pheasant & Haslegrave: 72 and 55 of 189 mm): this share brings them within its standard deviation.
    pub shorter: f64,
    /// Full breadth in HB at: proximal phalanx, PIP joint, middle phalanx, DIP joint, distal phalanx.
    /// Phalanges from the section table beside Buchholz's coefficients, PIP from Pheasant's index finger (21 of 87 mm).
    pub breadth: [f64; 5],
    /// Full depth in HB at the same places.
    pub depth: [f64; 5],
    /// Rest angles, degrees: radial splay in the palm plane, roll about the finger, MCP, PIP, DIP flexion.
    pub rest: [f64; 5],
}

/// Index, middle, ring, little.
pub(crate) const FINGERS: [FingerProportions; 4] = [
    FingerProportions {
        name: "index",
        base_x: 0.126,
        head: [0.251, 0.447],
        arch_mm: -3.5,
        phalanges: [0.245, 0.143, 0.097],
        shorter: 1.0,
        breadth: [0.236, 0.238, 0.220, 0.210, 0.202],
        depth: [0.232, 0.2155, 0.192, 0.168, 0.155],
        rest: [7.0, -4.0, 9.0, 12.0, 6.0],
    },
    FingerProportions {
        name: "middle",
        base_x: 0.0,
        head: [0.0, 0.446],
        arch_mm: -5.0,
        phalanges: [0.266, 0.170, 0.108],
        shorter: 1.0,
        breadth: [0.234, 0.237, 0.219, 0.210, 0.204],
        depth: [0.231, 0.219, 0.192, 0.170, 0.159],
        rest: [0.5, 0.0, 12.0, 14.0, 8.0],
    },
    FingerProportions {
        name: "ring",
        base_x: -0.129,
        head: [-0.206, 0.409],
        arch_mm: -3.5,
        phalanges: [0.244, 0.165, 0.107],
        shorter: 0.935,
        breadth: [0.218, 0.220, 0.204, 0.196, 0.190],
        depth: [0.213, 0.199, 0.176, 0.158, 0.148],
        rest: [-6.0, 5.0, 14.0, 16.0, 9.0],
    },
    FingerProportions {
        name: "little",
        base_x: -0.223,
        head: [-0.402, 0.368],
        arch_mm: 0.5,
        phalanges: [0.204, 0.117, 0.093],
        shorter: 0.875,
        breadth: [0.192, 0.193, 0.179, 0.172, 0.166],
        depth: [0.186, 0.173, 0.157, 0.142, 0.132],
        rest: [-14.0, 11.0, 15.0, 18.0, 9.0],
    },
];

/// Length of every finger beyond its bones' published sum, in HL: makes the middle finger end at exactly one hand length.
pub(crate) const TIP: f64 = 1.0 - 0.446 - (0.266 + 0.170 + 0.108);
/// Bones of the metacarpus start here, y in HL (same source as the fingers).
pub(crate) const METACARPAL_BASE_Y: f64 = 0.073;
/// Thumb metacarpal, proximal and distal phalanx in HL: the same source's .251, .196, .158, each shortened to fit Pheasant's thumb (51 of 189 mm).
pub(crate) const THUMB_LENGTHS: [f64; 3] = [0.243, 0.177, 0.140];
/// Thumb CMC centre, x in HB (same source).
pub(crate) const THUMB_BASE_X: f64 = 0.196;
/// Hand length and breadth at which the millimetres of the palm were shaped by eye.
pub(crate) const REFERENCE: (f64, f64) = (190.0, 85.0);
