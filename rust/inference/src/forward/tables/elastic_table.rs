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
