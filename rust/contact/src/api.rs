//! What goes into a press and what comes out of it.

use thenar_surface::{Mesh, Product, Vec3};

use crate::Material;
use crate::fields::warnings::{Grade, Warning, grade, reason};

/// The contact model, chosen by name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Model {
    /// Coupled skin bonded to bone: the default.
    Layer,
    /// The paper's independent half-space regions with swelling added after the solve.
    Paper,
}

impl Model {
    /// The material taken where none is given: a fingertip's.
    pub fn preset(self) -> Material {
        match self {
            Model::Layer => Material::finger_layer(),
            Model::Paper => Material::finger(),
        }
    }

    /// The sentence that says so.
    pub fn preset_note(self) -> String {
        let name = match self {
            Model::Layer => "finger_layer",
            Model::Paper => "finger",
        };
        format!(
            "no materials were given: all skin is taken as a fingertip's (preset {name}); give regions and a material for \
             each, since a palm is thicker and stiffer at first touch"
        )
    }
}

/// A hand to prepare.
#[derive(Debug, Clone)]
pub struct SkinInput {
    /// Rest surface, mm.
    pub mesh: Mesh,
    /// Region of every vertex, from 0; negative for "no skin" (nails, back of the hand). Empty: all in region 0.
    pub regions: Vec<i32>,
    /// One material a region.
    pub materials: Vec<Material>,
    /// The contact model.
    pub model: Model,
}

/// A force to reach by moving the product.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ForceTarget {
    /// Normal force along the direction, N, positive.
    pub newton: f64,
    /// Where the product moves, towards the skin; unit length not needed. None: mean normal of the contact.
    pub direction: Option<Vec3>,
}

/// How the product is dragged along the skin once it is pressed on. It stands where it ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Drag {
    /// A motion: travel (mm) and turn about the center of the contact (rad, small).
    Motion { travel: Vec3, turn: Vec3 },
    /// Along this force until the shear on the skin is as large, N.
    Force(Vec3),
}

/// One press of a prepared skin.
#[derive(Clone, Copy)]
pub struct Press<'a> {
    /// The product, in the frame of the posed positions.
    pub product: &'a Product,
    /// Posed positions, mm, one per prepared vertex; None presses the rest pose.
    pub posed: Option<&'a [Vec3]>,
    /// None leaves the product where it is.
    pub force: Option<ForceTarget>,
    /// How the product is dragged under that press; works through the effect `friction`.
    pub drag: Option<Drag>,
    /// Where the solver starts.
    pub start: Start,
    /// What becomes of a contact that does not reach its tolerances.
    pub unsolved: Unsolved,
}

/// What becomes of a contact that does not reach its tolerances.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Unsolved {
    /// It is an error that names the place.
    #[default]
    Refuse,
    /// The best state found is returned, graded [`Grade::DoNotUse`].
    Keep,
}

impl Unsolved {
    /// From what a caller asks for.
    pub fn kept_if(keep: bool) -> Unsolved {
        match keep {
            true => Unsolved::Keep,
            false => Unsolved::Refuse,
        }
    }
}

/// Where the solver starts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Start {
    /// From nothing: the result depends on the input alone, bit for bit.
    Fresh,
    /// From this skin's last result: faster when little has moved, equal within the tolerances.
    Warm,
    /// As warm, and only as exact as what moves before the eye needs to be: skin away from what moved keeps its forces until
    /// it is off by 0.5 % of the deepest penetration, the certificate; the written surface fits the product within 0.02 mm. The
    /// response of a site to others is rounded to 1/64000 of the largest.
    Live,
}

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
    /// Deepest skin vertex inside the product after deformation, measured anew, mm.
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
