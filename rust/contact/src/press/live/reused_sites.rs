//! Live presses: which sites keep the last frame's solution (why Live skips a site), with a check after each solve.
//!
//! After each solve, the displacement that changes elsewhere cause at reused sites, and changes outside the near field at solved
//! ones, is compared with the live tolerance; sites above it are solved again.

use thenar_surface::Vec3;

use super::extrapolation::{extrapolated, is_live};
use crate::press::setting::{SolveSetting, vertex};
use crate::press::solution::ZoneSolution;
use crate::skin::prepare::Skin;
use crate::workspace::Pressing;
use crate::workspace::live_cache::{LiveContact, ReusedSite};

/// Sites in patches nearer than this to a changed site are solved with it, mm (tests pass from 1 to 8).
const REACH: f64 = 3.0;
/// The same around sites that exceed the tolerance or are lifted into the product, mm (tests pass from 1 to 3).
const REACH_AGAIN: f64 = 1.0;
/// Share of the zone above which all of it is solved.
const MOST: f64 = 0.7;
/// Largest displacement error of a reused site over the deepest penetration: below the certificate's 0.5 %, so that reused
/// sites stay within it.
const STRAY: f64 = 4.5e-3;
/// Relative change of a site's weight since it was solved that leaves its solution: a fifth of that error. A region's weights
/// all follow the overlap of its parts that move.
const SAME_WEIGHT: f64 = 1e-3;
/// Presses in which a site is solved at once after it strayed: in contact it moves little as long as it is solved, so that no
/// trend shows how far it would stray again (tests pass from 0, which solves every other press twice, to 1000).
const SOLVED_AT_ONCE: u32 = 16;
/// Share of that error from which a site is solved because it is expected to exceed it.
const EARLY: f64 = 0.9;

/// Which sites of `zone` reuse their solution of the last live press; the others are solved. Empty if all are solved.
///
/// `strayed`: sites that exceeded the tolerance in this press, from its second round on; None in the first.
pub fn reused_sites(
    pressing: &Pressing<'_>,
    setting: &SolveSetting<'_>,
    zone: &[u32],
    strayed: Option<&[u32]>,
) -> Vec<bool> {
    let skin = pressing.skin;
    let last = &pressing.workspace.live_contact;
    if !is_live(skin, setting) || last.zone.is_empty() {
        return Vec::new();
    }
    let met: Vec<Option<&ReusedSite>> = zone.iter().map(|&site| last.of(site)).collect();
    let is_changed = |(&site, met): (&u32, &Option<&ReusedSite>)| {
        let gap = &setting.detection.gaps[vertex(skin, site)];
        let weight = setting.weight[site as usize];
        let is_near = |met: &ReusedSite| (met.weight / weight - 1.0).abs() <= SAME_WEIGHT;
        !met.is_some_and(|met| met.gap == *gap && is_near(met))
    };
    let changed = zone.iter().zip(&met).filter(|&pair| is_changed(pair));
    let mut changed: Vec<u32> = changed.map(|(&site, _)| site).collect();
    // What will stray is solved with what moved; where nothing did, the last certificate stands.
    match strayed {
        Some(strayed) => changed.extend(strayed),
        None if changed.is_empty() => {}
        None => changed.extend(will_stray(pressing, setting, zone, &met)),
    }
    changed.sort();
    let reach = strayed.map_or(REACH, |_| REACH_AGAIN);
    let mut is_open = near(skin, &changed, reach);
    if strayed.is_none() && !changed.is_empty() {
        let before: Vec<u32> = last.strayed.iter().map(|(site, _)| *site).collect();
        for (is_open, is_near) in is_open.iter_mut().zip(near(skin, &before, REACH_AGAIN)) {
            *is_open |= is_near;
        }
    }
    let held = zone.iter().zip(met);
    let held = held.map(|(&site, met)| met.is_some() && !is_open[site as usize]);
    let held: Vec<bool> = held.collect();
    let open = held.iter().filter(|is_held| !**is_held).count();
    if open as f64 > MOST * zone.len() as f64 {
        return Vec::new();
    }
    held
}

/// Sites of `zone` that would exceed the tolerance if they were reused while the last change continues.
fn will_stray(
    pressing: &Pressing<'_>,
    setting: &SolveSetting<'_>,
    zone: &[u32],
    met: &[Option<&ReusedSite>],
) -> Vec<u32> {
    let most = EARLY * STRAY * setting.detection.deepest();
    let strays = |(site, met): &(&u32, &Option<&ReusedSite>)| {
        let off = |met: &&ReusedSite| {
            met.direction.dot(&extrapolated(pressing, setting, **site)) - met.travel
        };
        met.as_ref().is_some_and(|met| off(met).abs() > most)
    };
    let straying = zone.iter().zip(met).filter(strays);
    straying.map(|(&site, _)| site).collect()
}

/// Which sites lie in patches within `reach` (mm) of that of some of `sites` (ascending).
fn near(skin: &Skin, sites: &[u32], reach: f64) -> Vec<bool> {
    let patch_of = |site: &u32| skin.sites.patch[*site as usize];
    let mut is_near = vec![false; skin.sites.len()];
    for of_patch in sites.chunk_by(|a, b| patch_of(a) == patch_of(b)) {
        let bounds = skin.response.bounds(patch_of(&of_patch[0]));
        for (patch, _) in bounds.filter(|(_, bound)| *bound < reach) {
            let (first, last) = skin.sites.patch_range[patch as usize];
            is_near[first as usize..last as usize].fill(true);
        }
    }
    is_near
}

/// Keeps the solution of a live solve for the next frame; clears it after any other solve.
///
/// Sites that were reused stay as they are.
pub fn keep_solution(
    pressing: &mut Pressing<'_>,
    setting: &SolveSetting<'_>,
    found: &ZoneSolution<'_>,
) {
    let (skin, kept) = (pressing.skin, &mut pressing.workspace.live_contact);
    if !is_live(skin, setting) {
        *kept = LiveContact::default();
        return;
    }
    kept.met.resize_with(skin.sites.len(), || None);
    for site in &kept.zone {
        if found.zone.binary_search(site).is_err() {
            kept.met[*site as usize] = None;
        }
    }
    for (k, &site) in found.zone.iter().enumerate() {
        if found.is_reused.get(k) == Some(&true) {
            continue;
        }
        kept.met[site as usize] = Some(ReusedSite {
            gap: setting.detection.gaps[vertex(skin, site)],
            weight: setting.weight[site as usize],
            touch: found.touch[k],
            direction: found.direction[k],
            sums: found.sums[k],
            cosine: found.cosine[k],
            travel: found.travel[k],
            force: found.force[k],
            slack: found.slack[k],
        });
    }
    kept.zone.clear();
    kept.zone.extend_from_slice(found.zone);
}

/// Keeps which reused sites of a `round` are among those that strayed (`far`), for the next presses.
pub fn keep_strays(
    pressing: &mut Pressing<'_>,
    found: &ZoneSolution<'_>,
    round: usize,
    far: &[u32],
) {
    let kept = &mut pressing.workspace.live_contact;
    if round == 1 {
        kept.count_down();
    }
    let is_reused = |site: &u32| {
        let place = found.zone.binary_search(site);
        place.is_ok_and(|k| found.is_reused.get(k) == Some(&true))
    };
    let reused: Vec<u32> = far.iter().copied().filter(is_reused).collect();
    kept.solve_at_once(&reused, SOLVED_AT_ONCE);
}

/// Largest error of travel along the press directions over the deepest penetration, and the sites beyond the tolerance: reused
/// sites by changes elsewhere, solved sites by changes outside the near field.
///
/// `field`: displacement of every site by all forces.
pub fn strays(found: &ZoneSolution<'_>, field: &[Vec3], deepest: f64) -> (f64, Vec<u32>) {
    let most = STRAY * deepest;
    let (mut worst, mut far) = (0.0f64, Vec::new());
    for (k, &site) in found.zone.iter().enumerate() {
        let off = (found.direction[k].dot(&field[site as usize]) - found.travel[k]).abs();
        worst = worst.max(off);
        if off > most {
            far.push(site);
        }
    }
    (worst / deepest.max(f64::MIN_POSITIVE), far)
}
