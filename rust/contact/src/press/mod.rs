//! Conducts a press: detection, active zone, response, solve, fields.

pub mod displacement_field;
pub mod force_control;
pub mod linear_problem;
pub mod live;
pub mod paper_model;
pub mod relinearize;
pub mod zone_response;
pub mod zone_state;

use std::time::Instant;

use thenar_surface::{Mesh, Product, Vec3};

use crate::api::{Contact, Press, Start, Unsolved};
use crate::detection::gaps::{
    Detection, check_resolution, detect, kept_stiffness, pressed_thickness, serving,
};
use crate::effects::stiffening_law::shear_moduli;
use crate::fields::merged_vertices::put_out;
use crate::fields::summary::summarize;
use crate::fields::warnings::Warning;
use crate::history::displaced_posture::{Moved, moved, restore};
use crate::history::tissue_memory::Recall;
use crate::interface::adhesion::{Attraction, Clinging, MOST_SOLVES, Pull, steady};
use crate::interface::friction;
use crate::interface::friction::{Grasp, Sheared};
use crate::press::force_control::find_offset;
use crate::press::relinearize::{Setting, Solved, solve};
use crate::skin::prepare::Skin;
use crate::solve::Accuracy;
use crate::workspace::{Last, Trail};
use crate::{ContactError, Control, Model};

/// Share of a force target that may be missed without a word.
const FORCE_MISS: f64 = 1e-3;

/// Wall time by stage, s.
pub(crate) type Seconds = Vec<(&'static str, f64)>;

/// One solved position of the product.
#[derive(Clone)]
pub(crate) struct Pressed {
    pub detection: Detection,
    pub solved: Solved,
    /// Shear modulus by region, MPa.
    pub shear_modulus: Vec<f64>,
    /// Effective shear modulus by site, blended, MPa.
    pub modulus_at: Vec<f64>,
    /// What memory did to it, if the tissue remembers.
    pub recalled: Option<Recalled>,
    /// What attracts skin and product.
    pub clinging: Clinging,
    /// What friction made of a drag.
    pub shear: Option<Sheared>,
}

/// What a solve starts from.
struct State<'a> {
    product: &'a Product,
    truth: &'a Detection,
    recall: Option<&'a Recall>,
    /// Response weight by site.
    weight: &'a [f64],
}

/// The memory's part in a press.
#[derive(Clone)]
pub(crate) struct Recalled {
    pub recall: Recall,
    /// What each site of the zone bears, and what attraction pulls at, in the elastic tissue's terms, N.
    pub bearing: Vec<(u32, Vec3)>,
    /// True where attraction holds skin and product together, by region.
    pub clings: Vec<bool>,
}

impl Pressed {
    /// True if the contact is within its tolerances, and the attraction with it.
    pub fn has_converged(&self) -> bool {
        self.solved.convergence.has_converged && self.clinging.is_settled
    }

    /// Force on the skin along `direction`, N.
    pub fn force_along(&self, direction: &Vec3) -> f64 {
        self.force_on_skin().dot(direction)
    }

    /// Sum of the normal forces on the skin, attraction taken off, N.
    pub fn force_on_skin(&self) -> Vec3 {
        let forces = self.solved.force.iter().zip(&self.solved.touch);
        let pushed: Vec3 = forces.map(|(f, g)| g.normal * *f).sum();
        if self.clinging.pulls.is_empty() {
            return pushed;
        }
        pushed + self.clinging.force()
    }
}

impl Skin {
    /// Presses the prepared skin, in rest or posed, against a product.
    ///
    /// # Errors
    /// [`ContactError`]: a posture that does not fit the skin, skin swallowed by the product, a force that is out of reach,
    /// or `Cancelled`. The prepared skin stays usable after any of them.
    pub fn press(&mut self, press: &Press<'_>, control: &Control) -> Result<Contact, ContactError> {
        if press.start == Start::Fresh {
            self.memory.trail = Trail::default();
        }
        self.memory.trail.pulls.clear();
        self.memory.trail.accuracy = match press.start {
            Start::Live => Accuracy::Rough,
            Start::Fresh | Start::Warm => Accuracy::Full,
        };
        let mut seconds = Seconds::new();
        let posed = self.posed(press.posed)?;
        let (offset, direction, mut pressed) = match press.force {
            None => {
                let pressed = self.press_at(
                    &posed,
                    (press.product, Vec3::zeros()),
                    (control, &mut seconds),
                )?;
                let direction = pressed
                    .force_on_skin()
                    .try_normalize(0.0)
                    .unwrap_or_else(Vec3::zeros);
                (0.0, direction, pressed)
            }
            Some(target) => find_offset(
                self,
                (&posed, press.product),
                target,
                (control, &mut seconds),
            )?,
        };
        if press.unsolved == Unsolved::Refuse
            && let Some(refusal) = pressed.solved.refusal(self)
        {
            // What is known of it starts no other press.
            self.memory.trail = Trail::default();
            return Err(refusal);
        }
        if let Some(drag) = press.drag {
            let started = Instant::now();
            let from_rest = (drag, &Grasp::default());
            friction::drag(self, &mut pressed, from_rest, control)?;
            friction::move_skin(self, press.product, &mut pressed);
            add_time(&mut seconds, "friction", started);
        }
        control.step("fields", 0.0)?;
        let started = Instant::now();
        let mut contact = summarize(self, (&posed, press.product), &pressed, (offset, direction));
        put_out(self, press, direction * offset, &mut contact);
        add_time(&mut seconds, "fields", started);
        if let Some(target) = press.force {
            let reached = pressed.force_along(&contact.direction);
            if (reached - target.newton).abs() > FORCE_MISS * target.newton {
                contact.warnings.push(Warning::ForceLeaps {
                    asked: target.newton,
                    reached,
                });
            }
        }
        contact.seconds = seconds;
        self.remember(&pressed, offset);
        control.step("fields", 1.0)?;
        Ok(contact)
    }

    /// Solves with the product moved by `shift` (mm).
    pub(crate) fn press_at(
        &mut self,
        posed: &Mesh,
        (product, shift): (&Product, Vec3),
        (control, seconds): (&Control, &mut Seconds),
    ) -> Result<Pressed, ContactError> {
        control.step("distances", 0.0)?;
        let started = Instant::now();
        let truth = detect(self, posed, product, shift)?;
        add_time(seconds, "distances", started);
        let started = Instant::now();
        let mut shear_modulus = shear_moduli(self, &self.tissue.laws, &truth);
        let recall = self.recall(&truth);
        if let Some(recall) = &recall {
            recall.soften(&mut shear_modulus);
        }
        let effective = self.effective_moduli(&shear_modulus, &truth);
        let (mut weight, mut modulus_at) = self.weights(&effective);
        self.tissue.scale(&mut weight, &mut modulus_at);
        let attraction = Attraction::new(self);
        add_time(seconds, "response", started);
        let started = Instant::now();
        let state = State {
            product,
            truth: &truth,
            recall: recall.as_ref(),
            weight: &weight,
        };
        let (mut solved, clinging) = match &attraction {
            None => (self.solve_moved(&state, &[], control)?, Clinging::none()),
            Some(attraction) => self.solve_clinging(attraction, &state, control)?,
        };
        let recalled = recall.map(|recall| {
            let mut bearing = restore(self, &mut solved, &mut modulus_at, &recall);
            let mut clings = vec![false; recall.at_once.len()];
            for pull in &clinging.pulls {
                bearing.push(self.elastic(pull, &recall));
                clings[self.sites.home_region(pull.site as usize) as usize] = true;
            }
            Recalled {
                recall,
                bearing,
                clings,
            }
        });
        add_time(seconds, "solve", started);
        Ok(Pressed {
            detection: truth,
            solved,
            shear_modulus,
            modulus_at,
            recalled,
            clinging,
            shear: None,
        })
    }

    /// Solves in the posture that memory and attraction make of the true one.
    fn solve_moved(
        &mut self,
        state: &State<'_>,
        pulls: &[Pull],
        control: &Control,
    ) -> Result<Solved, ContactError> {
        let moved = self.moved_posture(state, pulls, control)?;
        let detection = moved.as_ref().map_or(state.truth, |moved| &moved.detection);
        let zone = serving(self, detection);
        check_resolution(self, &zone)?;
        let last = std::mem::take(&mut self.memory.trail.last);
        let elastic = state.recall.map(|recall| Last {
            force: recall.elastic(&last.force, &self.sites),
            travel: Vec::new(),
        });
        let start = elastic.as_ref().unwrap_or(&last);
        let setting = Setting {
            product: state.product,
            detection,
            weight: state.weight,
            start: (start.force.len() == self.sites.len()).then_some(start),
            // What moves besides the product is solved to the end.
            accuracy: match &moved {
                None => self.memory.trail.accuracy,
                Some(_) => Accuracy::Full,
            },
            spacing: self.spacing,
        };
        let solved = solve(self, zone, &setting, control);
        self.memory.trail.last = last;
        let mut solved = solved?;
        if let Some(moved) = &moved {
            moved.add_to(&mut solved);
        }
        Ok(solved)
    }

    fn moved_posture(
        &mut self,
        state: &State<'_>,
        pulls: &[Pull],
        control: &Control,
    ) -> Result<Option<Moved>, ContactError> {
        if state.recall.is_none() && pulls.is_empty() {
            return Ok(None);
        }
        let pulled: Vec<u32> = pulls.iter().map(|pull| pull.site).collect();
        if self.hierarchy.is_none() {
            self.response.make_rows(&pulled, &self.sites);
        }
        let mut loads = state
            .recall
            .map_or_else(Vec::new, |recall| recall.loads.clone());
        for pull in pulls {
            loads.push(match state.recall {
                Some(recall) => self.elastic(pull, recall),
                None => (pull.site, pull.load()),
            });
        }
        let mut moved = moved(
            self,
            state.product,
            (state.truth, &loads),
            (state.weight, control),
        )?;
        if !pulls.is_empty() {
            moved.detection.deepen(self);
        }
        Ok(Some(moved))
    }

    /// What an attraction is in the elastic tissue's terms: borne at once by what has not yet faded, N.
    fn elastic(&self, pull: &Pull, recall: &Recall) -> (u32, Vec3) {
        let region = self.sites.home_region(pull.site as usize) as usize;
        (pull.site, pull.load() / recall.at_once[region])
    }

    /// Finds attraction and contact together, from the attraction of the step before.
    fn solve_clinging(
        &mut self,
        attraction: &Attraction,
        state: &State<'_>,
        control: &Control,
    ) -> Result<(Solved, Clinging), ContactError> {
        let mut pulls = self.memory.trail.pulls.clone();
        for solve in 1.. {
            let solved = self.solve_moved(state, &pulls, control)?;
            let mut next = attraction.pulls(self, (state.product, state.truth), &solved);
            steady(&pulls, &mut next, solve);
            let is_settled = attraction.is_settled(&pulls, &next);
            if is_settled || solve == MOST_SOLVES {
                return Ok((solved, Clinging { pulls, is_settled }));
            }
            pulls = next;
            if state.recall.is_none() {
                self.memory.trail.last = Last {
                    travel: Vec::new(),
                    ..Last::of(&solved, self.sites.len())
                };
            }
        }
        Err(ContactError::Cancelled)
    }

    /// What the tissue remembers of the steps before, if a protocol is followed.
    fn recall(&self, detection: &Detection) -> Option<Recall> {
        let history = self.history.as_ref()?;
        Some(history.recall(&detection.max_penetration, &self.sites))
    }

    /// Moduli with what escapes sideways in deep presses taken off; model layer only.
    fn effective_moduli(&self, shear_modulus: &[f64], detection: &Detection) -> Vec<f64> {
        let thickness = pressed_thickness(self, detection);
        let kept = |(thickness, depth): (&f64, &f64)| match self.model {
            Model::Layer => kept_stiffness(*thickness, *depth),
            Model::Paper => 1.0,
        };
        let kept = thickness.iter().zip(&detection.max_penetration).map(kept);
        shear_modulus
            .iter()
            .zip(kept)
            .map(|(g, kept)| g * kept)
            .collect()
    }

    /// Response weight of every site of skin that nothing presses.
    pub(crate) fn rest_weights(&self) -> Vec<f64> {
        let moduli: Vec<f64> = self.tissue.materials.iter().map(|m| m.g0_mpa).collect();
        let (mut weight, mut modulus_at) = self.weights(&moduli);
        self.tissue.scale(&mut weight, &mut modulus_at);
        weight
    }

    /// Response weight sqrt((1 - nu) / (2 pi G)) and modulus of every site; blended over creases in model layer.
    fn weights(&self, shear_modulus: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let softness: Vec<f64> = self
            .tissue
            .materials
            .iter()
            .zip(shear_modulus)
            .map(|(m, g)| (1.0 - m.poisson_ratio) / (std::f64::consts::TAU * g))
            .collect();
        let of_region = |values: &[f64]| match self.model {
            Model::Layer => self.sites.blended(values),
            Model::Paper => self
                .sites
                .region
                .iter()
                .map(|&r| values.get(r as usize).copied().unwrap_or(0.0))
                .collect(),
        };
        let weight = of_region(&softness).into_iter().map(f64::sqrt).collect();
        (weight, of_region(shear_modulus))
    }

    pub(crate) fn remember(&mut self, pressed: &Pressed, offset: f64) {
        self.memory.trail.last = Last::of(&pressed.solved, self.sites.len());
        self.memory.trail.offset = offset;
        self.memory.trail.pulls.clone_from(&pressed.clinging.pulls);
    }
}

/// Adds the time since `started` to a stage.
pub(crate) fn add_time(seconds: &mut Seconds, stage: &'static str, started: Instant) {
    let elapsed = started.elapsed().as_secs_f64();
    match seconds.iter_mut().find(|s| s.0 == stage) {
        Some(entry) => entry.1 += elapsed,
        None => seconds.push((stage, elapsed)),
    }
}
