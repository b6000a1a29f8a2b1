//! The paper as a flat sheet: where a place near the product lies on it, mm along its columns and rows.

use std::collections::BTreeMap;

use nalgebra::Vector3;

use thenar_inference::observe::measured::Mat;
use thenar_inference::observe::robust_scale::median;

/// A place farther off the paper than this does not lie on it, mm: skin that nearly touches, and a coarse product's chords.
const OFF: f64 = 4.0;
/// How much farther off it may lie for every mm beyond the paper's edge, where the product bends away from it, as a cylinder
/// of 25 mm radius does at [`MARGIN`].
const BENDS: f64 = 0.3;
/// A place beyond the paper's edge is followed so far along it, mm: paper that lies otherwise than it is said to may reach there.
pub const MARGIN: f64 = 15.0;

/// Cells by row and column, and what a step along each of them is in space.
pub struct Sheet {
    centers: Vec<Vector3<f64>>,
    places: Vec<[u32; 2]>,
    /// By cell: a step along the columns and one along the rows, mm.
    steps: Vec<[Vector3<f64>; 2]>,
    /// Cells by row and column.
    pub index: BTreeMap<[u32; 2], usize>,
    /// Usual length of a step along columns and along rows, mm.
    pub pitch: [f64; 2],
    /// Length once around along columns and along rows, mm, where the paper's ends nearly meet behind the product.
    around: [Option<f64>; 2],
}

impl Sheet {
    /// The sheet of a mat whose cells are numbered; None if one is not, or none lies beside another.
    pub fn new(mat: &Mat) -> Option<Sheet> {
        let places: Vec<[u32; 2]> = mat.places.iter().copied().collect::<Option<_>>()?;
        let numbered = places.iter().enumerate();
        let index: BTreeMap<[u32; 2], usize> = numbered.map(|(k, place)| (*place, k)).collect();
        let along = |k: usize, axis: usize| {
            let beside = |by: i64| {
                let mut place = places[k];
                // Columns are the second number of a place.
                let number = u32::try_from(i64::from(place[1 - axis]) + by).ok()?;
                place[1 - axis] = number;
                index.get(&place).map(|other| mat.centers[*other])
            };
            match (beside(-1), beside(1)) {
                (Some(before), Some(after)) => Some(0.5 * (after - before)),
                (Some(before), None) => Some(mat.centers[k] - before),
                (None, Some(after)) => Some(after - mat.centers[k]),
                (None, None) => None,
            }
        };
        let pitch = [0, 1].map(|axis| {
            let mut lengths: Vec<f64> = (0..places.len())
                .filter_map(|k| Some(along(k, axis)?.norm()))
                .collect();
            (!lengths.is_empty()).then(|| median(&mut lengths))
        });
        let pitch = match pitch {
            [Some(columns), Some(rows)] => [columns, rows],
            [Some(one), None] | [None, Some(one)] => [one, one],
            [None, None] => return None,
        };
        let step = |k: usize| {
            let (column, row) = (along(k, 0), along(k, 1));
            let normal = mat.normals[k];
            let column = column.or_else(|| Some(row?.cross(&normal).normalize() * pitch[0]));
            let row = row.or_else(|| Some(normal.cross(&column?).normalize() * pitch[1]));
            [column, row].map(|step| step.unwrap_or_else(Vector3::zeros))
        };
        let mut sheet = Sheet {
            steps: (0..places.len()).map(step).collect(),
            centers: mat.centers.clone(),
            places,
            index,
            pitch,
            around: [None; 2],
        };
        sheet.around = [0, 1].map(|axis| sheet.length_around(axis));
        Some(sheet)
    }

    /// The usual length around of its lines along an axis; None where the ends of most lines lie apart.
    fn length_around(&self, axis: usize) -> Option<f64> {
        let mut lines: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
        for (k, place) in self.places.iter().enumerate() {
            lines.entry(place[axis]).or_default().push(k);
        }
        let count = lines.len();
        let mut lengths: Vec<f64> = lines
            .into_values()
            .filter_map(|line| {
                let number = |k: &usize| self.places[*k][1 - axis];
                let first = line.iter().copied().min_by_key(number)?;
                let last = line.iter().copied().max_by_key(number)?;
                let steps = f64::from(number(&last) - number(&first));
                Some(steps * self.pitch[axis] + self.arc(last, first, axis)?)
            })
            .collect();
        lengths.sort_by(f64::total_cmp);
        (2 * lengths.len() > count).then(|| lengths[lengths.len() / 2])
    }

    /// Length, mm, on from the last cell of a line to its first, as of a circle that both steps touch; None where that does not lead there, or
    /// is farther than a place is followed from both ends.
    fn arc(&self, last: usize, first: usize, axis: usize) -> Option<f64> {
        let chord = self.centers[first] - self.centers[last];
        let steps = [last, first].map(|cell| self.steps[cell][axis]);
        if last == first || steps.iter().any(|step| step.dot(&chord) <= 0.0) {
            return None;
        }
        // A step at an end is that from its neighbor and touches half a pitch before it: both turn over one pitch more than the arc does.
        let (straight, mut arc) = (chord.norm(), chord.norm());
        for _ in 0..4 {
            let turn = steps[0].angle(&steps[1]) * arc / (arc + self.pitch[axis]);
            let half = (0.5 * turn).max(1e-9);
            arc = straight * half / libm::sin(half);
        }
        (arc <= 2.0 * MARGIN + self.pitch[axis]).then_some(arc)
    }

    /// A place, and the same place once around the product either way where the paper's ends meet.
    pub fn images(&self, at: [f64; 2]) -> Vec<[f64; 2]> {
        let mut all = vec![at];
        for axis in 0..2 {
            let Some(around) = self.around[axis] else {
                continue;
            };
            for k in 0..all.len() {
                for by in [around, -around] {
                    let mut image = all[k];
                    image[axis] += by;
                    all.push(image);
                }
            }
        }
        all
    }

    /// The cell so many steps along columns and rows from another.
    pub fn beside(&self, cell: usize, steps: [f64; 2]) -> Option<usize> {
        let middle = self.middle(cell);
        self.cell([0, 1].map(|axis| middle[axis] + steps[axis] * self.pitch[axis]))
    }

    /// Middle of a cell, mm along columns and rows.
    pub fn middle(&self, cell: usize) -> [f64; 2] {
        let [row, column] = self.places[cell];
        [
            (f64::from(column) + 0.5) * self.pitch[0],
            (f64::from(row) + 0.5) * self.pitch[1],
        ]
    }

    /// The cell that holds a place of the sheet, or the same place once around.
    pub fn cell(&self, at: [f64; 2]) -> Option<usize> {
        self.images(at).into_iter().find_map(|at| self.holding(at))
    }

    fn holding(&self, at: [f64; 2]) -> Option<usize> {
        let number = |axis: usize| {
            let number = (at[axis] / self.pitch[axis]).floor();
            (0.0..f64::from(u32::MAX))
                .contains(&number)
                .then_some(number as u32)
        };
        self.index.get(&[number(1)?, number(0)?]).copied()
    }

    /// Where a place near the product lies on the sheet, or on what would go on beyond its edge, and how far off it; None away from it.
    pub fn spot(&self, point: &Vector3<f64>) -> Option<([f64; 2], f64)> {
        let mut nearest = (f64::INFINITY, 0);
        for (k, center) in self.centers.iter().enumerate() {
            let apart = (center - point).norm_squared();
            if apart < nearest.0 {
                nearest = (apart, k);
            }
        }
        let cell = nearest.1;
        let apart = point - self.centers.get(cell)?;
        let [column, row] = &self.steps[cell];
        let share = |step: &Vector3<f64>| match step.norm_squared() {
            0.0 => 0.0,
            square => apart.dot(step) / square,
        };
        let (x, y) = (share(column), share(row));
        let beyond = (x.abs() * self.pitch[0]).hypot(y.abs() * self.pitch[1]);
        let off = (apart - column * x - row * y).norm();
        let middle = self.middle(cell);
        let is_near =
            off <= OFF + BENDS * beyond && beyond <= MARGIN + self.pitch[0].hypot(self.pitch[1]);
        is_near.then(|| {
            let at = [middle[0] + x * self.pitch[0], middle[1] + y * self.pitch[1]];
            (at, off)
        })
    }
}
