//! Names that files give their columns, in the languages of their makers, and the names here.

use crate::text::units::Quantity;

/// Names that files use, the name here, and what it must measure.
pub(super) const KNOWN: &[(&str, &str, Option<Quantity>)] = &[
    ("time", "time", Some(Quantity::Time)),
    ("t", "time", Some(Quantity::Time)),
    ("test_time", "time", Some(Quantity::Time)),
    ("elapsed_time", "time", Some(Quantity::Time)),
    ("total_time", "time", Some(Quantity::Time)),
    ("temps_d'essai", "time", Some(Quantity::Time)),
    ("temps", "time", Some(Quantity::Time)),
    ("prüfzeit", "time", Some(Quantity::Time)),
    ("zeit", "time", Some(Quantity::Time)),
    ("tiempo", "time", Some(Quantity::Time)),
    ("tempo", "time", Some(Quantity::Time)),
    ("depth", "depth", Some(Quantity::Length)),
    ("compression", "depth", Some(Quantity::Length)),
    ("indentation_depth", "depth", Some(Quantity::Length)),
    ("penetration_depth", "depth", Some(Quantity::Length)),
    // MTS, Agilent and Keysight nanoindenters.
    ("displacement_into_surface", "depth", Some(Quantity::Length)),
    ("load_on_sample", "force", Some(Quantity::Force)),
    ("time_on_sample", "time", Some(Quantity::Time)),
    // Hysitron.
    ("indent_disp.", "travel", Some(Quantity::Length)),
    ("indent_load", "force", Some(Quantity::Force)),
    // Anton Paar: penetration depth and normal force.
    ("pd", "depth", Some(Quantity::Length)),
    ("fn", "force", Some(Quantity::Force)),
    ("travel", "travel", Some(Quantity::Length)),
    ("displacement", "travel", Some(Quantity::Length)),
    ("length", "travel", Some(Quantity::Length)),
    ("distance", "travel", Some(Quantity::Length)),
    ("compressive_extension", "travel", Some(Quantity::Length)),
    ("compressive_displacement", "travel", Some(Quantity::Length)),
    ("force", "force", Some(Quantity::Force)),
    ("load", "force", Some(Quantity::Force)),
    ("normal_force", "force", Some(Quantity::Force)),
    ("compressive_load", "force", Some(Quantity::Force)),
    ("compressive_force", "force", Some(Quantity::Force)),
    ("standard_force", "force", Some(Quantity::Force)),
    ("force_standard", "force", Some(Quantity::Force)),
    ("standardkraft", "force", Some(Quantity::Force)),
    ("prüfkraft", "force", Some(Quantity::Force)),
    ("kraft", "force", Some(Quantity::Force)),
    ("fuerza", "force", Some(Quantity::Force)),
    ("carga", "force", Some(Quantity::Force)),
    ("forza", "force", Some(Quantity::Force)),
    ("tool_separation", "tool_gap", Some(Quantity::Length)),
    (
        "ecartement_entre_outils",
        "tool_gap",
        Some(Quantity::Length),
    ),
    (
        "écartement_entre_outils",
        "tool_gap",
        Some(Quantity::Length),
    ),
    ("werkzeugabstand", "tool_gap", Some(Quantity::Length)),
    ("allongement", "elongation", Some(Quantity::Length)),
    ("area", "area", Some(Quantity::Area)),
    ("slide", "slide", Some(Quantity::Length)),
    (
        "tangential_force",
        "tangential_force",
        Some(Quantity::Force),
    ),
    ("pressure", "pressure", Some(Quantity::Pressure)),
    ("row", "row", None),
    ("col", "column", None),
    ("column", "column", None),
    ("phase", "phase", None),
    ("segment", "segment", None),
];

/// The name here of a column, and what it must measure, if it is known.
pub(super) fn known(base: &str) -> Option<(&'static str, Option<Quantity>)> {
    KNOWN
        .iter()
        .find(|(name, ..)| *name == base)
        .map(|(_, name, quantity)| (*name, *quantity))
}

/// What a quantity that is called so here must measure.
pub(super) fn quantity(name: &str) -> Option<Quantity> {
    KNOWN
        .iter()
        .find(|(_, known, _)| *known == name)
        .and_then(|(.., quantity)| *quantity)
}
