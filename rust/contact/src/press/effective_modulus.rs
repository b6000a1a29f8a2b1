//! Effective shear moduli of a press and the response weights from them (`deep_tissue`).

use super::deep_tissue;
use crate::Model;
use crate::detection::gaps::Detection;
use crate::effects::stiffening_law;
use crate::skin::prepare::Skin;

/// Largest penetration over thickness up to which the layer was held against solids (`tests/proof/deep_pads/test_deep_pads.py`).
pub const KERNEL_LIMIT: f64 = 0.5;

/// The response at every site: `u_i = s_i s_j K_ij p_j`.
pub struct SiteResponse {
    /// Response weight `s = sqrt((1 - nu) / (2 pi G))`.
    pub weight: Vec<f64>,
    /// Effective shear modulus, blended over creases, MPa.
    pub modulus: Vec<f64>,
}

/// Shear modulus by region at its largest penetration, MPa: the material's line with the laws of stiffening.
pub fn region_moduli(skin: &Skin, detection: &Detection) -> Vec<f64> {
    let laws = &skin.tissue.laws;
    let strains = match laws.iter().any(stiffening_law::grows_with_strain) {
        true => contact_strains(skin, detection),
        false => Vec::new(),
    };
    let reached = (&detection.max_penetration[..], &strains[..]);
    stiffening_law::shear_moduli(&skin.tissue.materials, laws, reached)
}

/// Weights and moduli of the sites under these `shear_modulus` by region (MPa), as deep as each is pressed.
pub fn site_response(skin: &Skin, shear_modulus: &[f64], detection: &Detection) -> SiteResponse {
    let materials = &skin.tissue.materials;
    if skin.model != Model::Layer || !materials.iter().any(deep_tissue::is_deep) {
        return blended(skin, shear_modulus);
    }
    let reached = detection
        .max_penetration
        .iter()
        .zip(overlap_volumes(skin, detection));
    let thickness = pressed_thickness(skin, detection);
    let factors = materials.iter().zip(thickness).zip(reached);
    let factors =
        factors.map(|((m, thickness), reached)| deep_tissue::factor(m, thickness, reached));
    let moduli: Vec<f64> = shear_modulus
        .iter()
        .zip(factors)
        .map(|(g, factor)| g * factor)
        .collect();
    let mut response = blended(skin, &moduli);
    stiffen(skin, detection, &mut response);
    response
}

/// Response weight of every site of skin that nothing presses.
pub fn rest_weights(skin: &Skin) -> Vec<f64> {
    let moduli: Vec<f64> = skin.tissue.materials.iter().map(|m| m.g0_mpa).collect();
    blended(skin, &moduli).weight
}

/// Contact strain a/R of each region's penetration; 0 without.
fn contact_strains(skin: &Skin, detection: &Detection) -> Vec<f64> {
    let reached = detection
        .max_penetration
        .iter()
        .zip(overlap_volumes(skin, detection));
    reached
        .map(|(depth, volume)| stiffening_law::contact_strain(*depth, volume))
        .collect()
}

/// Volume of skin and product that lies in both, by region, mm3.
fn overlap_volumes(skin: &Skin, detection: &Detection) -> Vec<f64> {
    let mut volume = vec![0.0; skin.tissue.materials.len()];
    for (site, &vertex) in skin.sites.vertex.iter().enumerate() {
        let region = skin.sites.region[site];
        let depth = (-detection.distances[vertex as usize]).max(0.0);
        if region >= 0 {
            volume[region as usize] += depth * skin.sites.area[site];
        }
    }
    volume
}

/// Stiffens tissue by the depth at its own place, as a factor of the site's weight: the response stays symmetric and definite.
fn stiffen(skin: &Skin, detection: &Detection, response: &mut SiteResponse) {
    let exponents: Vec<f64> = skin.tissue.materials.iter().map(|m| m.stiffening).collect();
    let curvatures: Vec<f64> = skin
        .tissue
        .materials
        .iter()
        .map(|m| 1.0 / m.thickness_mm)
        .collect();
    for (site, &vertex) in skin.sites.vertex.iter().enumerate() {
        let depth = -detection.distances[vertex as usize];
        if depth <= 0.0 {
            continue;
        }
        let exponent = skin.sites.blended_at(site, &exponents);
        if exponent > 0.0 {
            let curvature = match &skin.tissue.geometry.curvature {
                Some(field) => field[site],
                None => skin.sites.blended_at(site, &curvatures),
            };
            let growth = deep_tissue::growth(exponent, depth * curvature);
            response.weight[site] /= growth.sqrt();
            response.modulus[site] *= growth;
        }
    }
}

/// Thickness where each region is pressed deepest, mm.
pub fn pressed_thickness(skin: &Skin, detection: &Detection) -> Vec<f64> {
    let mut thickness: Vec<f64> = skin
        .tissue
        .materials
        .iter()
        .map(|m| m.thickness_mm)
        .collect();
    let Some(curvature) = &skin.tissue.geometry.curvature else {
        return thickness;
    };
    let mut deepest = vec![0.0; thickness.len()];
    for (site, &vertex) in skin.sites.vertex.iter().enumerate() {
        let depth = -detection.distances[vertex as usize];
        let region = skin.sites.region[site];
        if region >= 0 && depth > deepest[region as usize] {
            deepest[region as usize] = depth;
            thickness[region as usize] = 1.0 / curvature[site];
        }
    }
    thickness
}

/// Weights and moduli of all sites under these moduli by region; blended over creases in model layer.
fn blended(skin: &Skin, shear_modulus: &[f64]) -> SiteResponse {
    let softness: Vec<f64> = skin
        .tissue
        .materials
        .iter()
        .zip(shear_modulus)
        .map(|(m, g)| (1.0 - m.poisson_ratio) / (std::f64::consts::TAU * g))
        .collect();
    let of_region = |values: &[f64]| match skin.model {
        Model::Layer => skin.sites.blended(values),
        Model::Paper => skin
            .sites
            .region
            .iter()
            .map(|&r| values.get(r as usize).copied().unwrap_or(0.0))
            .collect(),
    };
    let mut weight: Vec<f64> = of_region(&softness).into_iter().map(f64::sqrt).collect();
    let mut modulus = of_region(shear_modulus);
    skin.tissue.scale(&mut weight, &mut modulus);
    SiteResponse { weight, modulus }
}
