//! What of the last live contact still holds: skin that neither moved nor was strained from elsewhere keeps its forces.
//!
//! Certified each time: held skin is not carried off, by what changed elsewhere, farther than the written surface may miss
//! the product; where it is, it is solved anew.

use thenar_surface::{Gap, Vec3};

use crate::Model;
use crate::carried::Found;
use crate::linearize::{Setting, vertex};
use crate::skin::Skin;
use crate::solve::Accuracy;

/// Skin nearer than this to what moved is solved with it, mm: about a tissue's thickness (tests pass from 3 to 15).
const REACH: f64 = 6.0;
/// Share of the zone above which all of it is solved.
const MOST: f64 = 0.7;
/// How far held skin may stray, over the deepest penetration: a half per cent of what it bears.
const STRAY: f64 = 5e-3;
/// Share of that from which it is solved with the next frame.
const EARLY: f64 = 0.5;
/// Largest distance between written contact and product that ends a live solve, mm, and over the deepest penetration.
const MISFIT: f64 = 0.02;
const MISFIT_SHARE: f64 = 2.5e-3;

/// Where a site met the product in the last live solve.
#[derive(Debug, Clone)]
pub struct Met {
    /// Its gap before deformation, and its response weight.
    gap: Option<Gap>,
    weight: f64,
    /// As in a solve's state.
    pub touch: Gap,
    pub direction: Vec3,
    pub cosine: f64,
    pub travel: f64,
    pub force: f64,
    pub slack: f64,
}

/// The last live solve.
#[derive(Debug, Clone, Default)]
pub struct Held {
    /// Its zone (ascending), and what each site met.
    zone: Vec<u32>,
    met: Vec<Met>,
    /// Sites that strayed a little.
    strayed: Vec<u32>,
}

impl Held {
    /// What a site met, if it was in the zone.
    fn of(&self, site: u32) -> Option<&Met> {
        let place = self.zone.binary_search(&site).ok()?;
        self.met.get(place)
    }
}

/// What each site of `zone` still holds from the last live solve; None where it is to be solved. Empty if all are.
pub fn held(skin: &Skin, setting: &Setting<'_>, zone: &[u32], strayed: &[u32]) -> Vec<Option<Met>> {
    let last = &skin.memory.held;
    let is_small = skin.hierarchy.is_none() && !skin.memory.coupling.is_large();
    let is_live = setting.accuracy == Accuracy::Rough && skin.model == Model::Layer;
    if !is_small || !is_live || last.zone.is_empty() {
        return Vec::new();
    }
    let met: Vec<Option<&Met>> = zone.iter().map(|&site| last.of(site)).collect();
    let patch = |site: u32| skin.sites.patch[site as usize] as usize;
    let mut is_changed = vec![false; skin.sites.patch_range.len()];
    for (&site, met) in zone.iter().zip(&met) {
        let gap = &setting.detection.gaps[vertex(skin, site)];
        let weight = setting.weight[site as usize];
        if !met.is_some_and(|met| met.gap == *gap && met.weight == weight) {
            is_changed[patch(site)] = true;
        }
    }
    for &site in last.strayed.iter().chain(strayed) {
        is_changed[patch(site)] = true;
    }
    let mut is_open = is_changed.clone();
    for from in (0..is_changed.len()).filter(|&p| is_changed[p]) {
        for (near, bound) in skin.response.bounds(from as u32) {
            is_open[near as usize] |= bound < REACH;
        }
    }
    let held: Vec<Option<Met>> = zone
        .iter()
        .zip(met)
        .map(|(&site, met)| met.filter(|_| !is_open[patch(site)]).cloned())
        .collect();
    let open = held.iter().filter(|met| met.is_none()).count();
    if open as f64 > MOST * zone.len() as f64 {
        return Vec::new();
    }
    held
}

/// Keeps a live solve for the next; forgets what there was after any other.
pub fn keep(skin: &mut Skin, setting: &Setting<'_>, found: &Found<'_>, slack: &[f64]) {
    if setting.accuracy != Accuracy::Rough {
        skin.memory.held = Held::default();
        return;
    }
    let met = |(k, &site): (usize, &u32)| Met {
        gap: setting.detection.gaps[vertex(skin, site)],
        weight: setting.weight[site as usize],
        touch: found.touch[k],
        direction: found.direction[k],
        cosine: found.cosine[k],
        travel: found.travel[k],
        force: found.force[k],
        slack: slack[k],
    };
    let met = found.zone.iter().enumerate().map(met).collect();
    skin.memory.held = Held {
        zone: found.zone.to_vec(),
        met,
        strayed: skin.memory.held.strayed.clone(),
    };
}

/// The largest misfit of a live solve, mm.
pub fn tolerance(deepest: f64) -> f64 {
    MISFIT.min(MISFIT_SHARE * deepest)
}

/// How far held skin was carried off along its directions, over the deepest penetration, and the sites that strayed too far.
///
/// `field`: displacement of every site by all forces. Sites that strayed less are solved with the next frame.
pub fn strays(
    skin: &mut Skin,
    (found, held): (&Found<'_>, &[Option<Met>]),
    field: &[Vec3],
    deepest: f64,
) -> (f64, Vec<u32>) {
    let most = STRAY * deepest;
    let (mut worst, mut far, mut some) = (0.0f64, Vec::new(), Vec::new());
    for (k, _) in held.iter().enumerate().filter(|(_, met)| met.is_some()) {
        let site = found.zone[k];
        let off = (found.direction[k].dot(&field[site as usize]) - found.travel[k]).abs();
        worst = worst.max(off);
        if off > most {
            far.push(site);
        } else if off > EARLY * most {
            some.push(site);
        }
    }
    skin.memory.held.strayed = some;
    (worst / deepest.max(f64::MIN_POSITIVE), far)
}
