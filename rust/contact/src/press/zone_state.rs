//! The state of a zone while its contact is iterated: forces, directions, travels, measured distances.

use thenar_surface::{Gap, GapLimits, Vec3};

use super::live::extrapolation;
use super::setting::{SolveSetting, vertex};
use super::solution::ZoneSolution;
use crate::Model;
use crate::detection::gaps::limits;
use crate::detection::press_direction::{LEAST_COSINE, Neighborhood, Sums, press_directions};
use crate::fields::result::Convergence;
use crate::press::live::extrapolation::OuterLoads;
use crate::skin::prepare::Skin;
use crate::workspace::Pressing;
use crate::workspace::live_cache::ReusedSite;

/// Way in which a product's distance grows evenly, mm: over an edge of it the distance is then off by twice that at most (tests
/// pass up to 0.1).
const LITTLE_WAY: f64 = 1e-2;

/// What is known so far, by place in the zone.
pub(crate) struct ZoneState {
    pub zone: Vec<u32>,
    /// Which hold on to what they met in the last live solve; empty if all are solved.
    pub is_reused: Vec<bool>,
    pub beyond: OuterLoads,
    pub force: Vec<f64>,
    pub touch: Vec<Gap>,
    pub slack: Vec<f64>,
    pub direction: Vec<Vec3>,
    /// Normal of the wall that each was detected at: the side of the product on which it stays.
    pub(super) wall: Vec<Vec3>,
    /// What each direction comes from, where it is an average.
    pub sums: Vec<Sums>,
    /// Cosine between each direction and the product's normal.
    pub cosine: Vec<f64>,
    /// Travel of each zone site along its direction, mm.
    pub travel: Vec<f64>,
    /// The travel at which each was measured against the product, mm; NaN where it was not.
    placed: Vec<f64>,
    pub misfit: f64,
    pub complementarity: f64,
    pub convergence: Convergence,
}

impl ZoneState {
    pub(crate) fn new(zone: Vec<u32>) -> Self {
        let convergence = Convergence {
            has_converged: false,
            passes: 0,
            pivots: 0,
            cg_steps: 0,
        };
        ZoneState {
            zone,
            is_reused: Vec::new(),
            beyond: OuterLoads::Nothing,
            force: Vec::new(),
            touch: Vec::new(),
            slack: Vec::new(),
            direction: Vec::new(),
            wall: Vec::new(),
            sums: Vec::new(),
            cosine: Vec::new(),
            travel: Vec::new(),
            placed: Vec::new(),
            misfit: 0.0,
            complementarity: 0.0,
            convergence,
        }
    }

    /// Takes gaps, normals and directions of the undeformed posture.
    pub(crate) fn open(&mut self, pressing: &Pressing<'_>, setting: &SolveSetting<'_>) {
        let skin = pressing.skin;
        let gap_of =
            |&site: &u32| setting.detection.gaps[skin.sites.vertex[site as usize] as usize];
        self.touch = self.zone.iter().filter_map(gap_of).collect();
        debug_assert_eq!(self.touch.len(), self.zone.len());
        let normal: Vec<Vec3> = self.touch.iter().map(|g| g.normal).collect();
        self.wall.clone_from(&normal);
        self.sums = vec![Sums::default(); self.zone.len()];
        self.direction = match skin.model {
            Model::Paper => normal,
            Model::Layer => self.averaged_directions(pressing, setting, &normal),
        };
        self.travel = vec![0.0; self.zone.len()];
        let travel = setting.start.map_or(&[][..], |last| &last.travel);
        if !travel.is_empty() && skin.model == Model::Layer {
            // Little has moved: the product is met where the skin lay last.
            self.travel = self.zone.iter().map(|&s| travel[s as usize]).collect();
        }
        if self.beyond == OuterLoads::Trend {
            self.carry_travel_on(pressing, setting);
        }
        self.take_reused(pressing);
        self.placed = vec![f64::NAN; self.zone.len()];
        if !travel.is_empty() && skin.model == Model::Layer {
            self.place(skin, setting);
        }
        self.update_cosines(pressing);
        self.slack = self.reused_or(
            pressing,
            |reused_site| reused_site.slack,
            vec![0.0; self.zone.len()],
        );
        let carried = std::mem::take(&mut self.force);
        self.force = if carried.len() == self.zone.len() {
            carried
        } else {
            self.zone
                .iter()
                .map(|&s| setting.start.map_or(0.0, |start| start.force[s as usize]))
                .collect()
        };
        let mut force = std::mem::take(&mut self.force);
        if self.beyond == OuterLoads::Trend {
            self.carry_forces_on(pressing, setting, &mut force);
        }
        self.force = self.reused_or(pressing, |reused_site| reused_site.force, force);
    }

    /// Extrapolates travels from the last live press: motion usually continues.
    fn carry_travel_on(&mut self, pressing: &Pressing<'_>, setting: &SolveSetting<'_>) {
        for (k, &site) in self.zone.iter().enumerate() {
            // What joins the zone lay where the field carried it.
            self.travel[k] = match pressing.workspace.live_contact.of(site) {
                Some(_) => {
                    self.travel[k]
                        + extrapolation::extrapolated_change(pressing, setting, site)
                            .dot(&self.direction[k])
                }
                None => {
                    extrapolation::extrapolated(pressing, setting, site).dot(&self.direction[k])
                }
            };
        }
    }

    /// The same of forces.
    fn carry_forces_on(
        &self,
        pressing: &Pressing<'_>,
        setting: &SolveSetting<'_>,
        force: &mut [f64],
    ) {
        let live_field = &pressing.workspace.live_field;
        if !live_field.matches(pressing.skin.sites.len()) {
            return;
        }
        for (k, (force, &site)) in force.iter_mut().zip(&self.zone).enumerate() {
            if *force > 0.0 {
                let change = live_field.load_change[site as usize].dot(&self.direction[k]);
                let per_newton = setting.weight[site as usize] * self.cosine[k];
                *force = (*force + change / per_newton).max(0.0);
            }
        }
    }

    /// What a place holds on to.
    fn reused_site<'a>(&self, pressing: &'a Pressing<'_>, k: usize) -> Option<&'a ReusedSite> {
        let is_held = self.is_reused.get(k) == Some(&true);
        is_held.then(|| pressing.workspace.live_contact.of(self.zone[k]))?
    }

    /// `values` by place in the zone, with reused sites' own values filled in.
    fn reused_or(
        &self,
        pressing: &Pressing<'_>,
        value: impl Fn(&ReusedSite) -> f64,
        mut values: Vec<f64>,
    ) -> Vec<f64> {
        for (k, own) in values.iter_mut().enumerate() {
            *own = self.reused_site(pressing, k).map_or(*own, &value);
        }
        values
    }

    /// Takes over the solution of reused sites, before the other sites are measured.
    fn take_reused(&mut self, pressing: &Pressing<'_>) {
        for k in 0..self.is_reused.len() {
            if let Some(reused_site) = self.reused_site(pressing, k) {
                (self.touch[k], self.direction[k]) = (reused_site.touch, reused_site.direction);
                self.travel[k] = reused_site.travel;
            }
        }
    }

    /// Places in the zone that are solved.
    pub(crate) fn solved(&self) -> Vec<usize> {
        let is_solved = |k: &usize| self.is_reused.get(*k) != Some(&true);
        (0..self.zone.len()).filter(is_solved).collect()
    }

    /// Sites that are solved, ascending.
    pub(crate) fn solved_sites(&self) -> Vec<u32> {
        let sites = self.solved().into_iter().map(|k| self.zone[k]);
        sites.collect()
    }

    /// Averages over the penetrating sites, whatever else the zone holds: the result must not depend on its history.
    fn averaged_directions(
        &mut self,
        pressing: &Pressing<'_>,
        setting: &SolveSetting<'_>,
        normal: &[Vec3],
    ) -> Vec<Vec3> {
        let skin = pressing.skin;
        let inside: Vec<usize> = (0..self.zone.len())
            .filter(|&k| self.touch[k].distance < 0.0)
            .collect();
        let sites: Vec<u32> = inside.iter().map(|&k| self.zone[k]).collect();
        let normals: Vec<Vec3> = inside.iter().map(|&k| normal[k]).collect();
        let gaps: Vec<f64> = inside.iter().map(|&k| self.touch[k].distance).collect();
        let sums = |&k: &usize| {
            self.reused_site(pressing, k)
                .map(|reused_site| reused_site.sums)
        };
        let known: Vec<Option<Sums>> = inside.iter().map(sums).collect();
        let around = Neighborhood {
            sites: &skin.sites,
            adjacency: &skin.adjacency,
            spacing: setting.spacing,
        };
        let (averaged, sums) = press_directions(&sites, (&normals, &gaps), &known, &around);
        let mut direction = normal.to_vec();
        for ((k, average), sums) in inside.into_iter().zip(averaged).zip(sums) {
            (direction[k], self.sums[k]) = (average, sums);
        }
        direction
    }

    /// Takes the cosines between directions and the product's normals as they are now.
    pub(crate) fn update_cosines(&mut self, pressing: &Pressing<'_>) {
        let cosine = |(touch, direction): (&Gap, &Vec3)| touch.normal.dot(direction);
        let cosines = self.touch.iter().zip(&self.direction).map(cosine);
        let cosines = cosines.map(|c| c.max(LEAST_COSINE)).collect();
        self.cosine = self.reused_or(pressing, |reused_site| reused_site.cosine, cosines);
    }

    /// Measures the displaced zone against the product; in a live press, what hardly travelled since it was measured is only
    /// carried on.
    pub(crate) fn place(&mut self, skin: &Skin, setting: &SolveSetting<'_>) {
        let positions = &setting.detection.positions;
        let mut places = self.solved();
        if self.beyond != OuterLoads::Nothing {
            places.retain(|&k| !self.is_carried_on(k));
        }
        let written =
            |&k: &usize| positions[vertex(skin, self.zone[k])] + self.direction[k] * self.travel[k];
        let written: Vec<Vec3> = places.iter().map(written).collect();
        // The side detected stays the side: skin in a fold, or at a thin wall, may be nearer to another wall once it has moved.
        let normals: Vec<Vec3> = places.iter().map(|&k| -self.wall[k]).collect();
        let hints: Vec<u32> = places.iter().map(|&k| self.touch[k].triangle).collect();
        let fresh = setting
            .product
            .gaps_along(&written, Some(&normals), limits(), &hints);
        let mut fresh = self.measured_without_limit(setting, &written, fresh);
        if let Some(tool) = &setting.detection.under_tool {
            let vertices = places.iter().map(|&k| vertex(skin, self.zone[k]));
            let readings = vertices.zip(written).zip(&mut fresh);
            tool.read_again(setting.product, readings.map(|((v, p), gap)| (v, p, gap)));
        }
        for (k, gap) in places.into_iter().zip(fresh) {
            if let Some(gap) = gap {
                self.touch[k] = gap;
                self.placed[k] = self.travel[k];
            }
        }
        self.misfit = self.measure();
    }

    /// Measures again, as far as it takes, what has left the reach of the query: it is outside, never where it was before.
    fn measured_without_limit(
        &self,
        setting: &SolveSetting<'_>,
        written: &[Vec3],
        mut gaps: Vec<Option<Gap>>,
    ) -> Vec<Option<Gap>> {
        let lost: Vec<usize> = (0..gaps.len()).filter(|&k| gaps[k].is_none()).collect();
        let points: Vec<Vec3> = lost.iter().map(|&k| written[k]).collect();
        let in_full = GapLimits {
            cut_off_mm: f64::INFINITY,
            ..limits()
        };
        let found = setting.product.gaps_along(&points, None, in_full, &[]);
        lost.into_iter()
            .zip(found)
            .for_each(|(k, gap)| gaps[k] = gap);
        gaps
    }

    /// Distance from the product's surface of each place under a force, or depth of each without, mm.
    pub(crate) fn misfits(&self) -> Vec<f64> {
        self.touch
            .iter()
            .zip(&self.force)
            .map(|(gap, force)| misfit(gap, *force))
            .collect()
    }

    /// Travel (mm) and distance to the product there (mm) of each place, as measured last.
    pub(crate) fn measured(&self) -> impl Iterator<Item = (f64, f64)> {
        let distances = self.touch.iter().map(|gap| gap.distance);
        self.travel.iter().copied().zip(distances)
    }

    /// Whether a place travelled so little since it was measured that its distance follows; it then does.
    fn is_carried_on(&mut self, k: usize) -> bool {
        let way = self.travel[k] - self.placed[k];
        let is_little = way.abs() < LITTLE_WAY;
        if is_little {
            let touch = &mut self.touch[k];
            let by = touch.normal.dot(&self.direction[k]) * way;
            touch.distance += by;
            touch.closest += self.direction[k] * way - touch.normal * by;
            self.placed[k] = self.travel[k];
        }
        is_little
    }

    /// Largest penetration of the zone, or opening under a force, mm.
    pub(crate) fn measure(&self) -> f64 {
        self.misfits().into_iter().fold(0.0, f64::max)
    }

    pub(crate) fn found(&self) -> ZoneSolution<'_> {
        ZoneSolution {
            zone: &self.zone,
            force: &self.force,
            direction: &self.direction,
            cosine: &self.cosine,
            travel: &self.travel,
            touch: &self.touch,
            slack: &self.slack,
            sums: &self.sums,
            is_reused: &self.is_reused,
        }
    }

    pub(crate) fn extend(&mut self, lifted: Vec<u32>) {
        let carried: Vec<(u32, f64)> = self
            .zone
            .iter()
            .copied()
            .zip(self.force.iter().copied())
            .collect();
        self.zone.extend(lifted);
        self.zone.sort_unstable();
        let find = |site: &u32| {
            carried
                .binary_search_by_key(site, |c| c.0)
                .map_or(0.0, |k| carried[k].1)
        };
        self.force = self.zone.iter().map(find).collect();
    }
}

/// Distance from the surface under a force, or depth without, mm.
fn misfit(gap: &Gap, force: f64) -> f64 {
    if force > 0.0 {
        gap.distance.abs()
    } else {
        (-gap.distance).max(0.0)
    }
}
