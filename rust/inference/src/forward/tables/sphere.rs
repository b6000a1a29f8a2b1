//! Closed-form tables of spheres on flat homogeneous skin, without a mesh (`thenar_contact::ball`).

use crate::forward::mesh::replay::Replay;
use thenar_contact::ball::Ball;
use thenar_contact::effects::Effect;
use thenar_contact::{ActiveEffect, Material};

use crate::forward::mesh::press_table::PressTable;

/// Part by which the mesh's force may differ from a ball's in the last quarter of its table, if that is the ball that it is pressed with.
const AGREES: f64 = 0.05;

/// Part of the deepest depth from which rings are as many as a contact needs.
const SHALLOW: f64 = 0.01;

/// A tool at a place that is such a ball.
#[derive(Debug, Clone)]
pub struct SphereTable {
    radius_mm: f64,
    /// Thickness, mm, and Poisson's ratio.
    layer: (f64, f64),
    /// Roots of the depths of its table, mm^0.5.
    roots: Vec<f64>,
    /// Forces there over the modulus, mm2.
    pub bare: Vec<f64>,
}

/// Whether the bone under every one of these tissues has a width; one without end is as one that is not known.
pub(crate) fn has_width(materials: &[Material]) -> bool {
    materials.iter().all(|m| m.bone_half_width_mm.is_finite())
}

/// By place whose table from the mesh is given: the ball that it is. Skin of one region that is flat over bone without end, and a ball that presses it as
/// the mesh has it.
pub fn known(
    replay: &Replay,
    is_flat: bool,
    (places, base, materials): (&[usize], &[PressTable], &[Material]),
) -> Vec<Option<SphereTable>> {
    let one = |(place, table): (&usize, &PressTable)| {
        let radius_mm = replay.ball(*place)?;
        let [material] = materials else {
            return None;
        };
        // Narrow bone gives tissue room to the sides, which a layer without end has not.
        let is_layer = is_flat && !has_width(materials);
        SphereTable::of(radius_mm, material, table).filter(|_| is_layer)
    };
    places.iter().zip(base).map(one).collect()
}

impl SphereTable {
    fn of(radius_mm: f64, material: &Material, table: &PressTable) -> Option<SphereTable> {
        let mut known = SphereTable {
            radius_mm,
            layer: (material.thickness_mm, material.poisson_ratio),
            roots: table.roots.clone(),
            bare: Vec::new(),
        };
        known.bare = known.forces(known.layer)?;
        let last = known.bare.len() * 3 / 4;
        let pairs = known.bare.iter().zip(&table.force).skip(last);
        let agrees = |(a, b): (&f64, &f64)| (b / material.g0_mpa / a - 1.0).abs() < AGREES;
        let is_it = pairs.into_iter().all(agrees);
        is_it.then_some(known)
    }

    /// The ball over its layer, to its deepest depth.
    pub fn ball(&self) -> Option<Ball> {
        self.on(self.layer)
    }

    fn on(&self, layer: (f64, f64)) -> Option<Ball> {
        let deepest = self.roots.last()?.powi(2);
        (deepest < self.radius_mm).then(|| Ball::new(layer, self.radius_mm, deepest))
    }

    /// By how much an effect changes the force, as a logarithm, by depth of the table; None for one that changes more of the layer than its
    /// thickness and Poisson's ratio.
    pub fn changed(&self, effect: &ActiveEffect) -> Option<Vec<f64>> {
        let forces = self.forces(match effect.effect {
            Effect::Bone => (effect.shape[0], self.layer.1),
            Effect::Compressibility => (self.layer.0, effect.shape[0]),
            _ => return None,
        })?;
        let log = |(with, bare): (&f64, &f64)| libm::log(with / bare);
        let mut logs: Vec<f64> = forces.iter().zip(&self.bare).map(log).collect();
        // At first touch, where both vanish, as at the first rung.
        logs[0] = logs[1];
        Some(logs)
    }

    /// Forces over the modulus, mm2, by depth of the table, on a layer.
    fn forces(&self, layer: (f64, f64)) -> Option<Vec<f64>> {
        let deepest = self.roots.last()?;
        let first = self
            .roots
            .iter()
            .position(|r| r * r >= SHALLOW * deepest * deepest)?;
        let depths: Vec<f64> = self.roots[first..].iter().map(|r| r * r).collect();
        let found = self.on(layer)?.forces(None, &depths)?;
        // The first ones as Hertz has them: no layer is thin against so small a contact.
        let hertz = |root: &f64| found[0] * (root / self.roots[first]).powi(3);
        let shallow = self.roots[..first].iter().map(hertz);
        Some(shallow.chain(found.iter().copied()).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::forward::surrogate::synthetic::press_table;

    fn half_space(poisson_ratio: f64) -> Material {
        Material {
            g0_mpa: 0.01,
            thickness_mm: f64::INFINITY,
            poisson_ratio,
            ..Material::default()
        }
    }

    /// Hertz: F = 8/3 G / (1 - nu) sqrt(R) d^1.5; a ball of 40 mm is his paraboloid within 0.3 %.
    #[test]
    fn sphere_table_equals_hertz() {
        let hertz = |nu: f64, d: f64| 8.0 / 3.0 / (1.0 - nu) * 40.0f64.sqrt() * libm::pow(d, 1.5);
        let material = half_space(0.5);
        let meshed = |share: f64| press_table(0.7, move |d| 0.01 * share * hertz(0.5, d));
        assert!(SphereTable::of(40.0, &material, &meshed(0.9)).is_none());
        let known = SphereTable::of(40.0, &material, &meshed(1.02)).unwrap();
        let mut softer = ActiveEffect::new(Effect::Compressibility, 1.0);
        softer.shape[0] = 0.3;
        let changed = known.changed(&softer).unwrap();
        assert_eq!((known.bare[0], changed[0]), (0.0, changed[1]));
        for (k, root) in known.roots.iter().enumerate().skip(1) {
            let (depth, share) = (root * root, root * root / 0.7);
            let most = if share > 0.04 { 0.008 } else { 0.06 };
            let off = known.bare[k] / hertz(0.5, depth) - 1.0;
            assert!(off.abs() < most, "{share}: {off}");
            // 1 / (1 - 0.3) for 1 / (1 - 0.5), at all depths.
            assert!((changed[k] - libm::log(0.5 / 0.7)).abs() < 1e-9);
        }
    }

    /// On 5 mm, to 0.64 mm.
    fn thick(radius_mm: f64) -> SphereTable {
        SphereTable {
            radius_mm,
            layer: (5.0, 0.5),
            roots: vec![0.0, 0.4, 0.8],
            bare: Vec::new(),
        }
    }

    /// Bone at half the depth is a layer of half the thickness.
    #[test]
    fn bone_effect_equals_thinner_layer() {
        let mut known = thick(6.0);
        known.bare = known.forces(known.layer).unwrap();
        let mut bone = ActiveEffect::new(Effect::Bone, 1.0);
        bone.shape[0] = 2.5;
        let (thinner, changed) = (
            known.forces((2.5, 0.5)).unwrap(),
            known.changed(&bone).unwrap(),
        );
        for k in [1, 2] {
            assert!((changed[k] - libm::log(thinner[k] / known.bare[k])).abs() < 1e-12);
        }
        assert!(changed[2] > 0.1, "the deepest feels it");
        let other = ActiveEffect::new(Effect::StiffSkin, 1.0);
        assert!(known.changed(&other).is_none());
    }

    #[test]
    fn sphere_table_ends_at_half_its_height() {
        let deep = thick(0.6);
        assert!(deep.forces(deep.layer).is_none() && deep.ball().is_none());
    }
}
