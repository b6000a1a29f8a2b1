//! The request: hand, model, press, force target, drag and start. The result is `fields::result`.

use thenar_surface::{Mesh, Product, Vec3};

use crate::Material;

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
    /// The best state found is returned, graded [`DoNotUse`](crate::Grade::DoNotUse).
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
