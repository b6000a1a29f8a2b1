//! A ball that is pressed into a flat layer, with or without a stiff skin that stretches: round, and so a matter of rings.
//!
//! Without a skin it is as exact as its rings: on a half space within 0.2 % of Sneddon's sphere (1965), from a fifteenth of the deepest depth.
//! The contact model on meshes takes a stiff skin for a plate at small strains. Here the skin gives way through its own thickness
//! (`wave_response`) and is stretched by its own deflection (`membrane_tension`): what a ball meets that is small against the skin, and what it meets
//! once it has sunk in. Against the finite elements of `tests/trial` see `python -m trial.against_skin`.

mod wave_response;
mod ring_quadrature;
mod membrane_tension;

use nalgebra::{DMatrix, DVector};

use crate::response::bonded_layer::Layer;
use crate::response::plate_on_layer::Sheet;
use membrane_tension::Stretching;
use ring_quadrature::Rings;

/// A skin over pulp, bonded to it, and part of the layer's thickness.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StiffSkin {
    /// mm, less than the layer's.
    pub thickness_mm: f64,
    /// Its modulus over that of pulp, at least 1.
    pub ratio: f64,
}

impl StiffSkin {
    /// The same as a thin plate over pulp of that Poisson's ratio: `D = E t^3 / 9` and `M = 4 E t / 3` with E = 3 G times the ratio.
    fn sheet(self, poisson_ratio: f64) -> Sheet {
        let (share, modulus) = (1.0 - poisson_ratio, 3.0 * self.ratio);
        Sheet {
            bending: share * modulus * self.thickness_mm.powi(3) / 9.0,
            stretch: share * modulus * self.thickness_mm * 4.0 / 3.0,
            middle: 0.5 * self.thickness_mm,
            takes: self.thickness_mm * self.beyond(),
            tension: 0.0,
        }
    }

    /// The part by which it is stiffer than pulp.
    fn beyond(self) -> f64 {
        1.0 - 1.0 / self.ratio
    }

    /// Stiffness against stretch over G, as far as it is stiffer than pulp, mm.
    fn stretch(self) -> f64 {
        self.sheet(0.0).stretch * self.beyond()
    }
}

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
/// Exchanges of a contact, at most.
const EXCHANGES: usize = 100;

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
            let stretching = Stretching::new(rings, self.layer, skin);
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

/// Pressures that hold rings at their gaps where they touch, none elsewhere: exchanged until none pulls and none overlaps.
fn touch(compliance: &DMatrix<f64>, gaps: &DVector<f64>) -> DVector<f64> {
    let mut touches: Vec<bool> = gaps.iter().map(|g| *g > 0.0).collect();
    let mut pressure = DVector::zeros(gaps.len());
    for _ in 0..EXCHANGES {
        let kept: Vec<usize> = (0..gaps.len()).filter(|i| touches[*i]).collect();
        if kept.is_empty() {
            return DVector::zeros(gaps.len());
        }
        let part = compliance.select_rows(&kept).select_columns(&kept);
        let wanted = gaps.select_rows(&kept);
        pressure.fill(0.0);
        if let Some(found) = part.lu().solve(&wanted) {
            kept.iter()
                .zip(found.iter())
                .for_each(|(i, p)| pressure[*i] = *p);
        }
        let left = gaps - compliance * &pressure;
        let next: Vec<bool> = (0..gaps.len())
            .map(|i| match touches[i] {
                true => pressure[i] >= 0.0,
                false => left[i] > 1e-12,
            })
            .collect();
        if next == touches {
            break;
        }
        touches = next;
    }
    pressure.map(|p: f64| p.max(0.0))
}
