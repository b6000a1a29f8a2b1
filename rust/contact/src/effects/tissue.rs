//! What the effects that act at all times make of the tissue, worked out once when effects are set.

use super::active::ActiveEffect;
use super::catalogue::Effect;
use super::{bone, region_coupling};
use crate::Material;
use crate::response::bonded_layer::Layer;
use crate::response::rows::Geometry;
use crate::sites::Sites;

/// The tissue as the effects leave it.
#[derive(Debug, Clone, PartialEq)]
pub struct Tissue {
    /// Materials by region.
    pub materials: Vec<Material>,
    /// What the response depends on.
    pub geometry: Geometry,
}

impl Tissue {
    /// Composes the effects in the order of the catalogue. `effects` must have been validated; `source` is the vertex of the
    /// mesh as given that each welded vertex stands for.
    pub fn new(
        base: &[Material],
        effects: &[ActiveEffect],
        (sites, source): (&Sites, &[u32]),
    ) -> Tissue {
        let mut tissue = Tissue {
            materials: base.to_vec(),
            geometry: Geometry {
                layers: Vec::new(),
                curvature: None,
                cuts: Vec::new(),
            },
        };
        for effect in in_order(effects) {
            match effect.effect {
                Effect::Bone => tissue.lay_on_bone(effect, (sites, source)),
                Effect::RegionCoupling => tissue
                    .geometry
                    .cuts
                    .push(region_coupling::cut(effect, sites)),
            }
        }
        tissue.geometry.layers = layers(&tissue.materials);
        tissue
    }

    /// Thickness at a site of `region`, mm.
    pub fn thickness(&self, site: usize, region: usize) -> f64 {
        match &self.geometry.curvature {
            Some(curvature) => 1.0 / curvature[site],
            None => self.materials[region].thickness_mm,
        }
    }

    /// Largest thickness anywhere, mm.
    pub fn thickest(&self) -> f64 {
        let thickest = self
            .materials
            .iter()
            .map(|m| m.thickness_mm)
            .fold(0.0, f64::max);
        let field = self.geometry.curvature.iter().flatten().map(|c| 1.0 / c);
        field.fold(thickest, f64::max)
    }

    fn lay_on_bone(&mut self, effect: &ActiveEffect, (sites, source): (&Sites, &[u32])) {
        if bone::is_field(effect) || self.geometry.curvature.is_some() {
            let curvature = match self.geometry.curvature.take() {
                Some(curvature) => curvature,
                None => {
                    let of_region: Vec<f64> = self
                        .materials
                        .iter()
                        .map(|m| 1.0 / m.thickness_mm)
                        .collect();
                    sites.blended(&of_region)
                }
            };
            let curvature = bone::field(effect, (sites, source), &curvature);
            for (region, material) in self.materials.iter_mut().enumerate() {
                if let Some(mean) = mean_over(region, sites, &curvature) {
                    material.thickness_mm = 1.0 / mean;
                }
            }
            self.geometry.curvature = Some(curvature);
            return;
        }
        for (region, material) in self.materials.iter_mut().enumerate() {
            let share = effect.amplitude_on(region as u32);
            if share > 0.0 {
                let curvature =
                    (1.0 - share) / material.thickness_mm + share / bone::thickness(effect);
                material.thickness_mm = 1.0 / curvature;
            }
        }
    }
}

/// The effects that do anything, in the order of the catalogue; equal ones stay in the order given.
pub fn in_order(effects: &[ActiveEffect]) -> Vec<&ActiveEffect> {
    let mut acting: Vec<&ActiveEffect> = effects.iter().filter(|e| e.amplitude > 0.0).collect();
    acting.sort_by_key(|e| e.effect.place());
    acting
}

/// The layers of the materials.
fn layers(materials: &[Material]) -> Vec<Layer> {
    let layer = |m: &Material| Layer {
        thickness: m.thickness_mm,
        poisson_ratio: m.poisson_ratio,
    };
    materials.iter().map(layer).collect()
}

/// Mean over a region's area.
fn mean_over(region: usize, sites: &Sites, values: &[f64]) -> Option<f64> {
    let (mut sum, mut area) = (0.0, 0.0);
    for site in (0..sites.len()).filter(|&s| sites.region[s] == region as i32) {
        sum += values[site] * sites.area[site];
        area += sites.area[site];
    }
    (area > 0.0).then(|| sum / area)
}
