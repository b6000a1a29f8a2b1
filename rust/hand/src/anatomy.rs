//! Which digit a vertex belongs to and where on it: the common ground of regions and weights.

use crate::flesh::{Flesh, Station};
use rayon::prelude::*;
use thenar_surface::Vec3;

/// One vertex seen from its nearest digit.
pub(crate) struct Place {
    /// Rest position, mm.
    pub position: Vec3,
    /// Outward unit normal of the field.
    pub normal: Vec3,
    /// Nearest digit, index to little, then thumb.
    pub digit: usize,
    /// Distance from that digit's own skin, mm.
    pub distance: f64,
    /// The same for every digit; infinite where it is far.
    pub distances: [f64; 5],
    /// Coordinates along that digit.
    pub station: Station,
    /// Outline distance of its nail, mm.
    pub nail: f64,
}

/// The places of all vertices.
pub(crate) fn places(flesh: &Flesh, positions: &[Vec3]) -> Vec<Place> {
    positions
        .par_iter()
        .map(|&position| place(flesh, position))
        .collect()
}

fn place(flesh: &Flesh, position: Vec3) -> Place {
    let distances: [f64; 5] = std::array::from_fn(|k| flesh.digit(k, position));
    let nearest = |a: &usize, b: &usize| distances[*a].total_cmp(&distances[*b]);
    let digit = (0..5).min_by(nearest).unwrap_or(0);
    let station = flesh.station(digit, position);
    let nail = flesh.nails()[digit].outline(&station);
    Place {
        position,
        normal: flesh.value_and_gradient(position).1.normalize(),
        digit,
        distance: distances[digit],
        distances,
        station,
        nail,
    }
}
