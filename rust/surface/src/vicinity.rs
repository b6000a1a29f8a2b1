//! Which points lie near which, by a grid as wide as the points are apart.

use crate::mesh::Vec3;

/// Points this many typical spacings apart are neighbors: the second ring around a vertex. Tests pass from 1.6 to 4.
const REACH: f64 = 2.5;

/// Points whose nearest neighbor is measured to find the typical spacing.
const SAMPLES: usize = 64;

/// Points sorted into the cells of a grid.
pub(crate) struct Vicinity<'a> {
    points: &'a [Vec3],
    reach: f64,
    /// Cells that hold points, sorted.
    cells: Vec<[i64; 3]>,
    /// Where the points of each begin among `members`, and where those of the last end.
    starts: Vec<usize>,
    members: Vec<u32>,
    /// By cell, the runs of cells around it: first, and one past the last.
    around: Vec<[(u32, u32); COLUMNS]>,
}

/// Columns of cells that hold what may be near.
const COLUMNS: usize = 9;

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
        let mut sorted: Vec<([i64; 3], u32)> = members
            .iter()
            .map(|&i| (cell(points[i as usize], reach), i))
            .collect();
        sorted.sort_unstable();
        let mut starts = vec![0];
        let alike = sorted.chunk_by(|a, b| a.0 == b.0);
        let cells: Vec<[i64; 3]> = alike
            .map(|alike| {
                starts.push(starts[starts.len() - 1] + alike.len());
                alike[0].0
            })
            .collect();
        Vicinity {
            points,
            reach,
            around: columns_around(&cells),
            cells,
            starts,
            members: sorted.into_iter().map(|(_, i)| i).collect(),
        }
    }

    /// How near is near, mm.
    pub(crate) fn reach(&self) -> f64 {
        self.reach
    }

    /// The points near one of the members, itself among them.
    pub(crate) fn around(&self, i: u32) -> Vec<u32> {
        let at = self.points[i as usize];
        let mut near = Vec::new();
        for (first, end) in self.columns(i) {
            let there = self.starts[first as usize]..self.starts[end as usize];
            let is_near = |j: &u32| (self.points[*j as usize] - at).norm() <= self.reach;
            near.extend(self.members[there].iter().copied().filter(is_near));
        }
        near
    }

    /// For each of some members, what no `value` of a point near it is below.
    pub(crate) fn least_near(&self, places: &[u32], value: impl Fn(u32) -> f64) -> Vec<f64> {
        let least = |values: &mut dyn Iterator<Item = f64>| values.fold(f64::INFINITY, f64::min);
        let own: Vec<f64> = self
            .starts
            .windows(2)
            .map(|w| least(&mut self.members[w[0]..w[1]].iter().map(|&j| value(j))))
            .collect();
        let near = |&i: &u32| {
            let runs = self.columns(i).into_iter();
            least(
                &mut runs
                    .flat_map(|(first, end)| own[first as usize..end as usize].iter().copied()),
            )
        };
        places.iter().map(near).collect()
    }

    fn columns(&self, i: u32) -> [(u32, u32); COLUMNS] {
        let home = cell(self.points[i as usize], self.reach);
        let home = self.cells.binary_search(&home);
        home.map_or([(0, 0); COLUMNS], |k| self.around[k])
    }
}

/// The runs of `cells` (sorted) around each of them.
fn columns_around(cells: &[[i64; 3]]) -> Vec<[(u32, u32); COLUMNS]> {
    let mut around = vec![[(0, 0); COLUMNS]; cells.len()];
    let steps = (-1..=1).flat_map(|dx| (-1..=1).map(move |dy| (dx, dy)));
    for (column, (dx, dy)) in steps.enumerate() {
        // What is around one cell lies behind what is around the cell before: one walk finds all.
        let mut first = 0;
        for (&[x, y, z], around) in cells.iter().zip(&mut around) {
            let [low, high] = [z.saturating_sub(1), z.saturating_add(1)]
                .map(|z| [x.saturating_add(dx), y.saturating_add(dy), z]);
            while first < cells.len() && cells[first] < low {
                first += 1;
            }
            let there = cells[first..].iter().take_while(|cell| **cell <= high);
            around[column] = (first as u32, (first + there.count()) as u32);
        }
    }
    around
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_near_and_the_least_of_it_are_those_of_a_search_in_full() {
        // A sheet that waves, some points twice, half of them members.
        let place = |k: u32| f64::from(k % 300);
        let points: Vec<Vec3> = (0..640)
            .map(|k| {
                let (x, y) = ((place(k) * 0.37) % 7.0 - 3.0, (place(k) * 0.71) % 5.0 - 2.0);
                Vec3::new(x, y, (2.0 * x).sin())
            })
            .collect();
        let members: Vec<u32> = (0..640).filter(|k| k % 2 == 0).collect();
        let places = &members[20..200];
        let vicinity = Vicinity::new(&points, &members, places);
        let value = |i: u32| f64::from(i * 7919 % 641) - 300.0;
        let least = vicinity.least_near(places, value);
        let mut sharp = 0;
        for (&i, bound) in places.iter().zip(least) {
            let apart = |j: &u32| (points[*j as usize] - points[i as usize]).norm();
            let is_near = |j: &&u32| apart(j) <= vicinity.reach();
            let wanted: Vec<u32> = members.iter().filter(is_near).copied().collect();
            let mut found = vicinity.around(i);
            found.sort_unstable();
            assert_eq!(found, wanted);
            let own = wanted
                .iter()
                .map(|&j| value(j))
                .fold(f64::INFINITY, f64::min);
            assert!(bound <= own, "{bound} {own}");
            sharp += usize::from(bound == own);
        }
        assert!(
            sharp > 5 && sharp < places.len(),
            "{sharp} of {}",
            places.len()
        );
    }
}
