//! A press at one position of the product, solved: gaps, contact, moduli, and what memory, adhesion and friction add.

use thenar_surface::Vec3;

use super::solution::Solved;
use crate::detection::gaps::Detection;
use crate::history::tissue_memory::Recall;
use crate::interface::friction_state::Sheared;
use crate::interface::pulls::Clinging;
use crate::skin::prepare::Skin;

/// One solved position of the product.
#[derive(Clone)]
pub(crate) struct Pressed {
    pub detection: Detection,
    pub solved: Solved,
    /// Shear modulus by region, MPa.
    pub shear_modulus: Vec<f64>,
    /// Effective shear modulus by site, blended, MPa.
    pub modulus_at: Vec<f64>,
    /// What memory did to it, if the tissue remembers.
    pub recalled: Option<Recalled>,
    /// What attracts skin and product.
    pub clinging: Clinging,
    /// What friction made of a drag.
    pub shear: Option<Sheared>,
}

impl Pressed {
    /// True if the contact is within its tolerances, and the attraction with it.
    pub fn has_converged(&self) -> bool {
        self.solved.convergence.has_converged && self.clinging.is_settled
    }

    /// Force on the skin along `direction`, N.
    pub fn force_along(&self, direction: &Vec3) -> f64 {
        self.force_on_skin().dot(direction)
    }

    /// Sum of the normal forces on the skin, attraction taken off, N.
    pub fn force_on_skin(&self) -> Vec3 {
        let forces = self.solved.force.iter().zip(&self.solved.touch);
        let pushed: Vec3 = forces.map(|(f, g)| g.normal * *f).sum();
        if self.clinging.pulls.is_empty() {
            return pushed;
        }
        pushed + self.clinging.force()
    }

    /// Keeps it as what the next press of this skin starts from, the product having travelled `offset` (mm).
    pub fn start_next(&self, skin: &mut Skin, offset: f64) {
        let trail = &mut skin.memory.trail;
        trail.last = self.solved.to_start(skin.sites.len());
        trail.offset = offset;
        trail.pulls.clone_from(&self.clinging.pulls);
    }
}

/// The memory's part in a press.
#[derive(Clone)]
pub(crate) struct Recalled {
    pub recall: Recall,
    /// What each site of the zone bears, and what attraction pulls at, in the elastic tissue's terms, N.
    pub bearing: Vec<(u32, Vec3)>,
    /// True where attraction holds skin and product together, by region.
    pub clings: Vec<bool>,
}
