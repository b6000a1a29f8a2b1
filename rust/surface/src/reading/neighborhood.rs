//! Which points lie near which, by a grid over all of them.

use crate::mesh::triangles::Vec3;
use crate::reading::facing::PosedSkin;

/// Points this many typical spacings apart are neighbors: the second ring around a vertex. Tests pass from 1.6 to 4.
const REACH: f64 = 2.5;

/// The same in mean edges of the mesh, which are longer than the way to the nearest vertex.
const REACH_OF_EDGES: f64 = 2.0;

/// Points whose nearest neighbor is measured to find the typical spacing.
const SAMPLES: usize = 64;

/// Most cells of the grid for each point in it: what is found does not depend on it.
const CELLS_PER_POINT: f64 = 4.0;

/// Part of a cell by which rounding may put a point into the next one, with room to spare.
const ROUNDING: f64 = 1e-6;

/// Points sorted into the cells of a grid.
pub(crate) struct Vicinity<'a> {
    points: &'a [Vec3],
    reach: f64,
    grid: Grid,
    /// The points, those of a cell together, which cells these are, and where they lie.
    members: Vec<u32>,
    homes: Vec<u32>,
    places: Vec<Vec3>,
}

/// Cells over the box of some points.
struct Grid {
    low: Vec3,
    /// mm.
    size: f64,
    counts: [usize; 3],
    /// Where the points of each cell begin, and where those of the last end.
    starts: Vec<u32>,
}

/// Median over some places of the mean edge at each, mm; on slender triangles the nearest vertex says little of the spacing.
pub(crate) fn spacing(skin: &PosedSkin<'_>, places: &[u32]) -> Option<f64> {
    let adjacency = skin.surface?.adjacency;
    let at_place = |&i: &u32| {
        let around = adjacency.neighbors(i as usize);
        let edge = |&j: &u32| (skin.points[j as usize] - skin.points[i as usize]).norm();
        let sum: f64 = around.iter().map(edge).sum();
        (!around.is_empty()).then(|| sum / around.len() as f64)
    };
    let some = places.iter().step_by(places.len().div_ceil(SAMPLES).max(1));
    let mut edges: Vec<f64> = some.filter_map(at_place).collect();
    let middle = edges.len() / 2;
    (!edges.is_empty()).then(|| *edges.select_nth_unstable_by(middle, f64::total_cmp).1)
}

impl<'a> Vicinity<'a> {
    /// Sorts the points `members`, which are finite; their `spacing` (mm) is measured at some of `places`, which is not empty, if not known.
    pub(crate) fn new(
        points: &'a [Vec3],
        members: &[u32],
        (places, spacing): (&[u32], Option<f64>),
    ) -> Vicinity<'a> {
        let mut grid = Grid::over(members.iter().map(|&i| points[i as usize]));
        let (members, homes) = grid.sort(points, members);
        let mut vicinity = Vicinity {
            points,
            reach: 0.0,
            grid,
            places: members.iter().map(|&i| points[i as usize]).collect(),
            members,
            homes,
        };
        if let Some(spacing) = spacing {
            vicinity.reach = REACH_OF_EDGES * spacing;
            return vicinity;
        }
        let mut spacings: Vec<f64> = places
            .iter()
            .step_by(places.len().div_ceil(SAMPLES))
            .map(|&i| vicinity.spacing_at(points[i as usize]))
            .collect();
        spacings.sort_unstable_by(f64::total_cmp);
        vicinity.reach = REACH * spacings[spacings.len() / 2];
        vicinity
    }

    /// How near is near, mm.
    pub(crate) fn reach(&self) -> f64 {
        self.reach
    }

    /// A value of every member, in the order in which they stand here.
    pub(crate) fn values(&self, value: impl Fn(u32) -> f64) -> Vec<f64> {
        self.members.iter().map(|&j| value(j)).collect()
    }

    /// The points near one of the members, itself among them.
    pub(crate) fn around(&self, i: u32) -> Vec<u32> {
        let mut near = Vec::new();
        self.visit(i, |_| true, |k| near.push(self.members[k]));
        near
    }

    /// Those of [`Vicinity::around`] whose value is wanted.
    pub(crate) fn around_where(
        &self,
        i: u32,
        values: &[f64],
        wanted: impl Fn(f64) -> bool,
    ) -> Vec<u32> {
        let mut near = Vec::new();
        self.visit(i, |k| wanted(values[k]), |k| near.push(self.members[k]));
        near
    }

    /// Visits the wanted ones of the members near one of them, by where they stand here.
    fn visit(&self, i: u32, wanted: impl Fn(usize) -> bool, mut visit: impl FnMut(usize)) {
        let at = self.points[i as usize];
        for (first, end) in self.grid.rows(at, self.grid.steps(self.reach)) {
            for k in self.grid.starts[first] as usize..self.grid.starts[end] as usize {
                if wanted(k) && (self.places[k] - at).norm() <= self.reach {
                    visit(k);
                }
            }
        }
    }

    /// For each of some members, what none of the `values` of points near it is below.
    pub(crate) fn least_near(&self, places: &[u32], values: &[f64]) -> Vec<f64> {
        let mut own = vec![f64::INFINITY; self.grid.starts.len() - 1];
        for (&home, value) in self.homes.iter().zip(values) {
            let least = &mut own[home as usize];
            *least = least.min(*value);
        }
        let steps = self.grid.steps(self.reach);
        let near = |&i: &u32| {
            let rows = self.grid.rows(self.points[i as usize], steps);
            let cells = rows.flat_map(|(first, end)| &own[first..end]);
            cells.fold(f64::INFINITY, |least, own| least.min(*own))
        };
        places.iter().map(near).collect()
    }

    /// Distance from `p` to the nearest member that lies elsewhere; infinite if none does.
    fn spacing_at(&self, p: Vec3) -> f64 {
        let widest = self.grid.counts.into_iter().fold(0, usize::max);
        let mut steps = 1;
        loop {
            let mut least = f64::INFINITY;
            for (first, end) in self.grid.rows(p, steps) {
                let there = self.grid.starts[first] as usize..self.grid.starts[end] as usize;
                for place in &self.places[there] {
                    let squared = (place - p).norm_squared();
                    if squared > 0.0 && squared < least {
                        least = squared;
                    }
                }
            }
            // Nothing in other cells is nearer than this.
            let sure = (steps as f64 - ROUNDING) * self.grid.size;
            if least <= sure * sure || steps >= widest {
                return least.sqrt();
            }
            steps *= 2;
        }
    }
}

impl Grid {
    /// Cells over the box of some points, and few of them for each.
    fn over(points: impl ExactSizeIterator<Item = Vec3>) -> Grid {
        let most = CELLS_PER_POINT * points.len() as f64 + 1.0;
        let none = (Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY));
        let (low, high) = points.fold(none, |(low, high), p| (low.inf(&p), high.sup(&p)));
        let lengths = high - low;
        let longest = lengths.max();
        let mut size = (lengths.product() / most).cbrt().max(longest / most);
        if !(size > 0.0 && size.is_finite()) {
            // All at one place, or farther apart than numbers tell.
            size = f64::INFINITY;
        }
        let counts = |size: f64| lengths.map(|length| (length / size).floor() + 1.0);
        while counts(size).product() > most {
            size *= 1.25;
        }
        let counts = counts(size);
        Grid {
            low,
            size,
            counts: [0, 1, 2].map(|k| counts[k] as usize),
            starts: Vec::new(),
        }
    }

    /// Fills the cells; returns the points cell by cell, and the cell of each.
    fn sort(&mut self, points: &[Vec3], members: &[u32]) -> (Vec<u32>, Vec<u32>) {
        let home = |&i: &u32| self.home(&points[i as usize]) as u32;
        let homes: Vec<u32> = members.iter().map(home).collect();
        // Counted two places on, summed, and moved one place on as the cells are filled.
        let mut starts = vec![0u32; self.counts.iter().product::<usize>() + 2];
        homes.iter().for_each(|&h| starts[h as usize + 2] += 1);
        for k in 2..starts.len() {
            starts[k] += starts[k - 1];
        }
        let (mut sorted, mut sorted_homes) = (vec![0; members.len()], vec![0; members.len()]);
        for (&member, &home) in members.iter().zip(&homes) {
            let next = &mut starts[home as usize + 1];
            sorted[*next as usize] = member;
            sorted_homes[*next as usize] = home;
            *next += 1;
        }
        starts.pop();
        self.starts = starts;
        (sorted, sorted_homes)
    }

    fn cell(&self, p: &Vec3) -> [usize; 3] {
        // `as` saturates, and makes 0 of what is no number.
        [0, 1, 2].map(|k| (((p[k] - self.low[k]) / self.size) as usize).min(self.counts[k] - 1))
    }

    fn index(&self, [x, y, z]: [usize; 3]) -> usize {
        (z * self.counts[1] + y) * self.counts[0] + x
    }

    fn home(&self, p: &Vec3) -> usize {
        self.index(self.cell(p))
    }

    /// How many cells away what lies within `reach` may be.
    fn steps(&self, reach: f64) -> usize {
        (reach / self.size + ROUNDING).ceil() as usize
    }

    /// Rows of cells, first and one past the last, up to so many `steps` away from that of a point.
    fn rows(&self, p: Vec3, steps: usize) -> impl Iterator<Item = (usize, usize)> {
        let home = self.cell(&p);
        let low = home.map(|at| at.saturating_sub(steps));
        let high = [0, 1, 2].map(|k| home[k].saturating_add(steps).min(self.counts[k] - 1));
        (low[2]..=high[2]).flat_map(move |z| {
            (low[1]..=high[1]).map(move |y| {
                let first = self.index([low[0], y, z]);
                (first, first + high[0] - low[0] + 1)
            })
        })
    }
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
        let vicinity = Vicinity::new(&points, &members, (places, None));
        let value = |i: u32| f64::from(i * 7919 % 641) - 300.0;
        let least = vicinity.least_near(places, &vicinity.values(value));
        let mut sharp = 0;
        for (&i, bound) in places.iter().zip(least) {
            let apart = |j: &u32| (points[*j as usize] - points[i as usize]).norm();
            let is_near = |j: &&u32| apart(j) <= vicinity.reach();
            let wanted: Vec<u32> = members.iter().filter(is_near).copied().collect();
            let mut found = vicinity.around(i);
            found.sort_unstable();
            assert_eq!(found, wanted);
            let mut found = vicinity.around_where(i, &vicinity.values(value), |x| x <= -40.0);
            found.sort_unstable();
            let low: Vec<u32> = wanted
                .iter()
                .copied()
                .filter(|&j| value(j) <= -40.0)
                .collect();
            assert_eq!(found, low);
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
