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
        let apart = |i: u32| {
            let others = members.iter().filter(|&&j| j != i);
            let squared = others.map(|&j| (points[j as usize] - points[i as usize]).norm_squared());
            squared
                .filter(|d| *d > 0.0)
                .fold(f64::INFINITY, f64::min)
                .sqrt()
        };
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

/// `as` saturates: without spacing (one point only) all share the cell 0 or the last.
fn cell(p: Vec3, size: f64) -> [i64; 3] {
    [p.x / size, p.y / size, p.z / size].map(|x| x.floor() as i64)
}
