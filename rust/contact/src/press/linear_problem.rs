//! The linear contact problem of one pass: the zone's compliance along press directions, for the sites that are solved.

use thenar_surface::Vec3;

use super::live::extrapolation::OuterLoads;
use super::setting::{SolveSetting, vertex};
use super::zone_state::ZoneState;
use crate::response::assembly::compliance;
use crate::response::near_field::directional::DirectionalNearField;
use crate::soft_grip::joint_compliance::{GripRows, Joint};
use crate::soft_grip::yielding::Place;
use crate::solve::{Accuracy, Axes, Compliance, DirectionalCompliance, Part, solve_contact};
use crate::workspace::Pressing;
use crate::{ContactError, Control, Model};

/// The linear problem of the solved sites: directions, weights, likely contacts, and the stored part of their compliance.
pub(crate) struct DirectionalProblem {
    /// Places of the zone.
    places: Vec<u32>,
    axes: Axes,
    weight: Vec<f64>,
    likely: Vec<bool>,
    part: Part,
    /// Near-field entries along the directions, in a live press.
    near: Vec<i16>,
    /// Displacement of each along its direction by loads outside the coupling, over its weight; empty without such loads.
    push: Vec<f64>,
    /// What a soft grip adds to the compliance.
    grip: Option<GripRows>,
}

impl ZoneState {
    /// Directions and outer loads of the compliance; no entry is stored yet.
    pub(crate) fn directional_problem(&self, pressing: &Pressing<'_>) -> DirectionalProblem {
        let places: Vec<u32> = self.solved().into_iter().map(|k| k as u32).collect();
        let direction: Vec<Vec3> = match pressing.skin.model {
            Model::Layer => places.iter().map(|&k| self.direction[k as usize]).collect(),
            Model::Paper => vec![Vec3::x(); places.len()],
        };
        let likely = |&k: &u32| {
            let k = k as usize;
            self.touch[k].distance - self.cosine[k] * self.travel[k] < 0.0
        };
        let axes = Axes::new(&direction);
        let near = match self.beyond {
            OuterLoads::Nothing => Vec::new(),
            _ => pressing.workspace.near.now().turn(&axes),
        };
        DirectionalProblem {
            axes,
            near,
            weight: Vec::new(),
            likely: places.iter().map(likely).collect(),
            part: Part::default(),
            push: self.outer_displacement(pressing, (&places, &direction)),
            grip: None,
            places,
        }
    }

    /// Displacement of the solved places by outer loads: that of the last live press less their own near-field contribution.
    fn outer_displacement(
        &self,
        Pressing { skin, workspace }: &Pressing<'_>,
        (places, direction): (&[u32], &[Vec3]),
    ) -> Vec<f64> {
        let (live_field, near) = (&workspace.live_field, workspace.near.now());
        if self.beyond == OuterLoads::Nothing || !live_field.matches(skin.sites.len()) {
            return Vec::new();
        }
        let ahead = match self.beyond {
            OuterLoads::Trend => 1.0,
            _ => 0.0,
        };
        let load = |&site: &u32| {
            live_field.load[site as usize] + live_field.load_change[site as usize] * ahead
        };
        let loads: Vec<Vec3> = near.sites().iter().map(load).collect();
        let own = near.field(&loads);
        let push = |((&k, t), own): ((&u32, &Vec3), &Vec3)| {
            let site = self.zone[k as usize] as usize;
            t.dot(&(live_field.field[site] + live_field.field_change[site] * ahead - own))
        };
        places.iter().zip(direction).zip(&own).map(push).collect()
    }

    /// Compliance along the directions, seen along the normals: as weights, or written out into the workspace.
    pub(crate) fn matrix(
        &self,
        pressing: &mut Pressing<'_>,
        setting: &SolveSetting<'_>,
        problem: &mut DirectionalProblem,
    ) {
        let weight =
            |&k: &u32| setting.weight[self.zone[k as usize] as usize] * self.cosine[k as usize];
        problem.weight = problem.places.iter().map(weight).collect();
        let (skin, workspace) = (pressing.skin, &mut *pressing.workspace);
        problem.grip = workspace.grip.as_ref().map(|grip| {
            let area = |k: u32| setting.detection.areas[vertex(skin, self.zone[k as usize])];
            let place = |&k: &u32| grip.place(&self.touch[k as usize], area(k));
            grip.rows(&problem.places.iter().map(place).collect::<Vec<Place>>())
        });
        let direction = |&k: &u32| match skin.model {
            Model::Layer => self.direction[k as usize],
            Model::Paper => Vec3::x(),
        };
        if skin.hierarchy.is_some() {
            let along = problem.weight.iter().zip(&problem.places);
            workspace.problem.along = along
                .map(|(w, k)| self.direction[*k as usize] * *w)
                .collect();
        } else if self.beyond == OuterLoads::Nothing && workspace.problem.coupling.is_large() {
            let directions: Vec<Vec3> = problem.places.iter().map(direction).collect();
            compliance(
                &workspace.problem.coupling,
                (&problem.weight, &directions),
                &mut workspace.problem.compliance,
            );
        }
    }

    /// Solves the linear problem of the present gaps, under the loads of reused sites.
    pub(crate) fn solve(
        &mut self,
        pressing: &Pressing<'_>,
        problem: &DirectionalProblem,
        how: (Accuracy, &Control),
    ) -> Result<(), ContactError> {
        let workspace = &pressing.workspace;
        if let Some(matrix) = pressing.far_field_compliance() {
            return self.solve_linear(&matrix, problem, how);
        }
        if self.beyond != OuterLoads::Nothing {
            let near =
                DirectionalNearField::new(workspace.near.now(), &problem.near, &problem.weight);
            return self.solve_linear(&near, problem, how);
        }
        if workspace.problem.coupling.is_large() {
            return self.solve_linear(&workspace.problem.compliance, problem, how);
        }
        let along = DirectionalCompliance::new(
            (&workspace.problem.coupling, &problem.axes),
            (&problem.weight, &problem.likely),
            &problem.part,
        );
        self.solve_linear(&along, problem, how)
    }

    fn solve_linear<M: Compliance>(
        &mut self,
        matrix: &M,
        problem: &DirectionalProblem,
        how: (Accuracy, &Control),
    ) -> Result<(), ContactError> {
        match &problem.grip {
            None => self.solve_with(matrix, problem, how),
            Some(grip) => self.solve_with(&Joint::new(matrix, grip), problem, how),
        }
    }

    fn solve_with<M: Compliance>(
        &mut self,
        matrix: &M,
        problem: &DirectionalProblem,
        (accuracy, control): (Accuracy, &Control),
    ) -> Result<(), ContactError> {
        let place = |i: usize| problem.places[i] as usize;
        let solved = 0..problem.places.len();
        let push = |i: usize| problem.push.get(i).map_or(0.0, |p| p * problem.weight[i]);
        let gap: Vec<f64> = solved
            .clone()
            .map(|i| {
                let k = place(i);
                self.touch[k].distance - self.cosine[k] * self.travel[k] + push(i)
            })
            .collect();
        let force: Vec<f64> = solved.clone().map(|i| self.force[place(i)]).collect();
        let solution = solve_contact(matrix, &gap, Some(&force), (accuracy, control));
        control.check()?;
        for i in solved {
            let k = place(i);
            self.travel[k] = (solution.slack[i] - gap[i] + push(i)) / self.cosine[k];
            (self.force[k], self.slack[k]) = (solution.force[i], solution.slack[i]);
        }
        self.convergence.pivots += solution.pivots;
        self.convergence.cg_steps += solution.steps;
        self.complementarity = solution.complementarity;
        Ok(())
    }
}
