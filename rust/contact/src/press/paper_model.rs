//! Model `paper`: the active zone of Xie et al. and swelling added after the solve.
//!
//! Swelling must not stand inside the complementarity problem: with the paper's own upper palm moduli the matrix turns
//! indefinite and Lemke's method ends on secondary rays. Forces are solved without it (Xie Eq. 9 with the response of
//! Eq. 4), the Gaussian of Eq. 5 to 8 is added outside the contact (Eq. 7, 12), and is flattened, at no force, where it
//! would rise into the product.

use thenar_surface::{Gap, Vec3};

use super::setting::SolveSetting;
use crate::response::assembly::{Load, displacements};
use crate::skin::arc_length::arc_length;
use crate::skin::prepare::Skin;

/// Beyond this many widths the Gaussian of Eq. 5 is below 1e-7 of its height.
const GAUSSIAN_REACH: f64 = 5.7;

/// Displacement of every site, mm: pressed skin by its `travel`, the rest of the active zone by response and swelling.
///
/// Skin that is pressed goes along the product's normal, in which Eq. 13 measures its distance. Free skin goes along its own, as the
/// half space of Eq. 1 does: next to a thin tool the nearest side's normal lies across it. However it rises, it comes no nearer to the
/// product than it moves.
pub fn displacement(
    skin: &Skin,
    setting: &SolveSetting<'_>,
    (zone, force, travel): (&[u32], &[f64], &[f64]),
) -> Vec<Vec3> {
    let sites = &skin.sites;
    let pressed: Vec<(u32, f64)> = zone
        .iter()
        .copied()
        .zip(force.iter().copied())
        .filter(|(_, f)| *f > 0.0)
        .collect();
    let loads: Vec<Load> = pressed
        .iter()
        .map(|&(site, f)| Load {
            site,
            load: Vec3::new(f * setting.weight[site as usize], 0.0, 0.0),
        })
        .collect();
    let response = displacements(&skin.response, &loads, sites);
    let swelling_height = swelling_heights(skin, setting);
    let mut field = vec![Vec3::zeros(); sites.len()];
    for site in 0..sites.len() {
        let index = site as u32;
        let gap = &setting.detection.gaps[sites.vertex[site] as usize];
        let own = -setting.detection.normals[sites.vertex[site] as usize];
        if let Ok(k) = zone.binary_search(&index) {
            let rise = if force[k] > 0.0 {
                0.0
            } else {
                swelling(skin, &pressed, (index, &swelling_height))
            };
            let room = gap
                .as_ref()
                .map_or(f64::INFINITY, |g| g.distance + travel[k]);
            let is_pressed = |g: &&Gap| force[k] > 0.0 || g.distance < 0.0;
            let inward = gap.as_ref().filter(is_pressed).map_or(own, |g| g.normal);
            field[site] = inward * (travel[k] - rise.min(room.max(0.0)));
        } else if sites.is_skin(site) && is_active(skin, zone, index) {
            let press = setting.weight[site] * response[site].x;
            let rise = swelling(skin, &pressed, (index, &swelling_height));
            let room = gap.as_ref().map_or(f64::INFINITY, |g| g.distance + press);
            field[site] = own * (press - rise.min(room.max(0.0)));
        }
    }
    field
}

/// a(dmax) = a0 G0 / G(dmax) of every region, mm/N (Xie Eq. 6).
fn swelling_heights(skin: &Skin, setting: &SolveSetting<'_>) -> Vec<f64> {
    let depths = &setting.detection.max_penetration;
    let height = |(m, depth): (&crate::Material, &f64)| {
        m.swelling.height_mm_per_n * m.g0_mpa / m.shear_modulus(*depth)
    };
    skin.tissue
        .materials
        .iter()
        .zip(depths)
        .map(height)
        .collect()
}

/// Rise of a site beside the pressed ones, mm (Xie Eq. 5).
fn swelling(skin: &Skin, pressed: &[(u32, f64)], (site, heights): (u32, &[f64])) -> f64 {
    let region = skin.sites.region[site as usize];
    let swelling = skin.tissue.materials[region as usize].swelling;
    let reach = swelling.radius_mm + GAUSSIAN_REACH * swelling.width_mm;
    let here = &skin.sites.rest[site as usize];
    let mut rise = 0.0;
    for &(other, force) in pressed {
        let there = &skin.sites.rest[other as usize];
        if skin.sites.region[other as usize] == region
            && (there.position - here.position).norm() <= reach
        {
            let bound = skin.metric.lower_bound(
                skin.sites.patch[site as usize],
                skin.sites.patch[other as usize],
            );
            let off = (arc_length(here, there, bound) - swelling.radius_mm) / swelling.width_mm;
            rise += force * (-0.5 * off * off).exp();
        }
    }
    rise * heights[region as usize]
}

/// True if a site lies within its region's zone of a colliding one (Xie 3.2.3).
fn is_active(skin: &Skin, colliding: &[u32], site: u32) -> bool {
    let sites = &skin.sites;
    let region = sites.region[site as usize];
    let reach = skin.tissue.materials[region as usize].zone_mm;
    let here = sites.rest[site as usize].position;
    colliding.iter().any(|&other| {
        sites.region[other as usize] == region
            && (sites.rest[other as usize].position - here).norm_squared() <= reach * reach
    })
}
