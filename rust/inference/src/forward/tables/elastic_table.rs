//! Elastic force and contact radius of one tool against the root of depth, and its changes by an effect.

use thenar_contact::effects::Effect;

use crate::interpolation::{Table, interval, mixed};

/// How a table was changed, and by how much at each of its knots.
#[derive(Debug, Clone)]
pub struct Variant {
    /// What changes it.
    pub effect: Effect,
    /// Which of the effect's tables: a stiff skin has one by thickness.
    pub form: usize,
    /// Coordinate of each knot: logarithm of the thickness over the base's, lost part of Poisson's ratio, number of the skin's modulus.
    pub knots: Vec<f64>,
    /// By place, knot and rung (as many as the base has): logarithm of the force over the base's.
    pub log_ratio: Vec<Vec<Vec<f64>>>,
}

/// A tool at a site: force for a modulus of 1 MPa, and contact radius, by the root of depth.
#[derive(Debug, Clone)]
pub struct Tabulated {
    /// Roots of the depths, mm^0.5.
    pub roots: Vec<f64>,
    /// Force over the modulus, mm2.
    pub force: Table,
    /// The same at the rungs.
    pub rungs: Vec<f64>,
    /// Contact radius at the rungs, mm.
    pub radius: Vec<f64>,
    /// Deepest depth that was recorded, mm.
    pub deepest: f64,
    /// Whether its forces are known without the mesh.
    pub is_exact: bool,
}

/// Rung below a depth, and the share of the way to the next, along the root of depth.
pub fn rung(table: &Tabulated, depth: f64) -> (usize, f64) {
    let (k, share) = interval(&table.roots, depth.max(0.0).sqrt());
    (k, share.min(1.0))
}

/// Contact radius at a depth, mm.
pub fn radius(table: &Tabulated, depth: f64) -> f64 {
    mixed(&table.radius, rung(table, depth))
}

/// Part of the largest depth at which a tool's radius is read from its contact.
pub const SHALLOW: f64 = 0.05;

/// Radius of a round tool by those of its contact, where it is still small and at the largest depth, mm: `R = a^2 / d`.
///
/// At depth a thin layer's contact is up to twice as large as a half space's, so it is read where the contact is small; not where
/// it is not that of a round tool there, as a punch's, which is as wide from the first touch on.
pub fn round_radius((small, large): (f64, f64), deepest: f64) -> f64 {
    let by_large = large.max(1e-3).powi(2) / deepest;
    let by_small = small.powi(2) / (SHALLOW * deepest);
    match (0.4..1.3).contains(&(by_small / by_large)) {
        true => by_small,
        false => by_large,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A ball of 28 mm on a half space and on a layer whose contact is wider at depth; a punch of 3 mm, and a contact not yet seen.
    #[test]
    fn radius_is_read_where_a_round_tool_is_shallow() {
        let (deepest, ball) = (0.8, 28.0f64);
        let small = (ball * SHALLOW * deepest).sqrt();
        for large in [(ball * deepest).sqrt(), (1.9 * ball * deepest).sqrt()] {
            assert!((round_radius((small, large), deepest) - ball).abs() < 1e-9);
        }
        for small in [3.0, 0.0] {
            assert_eq!(round_radius((small, 3.0), deepest), 9.0 / deepest);
        }
    }
}
