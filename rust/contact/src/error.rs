//! Errors of the input, one variant a cause, each with place and remedy.

use thenar_surface::MeshError;

/// Bad input or a stopped run. How a solve ended is data ([`crate::Convergence`]), not an error.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ContactError {
    /// The hand mesh, or its posed positions, cannot be used.
    #[error("hand mesh: {0}")]
    Hand(MeshError),
    /// The product mesh cannot be used.
    #[error("product mesh: {0}")]
    Product(MeshError),
    /// A material number is outside what is admissible.
    #[error("material {material}: {name} is {found}, but must be {expected}")]
    Material {
        material: String,
        name: &'static str,
        found: f64,
        expected: &'static str,
    },
    /// There are regions without a material.
    #[error(
        "{title} has no material: {materials} materials were given; give one per region, numbered from 0"
    )]
    MissingMaterial {
        region: i32,
        title: String,
        materials: usize,
    },
    /// One region number per vertex is needed.
    #[error(
        "regions has {found} entries for {expected} vertices; give one per vertex, -1 for no skin"
    )]
    RegionCount { found: usize, expected: usize },
    /// Vertices are too far apart for the tissue to be resolved.
    #[error(
        "{title}: around vertex {vertex} the vertices are {spacing_mm:.1} mm apart, but the soft tissue is only \
         {thickness_mm:.2} mm thick; subdivide the hand there or give it thicker tissue"
    )]
    TooCoarse {
        region: i32,
        title: String,
        vertex: usize,
        spacing_mm: f64,
        thickness_mm: f64,
    },
    /// The zone that may touch needs more memory than a press may take.
    #[error(
        "{vertices} vertices of the hand may touch the product, and their response needs {needed_gib:.1} GiB, more than the \
         {limit_gib:.0} GiB allowed; press less of the skin at once, or decimate the hand where it is finer than 0.1 mm"
    )]
    TooLarge {
        vertices: usize,
        needed_gib: f64,
        limit_gib: f64,
    },
    /// No vertex may carry contact.
    #[error(
        "no vertex belongs to a region: every region number is negative; number skin regions from 0"
    )]
    NoSkin,
    /// Posed positions do not match the prepared mesh.
    #[error(
        "the posed hand has {found} vertices but was prepared with {expected}; prepare the skin again"
    )]
    PosedCount { found: usize, expected: usize },
    /// A posed position is NaN or infinite.
    #[error(
        "the posed hand has a coordinate at vertex {vertex} that is not finite; check its modifiers"
    )]
    PosedNotFinite { vertex: usize },
    /// The skin lies so deep in the product that no contact model applies.
    #[error(
        "the skin lies up to {depth_mm:.1} mm inside the product (vertex {vertex}), more than the {limit_mm:.1} mm \
         that soft tissue can yield; move the product out of the hand, or check that both have the same units"
    )]
    Swallowed {
        vertex: usize,
        depth_mm: f64,
        limit_mm: f64,
    },
    /// The contact did not reach its tolerances, and no result is given.
    #[error(
        "the contact was not solved: {title}{} is left {left_mm:.2} mm off the product's surface after {passes} passes; open the \
         hand a little there, move the product, or refine the hand's mesh there", at(.vertices)
    )]
    Unsolved {
        title: String,
        left_mm: f64,
        passes: usize,
        /// Of the hand as given, where it does not fit, the worst first.
        vertices: Vec<usize>,
    },
    /// A force target is negative, zero or not finite.
    #[error("the force target is {newton} N, but must be positive and finite")]
    ForceTarget { newton: f64 },
    /// A direction has no length.
    #[error("the direction of the force is zero or not finite; give a vector such as (0, 0, -1)")]
    Direction,
    /// The product cannot be brought to the hand.
    #[error(
        "no skin comes within {cut_off_mm:.0} mm of the product, so there is no direction to press in; \
         move the product closer or give a direction"
    )]
    OutOfReach { cut_off_mm: f64 },
    /// The force target needs more travel than is credible.
    #[error(
        "{target_n:.3} N is not reached within {travel_mm:.1} mm of travel (largest force {reached_n:.3} N); \
         lower the force, or change the direction or the posture"
    )]
    ForceOutOfReach {
        target_n: f64,
        reached_n: f64,
        travel_mm: f64,
    },
    /// A number of a soft grip is not admissible.
    #[error("elastomer {index} of the grip: {name} is {found}, but must be {expected}")]
    Elastomer {
        index: usize,
        name: &'static str,
        found: f64,
        expected: &'static str,
    },
    /// A grip names an elastomer that is not there.
    #[error(
        "the grip names elastomer {elastomer} at vertex {vertex} of the product, but there are {count}, numbered from 0; \
         -1 is rigid"
    )]
    UnknownElastomer {
        vertex: usize,
        elastomer: i32,
        count: usize,
    },
    /// One elastomer number per vertex of the product is needed.
    #[error(
        "the grip has {found} entries for {expected} vertices of the product; give one per vertex, -1 where it is rigid"
    )]
    GripCount { found: usize, expected: usize },
    /// The paper's model has no soft grips.
    #[error("a soft grip needs the model layer; the paper's model presses rigid products only")]
    GripModel,
    /// Skin and grip did not settle on one pressure.
    #[error(
        "the soft grip was not solved: after {presses} presses skin and grip still differ by {left_mm:.3} mm; press \
         less deep, or give the grip a larger thickness or modulus"
    )]
    GripUnsolved { left_mm: f64, presses: usize },
    /// A dense problem's arrays do not fit together.
    #[error(
        "the matrix has {found} entries but the gap has {gaps}; it must have {gaps} times {gaps}"
    )]
    DenseShape { found: usize, gaps: usize },
    /// A dense problem is not one that a compliance can pose.
    #[error(
        "the matrix entry ({row}, {column}) is {found}; a compliance is finite, symmetric and positive on its diagonal"
    )]
    DenseEntry {
        row: usize,
        column: usize,
        found: f64,
    },
    /// An effect's number, form, region or painting is not admissible.
    #[error("effect {effect}: {problem}")]
    Effect {
        effect: &'static str,
        problem: String,
    },
    /// There is no effect of that name.
    #[error("there is no effect {name:?}; there are {known}")]
    UnknownEffect { name: String, known: String },
    /// A mat's sensels cannot be used.
    #[error("mat: {problem}")]
    Mat { problem: String },
    /// The channels of a recording do not fit together.
    #[error("signals: {problem}")]
    Signals { problem: String },
    /// A row of a protocol cannot be followed.
    #[error("protocol, row {row}: {problem}")]
    Protocol { row: usize, problem: String },
    /// A protocol has no rows.
    #[error("the protocol has no rows; give at least one time with a depth, an offset or a force")]
    EmptyProtocol,
    /// A drag is not finite, or a force to drag with is zero.
    #[error(
        "the product's travel, turn and force along the skin must be finite, and the force not zero"
    )]
    Drag,
    /// A limit of friction is negative or not finite.
    #[error("the limit of site {site} is {found} N; a limit of friction is finite and 0 or more")]
    SlipLimit { site: usize, found: f64 },
    /// The caller asked to stop.
    #[error("cancelled")]
    Cancelled,
}

impl ContactError {
    /// The vertices of the hand that it is about, the worst first; empty where it is about none.
    pub fn vertices(&self) -> &[usize] {
        match self {
            ContactError::Unsolved { vertices, .. } => vertices,
            ContactError::TooCoarse { vertex, .. }
            | ContactError::Swallowed { vertex, .. }
            | ContactError::PosedNotFinite { vertex } => std::slice::from_ref(vertex),
            _ => &[],
        }
    }
}

/// Where skin does not fit, in words.
fn at(vertices: &[usize]) -> String {
    vertices
        .first()
        .map_or_else(String::new, |vertex| format!(", at vertex {vertex},"))
}
