//! Pressure on the product's vertices: nodal forces of the skin, distributed without loss.

use thenar_surface::{Gap, Product, Vec3};

/// Reach over which a nodal force is spread, in vertex spacings of the hand: the coarser mesh sets what a map can resolve,
/// and two meshes that sample each other point by point would show stripes.
const SPREAD: f64 = 1.2;
/// Share of that reach beyond which a vertex off the touched plane belongs to another wall.
const WALL_SHARE: f64 = 0.6;

/// Pressure at every product vertex, MPa, and the force that it sums to, N.
///
/// Each nodal force is spread over the product's vertices within reach of its touch, by area and nearness; where there are
/// none (a coarse product) it goes to the corners of the touched triangle by barycentric coordinates. `spacing` is the
/// hand's, mm.
pub fn product_pressure(
    product: &Product,
    touches: &[(f64, &Gap)],
    spacing: f64,
) -> (Vec<f64>, f64) {
    let areas = product.vertex_areas();
    let mut force = vec![0.0; areas.len()];
    let reach = SPREAD * spacing;
    let cells = Cells::new(product, touches, reach);
    let mut shares = vec![(0, 0.0); cells.vertices.len()];
    for (nodal, gap) in touches {
        let count = find_shares((gap, reach), &cells, &mut shares);
        let sum: f64 = shares[..count].iter().map(|s| s.1).sum();
        if sum > 0.0 {
            let scale = nodal / sum;
            for (vertex, share) in &shares[..count] {
                force[*vertex as usize] += scale * share;
            }
        } else {
            let triangle = product.mesh().triangles()[gap.triangle as usize];
            for (corner, share) in triangle.into_iter().zip(gap.barycentric) {
                force[corner as usize] += nodal * share;
            }
        }
    }
    let total = force.iter().sum();
    let pressure = force
        .iter()
        .zip(areas)
        .map(|(f, a)| if *a > 0.0 { f / a } else { 0.0 })
        .collect();
    (pressure, total)
}

/// A vertex of the product.
#[derive(Clone, Copy)]
struct Vertex {
    index: u32,
    /// mm2.
    area: f64,
    position: Vec3,
}

/// Product vertices about the touches, by the cells of a grid.
struct Cells {
    low: Vec3,
    /// Cells a mm.
    per_mm: f64,
    counts: [usize; 3],
    /// Where the vertices of each cell begin, and where those of the last end.
    starts: Vec<u32>,
    vertices: Vec<Vertex>,
}

/// Most cells for each vertex of the product.
const CELLS_PER_VERTEX: f64 = 2.0;

impl Cells {
    fn new(product: &Product, touches: &[(f64, &Gap)], reach: f64) -> Self {
        let mut low = Vec3::repeat(f64::INFINITY);
        let mut high = Vec3::repeat(f64::NEG_INFINITY);
        for (_, gap) in touches {
            (low, high) = (low.inf(&gap.closest), high.sup(&gap.closest));
        }
        (low, high) = (low.add_scalar(-reach), high.add_scalar(reach));
        let is_near = |p: &Vec3| (0..3).all(|k| low[k] <= p[k] && p[k] <= high[k]);
        let all = product
            .mesh()
            .positions()
            .iter()
            .zip(product.vertex_areas());
        let near = (0..).zip(all).filter(|(_, (p, _))| is_near(p));
        let near = near.map(|(index, (position, area))| Vertex {
            index,
            area: *area,
            position: *position,
        });
        let near: Vec<Vertex> = near.collect();
        let most = CELLS_PER_VERTEX * near.len() as f64 + 1.0;
        let mut size = reach;
        let counts_of =
            |size: f64| (high - low).map(|length| (length / size).max(0.0).floor() + 1.0);
        while counts_of(size).product() > most {
            size *= 1.25;
        }
        let counts = counts_of(size);
        let mut cells = Cells {
            low,
            per_mm: 1.0 / size,
            counts: [0, 1, 2].map(|k| counts[k] as usize),
            starts: Vec::new(),
            vertices: near.clone(),
        };
        cells.sort(&near);
        cells
    }

    /// Sorts the vertices by cell, those of one cell in ascending order.
    fn sort(&mut self, near: &[Vertex]) {
        let home = |v: &Vertex| self.index(self.cell(&v.position)) as u32;
        let homes: Vec<u32> = near.iter().map(home).collect();
        // Counted two places on, summed, and moved one place on as the cells are filled.
        let mut starts = vec![0u32; self.counts.iter().product::<usize>() + 2];
        homes
            .iter()
            .for_each(|&home| starts[home as usize + 2] += 1);
        for k in 2..starts.len() {
            starts[k] += starts[k - 1];
        }
        for (vertex, &home) in near.iter().zip(&homes) {
            let slot = &mut starts[home as usize + 1];
            self.vertices[*slot as usize] = *vertex;
            *slot += 1;
        }
        starts.pop();
        self.starts = starts;
    }

    fn cell(&self, point: &Vec3) -> [usize; 3] {
        [0, 1, 2].map(|k| {
            let at = ((point[k] - self.low[k]) * self.per_mm) as usize;
            at.min(self.counts[k] - 1)
        })
    }

    fn index(&self, cell: [usize; 3]) -> usize {
        (cell[2] * self.counts[1] + cell[1]) * self.counts[0] + cell[0]
    }

    /// Visits the vertices of all cells within `reach` (mm) of a point.
    fn visit(&self, point: &Vec3, reach: f64, mut visit: impl FnMut(&Vertex)) {
        let [first, last] = [-reach, reach].map(|by| self.cell(&point.add_scalar(by)));
        for z in first[2]..=last[2] {
            for y in first[1]..=last[1] {
                let row = self.index([0, y, z]);
                let (start, end) = (self.starts[row + first[0]], self.starts[row + last[0] + 1]);
                self.vertices[start as usize..end as usize]
                    .iter()
                    .for_each(&mut visit);
            }
        }
    }
}

/// Finds the vertices over which a touch is spread, with their shares; returns how many. `found` has room for all of `cells`.
fn find_shares((gap, reach): (&Gap, f64), cells: &Cells, found: &mut [(u32, f64)]) -> usize {
    let (scale, wall) = (1.0 / (reach * reach), WALL_SHARE * reach);
    let mut count = 0;
    cells.visit(&gap.closest, reach, |vertex| {
        let offset = vertex.position - gap.closest;
        let near = 1.0 - offset.norm_squared() * scale;
        // Written in any case and kept if it counts: a branch would be guessed wrong too often.
        found[count] = (vertex.index, vertex.area * near * near);
        count += usize::from((near > 0.0) & (offset.dot(&gap.normal).abs() < wall));
    });
    count
}
