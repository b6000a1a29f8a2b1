//! A press solved at one position: gaps, contact, moduli, and what memory, adhesion and friction add.

use std::sync::Arc;

use thenar_surface::Vec3;

use super::solution::SolvedContact;
use crate::detection::gaps::Detection;
use crate::history::tissue_memory::MemoryStep;
use crate::interface::friction_state::ShearState;
use crate::interface::pulls::Adhesion;
use crate::solve::Accuracy;
use crate::workspace::Pressing;

/// Travel of the product.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Travel {
    /// Along the direction, mm.
    pub offset: f64,
    /// Unit direction; zero without contact.
    pub direction: Vec3,
}

impl Travel {
    /// Shift of the product, mm.
    pub fn shift(&self) -> Vec3 {
        self.direction * self.offset
    }
}

/// One solved position of the product.
#[derive(Clone)]
pub(crate) struct Pressed {
    pub detection: Detection,
    pub solved: SolvedContact,
    /// Shear modulus by region, MPa.
    pub shear_modulus: Vec<f64>,
    /// Effective shear modulus by site, blended, MPa.
    pub modulus_at: Vec<f64>,
    /// Part of tissue memory, if a protocol is followed.
    pub recalled: Option<PressMemory>,
    /// Adhesive attraction.
    pub adhesion: Adhesion,
    /// Shear of a drag with friction.
    pub shear: Option<ShearState>,
    /// How far it was solved: a frame of Live roughly.
    pub accuracy: Accuracy,
}

impl Pressed {
    /// True if the contact is within its tolerances, and the attraction with it.
    pub fn has_converged(&self) -> bool {
        self.solved.convergence.has_converged && self.adhesion.is_settled
    }

    /// Force on the skin along `direction`, N.
    pub fn force_along(&self, direction: &Vec3) -> f64 {
        self.force_on_skin().dot(direction)
    }

    /// Sum of the normal forces on the skin, attraction taken off, N.
    pub fn force_on_skin(&self) -> Vec3 {
        let forces = self.solved.force.iter().zip(&self.solved.touch);
        let pushed: Vec3 = forces.map(|(f, g)| g.normal * *f).sum();
        if self.adhesion.pulls.is_empty() {
            return pushed;
        }
        pushed + self.adhesion.force()
    }

    /// Keeps it as what the next press in this workspace starts from, the product having travelled `offset` (mm).
    pub fn start_next(&self, pressing: &mut Pressing<'_>, offset: f64) {
        let warm_start = &mut pressing.workspace.warm_start;
        warm_start.last = Arc::new(self.solved.to_start(pressing.skin.sites.len()));
        warm_start.offset = offset;
        warm_start.pulls.clone_from(&self.adhesion.pulls);
    }
}

/// The memory's part in a press.
#[derive(Clone)]
pub(crate) struct PressMemory {
    pub recall: MemoryStep,
    /// What each site of the zone bears, and what attraction pulls at, in the elastic tissue's terms, N.
    pub bearing: Vec<(u32, Vec3)>,
    /// True where attraction holds skin and product together, by region.
    pub clings: Vec<bool>,
}
