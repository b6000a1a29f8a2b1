//! Form error of the mesh model as parameters: a smooth factor on the load, by depth, for each tool at each site.
//!
//! A layer on bone is not a finger: to meet the finite-element fingertip of `tests/proof`, plate or cylinder, to 3 mm, its modulus
//! departs by up to 9 % from the best straight line over depth, the same at every speed and in every repeat. What is called
//! missing must be larger, or of another kind.

use crate::forward::mesh::nuisance::KNOTS;
use crate::parameters::parameter::{Kind, Parameter};
use crate::parameters::priors::MOST_GAIN;

/// One parameter a knot for each place in use, of standard deviation `share`; none for 0.
pub(crate) fn form_parameters(share: f64, place_of: &[usize], is_used: &[bool]) -> Vec<Parameter> {
    let used = place_of.iter().zip(is_used).filter(|(_, used)| **used);
    let mut places: Vec<usize> = used.map(|(place, _)| *place).collect();
    places.sort_unstable();
    places.dedup();
    let one = |(place, knot): (usize, usize)| {
        Parameter::about(Kind::Form(place, knot), (share, MOST_GAIN), 1e-3)
    };
    match share > 0.0 {
        true => places
            .iter()
            .flat_map(|p| (0..KNOTS).map(|k| (*p, k)))
            .map(one)
            .collect(),
        false => Vec::new(),
    }
}
