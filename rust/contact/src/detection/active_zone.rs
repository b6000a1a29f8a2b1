//! Stage 2: the active zone, the sites that may come into contact; a warm start keeps the last zone where it still serves.

use crate::detection::gaps::Detection;
use crate::skin::prepare::Skin;
use crate::workspace::Pressing;
use crate::{ContactError, Model};

/// Least thickness in vertex spacings for which a vertex still yields to its own force (0.34 in theory).
const COARSEST_SHARE: f64 = 0.4;
/// Share of the largest penetration that a bulge may rise into the product (0.2 measured at most; see physics tests).
const BULGE_SHARE: f64 = 0.25;
/// Gap beyond that margin up to which sites join the zone of a warm start, mm: the zone then serves many small moves.
const WARM_MARGIN: f64 = 0.3;

/// Sites that may touch: skin that penetrates or may be lifted into the product, ascending.
pub fn candidates(skin: &Skin, detection: &Detection) -> Vec<u32> {
    within(skin, detection, 0.0)
}

/// [`candidates`] within a wider margin, to serve several small moves; merged with the `last` zone where that adds little, since
/// sites that were lifted into the product are likely to be again.
pub fn widened_zone(skin: &Skin, detection: &Detection, last: &[u32]) -> Vec<u32> {
    let lasting = within(skin, detection, WARM_MARGIN);
    let distance = |s: u32| detection.distances[skin.sites.vertex[s as usize] as usize];
    let is_known = |s: &&u32| distance(**s) < f64::INFINITY;
    let mut both = lasting.clone();
    both.extend(last.iter().filter(is_known));
    // Of two ascending lists, which a stable sort merges.
    both.sort();
    both.dedup();
    if both.len() > lasting.len() + lasting.len() / 4 {
        lasting
    } else {
        both
    }
}

/// The last zone where it still serves, else the sites that may touch.
pub fn active_zone(pressing: &Pressing<'_>, detection: &Detection) -> Vec<u32> {
    let (skin, workspace) = (pressing.skin, &pressing.workspace);
    let zone = candidates(skin, detection);
    let last = &workspace.problem.zone;
    let is_warm = !workspace.warm_start.last.force.is_empty();
    let distance = |s: u32| detection.distances[skin.sites.vertex[s as usize] as usize];
    let is_known = |&s: &u32| distance(s) < f64::INFINITY;
    let serves = is_warm
        && last.len() <= zone.len() + zone.len() / 4
        && zone.iter().all(|site| last.binary_search(site).is_ok())
        && last.iter().all(is_known);
    match (serves, is_warm && !zone.is_empty()) {
        (true, _) => last.clone(),
        (false, true) => widened_zone(skin, detection, last),
        (false, false) => zone,
    }
}

fn within(skin: &Skin, detection: &Detection, more: f64) -> Vec<u32> {
    let margin = match skin.model {
        Model::Paper => 0.0,
        Model::Layer => BULGE_SHARE * detection.deepest() + more,
    };
    let may_touch = |site: &u32| {
        let site = *site as usize;
        let distance = detection.distances[skin.sites.vertex[site] as usize];
        distance < margin && skin.sites.is_skin(site)
    };
    if detection.deepest() <= 0.0 {
        return Vec::new();
    }
    (0..skin.sites.len() as u32).filter(may_touch).collect()
}

/// Refuses skin whose vertex spacing is too coarse for its layer: a vertex's own compliance would turn negative.
///
/// # Errors
/// [`ContactError::TooCoarse`] naming the first such vertex.
pub fn check_resolution(skin: &Skin, zone: &[u32]) -> Result<(), ContactError> {
    for &site in zone.iter().filter(|_| skin.model == Model::Layer) {
        let region = skin.sites.region[site as usize];
        let spacing_mm = (skin.sites.area[site as usize] * 2.0 / 3f64.sqrt()).sqrt();
        let thickness_mm = skin.tissue.thickness(site as usize, region as usize);
        if thickness_mm < COARSEST_SHARE * spacing_mm {
            let vertex = skin.merged.source[skin.sites.vertex[site as usize] as usize] as usize;
            return Err(ContactError::TooCoarse {
                region,
                title: skin.region_title(region as usize),
                vertex,
                spacing_mm,
                thickness_mm,
            });
        }
    }
    Ok(())
}
