//! What one press leaves for the next, so that small moves are cheap.

use crate::far_field::Coupled;
use crate::interface::adhesion::Pull;
use crate::interface::shear_kernel::ShearTables;
use crate::interface::shear_response::Pairs;
use crate::press::live::reused_sites::Held;
use crate::press::relinearize::Solved;
use crate::response::near_field::Near;
use crate::response::quantized_rows::Rounded;
use crate::solve::Accuracy;
use crate::solve::row_runs::Rows;
use thenar_surface::{Mesh, Readings, Vec3, renew_shape, vertex_areas, vertex_normals};

/// What one press leaves for the next.
#[derive(Debug, Clone, Default)]
pub struct Memory {
    /// Zone of the last press.
    pub zone: Vec<u32>,
    /// What was solved last, the zone or what of it was not held, and its coupling.
    pub between: Vec<u32>,
    pub coupling: Rows<f32>,
    /// The compliance of those sites, kept for its storage.
    pub compliance: Rows<f32>,
    /// The rows of live presses.
    pub rounded: Rounded,
    /// What was solved last in a live press, and its near coupling.
    pub near: Nears,
    /// In a large skin, the coupling of those sites, and response weight times direction at each of them.
    pub coupled: Coupled,
    pub along: Vec<Vec3>,
    /// Where the last solve ended.
    pub trail: Trail,
    /// The last posture, and what was measured of it.
    pub seen: Seen,
    /// Where the skin was last carried in a live press, and what it met there.
    pub shown: Shown,
    pub held: Held,
    /// Kernels of shear, once friction has needed them.
    pub shear: Option<ShearTables>,
    /// And what they are between the sites that were last in contact.
    pub pairs: Pairs,
}

/// The coupling of the first round of a solve, which often serves the next solve, and that of the rounds after it, of few sites.
#[derive(Debug, Clone, Default)]
pub struct Nears {
    of_rounds: [Near; 2],
    now: usize,
}

impl Nears {
    /// Takes the one of a `round`, from 1.
    pub fn turn_to(&mut self, round: usize) {
        self.now = usize::from(round > 1);
    }

    /// The one of this round.
    pub fn now(&self) -> &Near {
        &self.of_rounds[self.now]
    }

    /// The same, to be made anew.
    pub fn now_mut(&mut self) -> &mut Near {
        &mut self.of_rounds[self.now]
    }
}

/// Where one solve ended, for the next to start from; a walk through a protocol keeps its own.
#[derive(Debug, Clone, Default)]
pub struct Trail {
    /// What the last solve found.
    pub last: Last,
    /// Travel found by force control, mm.
    pub offset: f64,
    /// Slope there of the search for it, in its own terms per mm.
    pub slope: Option<f64>,
    /// Attraction of the last row of a protocol.
    pub pulls: Vec<Pull>,
    /// How far solves go from here.
    pub accuracy: Accuracy,
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

/// A posture and what was measured of it: what has not moved need not be measured again.
#[derive(Debug, Clone, Default)]
pub struct Seen {
    /// Posed positions of the welded vertices, mm.
    posed: Vec<Vec3>,
    shape: Shape,
    /// Their gaps to the product.
    pub readings: Readings,
}

/// What follows from a posture alone, by welded vertex.
#[derive(Debug, Clone, Default)]
pub struct Shape {
    pub normals: Vec<Vec3>,
    /// mm2.
    pub areas: Vec<f64>,
}

impl Seen {
    /// Normals and areas of the welded mesh in its next posture.
    pub fn shape(&mut self, mesh: &Mesh) -> Shape {
        let (before, shape) = (&mut self.posed, &mut self.shape);
        if before.len() == mesh.positions().len() {
            let pairs = before.iter().zip(mesh.positions());
            let has_moved: Vec<bool> = pairs.map(|(a, b)| a != b).collect();
            if has_moved.contains(&true) {
                renew_shape(mesh, &has_moved, (&mut shape.normals, &mut shape.areas));
            }
        } else {
            shape.normals = vertex_normals(mesh);
            shape.areas = vertex_areas(mesh);
        }
        before.clear();
        before.extend_from_slice(mesh.positions());
        shape.clone()
    }
}

impl Shown {
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

/// Where loads carried the skin: a change of some is added to it.
#[derive(Debug, Clone, Default)]
pub struct Shown {
    /// Load at every site, weight and direction in it.
    pub load: Vec<Vec3>,
    /// `sum_j K_ij load_j` at every site.
    pub field: Vec<Vec3>,
    /// How both changed in the last live press.
    pub load_change: Vec<Vec3>,
    pub field_change: Vec<Vec3>,
}
