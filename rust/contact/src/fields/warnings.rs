//! Warnings of a result: their numbers, wording and grade.

use std::fmt;

/// How far a result may be used.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default)]
pub enum Grade {
    /// Within the model's range, and all its tolerances met.
    #[default]
    Good,
    /// Solved, but something limits what it says.
    ReadThis,
    /// Its numbers mean nothing.
    DoNotUse,
}

impl Grade {
    /// The name that leaves the library.
    pub fn name(self) -> &'static str {
        match self {
            Grade::Good => "good",
            Grade::ReadThis => "read this",
            Grade::DoNotUse => "do not use",
        }
    }
}

/// Yield of a soft grip over its thickness beyond which a linear material answers for nothing.
const MOST_GRIP_STRAIN: f64 = 0.5;

/// One remark on a result; lengths in mm, forces in N, pressures in MPa. Its text is its `Display`.
#[derive(Debug, Clone, PartialEq)]
pub enum Warning {
    /// Of the meshes or the preparation, as said there.
    Note(String),
    /// The hand has no hand's size.
    HandSize { extent: f64 },
    /// A region's modulus has reached its limit.
    BeyondStiffening {
        region: usize,
        title: String,
        depth: f64,
        limit: f64,
    },
    /// A region is pressed over half its thickness.
    BeyondTheory {
        region: usize,
        title: String,
        depth: f64,
        thickness: f64,
    },
    /// A region is pressed deeper than it is thick.
    BeyondTissue {
        region: usize,
        title: String,
        depth: f64,
        thickness: f64,
    },
    /// Vertices without skin lie in the product.
    Bare { depth: f64, vertex: usize },
    /// Hand and product do not touch, and the product lies within the hand.
    ProductInside,
    /// Hand and product do not touch.
    NoContact,
    /// Triangles of the product are long where it is touched.
    CoarseProduct { longest: f64, spacing: f64 },
    /// Few vertices bear the contact.
    FewVertices { vertices: usize, spacing: f64 },
    /// The product lies under the skin between its vertices; `touches` tells whether any vertex bears force.
    ProductBetweenVertices {
        vertex: usize,
        depth: f64,
        spacing: f64,
        touches: bool,
    },
    /// The pressure over a sensel is beyond what skin bears: an edge does that.
    Edge { patch_peak: f64 },
    /// The peak stands on a vertex whose skin is folded together.
    Crease { vertex: usize, share: f64 },
    /// The forces on a product that is held from several sides leave a sum.
    OffBalance { net: f64, sum: f64 },
    /// Attraction and contact did not settle.
    AdhesionUnsettled,
    /// The contact did not reach its tolerances.
    Unsolved {
        penetration: f64,
        passes: usize,
        spacing: f64,
    },
    /// Rows of a protocol did not reach their tolerances.
    UnsolvedRows { unsolved: usize, rows: usize },
    /// The written skin lies in the product.
    Penetration { depth: f64 },
    /// Skin moved farther than it overlapped.
    Runaway {
        vertex: usize,
        moved: f64,
        overlap: f64,
    },
    /// A soft grip is pressed beyond what its linear law answers for; yield over thickness.
    GripStrain { strain: f64 },
    /// A soft grip is thicker than half the product, at this vertex of the product.
    GripWithoutCore { vertex: usize },
    /// Skin and soft grip settled roughly, mm.
    GripRough { left: f64 },
    /// Skin and soft grip did not settle on one pressure, mm.
    GripUnsolved { left: f64 },
    /// The force leaps over what was asked for.
    ForceLeaps { asked: f64, reached: f64 },
}

impl Warning {
    /// How far a result with this remark may be used.
    pub fn grade(&self) -> Grade {
        match self {
            Warning::Note(_) | Warning::BeyondStiffening { .. } | Warning::Bare { .. } => {
                Grade::Good
            }
            Warning::HandSize { .. }
            | Warning::BeyondTheory { .. }
            | Warning::CoarseProduct { .. }
            | Warning::FewVertices { .. }
            | Warning::ProductBetweenVertices { touches: true, .. }
            | Warning::Edge { .. }
            | Warning::Crease { .. }
            | Warning::OffBalance { .. }
            | Warning::AdhesionUnsettled
            | Warning::GripRough { .. }
            | Warning::GripWithoutCore { .. }
            | Warning::ForceLeaps { .. } => Grade::ReadThis,
            Warning::GripStrain { strain } if *strain <= MOST_GRIP_STRAIN => Grade::ReadThis,
            Warning::GripStrain { .. }
            | Warning::ProductInside
            | Warning::NoContact
            | Warning::BeyondTissue { .. }
            | Warning::ProductBetweenVertices { touches: false, .. }
            | Warning::Unsolved { .. }
            | Warning::GripUnsolved { .. }
            | Warning::UnsolvedRows { .. }
            | Warning::Penetration { .. }
            | Warning::Runaway { .. } => Grade::DoNotUse,
        }
    }

    /// The kind's name, as it leaves the library.
    pub fn kind(&self) -> &'static str {
        match self {
            Warning::Note(_) => "note",
            Warning::HandSize { .. } => "hand_size",
            Warning::BeyondStiffening { .. } => "beyond_stiffening",
            Warning::BeyondTheory { .. } => "beyond_theory",
            Warning::BeyondTissue { .. } => "beyond_tissue",
            Warning::Bare { .. } => "bare_parts_inside",
            Warning::ProductInside => "product_inside_hand",
            Warning::NoContact => "no_contact",
            Warning::CoarseProduct { .. } => "coarse_product",
            Warning::FewVertices { .. } => "few_vertices",
            Warning::ProductBetweenVertices { .. } => "product_between_vertices",
            Warning::Edge { .. } => "sharp_edge",
            Warning::Crease { .. } => "peak_in_crease",
            Warning::OffBalance { .. } => "off_balance",
            Warning::AdhesionUnsettled => "adhesion_unsettled",
            Warning::GripStrain { .. } => "grip_strain",
            Warning::GripWithoutCore { .. } => "grip_without_core",
            Warning::GripRough { .. } => "grip_rough",
            Warning::GripUnsolved { .. } => "grip_unsolved",
            Warning::Unsolved { .. } => "unsolved",
            Warning::UnsolvedRows { .. } => "unsolved_rows",
            Warning::Penetration { .. } => "penetration",
            Warning::Runaway { .. } => "runaway",
            Warning::ForceLeaps { .. } => "force_leaps",
        }
    }

    /// The vertex of the hand that it is about, if it is about one.
    pub fn vertex(&self) -> Option<usize> {
        match self {
            Warning::Bare { vertex, .. }
            | Warning::Crease { vertex, .. }
            | Warning::ProductBetweenVertices { vertex, .. }
            | Warning::Runaway { vertex, .. } => Some(*vertex),
            _ => None,
        }
    }

    /// The region that it is about, if it is about one.
    pub fn region(&self) -> Option<usize> {
        match self {
            Warning::BeyondStiffening { region, .. }
            | Warning::BeyondTheory { region, .. }
            | Warning::BeyondTissue { region, .. } => Some(*region),
            _ => None,
        }
    }
}

/// The grade of a result with these remarks: that of the gravest.
pub fn grade(warnings: &[Warning]) -> Grade {
    warnings
        .iter()
        .map(Warning::grade)
        .max()
        .unwrap_or_default()
}

/// The gravest remark, the first of several, unless the result is good.
pub fn reason(warnings: &[Warning]) -> Option<&Warning> {
    let worst = grade(warnings);
    warnings
        .iter()
        .find(|warning| worst > Grade::Good && warning.grade() == worst)
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Warning::Note(text) => f.write_str(text),
            Warning::HandSize { extent } => write!(
                f,
                "the hand measures {extent:.4} mm: if its coordinates are not in mm, convert them first"
            ),
            Warning::BeyondStiffening {
                title,
                depth,
                limit,
                ..
            } => write!(
                f,
                "{title} is pressed {depth:.2} mm deep, beyond its dlim of {limit:.2} mm: its modulus is held at Glim"
            ),
            Warning::BeyondTheory {
                title,
                depth,
                thickness,
                ..
            } => write!(
                f,
                "{title} is pressed {depth:.2} mm deep, over half its {thickness:.2} mm of soft tissue: the layer was held \
                 against solids up to half only; Certify solves the tissue as a solid"
            ),
            Warning::BeyondTissue {
                title,
                depth,
                thickness,
                ..
            } => write!(
                f,
                "{title} is pressed {depth:.2} mm deep, more than its {thickness:.2} mm of soft tissue: forces there are not \
                 to be trusted"
            ),
            Warning::Bare { depth, vertex } => write!(
                f,
                "parts without skin (no region) lie up to {depth:.1} mm inside the product, at vertex {vertex}: they bear no \
                 force and are not moved"
            ),
            Warning::ProductInside => f.write_str(
                "the product lies inside the hand and touches no skin: move it out",
            ),
            Warning::NoContact => f.write_str(
                "no skin touches the product: there is no pressure; move them together or ask for a force (a product finer than the \
                 hand's vertex spacing may lie between vertices: refine the hand there)",
            ),
            Warning::CoarseProduct { longest, spacing } => write!(
                f,
                "the product's triangles are up to {longest:.1} mm long where it is touched, the hand's {spacing:.1} mm: its \
                 pressure map is smeared; subdivide the product for a map (forces on the hand are not affected)"
            ),
            Warning::FewVertices { vertices, spacing } => write!(
                f,
                "only {vertices} {} in contact: the contact is finer than the hand's vertex spacing of {spacing:.1} mm, so its \
                 force and pressure are rough; refine the hand there",
                if *vertices == 1 { "vertex is" } else { "vertices are" }
            ),
            Warning::ProductBetweenVertices {
                vertex,
                depth,
                spacing,
                touches,
            } => write!(
                f,
                "the product passes between the skin's vertices, up to {depth:.1} mm under the skin at vertex {vertex}: it is finer \
                 than their spacing of {spacing:.1} mm, so that {}; refine the skin there",
                match touches {
                    true => "force and pressure are too low",
                    false => "no vertex touches it and there is no pressure",
                }
            ),
            Warning::Edge { patch_peak } => write!(
                f,
                "the pressure over 24 mm2 reaches {:.2} MPa, more than skin bears: a sharp edge or corner does that; round it, \
                 or read the force alone",
                patch_peak
            ),
            Warning::Crease { vertex, share } => write!(
                f,
                "the peak pressure stands at vertex {vertex} in a crease, where the posture has folded the skin to {:.0} % of its \
                 area: read the patch peak instead",
                100.0 * share
            ),
            Warning::OffBalance { net, sum } => write!(
                f,
                "the product is held from several sides, but {net:.1} N of {sum:.1} N are left over: without a \
                 load of that size it would slip out; move the product or the fingers"
            ),
            Warning::AdhesionUnsettled => f.write_str(
                "adhesion is about to make the skin leap and did not settle: take smaller steps there",
            ),
            Warning::Unsolved {
                penetration,
                passes,
                spacing,
            } => write!(
                f,
                "the contact was not solved: {penetration:.3} mm are left after {passes} passes; the product may have folds \
                 smaller than the hand's vertex spacing of {spacing:.1} mm"
            ),
            Warning::UnsolvedRows { unsolved, rows } => write!(
                f,
                "{unsolved} of {rows} rows of the protocol were not solved (has_converged is false there); take smaller steps, or \
                 refine the hand's mesh"
            ),
            Warning::Penetration { depth } => write!(
                f,
                "the written skin still lies {depth:.3} mm inside the product; refine the hand's mesh there"
            ),
            Warning::Runaway {
                vertex,
                moved,
                overlap,
            } => write!(
                f,
                "vertex {vertex} moves {moved:.1} mm where skin overlaps the product by {overlap:.1} mm at most: the skin is \
                 folded there; open the hand a little"
            ),
            Warning::GripStrain { strain } => write!(
                f,
                "the soft grip is pressed in by {:.0} % of its thickness: its material is taken as linear, and most yield less and less \
                 from 25 % on; take a thicker or harder grip, or read the pressure as a lower bound",
                100.0 * strain
            ),
            Warning::GripWithoutCore { vertex } => write!(
                f,
                "the soft grip is thicker than half the product at the product's vertex {vertex}, so that no rigid core is left there: it \
                 yields more than computed; make it thinner"
            ),
            Warning::GripRough { left } => write!(
                f,
                "skin and soft grip settled to {left:.3} mm only, as where a grip is pressed as thin as it gets: take a thicker or \
                 harder grip, or read the force alone"
            ),
            Warning::GripUnsolved { left } => write!(
                f,
                "the soft grip was not solved: skin and grip still differ by {left:.3} mm; press less deep, or take a \
                 thicker or harder grip"
            ),
            Warning::ForceLeaps { asked, reached } => write!(
                f,
                "{asked:.3} N were asked for, but the force leaps there: {reached:.3} N is the nearest; a finer hand mesh, or \
                 a product with thickness, leaps less"
            ),
        }
    }
}
