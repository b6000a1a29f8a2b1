//! Conducts friction on a solved press: force limits, one stick-slip step, the skin displaced by shear.
//!
//! Left out: what shear does to the pressure and pressure to shear (nothing at nu = 1/2 on a half space; Goodman's
//! approximation elsewhere), relaxation of the shear force, and the shrinking of the contact at the onset of slip.

use std::collections::BTreeSet;

use rayon::prelude::*;
use thenar_surface::{Gap, Product, Vec3};

use super::friction_state::{FrictionMemory, ShearState};
use super::shear_matrix::{ShearMatrix, tangents};
use super::shear_response::{Pairs, Place, ShearResponse};
use super::stick_slip::{SiteFriction, StickSlipProblem};
use crate::api::Drag;
use crate::detection::gaps::limits;
use crate::effects::{ActiveEffect, Effect, friction};
use crate::press::pressed::Pressed;
use crate::press::solution::SolvedContact;
use crate::skin::prepare::Skin;
use crate::workspace::Pressing;
use crate::{ContactError, Control};

/// Most sites in contact: their compliance takes 8 bytes a pair.
const MOST_SITES: usize = 8192;

/// Most sites whose kernel is kept for the next row.
const MOST_KEPT: usize = 3000;

/// True if friction acts anywhere.
pub(crate) fn acts(skin: &Skin) -> bool {
    active(skin).next().is_some()
}

fn active(skin: &Skin) -> impl Iterator<Item = &ActiveEffect> {
    skin.effects()
        .iter()
        .filter(|e| e.effect == Effect::Friction && e.amplitude > 0.0)
}

/// What the next step must know of this one, the product having travelled `travel` (mm).
pub(crate) fn friction_memory(pressed: &Pressed, travel: Vec3) -> FrictionMemory {
    let Some(sheared) = &pressed.shear else {
        return FrictionMemory {
            travel,
            ..FrictionMemory::default()
        };
    };
    let traces = sheared.places.iter().map(|p| p.site);
    FrictionMemory {
        traces: traces.zip(sheared.end.traces.iter().copied()).collect(),
        travel,
        turn: sheared.turn,
        strays: Vec::new(),
    }
}

/// Drags the product over the pressed skin; does nothing without the effect or without contact. The skin moves only when
/// [`move_skin`] is called.
///
/// # Errors
/// [`ContactError::Effect`] if there are too many sites or friction cannot hold the force, `Direction`, `Cancelled`.
pub(crate) fn drag(
    pressing: &mut Pressing<'_>,
    pressed: &mut Pressed,
    (drag, before): (Drag, &FrictionMemory),
    control: &Control,
) -> Result<(), ContactError> {
    check(drag)?;
    let skin = pressing.skin;
    let at: Vec<usize> = (0..pressed.solved.zone.len())
        .filter(|&k| pressed.solved.force[k] > 0.0)
        .collect();
    if !acts(skin) || at.is_empty() {
        return Ok(());
    }
    if at.len() > MOST_SITES {
        return Err(ContactError::Effect {
            effect: Effect::Friction.name(),
            problem: format!(
                "{} vertices are in contact, but friction takes {MOST_SITES} at most; use a coarser hand",
                at.len()
            ),
        });
    }
    control.step("friction", 0.0)?;
    let sites: Vec<u32> = at.iter().map(|&k| pressed.solved.zone[k]).collect();
    let pairs = response(skin).pairs(&sites, &pressing.workspace.pairs);
    let scene = FrictionProblem::new(skin, (pressed, at), &pairs);
    let sheared = scene.drag((drag, before), control)?;
    control.check()?;
    pressed.shear = Some(sheared);
    pressing.workspace.pairs = if sites.len() <= MOST_KEPT {
        pairs
    } else {
        Pairs::default()
    };
    control.step("friction", 1.0)
}

fn check(drag: Drag) -> Result<(), ContactError> {
    let is_finite = |v: Vec3| v.iter().all(|c| c.is_finite());
    match drag {
        Drag::Motion { travel, turn } if is_finite(travel) && is_finite(turn) => Ok(()),
        Drag::Force(force) if is_finite(force) && force.norm() > 0.0 => Ok(()),
        _ => Err(ContactError::Drag),
    }
}

/// The contact as friction sees it.
struct FrictionProblem {
    at: Vec<usize>,
    places: Vec<Place>,
    tangents: Vec<[Vec3; 2]>,
    limit: Vec<f64>,
    /// Force-weighted mean of the contact, mm.
    center: Vec3,
    /// Mean normal of the region's contact, at every site.
    approach: Vec<Vec3>,
    matrix: ShearMatrix<f32>,
}

impl FrictionProblem {
    fn new(skin: &Skin, (pressed, at): (&Pressed, Vec<usize>), pairs: &Pairs) -> FrictionProblem {
        let solved = &pressed.solved;
        let place = |&k: &usize| place(skin, pressed, solved.zone[k]);
        let places: Vec<Place> = at.iter().map(place).collect();
        let tangents: Vec<[Vec3; 2]> = at
            .iter()
            .map(|&k| tangents(&solved.touch[k].normal))
            .collect();
        let limit = |(k, place): (&usize, &Place)| coefficient(skin, place.site) * solved.force[*k];
        let limit = at.iter().zip(&places).map(limit).collect();
        let force: f64 = at.iter().map(|&k| solved.force[k]).sum();
        let weighted = |&k: &usize| solved.touch[k].closest * (solved.force[k] / force);
        let center = at.iter().map(weighted).sum();
        let matrix = response(skin).matrix(&places, &tangents, pairs);
        let approach = approach(skin, &pressed.solved, &at);
        FrictionProblem {
            at,
            places,
            tangents,
            limit,
            center,
            approach,
            matrix,
        }
    }

    fn drag(
        self,
        (drag, before): (Drag, &FrictionMemory),
        control: &Control,
    ) -> Result<ShearState, ContactError> {
        let trace = |place: &Place| {
            let found = before.traces.binary_search_by_key(&place.site, |t| t.0);
            found.ok().map(|k| before.traces[k].1)
        };
        let remembered: Vec<Option<SiteFriction>> = self.places.iter().map(trace).collect();
        let grip = StickSlipProblem {
            matrix: &self.matrix,
            tangents: &self.tangents,
            limit: &self.limit,
            before: &remembered,
        };
        let strayed = self.strayed(&remembered, &before.strays);
        let astray = |motion: Vec<Vec3>| -> Vec<Vec3> {
            motion
                .into_iter()
                .zip(&strayed)
                .map(|(m, s)| m + s)
                .collect()
        };
        let from = self.moved(before.travel, before.turn);
        let (travel, turn, mut end) = match drag {
            Drag::Motion { travel, turn } => (
                travel,
                turn,
                grip.drag(&from, &astray(self.moved(travel, turn)), control),
            ),
            Drag::Force(force) => {
                let along = force.normalize();
                let direction = vec![along; self.at.len()];
                let wanted = (&direction[..], along, force.norm());
                let Some((travel, end)) = grip.drag_to_force(&from, wanted, control) else {
                    return Err(self.too_much(&force));
                };
                (before.travel + along * travel, before.turn, end)
            }
        };
        for (trace, strayed) in end.traces.iter_mut().zip(&strayed) {
            trace.strayed = *strayed;
        }
        Ok(ShearState {
            at: self.at,
            places: self.places,
            limit: self.limit,
            travel,
            turn,
            end,
        })
    }

    /// How far the posture's own motion has taken the product over every site, mm.
    ///
    /// What brings a contact nearer as a whole is no travel over the skin: it is taken off along the region's
    /// mean normal.
    fn strayed(&self, remembered: &[Option<SiteFriction>], strays: &[Vec3]) -> Vec<Vec3> {
        let strayed = |((place, trace), mean): ((&Place, &Option<SiteFriction>), &Vec3)| {
            let so_far = trace.map_or_else(Vec3::zeros, |t| t.strayed);
            let more = strays.get(place.site as usize);
            so_far + more.map_or_else(Vec3::zeros, |m| m - mean * mean.dot(m))
        };
        let sites = self.places.iter().zip(remembered);
        sites.zip(&self.approach).map(strayed).collect()
    }

    /// Motion of the product at every site, mm.
    fn moved(&self, travel: Vec3, turn: Vec3) -> Vec<Vec3> {
        let at = |place: &Place| travel + turn.cross(&(place.position - self.center));
        self.places.iter().map(at).collect()
    }

    fn too_much(&self, force: &Vec3) -> ContactError {
        let along = force.normalize();
        let holds = self.tangents.iter().zip(&self.limit);
        let most: f64 = holds
            .map(|([a, b], limit)| limit * along.dot(a).hypot(along.dot(b)))
            .sum();
        ContactError::Effect {
            effect: Effect::Friction.name(),
            problem: format!(
                "{:.3} N along the skin is more than the {most:.3} N that friction holds there; press harder, drag less, or \
                 give a larger coefficient",
                force.norm()
            ),
        }
    }
}

/// Coefficient of friction at a site: the largest of the effects there.
fn coefficient(skin: &Skin, site: u32) -> f64 {
    let region = skin.sites.home_region(site as usize);
    active(skin)
        .map(|effect| effect.amplitude_on(region) * friction::coefficient(effect))
        .fold(0.0, f64::max)
}

/// Mean normal of each region's contact by force, at every site in contact.
fn approach(skin: &Skin, solved: &SolvedContact, at: &[usize]) -> Vec<Vec3> {
    let region = |k: usize| skin.sites.home_region(solved.zone[k] as usize) as usize;
    let mut mean = vec![Vec3::zeros(); skin.tissue.materials.len()];
    for &k in at {
        mean[region(k)] += solved.touch[k].normal * solved.force[k];
    }
    let unit = |k: &usize| mean[region(*k)].try_normalize(0.0);
    at.iter()
        .map(|k| unit(k).unwrap_or_else(Vec3::zeros))
        .collect()
}

fn place(skin: &Skin, pressed: &Pressed, site: u32) -> Place {
    let modulus = pressed.modulus_at[site as usize];
    Place {
        site,
        position: pressed.detection.positions[skin.sites.vertex[site as usize] as usize],
        weight: 1.0 / (std::f64::consts::TAU * modulus).sqrt(),
    }
}

fn response(skin: &Skin) -> ShearResponse<'_> {
    ShearResponse {
        tables: skin.shear_tables(),
        response: &skin.response,
        sites: &skin.sites,
    }
}

/// Moves the skin as the shear forces do, along its own surface, and lays it on the product again.
pub(crate) fn move_skin(skin: &Skin, product: &Product, pressed: &mut Pressed) {
    let Some(sheared) = pressed.shear.as_ref() else {
        return;
    };
    let forces: Vec<Vec3> = sheared.end.traces.iter().map(|t| t.force).collect();
    let response = response(skin);
    let mut moved: Vec<Vec3> = (0..skin.sites.len() as u32)
        .into_par_iter()
        .with_min_len(64)
        .map(|site| {
            let vertex = skin.sites.vertex[site as usize] as usize;
            let normal = pressed.detection.normals[vertex];
            let there = place(skin, pressed, site);
            let u = response.displacement(&there, &sheared.places, &forces);
            (u - normal * normal.dot(&u)) * skin.sites.follow[site as usize]
        })
        .collect();
    for (place, u) in sheared.places.iter().zip(&sheared.end.displacement) {
        moved[place.site as usize] = *u;
    }
    let is_pressed: BTreeSet<u32> = sheared.places.iter().map(|p| p.site).collect();
    lay_on_product(skin, product, pressed, (&moved, &is_pressed));
}

/// Adds `moved` to the displacement; pressed skin stays on the product's surface and no other ends inside.
fn lay_on_product(
    skin: &Skin,
    product: &Product,
    pressed: &mut Pressed,
    (moved, is_pressed): (&[Vec3], &BTreeSet<u32>),
) {
    let gap_of = |site: u32| pressed.detection.gaps[skin.sites.vertex[site as usize] as usize];
    let mut near: Vec<(u32, Gap)> = Vec::new();
    for (site, u) in moved.iter().enumerate() {
        let whole = pressed.solved.displacement[site] + u;
        pressed.solved.displacement[site] = whole;
        let site = site as u32;
        if let Some(gap) =
            gap_of(site).filter(|g| g.distance < whole.norm() && skin.sites.is_skin(site as usize))
        {
            near.push((site, gap));
        }
    }
    let displacement = &mut pressed.solved.displacement;
    let position =
        |site: u32| pressed.detection.positions[skin.sites.vertex[site as usize] as usize];
    let points: Vec<Vec3> = near
        .iter()
        .map(|(s, _)| position(*s) + displacement[*s as usize])
        .collect();
    let facing: Vec<Vec3> = near.iter().map(|(_, g)| -g.normal).collect();
    let hints: Vec<u32> = near.iter().map(|(_, g)| g.triangle).collect();
    let fresh = product.gaps_along(&points, Some(&facing), limits(), &hints);
    for ((site, _), gap) in near.iter().zip(fresh) {
        let Some(gap) = gap else { continue };
        if gap.distance < 0.0 || is_pressed.contains(site) {
            displacement[*site as usize] -= gap.normal * gap.distance;
        }
    }
}
