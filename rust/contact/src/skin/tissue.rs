//! The tissue after effects: materials, layers, plates, cuts and moduli, composed once when effects are set.

use thenar_surface::SkinDistance;

use super::sites::Sites;
use crate::effects::definition::active::{ActiveEffect, in_order};
use crate::effects::definition::entry::Effect;
use crate::effects::{bone, compressibility, inclusion, region_coupling, stiff_skin};
use crate::response::bonded_layer::Layer;
use crate::response::plate_on_layer::Sheet;
use crate::response::tissue_geometry::Geometry;
use crate::{ContactError, Material};

/// The skin that effects act on.
#[derive(Clone, Copy)]
pub struct Place<'a> {
    /// Its sites.
    pub sites: &'a Sites,
    /// Distances along it.
    pub metric: &'a SkinDistance,
    /// Vertex of the mesh as given that represents each merged vertex.
    pub source: &'a [u32],
}

/// The tissue as the effects leave it.
#[derive(Debug, Clone, PartialEq)]
pub struct Tissue {
    /// Materials by region.
    pub materials: Vec<Material>,
    /// What the response depends on.
    pub geometry: Geometry,
    /// Laws of stiffening, in their order.
    pub laws: Vec<ActiveEffect>,
    /// Factor of the modulus at every site, where there is one.
    pub factor: Option<Vec<f64>>,
}

impl Tissue {
    /// The tissue without effects.
    pub fn bare(base: &[Material]) -> Tissue {
        Tissue {
            materials: base.to_vec(),
            geometry: Geometry {
                layers: layers(base),
                curvature: None,
                sheets: Vec::new(),
                cuts: Vec::new(),
            },
            laws: Vec::new(),
            factor: None,
        }
    }

    /// Composes the effects in the order of the catalogue. `effects` must have been validated.
    ///
    /// # Errors
    /// [`ContactError::Effect`] where an effect does not fit the tissue that those before it leave.
    pub fn new(
        base: &[Material],
        effects: &[ActiveEffect],
        place: &Place<'_>,
    ) -> Result<Tissue, ContactError> {
        let mut tissue = Tissue::bare(base);
        for effect in in_order(effects) {
            match effect.effect {
                Effect::Bone => tissue.lay_on_bone(effect, place),
                Effect::Compressibility => {
                    for (region, material) in tissue.materials.iter_mut().enumerate() {
                        material.poisson_ratio = compressibility::poisson_ratio(
                            effect,
                            region as u32,
                            material.poisson_ratio,
                        );
                    }
                }
                Effect::StiffSkin => tissue.cover(effect),
                Effect::RegionCoupling => tissue
                    .geometry
                    .cuts
                    .push(region_coupling::cut(effect, place.sites)),
                Effect::StiffeningLaw => tissue.laws.push(effect.clone()),
                Effect::Inclusion => tissue.include(effect, place)?,
                // What remembers acts in `history`.
                Effect::CycleSoftening
                | Effect::Relaxation
                | Effect::Drainage
                | Effect::RateIndependentLoss
                // And what acts between skin and product in `interface`.
                | Effect::Friction
                | Effect::Adhesion => {}
                // Instruments act in `instrument`; a skin takes none.
                Effect::FixtureCompliance
                | Effect::Misregistration
                | Effect::Crosstalk
                | Effect::Gain
                | Effect::Offset
                | Effect::Drift
                | Effect::Saturation
                | Effect::Threshold
                | Effect::DeadCells
                | Effect::Timing => {}
            }
        }
        tissue.geometry.layers = layers(&tissue.materials);
        Ok(tissue)
    }

    /// Applies the factor of the modulus to response weights and moduli by site.
    pub fn scale(&self, weight: &mut [f64], modulus: &mut [f64]) {
        for ((w, g), factor) in weight
            .iter_mut()
            .zip(modulus)
            .zip(self.factor.iter().flatten())
        {
            *w /= factor.sqrt();
            *g *= factor;
        }
    }

    /// Thickness at a site of `region`, mm.
    pub fn thickness(&self, site: usize, region: usize) -> f64 {
        match &self.geometry.curvature {
            Some(curvature) => 1.0 / curvature[site],
            None => self.materials[region].thickness_mm,
        }
    }

    /// Thickness by region, mm.
    pub fn thicknesses(&self) -> Vec<f64> {
        self.materials.iter().map(|m| m.thickness_mm).collect()
    }

    /// One over the thickness at every site, blended over creases, 1/mm.
    pub fn curvature(&self, sites: &Sites) -> Vec<f64> {
        let of_region = || self.materials.iter().map(|m| 1.0 / m.thickness_mm);
        let field = &self.geometry.curvature;
        field
            .clone()
            .unwrap_or_else(|| sites.blended(&of_region().collect::<Vec<f64>>()))
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

    fn cover(&mut self, effect: &ActiveEffect) {
        let sheets = &mut self.geometry.sheets;
        sheets.resize(self.materials.len(), Sheet::NONE);
        for (region, (sheet, material)) in sheets.iter_mut().zip(&self.materials).enumerate() {
            let more = stiff_skin::sheet(effect, region as u32, material);
            *sheet = sheet.with(&more);
        }
    }

    fn include(&mut self, effect: &ActiveEffect, place: &Place<'_>) -> Result<(), ContactError> {
        let home = inclusion::home(effect, place.sites);
        let (depth, thickness) = (
            inclusion::depth(effect),
            self.thickness(home, place.sites.home_region(home) as usize),
        );
        if depth >= thickness {
            return Err(effect.refuse(format!(
                "depth_mm is {depth}, but must be less than the {thickness:.2} mm of soft tissue there"
            )));
        }
        let factors = inclusion::factors(effect, (place.sites, place.metric));
        self.factor = Some(match self.factor.take() {
            Some(before) => before.iter().zip(&factors).map(|(a, b)| a * b).collect(),
            None => factors,
        });
        Ok(())
    }

    fn lay_on_bone(&mut self, effect: &ActiveEffect, place: &Place<'_>) {
        let (sites, source) = (place.sites, place.source);
        if bone::is_field(effect) || self.geometry.curvature.is_some() {
            let curvature = match self.geometry.curvature.take() {
                Some(curvature) => curvature,
                None => self.curvature(sites),
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
