//! The posture displaced by remembered loads before a solve, and the solution scaled back after it.

use std::sync::Arc;

use thenar_surface::{Product, Vec3};

use super::tissue_memory::MemoryStep;
use crate::detection::gaps::{Detection, distances_of, limits};
use crate::press::solution::SolvedContact;
use crate::response::assembly::Load;
use crate::skin::prepare::Skin;
use crate::workspace::Pressing;
use crate::{ContactError, Control};

/// Displaced skin nearer to the product than this is measured again, mm; farther skin keeps a first-order gap.
const NEAR: f64 = 2.0;

/// Bounds of the pressure left at a site over the elastic one.
const EDGE_SHARES: (f64, f64) = (0.02, 50.0);

/// The posture before memory and adhesion displace it.
pub struct TruePosture<'a> {
    pub product: &'a Product,
    /// Its gaps.
    pub detection: &'a Detection,
    /// Response weight by site.
    pub weight: &'a [f64],
}

/// The posture as the memory leaves it.
pub struct DisplacedPosture {
    /// Detection there; the largest penetrations stay those of the true posture.
    pub detection: Detection,
    /// Displacement that memory brings, by site, mm.
    field: Vec<Vec3>,
}

impl DisplacedPosture {
    /// Adds to a solution of the moved posture what moved it.
    pub fn add_to(&self, solved: &mut SolvedContact) {
        for (u, moved) in solved.displacement.iter_mut().zip(&self.field) {
            *u += moved;
        }
    }
}

/// Displaces a posture by loads (N) on sites.
///
/// # Errors
/// [`ContactError::Cancelled`].
pub fn displace(
    pressing: &Pressing<'_>,
    posture: &TruePosture<'_>,
    loads: &[(u32, Vec3)],
    control: &Control,
) -> Result<DisplacedPosture, ContactError> {
    let &TruePosture {
        product,
        detection: truth,
        weight,
    } = posture;
    let skin = pressing.skin;
    let load = |&(site, load): &(u32, Vec3)| Load {
        site,
        load: load * weight[site as usize],
    };
    let loads: Vec<Load> = loads.iter().map(load).collect();
    let mut field = pressing.displacement(loads, control)?.field;
    for (site, u) in field.iter_mut().enumerate() {
        *u *= weight[site] * skin.sites.follow[site];
    }
    let (mut positions, mut gaps) = (truth.positions.clone(), truth.gaps.to_vec());
    let mut near: Vec<usize> = Vec::new();
    for (u, &vertex) in field.iter().zip(&skin.sites.vertex) {
        let vertex = vertex as usize;
        positions[vertex] += u;
        if let Some(gap) = gaps[vertex].as_mut().filter(|_| *u != Vec3::zeros()) {
            gap.distance += u.dot(&gap.normal);
            if gap.distance < NEAR {
                near.push(vertex);
            }
        }
    }
    let points: Vec<Vec3> = near.iter().map(|&v| positions[v]).collect();
    let normals: Vec<Vec3> = near.iter().map(|&v| truth.normals[v]).collect();
    let hints: Vec<u32> = near
        .iter()
        .map(|&v| gaps[v].as_ref().map_or(u32::MAX, |g| g.triangle))
        .collect();
    let mut fresh = product.gaps_along(&points, Some(&normals), limits(), &hints);
    if let Some(tool) = &truth.under_tool {
        let places = near.iter().copied().zip(points.iter().copied());
        let readings = places.zip(&mut fresh).map(|((v, p), gap)| (v, p, gap));
        tool.read_again(product, readings);
    }
    for (vertex, gap) in near.into_iter().zip(fresh) {
        gaps[vertex] = gap.or(gaps[vertex]);
    }
    let detection = Detection {
        positions,
        normals: truth.normals.clone(),
        areas: truth.areas.clone(),
        distances: distances_of(&gaps),
        gaps: Arc::new(gaps),
        max_penetration: truth.max_penetration.clone(),
        under_tool: truth.under_tool.clone(),
    };
    Ok(DisplacedPosture { detection, field })
}

/// Turns the solution of the moved posture into that of the true one; returns what each site of the zone bears in the
/// elastic tissue's terms, N.
///
/// The gap beside the contact belongs to the elastic load, the pressure to what is left of it: `modulus` by site, which ties
/// one to the other at the contact's edge, is scaled by their ratio. Not so where the product leaves: near an edge that
/// moves inward only what happened last counts, and that is elastic.
pub fn restore(
    skin: &Skin,
    solved: &mut SolvedContact,
    modulus: &mut [f64],
    recall: &MemoryStep,
) -> Vec<(u32, Vec3)> {
    let mut bearing = Vec::with_capacity(solved.zone.len());
    for (k, &site) in solved.zone.iter().enumerate() {
        let fresh = solved.bearing[k] * solved.force[k];
        bearing.push((site, fresh));
        let region = skin.sites.home_region(site as usize) as usize;
        solved.force[k] *= recall.instantaneous[region];
        if solved.force[k] > 0.0 && !recall.is_left[region] {
            let known = recall.loads.binary_search_by_key(&site, |load| load.0);
            let elastic = fresh + known.map_or_else(|_| Vec3::zeros(), |at| recall.loads[at].1);
            let share = solved.force[k] / elastic.norm();
            modulus[site as usize] *= share.clamp(EDGE_SHARES.0, EDGE_SHARES.1);
        }
    }
    bearing
}
