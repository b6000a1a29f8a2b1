//! The linear contact problem of a zone: its compliance along directions, in whole or for the places that are not held.

use thenar_surface::Vec3;

use crate::contact_state::State;
use crate::linearize::Setting;
use crate::response::assembly::compliance;
use crate::skin::Skin;
use crate::solve::operator::Rows;
use crate::solve::{Accuracy, Along, Axes, Compliance, Part, solve_contact};
use crate::{ContactError, Control, Model};

/// Directions, weights and likely contacts of a zone, and the part of its compliance that is stored.
pub(crate) struct Turned {
    pub axes: Axes,
    pub weight: Vec<f64>,
    pub likely: Vec<bool>,
    pub part: Part,
    /// What is solved, where the rest is held.
    pub open: Option<Open>,
}

/// Places of a zone that are solved while the others are held, and the same of them.
pub(crate) struct Open {
    places: Vec<u32>,
    coupling: Rows<f32>,
    axes: Axes,
    likely: Vec<bool>,
    part: Part,
}

impl State {
    /// What the compliance is made of besides the coupling; nothing stored yet.
    pub(crate) fn turned(&self, skin: &Skin) -> Turned {
        let axes = match skin.model {
            Model::Layer => Axes::new(&self.direction),
            Model::Paper => Axes::new(&vec![Vec3::x(); self.zone.len()]),
        };
        let likely = self.touch.iter().zip(&self.cosine).zip(&self.travel);
        let likely: Vec<bool> = likely.map(|((g, c), u)| g.distance - c * u < 0.0).collect();
        let open = (!self.held.is_empty()).then(|| {
            let places: Vec<u32> = self.solved().into_iter().map(|k| k as u32).collect();
            Open {
                coupling: skin.memory.coupling.principal(&places),
                axes: axes.of(&places),
                likely: places.iter().map(|&k| likely[k as usize]).collect(),
                part: Part::default(),
                places,
            }
        });
        Turned {
            axes,
            weight: Vec::new(),
            likely,
            part: Part::default(),
            open,
        }
    }

    /// Compliance along the directions, seen along the normals: as weights, or written out into the skin's memory.
    pub(crate) fn matrix(&self, skin: &mut Skin, setting: &Setting<'_>, turned: &mut Turned) {
        let weight = |(&site, cosine): (&u32, &f64)| setting.weight[site as usize] * cosine;
        let weights: Vec<f64> = self.zone.iter().zip(&self.cosine).map(weight).collect();
        let memory = &mut skin.memory;
        if skin.hierarchy.is_some() {
            let along = weights.iter().zip(&self.direction);
            memory.along = along.map(|(w, t)| t * *w).collect();
            return;
        }
        if !memory.coupling.is_large() {
            turned.weight = weights;
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

    /// Solves the linear problem of the present gaps.
    pub(crate) fn solve(
        &mut self,
        skin: &Skin,
        turned: &Turned,
        (accuracy, control): (Accuracy, &Control),
    ) -> Result<(), ContactError> {
        let memory = &skin.memory;
        if let Some(matrix) = skin.directed() {
            return self.solve_linear(&matrix, (accuracy, control));
        }
        if memory.coupling.is_large() {
            return self.solve_linear(&memory.compliance, (accuracy, control));
        }
        let Turned {
            axes,
            weight,
            likely,
            part,
            open: part_of,
        } = turned;
        let along = Along::new((&memory.coupling, axes), (weight, likely), part);
        match part_of {
            None => self.solve_linear(&along, (accuracy, control)),
            Some(open) => self.solve_open((&along, weight), open, (accuracy, control)),
        }
    }

    /// Solves the places that are not held, under what those that are held do to them.
    fn solve_open(
        &mut self,
        (along, weight): (&Along<'_>, &[f64]),
        open: &Open,
        (accuracy, control): (Accuracy, &Control),
    ) -> Result<(), ContactError> {
        let pick = |values: &[f64]| -> Vec<f64> {
            open.places.iter().map(|&k| values[k as usize]).collect()
        };
        let mut held = self.force.clone();
        open.places.iter().for_each(|&k| held[k as usize] = 0.0);
        let mut push = vec![0.0; open.places.len()];
        along.times_rows(&open.places, &held, &mut push);
        let gap = |(&k, push): (&u32, &f64)| {
            let k = k as usize;
            self.touch[k].distance - self.cosine[k] * self.travel[k] + push
        };
        let gap: Vec<f64> = open.places.iter().zip(&push).map(gap).collect();
        let weight = pick(weight);
        let matrix = Along::new(
            (&open.coupling, &open.axes),
            (&weight, &open.likely),
            &open.part,
        );
        let force = pick(&self.force);
        let solution = solve_contact(&matrix, &gap, Some(&force), (accuracy, control));
        control.check()?;
        for (i, &k) in open.places.iter().enumerate() {
            let k = k as usize;
            let carried = solution.slack[i] - gap[i] + push[i];
            self.travel[k] = carried / self.cosine[k];
            (self.force[k], self.slack[k]) = (solution.force[i], solution.slack[i]);
        }
        self.convergence.pivots += solution.pivots;
        self.convergence.cg_steps += solution.steps;
        self.complementarity = solution.complementarity;
        Ok(())
    }

    fn solve_linear<M: Compliance>(
        &mut self,
        matrix: &M,
        (accuracy, control): (Accuracy, &Control),
    ) -> Result<(), ContactError> {
        let gap: Vec<f64> = (0..self.zone.len())
            .map(|k| self.touch[k].distance - self.cosine[k] * self.travel[k])
            .collect();
        let solution = solve_contact(matrix, &gap, Some(&self.force), (accuracy, control));
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
}
