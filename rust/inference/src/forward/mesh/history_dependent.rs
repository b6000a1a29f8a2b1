//! Predictions with history dependence: each protocol is run moment by moment from rest.

use rayon::prelude::*;
use thenar_contact::effects::Effect;
use thenar_contact::instrument::Placement;
use thenar_contact::{
    ActiveEffect, Control, Demand, Keep, Material, Pressing, Protocol, Row, Run, Step, Workspace,
};
use thenar_surface::Vec3;

use crate::errors::InferenceError;
use crate::forward::mesh::at_skin::AtSkin;
use crate::forward::mesh::mat_reading::{misplaced, slid};
use crate::forward::mesh::nuisance::{At, Nuisance};
use crate::forward::mesh::press_key::Key;
use crate::forward::mesh::replay::{Followed, Replay};
use crate::observe::measured::Moment;
use crate::observe::study::across;

/// Shortest time in which a recording that begins in the skin got there, s.
const QUICKEST: f64 = 1e-3;
/// Presses that stand for use before a recording, at most: softening has long come to rest.
const MOST_USED: usize = 10;
/// Runs kept for each recording.
const MOST_KEPT: usize = 6;

/// A protocol that is to be followed.
struct Task {
    recording: usize,
    key: Key,
    /// By moment, a force over `scale`.
    demands: Vec<Demand>,
    placement: Placement,
    /// Loading travel that the tissue has behind it, mm.
    used_mm: f64,
    /// Moduli over those of the key.
    scale: f64,
}

impl Replay {
    /// What a model that remembers says: the recording's own protocol, moment by moment, from rest.
    ///
    /// Where no effect has a force of its own, all forces grow with the moduli: one run serves all moduli of one proportion.
    pub(crate) fn follow(
        &mut self,
        recording: usize,
        at: At<'_>,
        control: &Control<'_>,
    ) -> Result<AtSkin, InferenceError> {
        let task = self.task(recording, at);
        let found = match self.known(&task) {
            Some(found) => found,
            None => {
                self.run_all(vec![task], control)?;
                let task = self.task(recording, at);
                self.known(&task).ok_or(InferenceError::Cancelled)?
            }
        };
        Ok(found)
    }

    /// Follows several protocols at once, those that are not known, so that later predictions find them; the same bits on any
    /// number of threads.
    ///
    /// # Errors
    /// What the contact model says of a press, or `Cancelled`.
    pub(crate) fn follow_ahead(
        &mut self,
        (materials, nuisances): (&[Material], &[Nuisance]),
        is_used: &[bool],
        control: &Control<'_>,
    ) -> Result<(), InferenceError> {
        if !self.remembers() {
            return Ok(());
        }
        let has_samples = |r: &usize| !self.observed.measured[*r].samples.is_empty();
        let used = (0..is_used.len())
            .filter(|&r| is_used[r])
            .filter(has_samples);
        let tasks = used.map(|r| self.task(r, (materials, &nuisances[r])));
        let unknown = tasks.filter(|task| self.known(task).is_none()).collect();
        self.run_all(unknown, control)
    }

    fn task(&self, recording: usize, (materials, nuisance): At<'_>) -> Task {
        let scale = match self.effects.iter().all(grows_with_modulus) {
            true => materials[0].g0_mpa / self.tissue.materials[0].g0_mpa,
            false => 1.0,
        };
        let materials = materials.iter().map(|material| Material {
            g0_mpa: material.g0_mpa / scale,
            g_lim_mpa: material.g_lim_mpa / scale,
            ..*material
        });
        Task {
            recording,
            key: Key {
                materials: materials.collect(),
                effects: self.effects.clone(),
            },
            demands: over(self.demands(recording, nuisance), scale),
            placement: misplaced(nuisance.placement, &self.instrument),
            used_mm: self.used_before_mm[recording],
            scale,
        }
    }

    fn known(&self, task: &Task) -> Option<AtSkin> {
        let is_alike = |f: &&Followed| {
            f.key == task.key
                && f.placement == task.placement
                && f.used_mm == task.used_mm
                && f.demands == task.demands
        };
        let found = self.followed[task.recording].iter().find(is_alike)?;
        Some(found.at_skin.clone().scaled(task.scale))
    }

    /// Runs tasks with one skin, and keeps what comes of them.
    fn run_all(&mut self, tasks: Vec<Task>, control: &Control<'_>) -> Result<(), InferenceError> {
        let Some(first) = tasks.first() else {
            return Ok(());
        };
        let title = self.places[self.place_of[first.recording]].title.clone();
        self.turn_skin(&first.key, (&title, control))?;
        let share = tasks.len().div_ceil(rayon::current_num_threads().max(1));
        let of_share = |tasks: &[Task]| -> Result<Vec<AtSkin>, InferenceError> {
            // A workspace keeps only what saves time: an empty one gives the same bits.
            let mut workspace = Workspace::default();
            tasks
                .iter()
                .map(|task| self.run(workspace.on(&self.tissue.skin), task, control))
                .collect()
        };
        let found: Vec<Vec<AtSkin>> = tasks
            .par_chunks(share)
            .map(of_share)
            .collect::<Result<_, InferenceError>>()?;
        for (task, at_skin) in tasks.into_iter().zip(found.into_iter().flatten()) {
            let kept = &mut self.followed[task.recording];
            if kept.len() == MOST_KEPT {
                kept.remove(0);
            }
            kept.push(Followed {
                key: task.key,
                demands: task.demands,
                placement: task.placement,
                used_mm: task.used_mm,
                at_skin,
            });
        }
        Ok(())
    }

    /// Follows a protocol with the skin as it is.
    fn run(
        &self,
        mut skin: Pressing<'_>,
        task: &Task,
        control: &Control<'_>,
    ) -> Result<AtSkin, InferenceError> {
        let recording = task.recording;
        let measured = &self.observed.measured[recording];
        let place = &self.places[self.place_of[recording]];
        let rows = rows(&measured.moments, (&task.demands, task.used_mm));
        let added = rows.len() - measured.moments.len();
        let protocol = Protocol {
            rows,
            direction: Some(place.direction),
        };
        let run = Run {
            product: &place.tool,
            posed: None,
            protocol: &protocol,
            keep: match self.readers[recording] {
                Some(_) => Keep::Loads,
                None => Keep::Totals,
            },
        };
        let quiet = Control {
            cancelled: control.cancelled,
            progress: &|_, _| {},
        };
        let what = format!("recording '{}'", measured.name);
        let course = skin.run(&run, &quiet);
        let course = course.map_err(InferenceError::of_contact(what))?;
        let steps = &course.steps[added..];
        let x = across(place.direction);
        let frames = match &self.readers[recording] {
            Some(reader) => {
                let read = |(step, moment): (&Step, &Moment)| {
                    let at = slid(task.placement, reader.sensels(), &moment.slide_mm);
                    reader.sensels().read_at(&step.loads, &at)
                };
                steps.iter().zip(&measured.moments).map(read).collect()
            }
            None => Vec::new(),
        };
        Ok(AtSkin {
            force: steps.iter().map(|step| step.force).collect(),
            tangential: steps.iter().map(|step| step.shear.dot(&x)).collect(),
            area: steps.iter().map(|step| step.area).collect(),
            frames,
            displacement: match measured.scan {
                Some(_) => course.last.displacement.clone(),
                None => Vec::new(),
            },
        })
    }
}

/// True for an effect under which all forces grow with the moduli: it has no stiffness and no force of its own.
fn grows_with_modulus(effect: &ActiveEffect) -> bool {
    effect.amplitude == 0.0
        || !matches!(
            effect.effect,
            Effect::StiffSkin | Effect::StiffeningLaw | Effect::Adhesion | Effect::RegionCoupling
        )
}

/// Forces divided: what they reach on a skin so many times softer is what they reach themselves.
fn over(mut demands: Vec<Demand>, scale: f64) -> Vec<Demand> {
    for demand in &mut demands {
        if let Demand::Force(force) = demand {
            *force /= scale;
        }
    }
    demands
}

/// One row a moment; a recording that begins within the skin is led there from first touch at its own speed, and tissue that was used
/// before is pressed as often as that took, at once, as deep as the recording goes.
fn rows(moments: &[Moment], (demands, used_mm): (&[Demand], f64)) -> Vec<Row> {
    let row = |(moment, demand): (&Moment, &Demand)| Row {
        time_s: moment.time_s,
        demand: *demand,
        slide: moment.slide_mm,
    };
    let mut rows: Vec<Row> = moments.iter().zip(demands).map(row).collect();
    if let (Some(first), Some(Demand::Depth(depth))) = (moments.first(), demands.first())
        && *depth > 0.0
    {
        let speed = first.rate_mm_s.max(0.0);
        let seconds = if speed > 0.0 { depth / speed } else { QUICKEST };
        let start = Row {
            time_s: first.time_s - seconds.max(QUICKEST),
            demand: Demand::Depth(0.0),
            slide: Vec3::zeros(),
        };
        rows.insert(0, start);
    }
    let mut all = use_before(&rows, used_mm);
    all.append(&mut rows);
    all
}

/// Presses before the rows that follow, each to their deepest and back, until so much travel is made.
fn use_before(rows: &[Row], used_mm: f64) -> Vec<Row> {
    let deepest = rows.iter().fold(0.0, |deepest, row| match row.demand {
        Demand::Depth(depth) => f64::max(deepest, depth),
        _ => deepest,
    });
    let (Some(first), true) = (rows.first(), used_mm > 0.0 && deepest > 0.0) else {
        return Vec::new();
    };
    let times = ((used_mm / deepest).ceil() as usize).min(MOST_USED);
    let each = (used_mm / times as f64).min(deepest);
    let depths = (0..2 * times).map(|k| if k % 2 == 0 { each } else { 0.0 });
    let before = |k: usize| (2 * times - k) as f64 * QUICKEST;
    let row = |(k, depth): (usize, f64)| Row {
        time_s: first.time_s - before(k),
        demand: Demand::Depth(depth),
        slide: Vec3::zeros(),
    };
    depths.enumerate().map(row).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn use_before_makes_its_travel_and_ends_unloaded() {
        let row = |time_s: f64, depth: f64| Row {
            time_s,
            demand: Demand::Depth(depth),
            slide: Vec3::zeros(),
        };
        let rows = [row(2.0, 0.0), row(3.0, 1.5), row(4.0, 0.2)];
        let before = use_before(&rows, 4.0);
        let depths: Vec<f64> = before
            .iter()
            .map(|row| match row.demand {
                Demand::Depth(depth) => depth,
                _ => f64::NAN,
            })
            .collect();
        let travel: f64 = depths.iter().sum();
        assert!((travel - 4.0).abs() < 1e-12 && depths.iter().all(|d| *d <= 1.5));
        assert_eq!(depths.last(), Some(&0.0));
        assert!(before.windows(2).all(|two| two[1].time_s > two[0].time_s));
        assert!(before.last().is_some_and(|last| last.time_s < 2.0));
        assert!(use_before(&rows, 0.0).is_empty());
    }
}
