//! Stage 4's outer loop: the contact problem is linear in the gap, the product is not; repeat until the written surface fits.

use thenar_surface::{Gap, Product, Vec3};

use crate::carried::{Found, field, lifted_sites};
use crate::direction::{LEAST_COSINE, yielding_directions};
use crate::memory::Last;
use crate::press::Convergence;
use crate::response::assembly::compliance;
use crate::skin::Skin;
use crate::solve::{Accuracy, Compliance, solve_contact};
use crate::zone::{Detection, limits};
use crate::{ContactError, Control, Model};

/// Largest distance between written contact and product that ends the loop, mm.
const OUTER_TOLERANCE: f64 = 0.008;
/// The same relative to the largest penetration: shallow presses are resolved as finely as deep ones.
const OUTER_SHARE: f64 = 5e-4;
/// Largest certificate of a large skin's far field.
const FAR_FIELD_TOLERANCE: f64 = 1e-4;
/// Most re-linearizations.
const MOST_PASSES: usize = 14;
/// Most rounds in which sites lifted into the product join the zone.
const MOST_ROUNDS: usize = 4;

/// The solved contact, in the product's frame.
#[derive(Clone)]
pub struct Solved {
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
}

/// What does not change within a solve.
pub struct Setting<'a> {
    /// The product.
    pub product: &'a Product,
    /// Detection of this posture.
    pub detection: &'a Detection,
    /// Response weight s = sqrt((1 - nu) / (2 pi G)) of every site.
    pub weight: &'a [f64],
    /// What to start from.
    pub start: Option<&'a Last>,
    /// Median edge, mm.
    pub spacing: f64,
}

/// Solves the contact of the sites in `zone`.
///
/// # Errors
/// [`ContactError::Cancelled`].
pub fn solve(
    skin: &mut Skin,
    zone: Vec<u32>,
    setting: &Setting<'_>,
    control: &Control,
) -> Result<Solved, ContactError> {
    let mut state = State::new(zone);
    let tolerance = OUTER_TOLERANCE.min(OUTER_SHARE * setting.detection.deepest());
    for round in 1.. {
        skin.couple(&state.zone, control)?;
        state.open(skin, setting);
        state.passes(skin, setting, (tolerance, control))?;
        let (field, far_field) = field(skin, setting, &state.found(), control)?;
        let (worst, lifted) = lifted_sites(skin, setting, (&field, &state.zone), tolerance);
        if lifted.is_empty() || round == MOST_ROUNDS {
            return Ok(state.finish((field, far_field), worst, tolerance));
        }
        state.extend(lifted);
    }
    Err(ContactError::Cancelled)
}

struct State {
    zone: Vec<u32>,
    force: Vec<f64>,
    touch: Vec<Gap>,
    slack: Vec<f64>,
    direction: Vec<Vec3>,
    /// Cosine between each direction and the product's normal.
    cosine: Vec<f64>,
    /// Travel of each zone site along its direction, mm.
    travel: Vec<f64>,
    misfit: f64,
    complementarity: f64,
    convergence: Convergence,
}

impl State {
    fn new(zone: Vec<u32>) -> Self {
        let convergence = Convergence {
            has_converged: false,
            passes: 0,
            pivots: 0,
            cg_steps: 0,
        };
        State {
            zone,
            force: Vec::new(),
            touch: Vec::new(),
            slack: Vec::new(),
            direction: Vec::new(),
            cosine: Vec::new(),
            travel: Vec::new(),
            misfit: 0.0,
            complementarity: 0.0,
            convergence,
        }
    }

    /// Takes gaps, normals and directions of the undeformed posture.
    fn open(&mut self, skin: &Skin, setting: &Setting<'_>) {
        let gap_of =
            |&site: &u32| setting.detection.gaps[skin.sites.vertex[site as usize] as usize];
        self.touch = self.zone.iter().filter_map(gap_of).collect();
        debug_assert_eq!(self.touch.len(), self.zone.len());
        let normal: Vec<Vec3> = self.touch.iter().map(|g| g.normal).collect();
        self.direction = match skin.model {
            Model::Paper => normal,
            Model::Layer => self.averaged_directions(skin, setting, &normal),
        };
        self.travel = vec![0.0; self.zone.len()];
        let travel = setting.start.map_or(&[][..], |last| &last.travel);
        if !travel.is_empty() && skin.model == Model::Layer {
            // Little has moved: the product is met where the skin lay last.
            self.travel = self.zone.iter().map(|&s| travel[s as usize]).collect();
            self.place(skin, setting);
        }
        self.see_along_normals();
        let carried = std::mem::take(&mut self.force);
        self.force = if carried.len() == self.zone.len() {
            carried
        } else {
            self.zone
                .iter()
                .map(|&s| setting.start.map_or(0.0, |start| start.force[s as usize]))
                .collect()
        };
    }

    /// Averages over the penetrating sites, whatever else the zone holds: the result must not depend on its history.
    fn averaged_directions(
        &self,
        skin: &Skin,
        setting: &Setting<'_>,
        normal: &[Vec3],
    ) -> Vec<Vec3> {
        let inside: Vec<usize> = (0..self.zone.len())
            .filter(|&k| self.touch[k].distance < 0.0)
            .collect();
        let sites: Vec<u32> = inside.iter().map(|&k| self.zone[k]).collect();
        let normals: Vec<Vec3> = inside.iter().map(|&k| normal[k]).collect();
        let gaps: Vec<f64> = inside.iter().map(|&k| self.touch[k].distance).collect();
        let around = (&skin.sites, &skin.adjacency, setting.spacing);
        let averaged = yielding_directions(&sites, &normals, &gaps, around);
        let mut direction = normal.to_vec();
        for (k, average) in inside.into_iter().zip(averaged) {
            direction[k] = average;
        }
        direction
    }

    /// Re-linearizes until the zone fits the product.
    fn passes(
        &mut self,
        skin: &mut Skin,
        setting: &Setting<'_>,
        (tolerance, control): (f64, &Control),
    ) -> Result<(), ContactError> {
        self.matrix(skin, setting);
        for pass in 0..MOST_PASSES {
            control.step("solving", pass as f64 / MOST_PASSES as f64)?;
            match skin.directed() {
                Some(matrix) => self.solve_linear(&matrix, control)?,
                None => self.solve_linear(&skin.memory.compliance, control)?,
            }
            self.convergence.passes = pass + 1;
            self.place(skin, setting);
            if self.misfit <= tolerance {
                break;
            }
            if pass == 0 && skin.model == Model::Layer {
                // From now on the normals where the skin lies; then held, so that facets cannot make them flicker.
                self.see_along_normals();
                self.matrix(skin, setting);
            }
        }
        Ok(())
    }

    /// Takes the cosines between directions and the product's normals as they are now.
    fn see_along_normals(&mut self) {
        let cosine = |(touch, direction): (&Gap, &Vec3)| touch.normal.dot(direction);
        let cosines = self.touch.iter().zip(&self.direction).map(cosine);
        self.cosine = cosines.map(|c| c.max(LEAST_COSINE)).collect();
    }

    /// Measures the displaced zone against the product.
    fn place(&mut self, skin: &Skin, setting: &Setting<'_>) {
        let positions = &setting.detection.positions;
        let written = |(k, &site): (usize, &u32)| {
            positions[vertex(skin, site)] + self.direction[k] * self.travel[k]
        };
        let written: Vec<Vec3> = self.zone.iter().enumerate().map(written).collect();
        // The side first touched stays the side: skin in a fold may face another wall once it has moved.
        let normals: Vec<Vec3> = self.touch.iter().map(|g| -g.normal).collect();
        let hints: Vec<u32> = self.touch.iter().map(|g| g.triangle).collect();
        let fresh = setting
            .product
            .gaps_near(&written, Some(&normals), limits(), &hints);
        for (touch, gap) in self.touch.iter_mut().zip(fresh) {
            if let Some(gap) = gap {
                *touch = gap;
            }
        }
        self.misfit = self.measure();
    }

    /// Compliance along the directions, seen along the normals, into the skin's memory.
    fn matrix(&self, skin: &mut Skin, setting: &Setting<'_>) {
        let weight = |(&site, cosine): (&u32, &f64)| setting.weight[site as usize] * cosine;
        let weights: Vec<f64> = self.zone.iter().zip(&self.cosine).map(weight).collect();
        let memory = &mut skin.memory;
        if skin.hierarchy.is_some() {
            let along = weights.iter().zip(&self.direction);
            memory.along = along.map(|(w, t)| t * *w).collect();
            return;
        }
        match skin.model {
            Model::Layer => compliance(
                &memory.coupling,
                (&weights, &self.direction),
                &mut memory.compliance,
            ),
            Model::Paper => compliance(
                &memory.coupling,
                (&weights, &vec![Vec3::x(); weights.len()]),
                &mut memory.compliance,
            ),
        }
    }

    fn solve_linear<M: Compliance>(
        &mut self,
        matrix: &M,
        control: &Control,
    ) -> Result<(), ContactError> {
        let gap: Vec<f64> = (0..self.zone.len())
            .map(|k| self.touch[k].distance - self.cosine[k] * self.travel[k])
            .collect();
        let solution = solve_contact(matrix, &gap, Some(&self.force), (Accuracy::Full, control));
        control.check()?;
        for (k, travel) in self.travel.iter_mut().enumerate() {
            *travel = (solution.slack[k] - gap[k]) / self.cosine[k];
        }
        self.convergence.pivots += solution.pivots;
        self.convergence.cg_steps += solution.steps;
        self.complementarity = solution.complementarity;
        (self.force, self.slack) = (solution.force, solution.slack);
        Ok(())
    }

    /// Largest penetration of the zone, or opening under a force, mm.
    fn measure(&self) -> f64 {
        let misfit = |(g, f): (&Gap, &f64)| {
            if *f > 0.0 {
                g.distance.abs()
            } else {
                (-g.distance).max(0.0)
            }
        };
        self.touch
            .iter()
            .zip(&self.force)
            .map(misfit)
            .fold(0.0, f64::max)
    }

    fn found(&self) -> Found<'_> {
        Found {
            zone: &self.zone,
            force: &self.force,
            direction: &self.direction,
            cosine: &self.cosine,
            travel: &self.travel,
            touch: &self.touch,
        }
    }

    fn extend(&mut self, lifted: Vec<u32>) {
        let carried: Vec<(u32, f64)> = self
            .zone
            .iter()
            .copied()
            .zip(self.force.iter().copied())
            .collect();
        self.zone.extend(lifted);
        self.zone.sort_unstable();
        let find = |site: &u32| {
            carried
                .binary_search_by_key(site, |c| c.0)
                .map_or(0.0, |k| carried[k].1)
        };
        self.force = self.zone.iter().map(find).collect();
    }

    fn finish(
        mut self,
        (displacement, far_field): (Vec<Vec3>, f64),
        worst: f64,
        tolerance: f64,
    ) -> Solved {
        let is_solved = self.misfit <= tolerance && self.complementarity <= 1e-10;
        self.convergence.has_converged = is_solved && far_field <= FAR_FIELD_TOLERANCE;
        let deepest = self.touch.iter().map(|g| -g.distance).fold(worst, f64::max);
        let bearing = self.direction.iter().zip(&self.cosine);
        Solved {
            bearing: bearing.map(|(d, c)| d * *c).collect(),
            zone: self.zone,
            force: self.force,
            touch: self.touch,
            travel: self.travel,
            slack: self.slack,
            displacement,
            penetration: deepest.max(0.0),
            complementarity: self.complementarity,
            far_field,
            convergence: self.convergence,
        }
    }
}

/// The welded vertex of a site.
pub fn vertex(skin: &Skin, site: u32) -> usize {
    skin.sites.vertex[site as usize] as usize
}
