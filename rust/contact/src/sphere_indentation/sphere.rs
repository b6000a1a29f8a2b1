//! The sphere pressed into a layer: forces at given depths, with or without a stiff skin.

use super::membrane_tension::MembraneTension;
use super::ring_contact::touch;
use super::ring_quadrature::Rings;
use super::stiff_skin::StiffSkin;
use super::wave_response;
use crate::response::bonded_layer::Layer;

/// A ball over a layer, and rings for all presses down to a depth.
pub struct Ball {
    layer: Layer,
    radius_mm: f64,
    rings: Rings,
}

/// Even rings reach to this many root (radius times depth): a thin layer's contact is wider than that; all rings as far as this many
/// of them and of thicknesses beyond.
const CORE: f64 = 1.6;

const BEYOND: (f64, f64) = (0.3, 1.6);

/// Thickness from which a layer is a half space here, over the contact's radius.
const THICK: f64 = 4.0;

/// Part of the deepest depth at which a contact is two rings wide.
pub const SHALLOWEST: f64 = 1.0 / 250.0;

impl Ball {
    /// A ball of `radius_mm` over a layer of `thickness_mm` (may be infinite) and a Poisson's ratio, pressed no deeper than `deepest_mm`.
    pub fn new((thickness_mm, poisson_ratio): (f64, f64), radius_mm: f64, deepest_mm: f64) -> Ball {
        let contact = (radius_mm * deepest_mm).sqrt();
        let far = BEYOND.1 * thickness_mm.min(THICK * contact);
        Ball {
            layer: Layer {
                thickness: thickness_mm,
                poisson_ratio,
            },
            radius_mm,
            rings: Rings::new(CORE * contact, (CORE + BEYOND.0) * contact + far),
        }
    }

    /// Forces over the pulp's modulus G, mm2, at rising `depths_mm`, from a [`SHALLOWEST`] of the deepest; without a skin for None. None where
    /// the skin's tension does not settle.
    pub fn forces(&self, skin: Option<StiffSkin>, depths_mm: &[f64]) -> Option<Vec<f64>> {
        let rings = &self.rings;
        if let Some(skin) = skin {
            let stretching = MembraneTension::new(rings, self.layer, skin);
            return stretching.forces(rings, self.radius_mm, depths_mm);
        }
        let compliance = rings.sunk(&rings.under_pressure(|k| wave_response::bare(self.layer, k)));
        let force = |depth: &f64| {
            let gaps = rings.gaps(self.radius_mm, *depth);
            rings.force(&touch(&compliance, &gaps))
        };
        Some(depths_mm.iter().map(force).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::layer_drainage::drop_of_layer;

    /// What a drained layer bears less than an undrained one, by contact radius over thickness: the closed form that the effect `drainage`
    /// takes against this model of rings.
    #[test]
    fn drained_layers_bear_what_the_closed_form_says() {
        let thickness = 5.0;
        for share in [0.1, 0.5, 1.0, 2.0] {
            // So flat a ball that its contact is much wider than it is deep.
            let (contact, radius) = (share * thickness, 20.0 * share * thickness);
            let deepest = contact * contact / radius;
            let pressed = |poisson_ratio: f64, depth: f64| {
                let ball = Ball::new((thickness, poisson_ratio), radius, deepest);
                let bare = |k: f64| wave_response::bare(ball.layer, k);
                let compliance = ball.rings.sunk(&ball.rings.under_pressure(bare));
                let pressure = touch(&compliance, &ball.rings.gaps(radius, depth));
                let touching = pressure.iter().filter(|p| **p > 0.0).count();
                (ball.rings.force(&pressure), ball.rings.edges[touching])
            };
            let (mut low, mut high) = (0.05 * deepest, deepest);
            for _ in 0..14 {
                let middle = 0.5 * (low + high);
                match pressed(0.5, middle).1 > contact {
                    true => high = middle,
                    false => low = middle,
                }
            }
            let undrained = pressed(0.5, low).0;
            for drained in [0.1, 0.3, 0.4] {
                let found = 1.0 - pressed(drained, low).0 / undrained;
                let wanted = drop_of_layer(drained, (contact, thickness));
                assert!(
                    (found - wanted).abs() < 0.02,
                    "{share} {drained}: {found} {wanted}"
                );
            }
        }
    }
}
