//! Displacement of every site under the solved forces, inside the active zone and outside.

use thenar_surface::{Gap, Vec3};

use super::paper_model;
use super::setting::{SolveSetting, vertex};
use super::solution::ZoneSolution;
use crate::detection::gaps::limits;
use crate::far_field::FarFieldDisplacement;
use crate::press::live::extrapolation::can_reach;
use crate::response::assembly::Load;
use crate::skin::prepare::Skin;
use crate::soft_grip::yielding::{Covered, Place};
use crate::solve::Accuracy;
use crate::workspace::Pressing;
use crate::{ContactError, Control, Model};

/// Change of a load, over the largest, below which a live press defers it: all together move skin by some micrometres.
const WAITING: f64 = 1e-5;

/// Displacement of every site, and how far a large skin's is from the direct sum (0: not at all).
///
/// # Errors
/// [`ContactError::Cancelled`].
pub fn field(
    pressing: &mut Pressing<'_>,
    setting: &SolveSetting<'_>,
    found: &ZoneSolution<'_>,
    control: &Control,
) -> Result<(Vec<Vec3>, f64), ContactError> {
    let skin = pressing.skin;
    if skin.model == Model::Paper {
        let field =
            paper_model::displacement(skin, setting, (found.zone, found.force, found.travel));
        return Ok((field, 0.0));
    }
    let mut loads = Vec::new();
    for (k, &site) in found.zone.iter().enumerate() {
        if found.force[k] > 0.0 {
            let load = setting.weight[site as usize] * found.cosine[k] * found.force[k];
            loads.push(Load {
                site,
                load: found.direction[k] * load,
            });
        }
    }
    let FarFieldDisplacement {
        mut field,
        certificate,
    } = if setting.accuracy == Accuracy::Rough && skin.hierarchy.is_none() {
        FarFieldDisplacement {
            field: displacement_by_changes(pressing, loads),
            certificate: 0.0,
        }
    } else {
        pressing.displacement(loads, control)?
    };
    for (site, u) in field.iter_mut().enumerate() {
        *u *= setting.weight[site] * skin.sites.follow[site];
    }
    if let Some(grip) = &pressing.workspace.grip {
        come_nearer(skin, setting, found, (grip, &mut field));
    }
    Ok((field, certificate))
}

/// Lets the skin come nearer to a soft grip by what the grip yields: a press tells how skin and grip move against each other.
fn come_nearer(
    skin: &Skin,
    setting: &SolveSetting<'_>,
    found: &ZoneSolution<'_>,
    (grip, field): (&Covered, &mut [Vec3]),
) {
    let detection = setting.detection;
    let mut near: Vec<(u32, Gap)> = Vec::new();
    for site in (0..field.len() as u32).filter(|&s| skin.sites.is_skin(s as usize)) {
        let gap = match found.zone.binary_search(&site) {
            Ok(k) => Some(found.touch[k]),
            Err(_) => detection.gaps[vertex(skin, site)],
        };
        near.extend(gap.map(|gap| (site, gap)));
    }
    let place = |(site, gap): &(u32, Gap)| grip.place(gap, detection.areas[vertex(skin, *site)]);
    let force = |site: u32| {
        let k = found.zone.binary_search(&site).ok()?;
        Some(found.force[k]).filter(|force| *force > 0.0)
    };
    let yields_at = |gaps: &[(u32, Gap)]| {
        let places: Vec<Place> = gaps.iter().map(place).collect();
        let bearing = gaps.iter().filter_map(|at| Some((place(at), force(at.0)?)));
        grip.yield_at(&places, &bearing.collect::<Vec<(Place, f64)>>())
    };
    let mut depths = yields_at(&near);
    for ((site, gap), depth) in near.iter().zip(&depths) {
        field[*site as usize] += gap.normal * *depth;
    }
    let mut yields = grip.yields();
    yields.met = vec![None; field.len()];
    for (site, gap) in &near {
        yields.met[*site as usize] = Some(*gap);
    }
    if !yields.held.is_empty() {
        let held = |(site, gap): &(u32, Gap)| (*site, yields.held[*site as usize].unwrap_or(*gap));
        depths = yields_at(&near.iter().map(held).collect::<Vec<(u32, Gap)>>());
    }
    yields.found = vec![0.0; field.len()];
    for ((site, _), depth) in near.iter().zip(depths) {
        let overlap = (-detection.distances[vertex(skin, *site)]).max(0.0);
        yields.found[*site as usize] = depth.min(overlap);
    }
}

/// Field of the loads by update of the last live press's field; small changes of load are deferred.
fn displacement_by_changes(pressing: &mut Pressing<'_>, loads: Vec<Load>) -> Vec<Vec3> {
    let (skin, workspace) = (pressing.skin, &mut *pressing.workspace);
    let live_field = &mut workspace.live_field;
    let sites = skin.sites.len();
    if !live_field.matches(sites) {
        live_field.load = vec![Vec3::zeros(); sites];
        live_field.field = vec![Vec3::zeros(); sites];
        live_field.load_change = vec![Vec3::zeros(); sites];
        live_field.field_change = vec![Vec3::zeros(); sites];
    }
    let largest = loads.iter().fold(0.0, |m, l| f64::max(m, l.load.norm()));
    let mut left = vec![Vec3::zeros(); sites];
    loads.iter().for_each(|l| left[l.site as usize] = l.load);
    let mut changes = Vec::new();
    let least = WAITING * largest;
    for (site, (now, before)) in left.iter().zip(&mut live_field.load).enumerate() {
        let load = now - *before;
        if load.norm_squared() > least * least {
            let change = &mut live_field.load_change[site];
            *change += load;
            let site = site as u32;
            changes.push(Load { site, load });
            *before = *now;
        }
    }
    let (ground, rows) = ((&*skin.response, &*skin.sites), &mut workspace.quantized);
    rows.make(changes.iter().map(|change| change.site), ground);
    let more = rows.displacements(ground, &changes);
    let sums = live_field
        .field
        .iter_mut()
        .zip(&mut live_field.field_change);
    for ((sum, change), more) in sums.zip(&more) {
        *sum += more;
        *change += more;
    }
    if loads.is_empty() {
        // Sums of single precision leave a trace; skin that nothing presses has none.
        live_field.field.fill(Vec3::zeros());
    }
    live_field.field.clone()
}

/// Sets sites in contact, and those that the field would move into the product, to their solved travel along their direction.
///
/// Other skin follows the field in full, in the zone or outside, so that the zone's margin leaves no mark.
pub fn keep_out_of_product(
    skin: &Skin,
    setting: &SolveSetting<'_>,
    found: &ZoneSolution<'_>,
    field: &mut [Vec3],
) {
    if skin.model == Model::Paper {
        return;
    }
    let mut is_carried = vec![false; found.zone.len()];
    let mut free = Vec::new();
    for k in (0..found.zone.len()).filter(|&k| found.force[k] == 0.0) {
        let site = found.zone[k];
        let gap = &setting.detection.gaps[vertex(skin, site)];
        // What moves less than it is away stays out.
        let stays_out = |g: &Gap| g.distance > field[site as usize].norm();
        is_carried[k] = gap.as_ref().is_some_and(stays_out);
        if !is_carried[k] {
            free.push(k);
        }
    }
    let carried = |&k: &usize| {
        let site = found.zone[k];
        setting.detection.positions[vertex(skin, site)] + field[site as usize]
    };
    let points: Vec<Vec3> = free.iter().map(carried).collect();
    let normals: Vec<Vec3> = free.iter().map(|&k| -found.touch[k].normal).collect();
    let hints: Vec<u32> = free.iter().map(|&k| found.touch[k].triangle).collect();
    let product = setting.product;
    let gaps = product.gaps_along(&points, Some(&normals), limits(), &hints);
    for (k, gap) in free.into_iter().zip(gaps) {
        is_carried[k] = gap.is_none_or(|g| g.distance >= 0.0);
    }
    for (k, &site) in found.zone.iter().enumerate() {
        if !is_carried[k] {
            field[site as usize] = found.direction[k] * found.travel[k];
        }
    }
}

/// Sites outside the zone that the displacement lifts into the product, and the deepest of them, mm.
pub fn lifted_sites(
    skin: &Skin,
    setting: &SolveSetting<'_>,
    (field, zone): (&[Vec3], &[u32]),
    tolerance: f64,
) -> (f64, Vec<u32>) {
    let mut near = Vec::new();
    for (site, u) in field.iter().enumerate() {
        let distance = setting.detection.distances[vertex(skin, site as u32)];
        if can_reach(u, distance)
            && skin.sites.is_skin(site)
            && zone.binary_search(&(site as u32)).is_err()
        {
            near.push(site as u32);
        }
    }
    let points: Vec<Vec3> = near
        .iter()
        .map(|&s| setting.detection.positions[vertex(skin, s)] + field[s as usize])
        .collect();
    let facing = |&s: &u32| {
        setting.detection.gaps[vertex(skin, s)]
            .as_ref()
            .map_or_else(Vec3::zeros, |g| -g.normal)
    };
    let normals: Vec<Vec3> = near.iter().map(facing).collect();
    let hint = |&s: &u32| {
        let gap = &setting.detection.gaps[vertex(skin, s)];
        gap.as_ref().map_or(u32::MAX, |g| g.triangle)
    };
    let hints: Vec<u32> = near.iter().map(hint).collect();
    let product = setting.product;
    let gaps = product.gaps_along(&points, Some(&normals), limits(), &hints);
    let depth = |g: &Option<Gap>| g.as_ref().map_or(0.0, |g| -g.distance);
    let worst = gaps.iter().map(depth).fold(0.0, f64::max);
    let lifted = near
        .into_iter()
        .zip(&gaps)
        .filter(|(_, g)| depth(g) > tolerance)
        .map(|(s, _)| s);
    (worst, lifted.collect())
}
