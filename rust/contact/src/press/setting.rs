//! Constants of one solve: product, gaps, response weights, start and accuracy.

use thenar_surface::Product;

use crate::detection::gaps::Detection;
use crate::skin::prepare::Skin;
use crate::solve::Accuracy;
use crate::workspace::warm_start::StartContact;

/// What does not change within a solve.
pub struct SolveSetting<'a> {
    /// The product.
    pub product: &'a Product,
    /// Detection of this posture.
    pub detection: &'a Detection,
    /// Response weight s = sqrt((1 - nu) / (2 pi G)) of every site.
    pub weight: &'a [f64],
    /// What to start from.
    pub start: Option<&'a StartContact>,
    /// How far the last linear problem is solved.
    pub accuracy: Accuracy,
    /// Median edge, mm.
    pub spacing: f64,
}

/// The welded vertex of a site.
pub fn vertex(skin: &Skin, site: u32) -> usize {
    skin.sites.vertex[site as usize] as usize
}
