//! Stages 1 and 2: which sites penetrate, how deep each region is pressed, and which sites may come to touch.

use std::sync::Arc;

use thenar_surface::{Gap, GapLimits, Mesh, PosedSkin, Product, SkinSurface, Vec3};

use crate::skin::prepare::Skin;
use crate::workspace::Shape;
use crate::{ContactError, Model};

/// Reach of the distance query outside the product, mm.
pub const CUT_OFF: f64 = 8.0;
/// Penetration beyond which no soft tissue of a hand can yield, mm.
pub const MOST_DEPTH: f64 = 20.0;
/// Power of thickness with which stiffness falls near that depth.
const ESCAPE_POWER: f64 = 1.5;
/// Least thickness in vertex spacings for which a vertex still yields to its own force (0.34 in theory).
const COARSEST_SHARE: f64 = 0.4;
/// Share of the largest penetration that a bulge may rise into the product (0.2 measured at most; see physics tests).
const BULGE_SHARE: f64 = 0.25;
/// Gap beyond that margin up to which sites join the zone of a warm start, mm: the zone then serves many small moves.
const WARM_MARGIN: f64 = 0.3;
/// Largest penetration over thickness for which the bonded layer's kernel is used as it is.
pub const KERNEL_LIMIT: f64 = 0.5;

/// The skin in one posture beside one product.
#[derive(Clone)]
pub struct Detection {
    /// Posed positions of the welded vertices, mm, in the product's frame.
    pub positions: Vec<Vec3>,
    /// Posed outward normals.
    pub normals: Vec<Vec3>,
    /// Posed areas, mm2.
    pub areas: Vec<f64>,
    /// Signed distance and closest point, by welded vertex.
    pub gaps: Arc<Vec<Option<Gap>>>,
    /// The distances alone, infinite beyond the reach of the query: most that ask need no more, and read a tenth.
    pub distances: Vec<f64>,
    /// Largest penetration, by region, mm.
    pub max_penetration: Vec<f64>,
}

impl Detection {
    /// Takes over the penetrations of a moved posture where they are larger.
    pub fn deepen(&mut self, skin: &Skin) {
        for (site, &vertex) in skin.sites.vertex.iter().enumerate() {
            if skin.sites.is_skin(site) {
                let most = &mut self.max_penetration[skin.sites.region[site] as usize];
                *most = most.max(-self.distances[vertex as usize]);
            }
        }
    }

    /// Largest penetration of any region, mm.
    pub fn deepest(&self) -> f64 {
        self.max_penetration
            .iter()
            .fold(0.0, |most, d| f64::max(most, *d))
    }
}

/// Reach and depth of every distance query.
pub fn limits() -> GapLimits {
    GapLimits {
        cut_off_mm: CUT_OFF,
        max_depth_mm: 2.0 * MOST_DEPTH,
    }
}

/// Measures the gaps of a posed mesh to a product that was moved by `shift` (mm).
///
/// # Errors
/// [`ContactError::Swallowed`] if skin lies deeper than any tissue yields.
pub fn detect(
    skin: &mut Skin,
    posed: &Mesh,
    product: &Product,
    shift: Vec3,
) -> Result<Detection, ContactError> {
    let positions: Vec<Vec3> = posed.positions().iter().map(|p| p - shift).collect();
    let seen = &mut skin.memory.seen;
    let Shape { normals, areas } = seen.shape(posed);
    let facing = PosedSkin {
        points: &positions,
        normals: &normals,
        surface: Some(SkinSurface {
            triangles: posed.triangles(),
            adjacency: &skin.adjacency,
        }),
    };
    let mut gaps = product.gaps_after(&mut seen.readings, &facing, limits());
    let mut distances = seen.readings.distances().to_vec();
    // Vertices without a triangle are no skin, wherever they lie.
    for (vertex, area) in skin.rest_area.iter().enumerate() {
        if *area == 0.0 {
            Arc::make_mut(&mut gaps)[vertex] = None;
            distances[vertex] = f64::INFINITY;
        }
    }
    let mut max_penetration = vec![0.0f64; skin.tissue.materials.len()];
    let mut deepest = (0.0, 0);
    for (site, &vertex) in skin.sites.vertex.iter().enumerate() {
        let (region, depth) = (skin.sites.region[site], -distances[vertex as usize]);
        if region < 0 {
            continue;
        }
        if depth > deepest.0 {
            deepest = (depth, vertex);
        }
        let most = &mut max_penetration[region as usize];
        *most = most.max(depth);
    }
    let (depth_mm, vertex) = deepest;
    if depth_mm > MOST_DEPTH {
        return Err(ContactError::Swallowed {
            vertex: skin.welded.source[vertex as usize] as usize,
            depth_mm,
            limit_mm: MOST_DEPTH,
        });
    }
    Ok(Detection {
        positions,
        normals,
        areas,
        gaps,
        distances,
        max_penetration,
    })
}

/// The distances of gaps; infinite where there is none.
pub fn distances_of(gaps: &[Option<Gap>]) -> Vec<f64> {
    let distance = |gap: &Option<Gap>| gap.as_ref().map_or(f64::INFINITY, |gap| gap.distance);
    gaps.iter().map(distance).collect()
}

/// Sites that may touch: skin that penetrates or may be lifted into the product, ascending.
pub fn candidates(skin: &Skin, detection: &Detection) -> Vec<u32> {
    within(skin, detection, 0.0)
}

/// [`candidates`] and their surroundings, to be kept while the posture changes little; with the `last` zone where that is little
/// more, for what was lifted into it is likely to be again.
pub fn lasting_with(skin: &Skin, detection: &Detection, last: &[u32]) -> Vec<u32> {
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
pub fn serving(skin: &Skin, detection: &Detection) -> Vec<u32> {
    let zone = candidates(skin, detection);
    let last = &skin.memory.zone;
    let is_warm = !skin.memory.trail.last.force.is_empty();
    let distance = |s: u32| detection.distances[skin.sites.vertex[s as usize] as usize];
    let is_known = |&s: &u32| distance(s) < f64::INFINITY;
    let serves = is_warm
        && last.len() <= zone.len() + zone.len() / 4
        && zone.iter().all(|site| last.binary_search(site).is_ok())
        && last.iter().all(is_known);
    match (serves, is_warm && !zone.is_empty()) {
        (true, _) => last.clone(),
        (false, true) => lasting_with(skin, detection, last),
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

/// Refuses to press skin whose vertices are too far apart for a layer so thin: one would answer its own force the wrong way.
///
/// # Errors
/// [`ContactError::TooCoarse`] naming the first such vertex.
pub fn check_resolution(skin: &Skin, zone: &[u32]) -> Result<(), ContactError> {
    for &site in zone.iter().filter(|_| skin.model == Model::Layer) {
        let region = skin.sites.region[site as usize];
        let spacing_mm = (skin.sites.area[site as usize] * 2.0 / 3f64.sqrt()).sqrt();
        let thickness_mm = skin.tissue.thickness(site as usize, region as usize);
        if thickness_mm < COARSEST_SHARE * spacing_mm {
            let vertex = skin.welded.source[skin.sites.vertex[site as usize] as usize] as usize;
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
