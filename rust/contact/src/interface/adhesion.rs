//! Adhesion: attraction by gap, iterated with the contact solver from the attracted side.
//!
//! The attraction moves the posture before the solve, as loads do; the certified contact solver then finds the repulsion in
//! the moved posture, and the gaps it leaves give the next attraction. More attraction means smaller gaps, so from the
//! attraction of the step before the iteration goes one way, to the nearest equilibrium on its side: the path in is not the
//! path out. It ends where equilibria are stable and leaps where they are not.

use thenar_surface::{Gap, Product, Vec3};

use super::pulls::Pull;
use crate::detection::gaps::{Detection, limits};
use crate::effects::{ActiveEffect, Effect, adhesion};
use crate::press::effective_modulus::rest_weights;
use crate::press::setting::vertex;
use crate::press::solution::SolvedContact;
use crate::skin::prepare::Skin;

/// Largest attraction of a vertex over `sqrt(2 w A / a)`, with A its area and a its own compliance.
///
/// At 1 a single vertex would leap by itself and the mesh would hold the contact's edge: pull-off is then overrated. Below,
/// attraction reaches farther where the mesh cannot resolve the range. Chosen together with [`MESH_SHARE`] so that pull-off on
/// lattices of 8 and 10 spacings in JKR's contact at no load is JKR's: there the agreement is a calibration.
const STEADY: f64 = 0.85;
/// Share of the work of adhesion that is kept where the mesh, not the range, limits the attraction.
///
/// Attraction that reaches as far as the mesh needs holds on longer than a short one: dense solves on lattices of six to ten
/// spacings in JKR's contact at no load pull off at 1.61 to 1.57 instead of 1.5 pi w R with the whole work. On coarser
/// meshes pull-off is higher still; DMT's limit, a wide range, does not use this.
const MESH_SHARE: f64 = 0.95;
/// Change of attraction over its largest value that ends the iteration.
const TOLERANCE: f64 = 1e-5;
/// Most solves of one press.
pub const MOST_SOLVES: usize = 400;

/// The law of every site of a skin.
pub(crate) struct AdhesionLaw {
    /// Largest attraction, N, and gap at which it ends, mm; by site, zero where there is none.
    law: Vec<(f64, f64)>,
    /// Sites that are pulled without being pressed: their bonds are reversible, or held in the step before.
    is_bonded: Vec<bool>,
    most: f64,
    farthest: f64,
}

impl AdhesionLaw {
    /// The law of the skin by its response weights in rest, so that it stays the same whatever is pressed: attraction that
    /// changed with the posture would do work of its own. `before` is the attraction of the step before. None without adhesion.
    pub fn new(skin: &Skin, before: &[Pull]) -> Option<AdhesionLaw> {
        let active: Vec<&ActiveEffect> = skin
            .effects()
            .iter()
            .filter(|e| {
                e.effect == Effect::Adhesion && e.amplitude > 0.0 && adhesion::work(e) > 0.0
            })
            .collect();
        if active.is_empty() {
            return None;
        }
        let weight = rest_weights(skin);
        let law_at = |site: usize| {
            let region = skin.sites.home_region(site);
            let here = active
                .iter()
                .filter(|e| skin.sites.is_skin(site) && e.acts_on(region));
            let strongest = here
                .map(|e| {
                    let work = e.amplitude * adhesion::work(e);
                    (work, adhesion::range(e), adhesion::is_on_touch(e))
                })
                .max_by(|a, b| a.0.total_cmp(&b.0));
            let Some((work, range, on_touch)) = strongest else {
                return ((0.0, 0.0), false);
            };
            let known = |pull: &Pull| pull.site.cmp(&(site as u32));
            let is_bonded = !on_touch || before.binary_search_by(known).is_ok();
            let energy = work * skin.sites.area[site];
            let own = weight[site].powi(2) * skin.response.own(site, &skin.sites);
            let steady = STEADY * (2.0 * energy / own).sqrt();
            let law = if 2.0 * energy / range <= steady {
                (2.0 * energy / range, range)
            } else {
                (steady, (MESH_SHARE * 2.0 * energy / steady).max(range))
            };
            (law, is_bonded)
        };
        let (law, is_bonded): (Vec<(f64, f64)>, Vec<bool>) =
            (0..skin.sites.len()).map(law_at).unzip();
        Some(AdhesionLaw {
            is_bonded,
            most: law.iter().fold(0.0, |most, l| f64::max(most, l.0)),
            farthest: law.iter().fold(0.0, |most, l| f64::max(most, l.1)),
            law,
        })
    }

    /// Attraction of the skin as a solve left it, from the true posture of `detection`.
    ///
    /// Where bonds form on touch, skin is pulled that is pressed now or was pulled in the step before.
    /// It falls with the distance from where the skin now lies and pulls along the normal there, the distance's gradient: so it
    /// has a potential.
    pub fn pulls(
        &self,
        skin: &Skin,
        (product, detection): (&Product, &Detection),
        solved: &SolvedContact,
    ) -> Vec<Pull> {
        let mut pulls = Vec::new();
        let (mut apart, mut points): (Vec<(usize, Gap)>, Vec<Vec3>) = (Vec::new(), Vec::new());
        for site in (0..self.law.len()).filter(|&s| self.law[s].0 > 0.0) {
            let vertex = vertex(skin, site as u32);
            let Some(gap) = detection.gaps[vertex] else {
                continue;
            };
            let moved = solved.displacement[site];
            if gap.distance - moved.norm() > self.farthest {
                continue;
            }
            match solved.zone.binary_search(&(site as u32)) {
                Ok(k) if solved.force[k] > 0.0 || self.is_bonded[site] => {
                    pulls.extend(self.pull(site, &solved.touch[k], solved.slack[k]));
                }
                Ok(_) => {}
                Err(_) if !self.is_bonded[site] => {}
                Err(_) => {
                    apart.push((site, gap));
                    points.push(detection.positions[vertex] + moved);
                }
            }
        }
        let facing: Vec<Vec3> = apart.iter().map(|(_, gap)| -gap.normal).collect();
        let hints: Vec<u32> = apart.iter().map(|(_, gap)| gap.triangle).collect();
        let gaps = product.gaps_along(&points, Some(&facing), limits(), &hints);
        let reached = apart.iter().zip(gaps);
        pulls.extend(reached.filter_map(|((site, _), gap)| self.pull(*site, &gap?, gap?.distance)));
        pulls.sort_unstable_by_key(|pull| pull.site);
        pulls
    }

    /// Attraction of a site at a distance (mm) from where it touches or would.
    fn pull(&self, site: usize, touch: &Gap, distance: f64) -> Option<Pull> {
        let (most, range) = self.law[site];
        let newton = most * (1.0 - distance.max(0.0) / range);
        (newton > 0.0).then_some(Pull {
            site: site as u32,
            normal: touch.normal,
            closest: touch.closest,
            newton,
        })
    }

    /// True if two attractions are the same within the tolerance.
    pub fn is_settled(&self, before: &[Pull], after: &[Pull]) -> bool {
        let (mut a, mut b) = (before.iter().peekable(), after.iter().peekable());
        let limit = TOLERANCE * self.most;
        loop {
            let change = match (a.peek(), b.peek()) {
                (None, None) => return true,
                (Some(x), Some(y)) if x.site == y.site => {
                    let change = (x.load() - y.load()).norm();
                    a.next();
                    b.next();
                    change
                }
                (Some(x), y) if y.is_none_or(|y| x.site < y.site) => {
                    a.next().map_or(0.0, |x| x.newton)
                }
                _ => b.next().map_or(0.0, |y| y.newton),
            };
            if change > limit {
                return false;
            }
        }
    }
}
