//! What one press leaves for the next, so that small moves are cheap.

use crate::hierarchy::Coupled;
use crate::interface::attraction::Pull;
use crate::interface::shear_kernel::ShearTables;
use crate::interface::shear_response::Pairs;
use crate::linearize::Solved;
use crate::solve::operator::Rows;
use thenar_surface::Vec3;

/// What one press leaves for the next.
#[derive(Debug, Clone, Default)]
pub struct Memory {
    /// Zone of the last press and its coupling.
    pub zone: Vec<u32>,
    pub coupling: Rows<f32>,
    /// The compliance of that zone, kept for its storage.
    pub compliance: Rows<f32>,
    /// In a large skin, the coupling of that zone, and response weight times direction at each of its sites.
    pub coupled: Coupled,
    pub along: Vec<Vec3>,
    /// Where the last solve ended.
    pub trail: Trail,
    /// Kernels of shear, once friction has needed them.
    pub shear: Option<ShearTables>,
    /// And what they are between the sites that were last in contact.
    pub pairs: Pairs,
}

/// Where one solve ended, for the next to start from; a walk through a protocol keeps its own.
#[derive(Debug, Clone, Default)]
pub struct Trail {
    /// What the last solve found.
    pub last: Last,
    /// Nearest product triangle by welded vertex.
    pub triangle: Vec<u32>,
    /// Travel found by force control, mm.
    pub offset: f64,
    /// Slope there of the search for it, in its own terms per mm.
    pub slope: Option<f64>,
    /// Attraction of the last row of a protocol.
    pub pulls: Vec<Pull>,
}

/// A solved contact by site, for the next solve to start from; empty for none.
#[derive(Debug, Clone, Default)]
pub struct Last {
    /// Normal force, N.
    pub force: Vec<f64>,
    /// Travel along the site's direction, mm; empty to begin with the undeformed skin all the same.
    pub travel: Vec<f64>,
}

impl Last {
    /// What to keep of a solve on a skin of so many sites.
    pub fn of(solved: &Solved, sites: usize) -> Self {
        let (mut force, mut travel) = (vec![0.0; sites], vec![0.0; sites]);
        for (k, &site) in solved.zone.iter().enumerate() {
            force[site as usize] = solved.force[k];
            travel[site as usize] = solved.travel[k];
        }
        Last { force, travel }
    }
}
