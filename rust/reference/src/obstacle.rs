//! The product as a penalty on skin that lies inside it.

use thenar_surface::{
    Adjacency, Gap, GapLimits, Mesh, PosedSkin, Product, SkinSurface, Vec3, vertex_areas,
    vertex_normals,
};

use crate::Tissue;

/// Distance over which the penalty's slope sets in, mm.
const ONSET_MM: f64 = 0.01;
/// Farthest distance outside at which skin is still followed, mm.
const REACH_MM: f64 = 12.0;

pub const LIMITS: GapLimits = GapLimits {
    cut_off_mm: REACH_MM,
    max_depth_mm: 100.0,
};

/// Cosine between a contact's normal and the skin's from which the skin is pushed along itself.
const SIDEWAYS: f64 = -0.2;

/// A rigid, smooth product before the skin of a posture.
pub struct Obstacle<'a> {
    product: &'a Product,
    limits: GapLimits,
    /// Skin vertices that may come to touch.
    vertices: Vec<u32>,
    /// Their outward normals before the press: the side of a wall that they meet.
    facing: Vec<Vec3>,
    /// Area of each before the press, mm2.
    areas: Vec<f64>,
    /// Deepest overlap before the press, mm; 0 outside.
    pub deepest: f64,
    /// Which lie inside it then.
    pressed: Vec<u32>,
    /// Whether skin lies behind a sheet without thickness.
    pub is_sheet: bool,
    /// How far the product's side is moved toward each, mm, so that its penalty holds the skin at the product and not below it.
    shifts: Vec<f64>,
}

/// Contact of one skin vertex.
#[derive(Debug, Clone, Copy)]
pub struct Touch {
    pub vertex: u32,
    /// Signed distance to the product, mm, < 0 inside.
    pub distance: f64,
    /// Away from the product.
    pub normal: Vec3,
    /// Along the normal, N.
    pub force: f64,
    /// Growth of the force with depth, N/mm.
    pub stiffness: f64,
    /// Energy of the penalty, N mm.
    pub energy: f64,
    /// Whether the product pushes the skin along itself and not back: a tool thinner than twice its depth does.
    pub is_sideways: bool,
}

/// How hard the product is, and how much of it has grown.
#[derive(Debug, Clone, Copy)]
pub struct Penalty {
    /// Pressure over depth, MPa/mm.
    pub stiffness: f64,
    /// The product is this much smaller all around, mm.
    pub inset: f64,
}

impl<'a> Obstacle<'a> {
    /// Whether every skin vertex lies within `reach` mm of the product, or in it.
    pub fn near(tissue: &Tissue, product: &Product, reach: f64) -> Vec<bool> {
        let limits = GapLimits {
            cut_off_mm: reach,
            ..LIMITS
        };
        let gaps = product.gaps(&tissue.skin, None, limits);
        gaps.iter().map(Option::is_some).collect()
    }

    pub fn new(
        tissue: &Tissue,
        product: &'a Product,
        can_touch: impl Fn(usize) -> bool,
    ) -> Obstacle<'a> {
        let limits = LIMITS;
        let mut obstacle = Obstacle {
            product,
            limits,
            vertices: Vec::new(),
            facing: Vec::new(),
            areas: Vec::new(),
            deepest: 0.0,
            pressed: Vec::new(),
            is_sheet: false,
            shifts: Vec::new(),
        };
        let Ok(mesh) = Mesh::new(tissue.skin.clone(), tissue.triangles.clone()) else {
            return obstacle;
        };
        let (normals, areas) = (vertex_normals(&mesh), vertex_areas(&mesh));
        let adjacency = Adjacency::new(&mesh);
        let skin = PosedSkin {
            points: mesh.positions(),
            normals: &normals,
            surface: Some(SkinSurface {
                triangles: mesh.triangles(),
                adjacency: &adjacency,
            }),
        };
        let gaps = product.gaps_of_skin(&skin, limits);
        for (v, gap) in gaps.iter().enumerate() {
            if let Some(gap) = gap.filter(|_| can_touch(v)) {
                obstacle.vertices.push(v as u32);
                obstacle.facing.push(normals[v]);
                obstacle.areas.push(areas[v]);
                obstacle.deepest = obstacle.deepest.max(-gap.distance);
                if gap.distance < 0.0 {
                    obstacle.pressed.push(v as u32);
                }
                // Skin behind a sheet, no farther than its flesh reaches, has met it.
                let is_behind = gap.distance < 0.0 || gap.normal.dot(&normals[v]) > 0.0;
                let reach = (tissue.skin[v] - tissue.bone[v]).norm();
                obstacle.is_sheet |= is_behind
                    && gap.distance.abs() < reach
                    && product.is_sheet(gap.triangle as usize);
                obstacle.shifts.push(0.0);
            }
        }
        obstacle
    }

    /// Readings of the followed vertices where they lie at `places`, mm.
    fn gaps(&self, place: impl Fn(usize) -> Vec3) -> Vec<Option<Gap>> {
        let points: Vec<Vec3> = self.vertices.iter().map(|v| place(*v as usize)).collect();
        self.product
            .gaps_along(&points, Some(&self.facing), self.limits, &[])
    }

    /// Whether all corners of a triangle of the skin may come to touch.
    pub fn follows(&self, triangle: &[u32; 3]) -> bool {
        triangle
            .iter()
            .all(|v| self.vertices.binary_search(v).is_ok())
    }

    /// Outward normal before the press at a point of a triangle that is followed.
    pub fn facing(&self, corners: [usize; 3], shares: [f64; 3]) -> Vec3 {
        let of = |v: usize| {
            self.vertices
                .binary_search(&(v as u32))
                .map(|k| self.facing[k])
        };
        let all = corners.iter().zip(shares);
        let normal: Vec3 = all
            .map(|(v, share)| of(*v).unwrap_or_default() * share)
            .sum();
        normal.try_normalize(1e-9).unwrap_or_default()
    }

    /// Those that lie inside the product before the press.
    pub fn pressed(&self) -> impl Iterator<Item = usize> {
        self.pressed.iter().map(|v| *v as usize)
    }

    pub fn product(&self) -> &Product {
        self.product
    }

    /// Signed distance of points that met the product facing as `facing`, mm; infinite where far.
    pub fn distances(&self, points: &[Vec3], facing: &[Vec3]) -> Vec<f64> {
        let gaps = self
            .product
            .gaps_along(points, Some(facing), self.limits, &[]);
        let distance = |gap: Option<Gap>| gap.map_or(f64::INFINITY, |gap| gap.distance);
        gaps.into_iter().map(distance).collect()
    }

    /// Signed distance of every followed vertex that has one, mm.
    pub fn readings(&self, place: impl Fn(usize) -> Vec3) -> Vec<(usize, f64)> {
        let gaps = self.gaps(place);
        let all = self.vertices.iter().zip(&gaps);
        all.filter_map(|(v, gap)| Some((*v as usize, gap.as_ref()?.distance)))
            .collect()
    }

    /// Contact of the vertices inside the product, or within the onset of its penalty.
    pub fn touches(&self, place: impl Fn(usize) -> Vec3, penalty: Penalty) -> Vec<Touch> {
        let gaps = self.gaps(place);
        let all = self
            .vertices
            .iter()
            .zip(&self.areas)
            .zip(&self.facing)
            .zip(self.shifts.iter().zip(&gaps));
        all.filter_map(|(((vertex, area), facing), (shift, gap))| {
            let gap = gap.as_ref()?;
            // The onset lies inside: skin that does not reach the product bears nothing.
            let distance = gap.distance + penalty.inset - shift + ONSET_MM;
            let (pressure, slope, energy) = law(distance, penalty.stiffness);
            (pressure > 0.0).then(|| Touch {
                vertex: *vertex,
                distance: gap.distance,
                normal: gap.normal,
                force: pressure * area,
                stiffness: slope * area,
                energy: energy * area,
                is_sideways: gap.normal.dot(facing) > SIDEWAYS,
            })
        })
        .collect()
    }
}

impl Obstacle<'_> {
    /// Moves the product's side by what the skin lies below it (augmented Lagrangian: pressure stays, depth goes).
    pub fn shift(&mut self, place: impl Fn(usize) -> Vec3) {
        let gaps = self.gaps(place);
        for (shift, gap) in self.shifts.iter_mut().zip(&gaps) {
            let distance = gap.as_ref().map_or(f64::INFINITY, |gap| gap.distance);
            *shift = (*shift - distance).max(0.0);
        }
    }
}

/// Pressure, its growth with depth, and energy by area, at a signed distance: linear, with a smooth onset.
fn law(distance: f64, stiffness: f64) -> (f64, f64, f64) {
    let depth = ONSET_MM - distance;
    if depth <= 0.0 {
        return (0.0, 0.0, 0.0);
    }
    if depth < 2.0 * ONSET_MM {
        let share = stiffness / (4.0 * ONSET_MM);
        return (
            share * depth * depth,
            2.0 * share * depth,
            share * depth.powi(3) / 3.0,
        );
    }
    let energy = stiffness * (distance * distance / 2.0 + ONSET_MM * ONSET_MM / 6.0);
    (-stiffness * distance, stiffness, energy)
}

#[cfg(test)]
mod tests {
    use super::law;

    #[test]
    fn pressure_is_the_slope_of_the_energy_and_has_no_jump() {
        for k in -40..40 {
            let (x, h) = (0.001 * f64::from(k) + 3e-4, 1e-7);
            let ((above, ..), (below, ..)) = (law(x + h, 2.0), law(x - h, 2.0));
            let ((.., high), (.., low), (pressure, slope, _)) =
                (law(x + h, 2.0), law(x - h, 2.0), law(x, 2.0));
            assert!(((low - high) / (2.0 * h) - pressure).abs() < 1e-6);
            assert!(((below - above) / (2.0 * h) - slope).abs() < 1e-5);
        }
    }
}
