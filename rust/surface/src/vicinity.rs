//! Which points lie near which, by a grid as wide as the points are apart.

use crate::mesh::Vec3;

/// Points this many typical spacings apart are neighbors: the second ring around a vertex. Tests pass from 1.6 to 4.
const REACH: f64 = 2.5;

/// Points whose nearest neighbor is measured to find the typical spacing.
const SAMPLES: usize = 64;

/// Points sorted into the cells of a grid.
pub(crate) struct Vicinity<'a> {
    points: &'a [Vec3],
    /// Cell and point, sorted.
    cells: Vec<([i64; 3], u32)>,
    reach: f64,
}

impl<'a> Vicinity<'a> {
    /// Sorts the points `members`; their spacing is measured at some of `places`, which is not empty.
    pub(crate) fn new(points: &'a [Vec3], members: &[u32], places: &[u32]) -> Vicinity<'a> {
        let axes: [Vec<f64>; 3] =
            [0, 1, 2].map(|k| members.iter().map(|&j| points[j as usize][k]).collect());
        let apart = |i: u32| nearest(&axes, points[i as usize]);
        let mut spacings: Vec<f64> = places
            .iter()
            .step_by(places.len().div_ceil(SAMPLES))
            .map(|&i| apart(i))
            .collect();
        spacings.sort_unstable_by(f64::total_cmp);
        let reach = REACH * spacings[spacings.len() / 2];
        let mut cells: Vec<([i64; 3], u32)> = members
            .iter()
            .map(|&i| (cell(points[i as usize], reach), i))
            .collect();
        cells.sort_unstable();
        Vicinity {
            points,
            cells,
            reach,
        }
    }

    /// The points near point `i`, itself among them.
    pub(crate) fn around(&self, i: u32) -> Vec<u32> {
        let at = self.points[i as usize];
        let [x, y, z] = cell(at, self.reach);
        let mut near = Vec::new();
        for (dx, dy) in (-1..=1).flat_map(|dx| (-1..=1).map(move |dy| (dx, dy))) {
            let [first, last] = [z.saturating_sub(1), z.saturating_add(1)]
                .map(|z| [x.saturating_add(dx), y.saturating_add(dy), z]);
            let from = self.cells.partition_point(|c| c.0 < first);
            let column = self.cells[from..].iter().take_while(|c| c.0 <= last);
            near.extend(
                column
                    .map(|c| c.1)
                    .filter(|&j| (self.points[j as usize] - at).norm() <= self.reach),
            );
        }
        near
    }
}

/// Distance from `p` to the nearest of some points that lies elsewhere; infinite if none does.
fn nearest([x, y, z]: &[Vec<f64>; 3], p: Vec3) -> f64 {
    // Eight chains: one would wait for each of its own comparisons.
    let mut least = [f64::INFINITY; 8];
    let mut compare = |lane: usize, [x, y, z]: [f64; 3]| {
        let (x, y, z) = (x - p.x, y - p.y, z - p.z);
        let squared = x * x + y * y + z * z;
        let is_nearer = squared > 0.0 && squared < least[lane];
        least[lane] = if is_nearer { squared } else { least[lane] };
    };
    let ((x8, x_rest), (y8, y_rest)) = (x.as_chunks::<8>(), y.as_chunks::<8>());
    let (z8, z_rest) = z.as_chunks::<8>();
    for ((x, y), z) in x8.iter().zip(y8).zip(z8) {
        (0..8).for_each(|lane| compare(lane, [x[lane], y[lane], z[lane]]));
    }
    for ((x, y), z) in x_rest.iter().zip(y_rest).zip(z_rest) {
        compare(0, [*x, *y, *z]);
    }
    least.into_iter().fold(f64::INFINITY, f64::min).sqrt()
}

/// `as` saturates: without spacing (one point only) all share the cell 0 or the last.
fn cell(p: Vec3, size: f64) -> [i64; 3] {
    [p.x / size, p.y / size, p.z / size].map(|x| x.floor() as i64)
}
