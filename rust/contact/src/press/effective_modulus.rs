//! Effective shear moduli of a press and the response weights from them; deep presses soften (`kept_stiffness`).

use crate::Model;
use crate::detection::gaps::Detection;
use crate::effects::stiffening_law;
use crate::skin::prepare::Skin;

/// Largest penetration over thickness for which the bonded layer's kernel is used as it is.
pub const KERNEL_LIMIT: f64 = 0.5;
/// Power of thickness with which stiffness falls near that depth.
const ESCAPE_POWER: f64 = 1.5;

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

/// Weights and moduli of the sites under these `shear_modulus` by region (MPa), with what deep presses lose taken off.
pub fn site_response(skin: &Skin, shear_modulus: &[f64], detection: &Detection) -> SiteResponse {
    blended(skin, &effective_moduli(skin, shear_modulus, detection))
}

/// Response weight of every site of skin that nothing presses.
pub fn rest_weights(skin: &Skin) -> Vec<f64> {
    let moduli: Vec<f64> = skin.tissue.materials.iter().map(|m| m.g0_mpa).collect();
    blended(skin, &moduli).weight
}

/// Contact strain a/R of each region's penetration; 0 without.
fn contact_strains(skin: &Skin, detection: &Detection) -> Vec<f64> {
    let mut volume = vec![0.0; skin.tissue.materials.len()];
    for (site, &vertex) in skin.sites.vertex.iter().enumerate() {
        let region = skin.sites.region[site];
        let depth = (-detection.distances[vertex as usize]).max(0.0);
        if region >= 0 {
            volume[region as usize] += depth * skin.sites.area[site];
        }
    }
    let depths = detection.max_penetration.iter().zip(&volume);
    depths
        .map(|(depth, volume)| stiffening_law::contact_strain(*depth, *volume))
        .collect()
}

/// Moduli with what escapes sideways in deep presses taken off; model layer only.
fn effective_moduli(skin: &Skin, shear_modulus: &[f64], detection: &Detection) -> Vec<f64> {
    let thickness = pressed_thickness(skin, detection);
    let kept = |(thickness, depth): (&f64, &f64)| match skin.model {
        Model::Layer => kept_stiffness(*thickness, *depth),
        Model::Paper => 1.0,
    };
    let kept = thickness.iter().zip(&detection.max_penetration).map(kept);
    shear_modulus
        .iter()
        .zip(kept)
        .map(|(g, kept)| g * kept)
        .collect()
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

/// Thickness where each region is pressed deepest, mm.
pub fn pressed_thickness(skin: &Skin, detection: &Detection) -> Vec<f64> {
    let of_region = skin.tissue.materials.iter().map(|m| m.thickness_mm);
    let mut thickness: Vec<f64> = of_region.collect();
    if skin.tissue.geometry.curvature.is_none() {
        return thickness;
    }
    let mut deepest = vec![0.0; thickness.len()];
    for (site, &vertex) in skin.sites.vertex.iter().enumerate() {
        let (region, depth) = (
            skin.sites.region[site],
            -detection.distances[vertex as usize],
        );
        if region >= 0 && depth > deepest[region as usize] {
            deepest[region as usize] = depth;
            thickness[region as usize] = skin.tissue.thickness(site, region as usize);
        }
    }
    thickness
}

/// Share of the small-strain stiffness that tissue of `thickness` (mm) keeps when pressed to `depth` (mm); 1 up to half.
///
/// Beyond, free sides and a receding bone let the tissue escape as a thicker layer would. A pad on a layer needs a force
/// that falls as the 1.5th power of thickness near these depths (fingertip of radius 8 mm at 4 mm: 6.25 times the half
/// space's on 5 mm, 3.67 times on 7.1 mm), so the stiffness is that of a layer which is twice as thick as the press is deep.
/// The response keeps its shape, stays definite, and force keeps growing with depth.
pub fn kept_stiffness(thickness: f64, depth: f64) -> f64 {
    let excess = depth / (KERNEL_LIMIT * thickness);
    if excess > 1.0 {
        excess.powf(-ESCAPE_POWER)
    } else {
        1.0
    }
}
