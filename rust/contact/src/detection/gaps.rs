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

/// Where a product is pressed: moved by `shift` (mm), `along` a unit direction where one is known.
#[derive(Clone, Copy)]
pub struct Stand<'a> {
    pub product: &'a Product,
    pub shift: Vec3,
    pub along: Option<Vec3>,
}

impl<'a> Stand<'a> {
    /// The product where it was given, pressed along no known direction.
    pub fn as_given(product: &'a Product) -> Self {
        Stand {
            product,
            shift: Vec3::zeros(),
            along: None,
        }
    }

    /// The product moved by `offset` (mm) along a unit direction.
    pub fn moved(product: &'a Product, along: Vec3, offset: f64) -> Self {
        Stand {
            product,
            shift: along * offset,
            along: Some(along),
        }
    }
}

/// Skin that reads the end of a thin tool, not its nearest side.
#[derive(Clone)]
pub struct UnderTool {
    /// The way of the tool, unit.
    along: Vec3,
    /// Welded vertices, ascending.
    vertices: Vec<u32>,
}

impl UnderTool {
    /// Reads the tool's end again where `gaps` of these welded vertices, now at `points` (mm), show one of its sides.
    pub fn read_again<'a>(
        &self,
        product: &Product,
        readings: impl Iterator<Item = (usize, Vec3, &'a mut Option<Gap>)>,
    ) {
        for (vertex, point, gap) in readings {
            if let Some(nearest) = gap.as_ref()
                && self.vertices.binary_search(&(vertex as u32)).is_ok()
                && let Some(end) = product.tool_end_again(point, nearest, self.along)
            {
                *gap = Some(end);
            }
        }
    }
}

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
    /// Skin under a thin tool; None where there is none.
    pub under_tool: Option<UnderTool>,
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

    /// Replaces what skin in a thin tool, pressed along a unit direction, reads of the tool's sides by what it reads of its end.
    fn read_tool_ends(&mut self, skin: &Skin, product: &Product, along: Vec3) {
        let mut ends = Vec::new();
        for (site, &vertex) in skin.sites.vertex.iter().enumerate() {
            let at = vertex as usize;
            if self.distances[at] < 0.0
                && skin.sites.is_skin(site)
                && let Some(nearest) = &self.gaps[at]
            {
                let here = (self.positions[at], self.normals[at]);
                ends.extend(
                    product
                        .tool_end(here, nearest, along)
                        .map(|end| (vertex, end)),
                );
            }
        }
        if ends.is_empty() {
            return;
        }
        let gaps = Arc::make_mut(&mut self.gaps);
        for (vertex, end) in &ends {
            self.distances[*vertex as usize] = end.distance;
            gaps[*vertex as usize] = Some(*end);
        }
        let mut vertices: Vec<u32> = ends.iter().map(|(vertex, _)| *vertex).collect();
        vertices.sort_unstable();
        self.under_tool = Some(UnderTool { along, vertices });
    }

    /// What of the depths the skin bears where a soft grip yields by so much (mm, by site; empty for not at all).
    pub fn relieved(&self, skin: &Skin, yields: &[f64]) -> Option<Detection> {
        if yields.is_empty() {
            return None;
        }
        let mut relieved = self.clone();
        relieved.max_penetration.fill(0.0);
        for (site, &vertex) in skin.sites.vertex.iter().enumerate() {
            let distance = &mut relieved.distances[vertex as usize];
            if *distance < 0.0 {
                *distance = (*distance + yields[site].max(0.0)).min(0.0);
            }
        }
        relieved.deepen(skin);
        Some(relieved)
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

/// Measures the gaps of a posed mesh to a product. Where its way is known, depth in a thin tool is measured to the tool's end.
///
/// # Errors
/// [`ContactError::Swallowed`] if skin lies deeper than any tissue yields.
pub fn detect(
    pressing: &mut Pressing<'_>,
    posed: &Mesh,
    stand: &Stand<'_>,
) -> Result<Detection, ContactError> {
    let &Stand { product, shift, .. } = stand;
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
    let mut detection = Detection {
        positions,
        normals,
        areas,
        gaps,
        distances,
        max_penetration: Vec::new(),
        under_tool: None,
    };
    if let Some(along) = stand.along {
        detection.read_tool_ends(skin, product, along);
    }
    let distances = &detection.distances;
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
    detection.max_penetration = max_penetration;
    Ok(detection)
}

/// The distances of gaps; infinite where there is none.
pub fn distances_of(gaps: &[Option<Gap>]) -> Vec<f64> {
    let distance = |gap: &Option<Gap>| gap.as_ref().map_or(f64::INFINITY, |gap| gap.distance);
    gaps.iter().map(distance).collect()
}
