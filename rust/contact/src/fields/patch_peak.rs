//! Patch peak: the largest mean pressure over a patch of a sensel's size.

use thenar_surface::{Adjacency, Vec3};

/// A sensel of the paper's mat (4.2 sensors per cm2), mm2.
pub const SENSEL_AREA: f64 = 24.0;

/// Centers nearer than this to another one are left out, mm: a sensel's mean changes by less than a thousandth over it.
const CENTER_SPACING: f64 = 0.25;

/// Mean pressure over the `SENSEL_AREA` around each of `centers`; the largest, MPa. 0 without centers.
///
/// The patch grows from its center over the mesh in order of distance until it has the area; the last vertex counts in part.
pub fn patch_peak(centers: &[u32], field: Field<'_>) -> f64 {
    let by_pressure = |a: &&u32, b: &&u32| field.pressure(**a).total_cmp(&field.pressure(**b));
    let thinned = thinned(centers, field);
    let mut search = Search::new(field);
    // A high mean first spares most of the others.
    let first = thinned.iter().max_by(by_pressure).copied();
    let others = thinned.iter().filter(|center| Some(**center) != first);
    for &center in first.iter().chain(others) {
        search.grow(center);
    }
    search.best
}

/// Centers of which none lies within [`CENTER_SPACING`] of an earlier one along the mesh.
fn thinned(centers: &[u32], field: Field<'_>) -> Vec<u32> {
    let mut is_covered = vec![false; field.area.len()];
    let (mut kept, mut open) = (Vec::new(), Vec::new());
    for &center in centers {
        if is_covered[center as usize] {
            continue;
        }
        kept.push(center);
        open.push(center);
        while let Some(v) = open.pop() {
            for &next in field.adjacency.neighbors(v as usize) {
                let off = field.positions[next as usize] - field.positions[center as usize];
                if !is_covered[next as usize]
                    && off.norm_squared() < CENTER_SPACING * CENTER_SPACING
                {
                    is_covered[next as usize] = true;
                    open.push(next);
                }
            }
        }
    }
    kept
}

/// A pressure field on a mesh.
#[derive(Clone, Copy)]
pub struct Field<'a> {
    /// Neighbors of every vertex.
    pub adjacency: &'a Adjacency,
    /// Positions, mm.
    pub positions: &'a [Vec3],
    /// Vertex areas, mm2.
    pub area: &'a [f64],
    /// Nodal forces, N.
    pub force: &'a [f64],
}

impl Field<'_> {
    fn pressure(&self, vertex: u32) -> f64 {
        self.force[vertex as usize] / self.area[vertex as usize]
    }
}

/// Vertices that a patch has come upon, from near to far.
#[derive(Default)]
struct Front {
    /// Squared distance (mm2) and vertex.
    reached: Vec<(f64, u32)>,
    /// How many were taken.
    taken: usize,
}

impl Front {
    fn clear(&mut self) {
        self.reached.clear();
        self.taken = 0;
    }

    /// Sorts a vertex in; what is come upon late is mostly far.
    fn push(&mut self, squared: f64, vertex: u32) {
        let mut at = self.reached.len();
        self.reached.push((squared, vertex));
        while at > self.taken && self.reached[at - 1] > (squared, vertex) {
            self.reached[at] = self.reached[at - 1];
            at -= 1;
        }
        self.reached[at] = (squared, vertex);
    }

    fn take(&mut self) -> Option<u32> {
        let (_, vertex) = self.reached.get(self.taken)?;
        self.taken += 1;
        Some(*vertex)
    }
}

/// What is left of a bound on a mean when rounding is taken off, with room to spare.
const ROUNDING: f64 = 1e-9;

/// The search for the patch of the highest mean.
struct Search<'a> {
    field: Field<'a>,
    /// Highest pressure of a vertex, and highest mean so far, MPa.
    highest: f64,
    best: f64,
    /// The center from which each vertex was last reached.
    seen: Vec<u32>,
    front: Front,
}

impl<'a> Search<'a> {
    fn new(field: Field<'a>) -> Self {
        let vertices = 0..field.area.len() as u32;
        let pressed = vertices.filter(|&v| field.force[v as usize] > 0.0);
        Search {
            field,
            highest: pressed.fold(0.0, |most, v| f64::max(most, field.pressure(v))),
            best: 0.0,
            seen: vec![u32::MAX; field.area.len()],
            front: Front::default(),
        }
    }

    /// Grows the patch about a center until it has its area, or can no longer be the best.
    fn grow(&mut self, center: u32) {
        let field = self.field;
        let origin = field.positions[center as usize];
        self.front.clear();
        self.front.push(0.0, center);
        self.seen[center as usize] = center;
        let (mut area, mut force) = (0.0, 0.0);
        while let Some(vertex) = self.front.take() {
            let v = vertex as usize;
            let share = ((SENSEL_AREA - area) / field.area[v].max(f64::MIN_POSITIVE)).min(1.0);
            area += share * field.area[v];
            force += share * field.force[v];
            if share < 1.0 {
                break;
            }
            let at_most = force + (SENSEL_AREA - area) * self.highest;
            if at_most < self.best * SENSEL_AREA * (1.0 - ROUNDING) {
                return;
            }
            for &next in field.adjacency.neighbors(v) {
                if self.seen[next as usize] != center {
                    self.seen[next as usize] = center;
                    let off = field.positions[next as usize] - origin;
                    self.front.push(off.norm_squared(), next);
                }
            }
        }
        // A skin smaller than a sensel loads it in part.
        self.best = self.best.max(force / SENSEL_AREA.max(area));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use thenar_surface::Mesh;

    #[test]
    fn the_patch_found_is_the_best_of_all_grown_in_full() {
        let side = 24u32;
        let at = |k: u32| Vec3::new(f64::from(k % side), f64::from(k / side), 0.0);
        let positions: Vec<Vec3> = (0..side * side).map(at).collect();
        let cells = (0..side * side).filter(|k| k % side + 1 < side && k / side + 1 < side);
        let triangles = cells.flat_map(|k| [[k, k + 1, k + side], [k + 1, k + side + 1, k + side]]);
        let mesh = Mesh::new(positions.clone(), triangles.collect()).unwrap();
        let adjacency = Adjacency::new(&mesh);
        let area: Vec<f64> = (0..side * side)
            .map(|k| 0.8 + f64::from(k % 5) * 0.1)
            .collect();
        for seed in 1..20 {
            let force: Vec<f64> = (0..side * side)
                .map(|k| f64::from((k * k + 7 * k) * seed % 97).max(20.0) - 20.0)
                .collect();
            let field = Field {
                adjacency: &adjacency,
                positions: &positions,
                area: &area,
                force: &force,
            };
            let pressed = |v: &u32| force[*v as usize] > 0.0;
            let centers: Vec<u32> = (0..side * side).filter(pressed).collect();
            let in_full = centers.iter().map(|&center| {
                let mut search = Search::new(field);
                search.grow(center);
                search.best
            });
            assert_eq!(patch_peak(&centers, field), in_full.fold(0.0, f64::max));
        }
    }
}
