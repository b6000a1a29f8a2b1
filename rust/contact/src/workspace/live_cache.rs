//! The cache of live presses: last displacement field, last solution by site, near-field couplings.

use thenar_surface::{Gap, Vec3};

use crate::detection::press_direction::Sums;
use crate::response::near_field::NearField;

/// Displacement field of the last live press; changes of loads are added to it.
#[derive(Debug, Clone, Default)]
pub struct LiveField {
    /// Load at every site, weight and direction in it.
    pub load: Vec<Vec3>,
    /// `sum_j K_ij load_j` at every site.
    pub field: Vec<Vec3>,
    /// Changes of both in the last live press.
    pub load_change: Vec<Vec3>,
    pub field_change: Vec<Vec3>,
}

impl LiveField {
    /// True if it holds the field of a skin of so many sites.
    pub fn matches(&self, sites: usize) -> bool {
        self.load.len() == sites
    }

    /// Begins the next press.
    pub fn begin(&mut self) {
        self.load_change.fill(Vec3::zeros());
        self.field_change.fill(Vec3::zeros());
    }
}

/// Solution of one site in the last live press.
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

/// Solution of the last live press.
#[derive(Debug, Clone, Default)]
pub struct LiveContact {
    /// Its zone, ascending.
    pub zone: Vec<u32>,
    /// The solution of each of them, by site.
    pub met: Vec<Option<ReusedSite>>,
    /// Sites that exceeded the tolerance while they were reused, ascending, and in how many more presses they are solved at once.
    pub strayed: Vec<(u32, u32)>,
}

impl LiveContact {
    /// Has these `sites` (ascending) solved at once in so many `presses`.
    pub fn solve_at_once(&mut self, sites: &[u32], presses: u32) {
        self.strayed
            .retain(|(site, _)| sites.binary_search(site).is_err());
        self.strayed
            .extend(sites.iter().map(|&site| (site, presses)));
        self.strayed.sort_unstable();
    }

    /// One press less for all sites that strayed.
    pub fn count_down(&mut self) {
        self.strayed.retain_mut(|(_, presses)| {
            *presses -= 1;
            *presses > 0
        });
    }

    /// Solution of a site, if it was in the zone.
    pub fn of(&self, site: u32) -> Option<&ReusedSite> {
        self.met.get(site as usize)?.as_ref()
    }
}

/// Near fields of the first round of a solve, often reused by the next solve, and of its later rounds, which have few sites.
#[derive(Debug, Clone, Default)]
pub struct NearFields {
    of_rounds: [NearField; 2],
    now: usize,
}

impl NearFields {
    /// Selects that of a `round`, from 1.
    pub fn turn_to(&mut self, round: usize) {
        self.now = usize::from(round > 1);
    }

    /// That of this round.
    pub fn now(&self) -> &NearField {
        &self.of_rounds[self.now]
    }

    /// The same, to be rebuilt.
    pub fn now_mut(&mut self) -> &mut NearField {
        &mut self.of_rounds[self.now]
    }
}
