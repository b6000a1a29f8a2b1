//! Stage 1: signed gaps of the posed skin to the product, and the largest penetration of each region.

use std::sync::Arc;

use thenar_surface::{Gap, GapLimits, Mesh, PosedSkin, Product, SkinSurface, Vec3};

use crate::ContactError;
use crate::skin::prepare::Skin;
use crate::workspace::Pressing;
use crate::workspace::posture::PostureShape;

/// Reach of the distance query outside the product, mm.
pub const CUT_OFF: f64 = 8.0;
/// Penetration beyond which no soft tissue of a hand can yield, mm.
pub const MOST_DEPTH: f64 = 20.0;

/// Gaps of the skin in one posture to one product.
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
    pressing: &mut Pressing<'_>,
    posed: &Mesh,
    product: &Product,
    shift: Vec3,
) -> Result<Detection, ContactError> {
    let positions: Vec<Vec3> = posed.positions().iter().map(|p| p - shift).collect();
    let skin = pressing.skin;
    let seen = &mut pressing.workspace.posture;
    let PostureShape { normals, areas } = seen.shape(posed);
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
            vertex: skin.merged.source[vertex as usize] as usize,
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
