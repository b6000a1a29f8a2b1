//! What the response depends on besides the skin's shape: layers, stiff plates, cuts; and the mix of two layers at a site.

use super::bonded_layer::Layer;
use super::plate_on_layer::Sheet;

/// Two layers and the weight of the first.
pub type Mix = (u16, u16, f64);

/// A cut between blocks of the skin.
#[derive(Debug, Clone, PartialEq)]
pub struct Cut {
    /// Block of every site.
    pub block: Vec<u32>,
    /// Share of the response that is kept between different blocks, 0 to 1.
    pub kept: f64,
}

/// What the response of model layer depends on, besides the skin's shape.
#[derive(Debug, Clone, PartialEq)]
pub struct Geometry {
    /// Layer of every region.
    pub layers: Vec<Layer>,
    /// Inverse thickness at every site, 1/mm, where it does not follow from the regions.
    pub curvature: Option<Vec<f64>>,
    /// Stiff skin of every region; empty where there is none.
    pub sheets: Vec<Sheet>,
    /// Cuts, each a factor between 0 and 1 that keeps the response definite (Schur product).
    pub cuts: Vec<Cut>,
}
