//! The result of a press: arrays by vertex, totals, region table, residuals, convergence.

use thenar_surface::Vec3;

use super::warnings::{Grade, Warning, grade, reason};

/// How a solve ended.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Convergence {
    /// True if complementarity and penetration, and adhesion where it acts, are within their tolerances.
    pub has_converged: bool,
    /// Re-linearisations of the gap in the last press.
    pub passes: usize,
    /// Changes of the contact set in all.
    pub pivots: usize,
    /// Conjugate-gradient steps in all.
    pub cg_steps: usize,
}

/// What is left of the equations in the written result.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Residual {
    /// Largest of |min(force, slack)|, force in compliance units, relative to the largest penetration (Xie Eq. 14).
    pub complementarity: f64,
    /// Deepest skin vertex inside the product after deformation, measured again, mm.
    pub penetration_mm: f64,
    /// Difference of the force on hand and product, relative to their sum.
    pub load_balance: f64,
    /// Largest difference of the displacement from the direct sum over all forces, on a sample of vertices, relative to the
    /// largest displacement; 0 where every response is exact (skins of less than 40,000 vertices).
    pub far_field: f64,
}

/// One region of the result table.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RegionResult {
    /// Region number.
    pub index: usize,
    /// Sum of normal forces, N.
    pub force: f64,
    /// Contact area, mm2.
    pub area: f64,
    /// Largest vertex pressure, MPa.
    pub peak: f64,
    /// Force over contact area, MPa.
    pub mean: f64,
    /// Largest penetration before deformation, mm.
    pub max_penetration: f64,
    /// Shear modulus used, MPa.
    pub shear_modulus: f64,
}

/// What friction makes of a drag. Arrays have one entry per vertex of the hand.
#[derive(Debug, Clone, PartialEq)]
pub struct Shear {
    /// Shear force on the skin, N, in the product's tangent plane.
    pub force: Vec<Vec3>,
    /// Its length over the vertex area, MPa.
    pub traction: Vec<f64>,
    /// Slip of the skin over the product, mm.
    pub slip: Vec<Vec3>,
    /// 1 - shear force / (coefficient x normal force): 0 where skin slips, 1 without shear; NaN without contact.
    pub margin: Vec<f64>,
    /// True where skin in contact does not slip.
    pub is_sticking: Vec<bool>,
    /// Shear force on the skin in all, N.
    pub total: Vec3,
    /// Travel of the product, mm; found where a force was asked for.
    pub travel: Vec3,
    /// Turn of the product about the center of the contact, rad.
    pub turn: Vec3,
    /// Energy lost to slip, N mm.
    pub dissipated: f64,
    /// Energy stored in the sheared skin, N mm.
    pub stored: f64,
    /// Largest natural residual of the law of friction, relative to the longest travel.
    pub residual: f64,
}

/// The result of a press. Arrays have one entry per vertex of the hand unless said otherwise.
#[derive(Debug, Clone, PartialEq)]
pub struct Contact {
    /// Displacement to add to the posed positions, mm.
    pub displacement: Vec<Vec3>,
    /// Normal force, N, compressive >= 0.
    pub nodal_force: Vec<f64>,
    /// Pressure, MPa.
    pub pressure: Vec<f64>,
    /// Signed distance to the product before deformation, mm; infinite beyond the reach of the query.
    pub gap: Vec<f64>,
    /// Product's outward normal where the vertex touches; zero where it does not.
    pub normal: Vec<Vec3>,
    /// Force on the product, N, with what friction adds. The skin bears the opposite.
    pub total_force: Vec3,
    /// Moment of that force about the origin, N mm.
    pub total_moment: Vec3,
    /// Force-weighted mean position of the contact, mm; zero without contact.
    pub center_of_pressure: Vec3,
    /// mm2.
    pub contact_area: f64,
    /// Largest vertex pressure, MPa.
    pub peak_pressure: f64,
    /// Sum of normal forces over contact area, MPa.
    pub mean_pressure: f64,
    /// Largest mean pressure over 24 mm2 of skin (a sensel of the paper's mat), MPa.
    pub patch_peak: f64,
    /// One row a region, by index.
    pub regions: Vec<RegionResult>,
    /// Pressure at every product vertex, MPa; its sum over vertex areas is the force.
    pub product_pressure: Vec<f64>,
    /// Travel of the product along `direction` found by force control, mm; 0 without.
    pub offset: f64,
    /// Direction of travel, or of the mean normal force without force control; zero without contact.
    pub direction: Vec3,
    /// Attraction towards the product, N, >= 0; zero without adhesion. Forces and pressures are those of contact alone; only
    /// totals are less by it.
    pub adhesion: Vec<f64>,
    /// Shear, where friction acts and the product is dragged.
    pub shear: Option<Shear>,
    /// What is left of the equations.
    pub residual: Residual,
    /// How the solve ended.
    pub convergence: Convergence,
    /// What there is to say about it.
    pub warnings: Vec<Warning>,
    /// Wall time by stage, s, in order.
    pub seconds: Vec<(&'static str, f64)>,
}

impl Contact {
    /// How far the result may be used.
    pub fn grade(&self) -> Grade {
        grade(&self.warnings)
    }

    /// The gravest remark, unless the result is good.
    pub fn reason(&self) -> Option<&Warning> {
        reason(&self.warnings)
    }
}
