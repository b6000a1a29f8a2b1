//! Balls on flat skin of one kind: their answers are known without a mesh, from rings (`thenar_contact::ball`).

use thenar_contact::ball::Ball;
use thenar_contact::effects::Effect;
use thenar_contact::{ActiveEffect, Material};

use crate::fit::Fitting;
use crate::replay::PressTable;

/// Part by which the mesh's force may differ from a ball's in the last quarter of its table, if that is the ball that it is pressed with.
const AGREES: f64 = 0.05;

/// Part of the deepest depth from which rings are as many as a contact needs.
const SHALLOW: f64 = 0.01;

/// A tool at a place that is such a ball.
#[derive(Debug, Clone)]
pub struct Known {
    radius_mm: f64,
    /// Thickness, mm, and Poisson's ratio.
    layer: (f64, f64),
    /// Roots of the depths of its table, mm^0.5.
    roots: Vec<f64>,
}

/// By place whose table from the mesh is given: the ball that it is. Skin of one region that is flat, and a ball that presses it as the mesh
/// has it.
pub fn known(
    fitting: &Fitting,
    is_flat: bool,
    (places, base, materials): (&[usize], &[PressTable], &[Material]),
) -> Vec<Option<Known>> {
    let one = |(place, table): (&usize, &PressTable)| {
        let radius_mm = fitting.replay.ball(*place)?;
        let [material] = materials else {
            return None;
        };
        Known::of(radius_mm, material, table).filter(|_| is_flat)
    };
    places.iter().zip(base).map(one).collect()
}

impl Known {
    fn of(radius_mm: f64, material: &Material, table: &PressTable) -> Option<Known> {
        let known = Known {
            radius_mm,
            layer: (material.thickness_mm, material.poisson_ratio),
            roots: table.roots.clone(),
        };
        let exact = known.forces(None)?;
        let pairs = exact.iter().zip(&table.force).skip(exact.len() * 3 / 4);
        let agrees = |(a, b): (&f64, &f64)| (b / material.g0_mpa / a - 1.0).abs() < AGREES;
        pairs.into_iter().all(agrees).then_some(known)
    }

    /// The ball over its layer, to its deepest depth.
    pub fn ball(&self) -> Option<Ball> {
        self.on(self.layer)
    }

    fn on(&self, layer: (f64, f64)) -> Option<Ball> {
        let deepest = self.roots.last()?.powi(2);
        (deepest < self.radius_mm).then(|| Ball::new(layer, self.radius_mm, deepest))
    }

    /// The layer with what changes it; None for an effect that changes more than thickness and Poisson's ratio.
    fn layer_with(&self, effect: &ActiveEffect) -> Option<(f64, f64)> {
        match effect.effect {
            Effect::Bone => Some((effect.shape[0], self.layer.1)),
            Effect::Compressibility => Some((self.layer.0, effect.shape[0])),
            _ => None,
        }
    }

    /// Forces over the modulus, mm2, by depth of the table, with what changes the layer; None where they are not known.
    pub fn forces(&self, with: Option<&ActiveEffect>) -> Option<Vec<f64>> {
        let layer = with.map_or(Some(self.layer), |effect| self.layer_with(effect))?;
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

    fn table(force: impl Fn(f64) -> f64) -> PressTable {
        let roots: Vec<f64> = (0..=30)
            .map(|k| 0.7f64.sqrt() * f64::from(k) / 30.0)
            .collect();
        PressTable {
            force: roots.iter().map(|root| force(root * root)).collect(),
            area: vec![0.0; roots.len()],
            loads: Vec::new(),
            touched: vec![true],
            roots,
        }
    }

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
    fn a_ball_is_known_by_what_it_presses_and_answers_as_hertz_has_it() {
        let hertz = |nu: f64, d: f64| 8.0 / 3.0 / (1.0 - nu) * 40.0f64.sqrt() * libm::pow(d, 1.5);
        let material = half_space(0.5);
        let meshed = |share: f64| table(move |d| 0.01 * share * hertz(0.5, d));
        assert!(Known::of(40.0, &material, &meshed(0.9)).is_none());
        let known = Known::of(40.0, &material, &meshed(1.02)).unwrap();
        let mut softer = ActiveEffect::new(Effect::Compressibility, 1.0);
        softer.shape[0] = 0.3;
        for (with, nu) in [(None, 0.5), (Some(&softer), 0.3)] {
            let found = known.forces(with).unwrap();
            assert_eq!(found[0], 0.0);
            for (force, root) in found.iter().zip(&known.roots).skip(1) {
                let (off, share) = (force / hertz(nu, root * root) - 1.0, root * root / 0.7);
                let most = if share > 0.04 { 0.008 } else { 0.06 };
                assert!(off.abs() < most, "{nu}, {share}: {off}");
            }
        }
    }

    /// A layer of half the thickness under bone is what bone nearer to the skin makes of it.
    #[test]
    fn bone_nearer_to_the_skin_is_a_thinner_layer() {
        let thin = |thickness_mm: f64| Known {
            radius_mm: 6.0,
            layer: (thickness_mm, 0.5),
            roots: vec![0.0, 0.4, 0.8],
        };
        let mut bone = ActiveEffect::new(Effect::Bone, 1.0);
        bone.shape[0] = 2.5;
        assert_eq!(thin(5.0).forces(Some(&bone)), thin(2.5).forces(None));
        let (near, far) = (
            thin(2.5).forces(None).unwrap(),
            thin(5.0).forces(None).unwrap(),
        );
        assert!(near[2] > 1.1 * far[2]);
    }

    #[test]
    fn a_ball_that_is_sunk_to_its_middle_is_not_known() {
        let deep = Known {
            radius_mm: 0.6,
            layer: (5.0, 0.5),
            roots: vec![0.0, 0.4, 0.8],
        };
        assert!(deep.forces(None).is_none() && deep.ball().is_none());
    }
}
