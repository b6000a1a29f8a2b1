//! The linear contact problem of a zone: its compliance along directions, in whole or for the places that are not held.

use thenar_surface::Vec3;

use super::live::extrapolation::Beyond;
use super::setting::Setting;
use super::zone_state::State;
use crate::response::assembly::compliance;
use crate::response::near_field::directional::NearAlong;
use crate::skin::prepare::Skin;
use crate::solve::{Accuracy, Along, Axes, Compliance, Part, solve_contact};
use crate::{ContactError, Control, Model};

/// Directions, weights and likely contacts of the places that are solved, and the part of their compliance that is stored.
pub(crate) struct Turned {
    /// Places of the zone.
    places: Vec<u32>,
    axes: Axes,
    weight: Vec<f64>,
    likely: Vec<bool>,
    part: Part,
    /// Entries of the near coupling along the directions, in a live press.
    near: Vec<i16>,
    /// What forces beyond the coupling do to each along its direction, over its weight; empty where there are none.
    push: Vec<f64>,
}

impl State {
    /// What the compliance is made of besides the coupling; nothing stored yet.
    pub(crate) fn turned(&self, skin: &Skin) -> Turned {
        let places: Vec<u32> = self.solved().into_iter().map(|k| k as u32).collect();
        let direction: Vec<Vec3> = match skin.model {
            Model::Layer => places.iter().map(|&k| self.direction[k as usize]).collect(),
            Model::Paper => vec![Vec3::x(); places.len()],
        };
        let likely = |&k: &u32| {
            let k = k as usize;
            self.touch[k].distance - self.cosine[k] * self.travel[k] < 0.0
        };
        let axes = Axes::new(&direction);
        let near = match self.beyond {
            Beyond::Nothing => Vec::new(),
            _ => skin.memory.near.now().turn(&axes),
        };
        Turned {
            axes,
            near,
            weight: Vec::new(),
            likely: places.iter().map(likely).collect(),
            part: Part::default(),
            push: self.push_from_beyond(skin, (&places, &direction)),
            places,
        }
    }

    /// What the last live press shows at the solved places, less what these did to themselves and each other nearby.
    fn push_from_beyond(&self, skin: &Skin, (places, direction): (&[u32], &[Vec3])) -> Vec<f64> {
        let (shown, near) = (&skin.memory.shown, skin.memory.near.now());
        if self.beyond == Beyond::Nothing || !shown.is_of(skin.sites.len()) {
            return Vec::new();
        }
        let ahead = match self.beyond {
            Beyond::Trend => 1.0,
            _ => 0.0,
        };
        let load =
            |&site: &u32| shown.load[site as usize] + shown.load_change[site as usize] * ahead;
        let loads: Vec<Vec3> = near.sites().iter().map(load).collect();
        let own = near.field(&loads);
        let push = |((&k, t), own): ((&u32, &Vec3), &Vec3)| {
            let site = self.zone[k as usize] as usize;
            t.dot(&(shown.field[site] + shown.field_change[site] * ahead - own))
        };
        places.iter().zip(direction).zip(&own).map(push).collect()
    }

    /// Compliance along the directions, seen along the normals: as weights, or written out into the skin's memory.
    pub(crate) fn matrix(&self, skin: &mut Skin, setting: &Setting<'_>, turned: &mut Turned) {
        let weight =
            |&k: &u32| setting.weight[self.zone[k as usize] as usize] * self.cosine[k as usize];
        turned.weight = turned.places.iter().map(weight).collect();
        let memory = &mut skin.memory;
        let direction = |&k: &u32| match skin.model {
            Model::Layer => self.direction[k as usize],
            Model::Paper => Vec3::x(),
        };
        if skin.hierarchy.is_some() {
            let along = turned.weight.iter().zip(&turned.places);
            memory.along = along
                .map(|(w, k)| self.direction[*k as usize] * *w)
                .collect();
        } else if self.beyond == Beyond::Nothing && memory.coupling.is_large() {
            let directions: Vec<Vec3> = turned.places.iter().map(direction).collect();
            compliance(
                &memory.coupling,
                (&turned.weight, &directions),
                &mut memory.compliance,
            );
        }
    }

    /// Solves the linear problem of the present gaps, under what held places do to those that are solved.
    pub(crate) fn solve(
        &mut self,
        skin: &Skin,
        turned: &Turned,
        how: (Accuracy, &Control),
    ) -> Result<(), ContactError> {
        let memory = &skin.memory;
        if let Some(matrix) = skin.directed() {
            return self.solve_linear(&matrix, turned, how);
        }
        if self.beyond != Beyond::Nothing {
            let near = NearAlong::new(memory.near.now(), &turned.near, &turned.weight);
            return self.solve_linear(&near, turned, how);
        }
        if memory.coupling.is_large() {
            return self.solve_linear(&memory.compliance, turned, how);
        }
        let along = Along::new(
            (&memory.coupling, &turned.axes),
            (&turned.weight, &turned.likely),
            &turned.part,
        );
        self.solve_linear(&along, turned, how)
    }

    fn solve_linear<M: Compliance>(
        &mut self,
        matrix: &M,
        turned: &Turned,
        (accuracy, control): (Accuracy, &Control),
    ) -> Result<(), ContactError> {
        let place = |i: usize| turned.places[i] as usize;
        let solved = 0..turned.places.len();
        let push = |i: usize| turned.push.get(i).map_or(0.0, |p| p * turned.weight[i]);
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
