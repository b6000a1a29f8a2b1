//! The product's side of the contact: nodal forces of the skin spread over the product's vertices, none lost.

use std::ops::Range;

use thenar_surface::{Gap, Mesh, Product, Vec3};

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
    touches: &[(f64, Gap)],
    spacing: f64,
) -> (Vec<f64>, f64) {
    let mesh = product.mesh();
    let areas = product.vertex_areas();
    let mut force = vec![0.0; areas.len()];
    let reach = SPREAD * spacing;
    let cells = Cells::new(mesh, touches, reach);
    let mut shares = Vec::new();
    for (nodal, gap) in touches {
        find_shares(mesh, (gap, reach), (&cells, areas), &mut shares);
        let sum: f64 = shares.iter().map(|s| s.1).sum();
        if sum > 0.0 {
            shares
                .iter()
                .for_each(|(vertex, share)| force[*vertex as usize] += nodal * share / sum);
        } else {
            let triangle = mesh.triangles()[gap.triangle as usize];
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

/// Product vertices about the touches, by the cells of a grid.
struct Cells {
    low: Vec3,
    /// At least the reach, mm.
    size: f64,
    counts: [usize; 3],
    /// One past the last vertex of each cell.
    ends: Vec<u32>,
    vertices: Vec<u32>,
}

/// Most cells for each vertex of the product.
const CELLS_PER_VERTEX: f64 = 4.0;

impl Cells {
    fn new(mesh: &Mesh, touches: &[(f64, Gap)], reach: f64) -> Self {
        let mut low = Vec3::repeat(f64::INFINITY);
        let mut high = Vec3::repeat(f64::NEG_INFINITY);
        for (_, gap) in touches {
            (low, high) = (low.inf(&gap.closest), high.sup(&gap.closest));
        }
        (low, high) = (low.add_scalar(-reach), high.add_scalar(reach));
        let is_near = |p: &Vec3| (0..3).all(|k| low[k] <= p[k] && p[k] <= high[k]);
        let inside: Vec<u32> = (0..mesh.positions().len() as u32)
            .filter(|&v| is_near(&mesh.positions()[v as usize]))
            .collect();
        let most = CELLS_PER_VERTEX * inside.len() as f64 + 1.0;
        let mut size = reach;
        let counts_of =
            |size: f64| (high - low).map(|length| (length / size).max(0.0).floor() + 1.0);
        while counts_of(size).product() > most {
            size *= 1.25;
        }
        let counts = counts_of(size);
        let mut cells = Cells {
            low,
            size,
            counts: [counts.x as usize, counts.y as usize, counts.z as usize],
            ends: Vec::new(),
            vertices: vec![0; inside.len()],
        };
        cells.sort(mesh, &inside);
        cells
    }

    /// Sorts the vertices by cell, those of one cell in ascending order.
    fn sort(&mut self, mesh: &Mesh, inside: &[u32]) {
        let homes: Vec<u32> = inside
            .iter()
            .map(|&v| self.index(self.cell(&mesh.positions()[v as usize])) as u32)
            .collect();
        let mut starts = vec![0u32; self.counts.iter().product::<usize>() + 1];
        for &home in &homes {
            starts[home as usize + 1] += 1;
        }
        for k in 1..starts.len() {
            starts[k] += starts[k - 1];
        }
        for (&vertex, &home) in inside.iter().zip(&homes) {
            let slot = &mut starts[home as usize];
            self.vertices[*slot as usize] = vertex;
            *slot += 1;
        }
        starts.pop();
        self.ends = starts;
    }

    fn cell(&self, point: &Vec3) -> [usize; 3] {
        [0, 1, 2].map(|k| {
            let at = ((point[k] - self.low[k]) / self.size) as usize;
            at.min(self.counts[k] - 1)
        })
    }

    fn index(&self, cell: [usize; 3]) -> usize {
        (cell[2] * self.counts[1] + cell[1]) * self.counts[0] + cell[0]
    }

    /// The vertices of a row of cells.
    fn row(&self, x: Range<usize>, [y, z]: [usize; 2]) -> &[u32] {
        let first = self.index([x.start, y, z]);
        let start = if first == 0 { 0 } else { self.ends[first - 1] };
        let end = self.ends[self.index([x.end - 1, y, z])];
        &self.vertices[start as usize..end as usize]
    }
}

fn find_shares(
    mesh: &Mesh,
    (gap, reach): (&Gap, f64),
    (cells, areas): (&Cells, &[f64]),
    found: &mut Vec<(u32, f64)>,
) {
    found.clear();
    let home = cells.cell(&gap.closest);
    let [x, y, z] =
        [0, 1, 2].map(|k| home[k].saturating_sub(1)..(home[k] + 2).min(cells.counts[k]));
    for (y, z) in z.flat_map(|z| y.clone().map(move |y| (y, z))) {
        for &vertex in cells.row(x.clone(), [y, z]) {
            let offset = mesh.positions()[vertex as usize] - gap.closest;
            let far = offset.norm_squared() / (reach * reach);
            if far < 1.0 && offset.dot(&gap.normal).abs() < WALL_SHARE * reach {
                found.push((vertex, areas[vertex as usize] * (1.0 - far) * (1.0 - far)));
            }
        }
    }
}
