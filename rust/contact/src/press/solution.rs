//! The solved contact by site: of one linear problem, and of the whole press.

use thenar_surface::{Gap, Vec3};

use super::setting::vertex;
use crate::ContactError;
use crate::detection::press_direction::Sums;
use crate::fields::result::Convergence;
use crate::skin::prepare::Skin;
use crate::workspace::warm_start::StartContact;

/// What a solve found, by site of its zone.
pub struct ZoneSolution<'a> {
    /// Sites, ascending.
    pub zone: &'a [u32],
    /// Normal force, N.
    pub force: &'a [f64],
    /// Direction in which each yields.
    pub direction: &'a [Vec3],
    /// Cosine between that and the product's normal.
    pub cosine: &'a [f64],
    /// Travel along it, mm.
    pub travel: &'a [f64],
    /// Where each met the product.
    pub touch: &'a [Gap],
    /// Slack of the last linear problem, mm.
    pub slack: &'a [f64],
    /// Sums of which each direction is an average.
    pub sums: &'a [Sums],
    /// Which reuse their solution of the last live press; empty if none do.
    pub is_reused: &'a [bool],
}

/// The solved contact, in the product's frame.
#[derive(Clone)]
pub struct SolvedContact {
    /// Sites that could touch, ascending.
    pub zone: Vec<u32>,
    /// Normal force on each, N.
    pub force: Vec<f64>,
    /// Where each touches, or would: closest point and normal after deformation.
    pub touch: Vec<Gap>,
    /// Travel of each along its direction, mm.
    pub travel: Vec<f64>,
    /// Slack of the last linear problem, mm.
    pub slack: Vec<f64>,
    /// Direction in which each yields times its cosine with the normal: load per normal force.
    pub bearing: Vec<Vec3>,
    /// Displacement of every site, mm.
    pub displacement: Vec<Vec3>,
    /// Signed distance of the written zone, and of every other site that was lifted towards the product, at worst, mm.
    pub penetration: f64,
    /// Complementarity of the last linear problem.
    pub complementarity: f64,
    /// Largest difference of the displacement from the direct sum, on a sample of sites, relative to the largest.
    pub far_field: f64,
    /// How it ended.
    pub convergence: Convergence,
    /// Sites that do not fit the product within the tolerance, the worst first, and how far that is off, mm.
    pub unfit: Vec<u32>,
    pub left: f64,
}

impl SolvedContact {
    /// The error that names where the contact did not reach its tolerances; None where it did.
    pub fn refusal(&self, skin: &Skin) -> Option<ContactError> {
        if self.convergence.has_converged {
            return None;
        }
        let source = |site: &u32| skin.merged.source[vertex(skin, *site)] as usize;
        let region = self
            .unfit
            .first()
            .map_or(-1, |&site| skin.sites.region[site as usize]);
        Some(ContactError::Unsolved {
            title: match usize::try_from(region) {
                Ok(region) => skin.region_title(region),
                Err(_) => "the skin".to_owned(),
            },
            left_mm: self.left,
            passes: self.convergence.passes,
            vertices: self.unfit.iter().map(source).collect(),
        })
    }

    /// What the next solve starts from, on a skin of so many sites.
    pub fn to_start(&self, sites: usize) -> StartContact {
        let (mut force, mut travel) = (vec![0.0; sites], vec![0.0; sites]);
        for (k, &site) in self.zone.iter().enumerate() {
            force[site as usize] = self.force[k];
            travel[site as usize] = self.travel[k];
        }
        StartContact { force, travel }
    }
}
