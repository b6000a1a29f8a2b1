//! Internal variables of the tissue: elastic and fading loads by site; softening, depth and contact radius by region.

use nalgebra::Rotation3;
use thenar_surface::Vec3;

use super::memory_branches::{Branch, Branches, Clock, Shares};
use crate::effects::definition::active::in_order;
use crate::effects::{ActiveEffect, Effect, cycle_softening, drainage};
use crate::skin::sites::Sites;

/// Steps shorter than this share of a branch's period are taken by the series of the closed form.
const SHORT_STEP: f64 = 1e-4;

/// Load below which a site has forgotten, N: 1e-7 of a light touch on one vertex.
const FAINT: f64 = 1e-10;

/// Internal variables of the tissue.
#[derive(Debug, Clone)]
pub struct TissueMemory {
    branches: Branches,
    /// What fades and lasts of the load of the last step.
    shares: Shares,
    softening: Vec<Softening>,
    /// Sites with a memory, ascending.
    touched: Vec<u32>,
    /// Load an elastic tissue would bear, by site, N.
    elastic: Vec<Vec3>,
    /// What is left of it in each branch, by site, N.
    fading: Vec<Vec<Vec3>>,
    /// Largest depth at the last step, by region, mm.
    depth: Vec<f64>,
    /// Last contact radius, by region, mm: clocks go by it where nothing touches, too.
    radius: Vec<f64>,
    /// Contact radius at the last step, by region, mm; none where nothing touched. Shares go by it.
    touching: Vec<f64>,
    /// True where skin clung to the product at the last step, by region.
    clings: Vec<bool>,
    /// Length of the step being taken, s.
    pub seconds: f64,
}

/// Cycle softening with its internal variable by region.
#[derive(Debug, Clone)]
struct Softening {
    effect: ActiveEffect,
    used: Vec<f64>,
}

/// A branch over a step.
#[derive(Debug, Clone, Copy)]
struct Fade {
    decay: f64,
    new: f64,
    old: f64,
}

impl Fade {
    /// Over a step of so many periods, with the branch's share of the load at its end and before it.
    ///
    /// The branch takes up what its share of the load grows by, and that is all that it holds: load that is put on fast is borne whole,
    /// whatever becomes of the shares meanwhile.
    fn over(x: f64, (now, before): (f64, f64)) -> Fade {
        let mean = if x < SHORT_STEP {
            1.0 - 0.5 * x
        } else {
            -(-x).exp_m1() / x
        };
        Fade {
            decay: (-x).exp(),
            new: now * mean,
            old: before * mean,
        }
    }
}

/// What the memory means for the step being taken.
#[derive(Debug, Clone)]
pub struct MemoryStep {
    /// Share of the elastic load that acts at the end of the step, by region.
    pub instantaneous: Vec<f64>,
    /// Factor of the modulus, by region.
    pub softness: Vec<f64>,
    /// Load, in the elastic tissue's terms, that moves the posture before the step, by site.
    pub loads: Vec<(u32, Vec3)>,
    /// True where the product leaves, by region.
    pub is_left: Vec<bool>,
    /// Decay over the step, and parts of the load at its end and of that before it which a branch takes up and gives off, by branch
    /// and region.
    fade: Vec<Vec<Fade>>,
    shares: Shares,
    used: Vec<Vec<f64>>,
    depth: Vec<f64>,
}

impl MemoryStep {
    /// Multiplies the moduli by region with what use has left of them.
    pub fn soften(&self, shear_modulus: &mut [f64]) {
        shear_modulus
            .iter_mut()
            .zip(&self.softness)
            .for_each(|(g, left)| *g *= left);
    }

    /// Forces by site in the elastic tissue's terms, for a start; empty stays empty.
    pub fn elastic(&self, force: &[f64], sites: &Sites) -> Vec<f64> {
        let scaled = |(site, force): (usize, &f64)| {
            force / self.instantaneous[sites.home_region(site) as usize]
        };
        force.iter().enumerate().map(scaled).collect()
    }
}

impl TissueMemory {
    /// Tissue of that thickness by region (mm) that was never pressed. None if no effect has memory.
    pub fn new(effects: &[ActiveEffect], thickness: &[f64], sites: usize) -> Option<TissueMemory> {
        let regions = thickness.len();
        let branches = Branches::new(effects, thickness);
        let softening: Vec<Softening> = in_order(effects)
            .into_iter()
            .filter(|e| e.effect == Effect::CycleSoftening)
            .map(|e| Softening {
                effect: e.clone(),
                used: vec![0.0; regions],
            })
            .collect();
        if branches.all.is_empty() && softening.is_empty() {
            return None;
        }
        Some(TissueMemory {
            fading: vec![vec![Vec3::zeros(); sites]; branches.all.len()],
            shares: branches.shares(&vec![0.0; regions]),
            branches,
            softening,
            touched: Vec::new(),
            elastic: vec![Vec3::zeros(); sites],
            depth: vec![0.0; regions],
            radius: vec![0.0; regions],
            touching: vec![0.0; regions],
            clings: vec![false; regions],
            seconds: 0.0,
        })
    }

    /// What the memory means for a step that brings the regions to `depth` (mm).
    pub fn recall(&self, depth: &[f64], sites: &Sites) -> MemoryStep {
        let shares = match self.branches.is_sized() {
            true => self.branches.shares(&self.touching),
            false => self.shares.clone(),
        };
        let fade = |(number, branch): (usize, &Branch)| -> Vec<Fade> {
            let (now, before) = (&shares.fading[number], &self.shares.fading[number]);
            let one = |r: usize| Fade::over(self.passed(branch, r, depth[r]), (now[r], before[r]));
            (0..depth.len()).map(one).collect()
        };
        let fade: Vec<Vec<Fade>> = self.branches.all.iter().enumerate().map(fade).collect();
        let mut instantaneous = shares.lasting.clone();
        for of_region in &fade {
            instantaneous
                .iter_mut()
                .zip(of_region)
                .for_each(|(a, fade)| *a += fade.new);
        }
        let load = |&site: &u32| {
            let (region, i) = (sites.home_region(site as usize) as usize, site as usize);
            let mut rest = Vec3::zeros();
            for (branch, of_region) in self.fading.iter().zip(&fade) {
                let fade = of_region[region];
                rest += branch[i] * fade.decay - self.elastic[i] * fade.old;
            }
            (site, -rest / instantaneous[region])
        };
        let used: Vec<Vec<f64>> = self
            .softening
            .iter()
            .map(|s| self.use_up(s, depth))
            .collect();
        let mut softness = vec![1.0; depth.len()];
        for (softening, used) in self.softening.iter().zip(&used) {
            for (region, factor) in softness.iter_mut().enumerate() {
                *factor *= 1.0 - softening.effect.amplitude_on(region as u32) * used[region];
            }
        }
        let loads = self
            .touched
            .iter()
            .map(load)
            .filter(|l| l.1 != Vec3::zeros())
            .collect();
        let is_left = |(now, last): (&f64, &f64)| now < last;
        MemoryStep {
            is_left: depth.iter().zip(&self.depth).map(is_left).collect(),
            loads,
            instantaneous,
            softness,
            fade,
            shares,
            used,
            depth: depth.to_vec(),
        }
    }

    /// Keeps a step: `bearing` is what each site bore in the elastic tissue's terms beyond the recalled loads, `clings` where
    /// attraction held it, `area` the contact area by region (mm2).
    pub fn commit(
        &mut self,
        recall: &MemoryStep,
        (bearing, clings): (&[(u32, Vec3)], &[bool]),
        (sites, area): (&Sites, &[f64]),
    ) {
        let mut fresh: Vec<(u32, Vec3)> = recall.loads.clone();
        fresh.extend(bearing.iter().filter(|b| b.1 != Vec3::zeros()));
        fresh.sort_by_key(|load| load.0);
        let mut known: Vec<u32> = self
            .touched
            .iter()
            .copied()
            .chain(fresh.iter().map(|f| f.0))
            .collect();
        known.sort_unstable();
        known.dedup();
        let mut next = fresh.iter().peekable();
        for &site in &known {
            let mut elastic = Vec3::zeros();
            while let Some(load) = next.next_if(|load| load.0 == site) {
                elastic += load.1;
            }
            let (i, region) = (site as usize, sites.home_region(site as usize) as usize);
            let change = elastic - self.elastic[i];
            for (branch, of_region) in self.fading.iter_mut().zip(&recall.fade) {
                let fade = of_region[region];
                branch[i] = match fade.new == fade.old {
                    true => branch[i] * fade.decay + change * fade.new,
                    false => {
                        branch[i] * fade.decay + elastic * fade.new - self.elastic[i] * fade.old
                    }
                };
            }
            self.elastic[i] = elastic;
        }
        known.retain(|&site| self.lives(site as usize));
        self.touched = known;
        for (softening, used) in self.softening.iter_mut().zip(&recall.used) {
            softening.used.clone_from(used);
        }
        self.depth.clone_from(&recall.depth);
        self.shares.clone_from(&recall.shares);
        self.clings.copy_from_slice(clings);
        for (region, area) in area.iter().enumerate() {
            self.touching[region] = (area.max(0.0) / std::f64::consts::PI).sqrt();
            if *area > 0.0 {
                self.radius[region] = self.touching[region];
            }
        }
    }

    /// Rotates the remembered loads of each site with its skin; `turn` by site.
    pub fn turn(&mut self, turn: impl Fn(u32) -> Rotation3<f64>) {
        for &site in &self.touched {
            let (turn, i) = (turn(site), site as usize);
            self.elastic[i] = turn * self.elastic[i];
            self.fading
                .iter_mut()
                .for_each(|branch| branch[i] = turn * branch[i]);
        }
    }

    /// True if a site still has memory; a faded remainder is dropped.
    fn lives(&mut self, i: usize) -> bool {
        let is_faint = |load: &Vec3| load.norm() < FAINT;
        if !(is_faint(&self.elastic[i]) && self.fading.iter().all(|branch| is_faint(&branch[i]))) {
            return true;
        }
        self.elastic[i] = Vec3::zeros();
        self.fading
            .iter_mut()
            .for_each(|branch| branch[i] = Vec3::zeros());
        false
    }

    /// How far a branch's clock goes in a step that brings its region to a depth, in its periods.
    fn passed(&self, branch: &Branch, region: usize, depth: f64) -> f64 {
        let passed = match &branch.clock {
            Clock::Time => self.seconds,
            Clock::Drainage(effect) => {
                drainage::progress(effect, self.seconds, self.radius[region])
            }
            Clock::Layer(layer, z) => {
                layer.progress((region, *z), self.seconds, self.radius[region])
            }
            Clock::Travel => (depth - self.depth[region]).abs(),
        };
        passed / branch.period
    }

    fn use_up(&self, softening: &Softening, depth: &[f64]) -> Vec<f64> {
        let after = |(region, used): (usize, &f64)| {
            let (last, now) = (self.depth[region], depth[region]);
            // Skin that clings bears load and does not rest: tissue that stiffened under load would give energy.
            let used = if now > 0.0 || self.clings[region] {
                *used
            } else {
                cycle_softening::rested(&softening.effect, *used, self.seconds)
            };
            cycle_softening::used(&softening.effect, used, (last, now))
        };
        softening.used.iter().enumerate().map(after).collect()
    }
}
