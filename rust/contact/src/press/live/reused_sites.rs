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
/// Presses in which a site is solved at once after it strayed, so that steady motion solves at most one of so many presses
/// twice. In contact a site moves little as long as it is solved: no trend shows how far it would stray again.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::detection::gaps::{Stand, detect};
    use crate::detection::press_direction::Sums;
    use crate::response::test_sheet::sheet;
    use crate::solve::Accuracy;
    use thenar_surface::{Gap, Mesh, Product};

    /// A plate that faces down, 2 mm above the sheet's lowest skin.
    fn plate() -> Product {
        let corners = [(-50.0, -50.0), (90.0, -50.0), (90.0, 90.0), (-50.0, 90.0)];
        let corners = corners.map(|(x, y)| Vec3::new(x, y, 2.0));
        let plate = Mesh::new(corners.to_vec(), vec![[0, 2, 1], [0, 3, 2]]);
        Product::new(plate.unwrap()).unwrap()
    }

    /// Calls `with` after a live press of all of the sheet that is near the plate; its last site has strayed.
    fn after_a_press(with: impl FnOnce(&mut Pressing<'_>, SolveSetting<'_>, &[u32])) {
        let (skin, mut workspace, _) = sheet();
        let mut pressing = workspace.on(&skin);
        let (product, mesh) = (plate(), skin.merged.mesh.clone());
        let detection = detect(&mut pressing, &mesh, &Stand::as_given(&product)).unwrap();
        let count = skin.sites.len();
        let setting = SolveSetting {
            product: &product,
            detection: &detection,
            weight: &vec![0.5; count],
            start: None,
            accuracy: Accuracy::Rough,
            spacing: skin.spacing,
        };
        let near = |site: u32| Some((site, detection.gaps[vertex(&skin, site)]?));
        let near = (0..count as u32).filter_map(near);
        let (zone, touch): (Vec<u32>, Vec<Gap>) = near.unzip();
        let count = zone.len();
        let (ones, zeros) = (vec![1.0; count], vec![0.0; count]);
        let found = ZoneSolution {
            zone: &zone,
            force: &ones,
            direction: &vec![-Vec3::z(); count],
            cosine: &ones,
            travel: &zeros,
            touch: &touch,
            slack: &zeros,
            sums: &vec![Sums::default(); count],
            is_reused: &[],
        };
        keep_solution(&mut pressing, &setting, &found);
        let all = vec![true; count];
        let reused = ZoneSolution {
            is_reused: &all,
            ..found
        };
        keep_strays(&mut pressing, &reused, 1, &zone[count - 1..]);
        with(&mut pressing, setting, &zone);
    }

    #[test]
    fn skin_that_strayed_is_solved_at_once_wherever_else_something_moves_for_some_presses() {
        after_a_press(|pressing, setting, zone| {
            let last = zone.len() - 1;
            let still = reused_sites(pressing, &setting, zone, None);
            assert!(still.iter().all(|is_reused| *is_reused), "nothing moved");
            let mut weight = setting.weight.to_vec();
            weight[zone[0] as usize] *= 1.1;
            let setting = SolveSetting {
                weight: &weight,
                ..setting
            };
            for press in 0..SOLVED_AT_ONCE {
                let held = reused_sites(pressing, &setting, zone, None);
                assert!(!held[0] && !held[last], "{press}");
                assert!(held.contains(&true), "{press}");
                pressing.workspace.live_contact.count_down();
            }
            let held = reused_sites(pressing, &setting, zone, None);
            assert!(!held[0] && held[last], "as any other");
        });
    }
}
