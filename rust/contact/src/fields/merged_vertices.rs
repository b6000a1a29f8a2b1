//! Merged vertices in the result: each is measured where it is written and moved out of the product.
//!
//! The vertex that represents them was solved; they lie next to it, so its displacement may leave them inside.

use thenar_surface::Vec3;

use super::result::Contact;
use super::warning_rules::MOST_PENETRATION;
use super::warnings::{Grade, Warning};
use crate::api::Press;
use crate::detection::gaps::limits;
use crate::skin::prepare::Skin;

/// Depth up to which a merged vertex stays where the other one's displacement brings it, mm: seams stay closed.
const LEFT_MM: f64 = 1e-3;
/// Moves to the nearest point of the product; more than one only where rounding leaves something.
const MOST_MOVES: usize = 3;

/// Puts merged skin of `contact` out of the product, which lies moved by `shift` (mm), and adds what is left of it to the
/// certificate.
pub fn move_out_of_product(skin: &Skin, press: &Press<'_>, shift: Vec3, contact: &mut Contact) {
    let given = match press.posed {
        Some(posed) => posed,
        None => &skin.merged.given,
    };
    for vertex in merged(skin) {
        let normal = contact.normal[vertex];
        let out = |displacement: Vec3| {
            let place = given[vertex] + displacement - shift;
            let gap = press.product.gap(place, None, limits())?;
            let way = gap.closest - place;
            // A sheet has no inside: there, the side that the product presses from tells.
            let is_inside = gap.distance < 0.0 || normal.dot(&way) > 0.0;
            is_inside.then_some(way)
        };
        for _ in 0..MOST_MOVES {
            let way = out(contact.displacement[vertex]).filter(|way| way.norm() > LEFT_MM);
            let Some(way) = way else { break };
            contact.displacement[vertex] += way;
        }
        let left = out(contact.displacement[vertex]).map_or(0.0, |way| way.norm());
        contact.residual.penetration_mm = contact.residual.penetration_mm.max(left);
    }
    let depth = contact.residual.penetration_mm;
    if depth > MOST_PENETRATION && contact.grade() != Grade::DoNotUse {
        contact.warnings.push(Warning::Penetration { depth });
    }
}

/// Skin vertices of the mesh as given that are represented by another.
fn merged(skin: &Skin) -> impl Iterator<Item = usize> + '_ {
    let welded = &skin.merged;
    let stands_alone = move |v: usize| welded.source[welded.merged_of[v] as usize] as usize == v;
    (0..welded.given.len()).filter(move |&v| !stands_alone(v) && skin.regions[v] >= 0)
}
