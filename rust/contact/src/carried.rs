//! Where the solved forces carry the skin: the displacement of every site, in the zone of the solve and outside.

use thenar_surface::{Gap, Vec3};

use crate::hierarchy::Carried;
use crate::linearize::{Setting, vertex};
use crate::response::assembly::Load;
use crate::skin::Skin;
use crate::zone::limits;
use crate::{ContactError, Control, Model, paper};

/// What a solve found, by site of its zone.
pub struct Found<'a> {
    /// Sites, ascending.
    pub zone: &'a [u32],
    /// Normal force, N.
    pub force: &'a [f64],
    /// Direction in which each yields.
    pub direction: &'a [Vec3],
    /// Cosine between that and the product's normal.
    pub cosine: &'a [f64],
    /// Travel along it, mm.
    pub travel: &'a [f64],
    /// Where each met the product.
    pub touch: &'a [Gap],
}

/// Displacement of every site, and how far a large skin's is from the direct sum (0: not at all).
///
/// # Errors
/// [`ContactError::Cancelled`].
pub fn field(
    skin: &Skin,
    setting: &Setting<'_>,
    found: &Found<'_>,
    control: &Control,
) -> Result<(Vec<Vec3>, f64), ContactError> {
    if skin.model == Model::Paper {
        let field = paper::displacement(skin, setting, (found.zone, found.force, found.travel));
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
    let Carried {
        mut field,
        certificate,
    } = skin.carry(loads, control)?;
    for (site, u) in field.iter_mut().enumerate() {
        *u *= setting.weight[site] * skin.sites.follow[site];
    }
    keep_out(skin, setting, found, &mut field);
    Ok((field, certificate))
}

/// Puts skin in contact, and what the field would carry into the product, where the solve left it: along its direction.
///
/// Other skin follows the field in full, in the zone or outside, so that the zone's margin leaves no mark.
fn keep_out(skin: &Skin, setting: &Setting<'_>, found: &Found<'_>, field: &mut [Vec3]) {
    let free: Vec<usize> = (0..found.zone.len())
        .filter(|&k| found.force[k] == 0.0)
        .collect();
    let carried = |&k: &usize| {
        let site = found.zone[k];
        setting.detection.positions[vertex(skin, site)] + field[site as usize]
    };
    let points: Vec<Vec3> = free.iter().map(carried).collect();
    let normals: Vec<Vec3> = free.iter().map(|&k| -found.touch[k].normal).collect();
    let hints: Vec<u32> = free.iter().map(|&k| found.touch[k].triangle).collect();
    let product = setting.product;
    let gaps = product.gaps_near(&points, Some(&normals), limits(), &hints);
    let mut is_carried = vec![false; found.zone.len()];
    for (k, gap) in free.into_iter().zip(gaps) {
        is_carried[k] = gap.is_none_or(|g| g.distance >= 0.0);
    }
    for (k, &site) in found.zone.iter().enumerate() {
        if !is_carried[k] {
            field[site as usize] = found.direction[k] * found.travel[k];
        }
    }
}

/// Skin outside the zone that the displacement carries into the product, and how deep, mm.
pub fn lifted_sites(
    skin: &Skin,
    setting: &Setting<'_>,
    (field, zone): (&[Vec3], &[u32]),
    tolerance: f64,
) -> (f64, Vec<u32>) {
    let mut near = Vec::new();
    for (site, u) in field.iter().enumerate() {
        let gap = &setting.detection.gaps[vertex(skin, site as u32)];
        let can_reach = gap.as_ref().is_some_and(|g| g.distance < u.norm());
        if can_reach && skin.sites.is_skin(site) && zone.binary_search(&(site as u32)).is_err() {
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
    let gaps = setting.product.gaps(&points, Some(&normals), limits());
    let depth = |g: &Option<Gap>| g.as_ref().map_or(0.0, |g| -g.distance);
    let worst = gaps.iter().map(depth).fold(0.0, f64::max);
    let lifted = near
        .into_iter()
        .zip(&gaps)
        .filter(|(_, g)| depth(g) > tolerance)
        .map(|(s, _)| s);
    (worst, lifted.collect())
}
