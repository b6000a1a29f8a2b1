//! The cache of live presses: last displacement field, last solution by site, near-field couplings.

use thenar_surface::{Gap, Vec3};

use crate::detection::press_direction::Sums;
use crate::response::near_field::NearField;

/// Where loads carried the skin: a change of some is added to it.
#[derive(Debug, Clone, Default)]
pub struct LiveField {
    /// Load at every site, weight and direction in it.
    pub load: Vec<Vec3>,
    /// `sum_j K_ij load_j` at every site.
    pub field: Vec<Vec3>,
    /// How both changed in the last live press.
    pub load_change: Vec<Vec3>,
    pub field_change: Vec<Vec3>,
}

impl LiveField {
    /// Whether there is something for a skin of so many sites.
    pub fn is_of(&self, sites: usize) -> bool {
        self.load.len() == sites
    }

    /// Begins the next press.
    pub fn begin(&mut self) {
        self.load_change.fill(Vec3::zeros());
        self.field_change.fill(Vec3::zeros());
    }
}

/// Where a site met the product in the last live solve.
#[derive(Debug, Clone)]
pub struct ReusedSite {
    /// Its gap before deformation, and its response weight.
    pub gap: Option<Gap>,
    pub weight: f64,
    /// As in a solve's state.
    pub touch: Gap,
    pub direction: Vec3,
    /// What the direction comes from, where it is an average.
    pub sums: Sums,
    pub cosine: f64,
    pub travel: f64,
    pub force: f64,
    pub slack: f64,
}

/// The last live solve.
#[derive(Debug, Clone, Default)]
pub struct LiveContact {
    /// Its zone, ascending.
    pub zone: Vec<u32>,
    /// What each of them met, by site, so that what is held on to stays where it is.
    pub met: Vec<Option<ReusedSite>>,
}

impl LiveContact {
    /// What a site met, if it was in the zone.
    pub fn of(&self, site: u32) -> Option<&ReusedSite> {
        self.met.get(site as usize)?.as_ref()
    }
}

/// The coupling of the first round of a solve, which often serves the next solve, and that of the rounds after it, of few sites.
#[derive(Debug, Clone, Default)]
pub struct NearFields {
    of_rounds: [NearField; 2],
    now: usize,
}

impl NearFields {
    /// Takes the one of a `round`, from 1.
    pub fn turn_to(&mut self, round: usize) {
        self.now = usize::from(round > 1);
    }

    /// The one of this round.
    pub fn now(&self) -> &NearField {
        &self.of_rounds[self.now]
    }

    /// The same, to be made anew.
    pub fn now_mut(&mut self) -> &mut NearField {
        &mut self.of_rounds[self.now]
    }
}
