//! Simulated contact rasterized on the paper: 1 where skin leaves ink, 0 elsewhere.

use crate::prints::paper_sheet::{MARGIN, Sheet};
use crate::prints::print_case::Pressed;
use thenar_inference::observe::robust_scale::median;

/// Parts of a cell's side into which the sheet is cut.
const PARTS: f64 = 4.0;
/// A place farther from every vertex than this is no skin, in roots of the vertex's area: the corners of a square are 0.71 away.
const REACH: f64 = 0.8;

/// The places nearer than `reach` to a vertex that lies `off` the sheet above `at`, mm.
struct Disk {
    at: [f64; 2],
    off: f64,
    reach: f64,
}

/// A grid over the sheet and what would go on beyond its edge, a value in the middle of each square.
#[derive(Clone)]
pub struct Field {
    low: [f64; 2],
    step: [f64; 2],
    size: [usize; 2],
    on: Vec<f32>,
    /// Usual distance of the vertices that touch, mm.
    grain: f64,
}

impl Field {
    /// Every place is what the vertex next to it is.
    pub fn of(sheet: &Sheet, pressed: &Pressed<'_>, ink_kpa: f64) -> Field {
        let mut field = Field::empty(sheet);
        let mut nearest = vec![f32::INFINITY; field.on.len()];
        let mut sides = Vec::new();
        for vertex in 0..pressed.force_n.len() {
            let Some((at, off)) = sheet.spot(&pressed.positions[vertex]) else {
                continue;
            };
            let touches = pressed.inks(vertex, ink_kpa);
            let reach = REACH * pressed.areas[vertex].sqrt();
            let value = f32::from(u8::from(touches));
            for image in sheet.images(at) {
                let disk = Disk {
                    at: image,
                    off,
                    reach,
                };
                field.cover(&disk, value, &mut nearest);
            }
            if touches {
                sides.push(pressed.areas[vertex].sqrt());
            }
        }
        if !sides.is_empty() {
            field.grain = median(&mut sides);
        }
        field
    }

    /// The same with its edge smeared over the distance of two vertices, between which nobody knows where it lies: its steps from vertex to
    /// vertex would tell a pose that is not there.
    pub fn smeared(&self) -> Field {
        let half = [0, 1].map(|axis| (self.grain / self.step[axis]).round() as usize);
        let mut on = self.on.clone();
        for _ in 0..2 {
            on = self.averaged(&on, (1, self.size[0], half[0]));
            on = self.averaged(&on, (self.size[0], 1, half[1]));
        }
        Field { on, ..self.clone() }
    }

    /// Means over `half` places on both sides, a line being `step` from place to place and `next` from line to line.
    fn averaged(&self, on: &[f32], (step, next, half): (usize, usize, usize)) -> Vec<f32> {
        let [long, lines] = match step {
            1 => self.size,
            _ => [self.size[1], self.size[0]],
        };
        let mut means = vec![0.0; on.len()];
        let mut sums = vec![0.0; long + 1];
        for line in 0..lines {
            for k in 0..long {
                sums[k + 1] = sums[k] + f64::from(on[line * next + k * step]);
            }
            for k in 0..long {
                let (first, last) = (k.saturating_sub(half), (k + half + 1).min(long));
                let sum = sums[last] - sums[first];
                means[line * next + k * step] = (sum / (2 * half + 1) as f64) as f32;
            }
        }
        means
    }

    fn empty(sheet: &Sheet) -> Field {
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for cell in sheet.index.values() {
            let middle = sheet.middle(*cell);
            for axis in 0..2 {
                let reach = MARGIN + 2.0 * sheet.pitch[axis];
                low[axis] = low[axis].min(middle[axis] - reach);
                high[axis] = high[axis].max(middle[axis] + reach);
            }
        }
        let step = sheet.pitch.map(|pitch| pitch / PARTS);
        let size = [0, 1].map(|axis| ((high[axis] - low[axis]) / step[axis]).ceil() as usize + 1);
        Field {
            on: vec![0.0; size[0] * size[1]],
            low,
            step,
            size,
            grain: 0.0,
        }
    }

    /// Gives a value to all places within reach that have had no nearer one.
    fn cover(&mut self, disk: &Disk, value: f32, nearest: &mut [f32]) {
        let Disk { at, off, reach } = *disk;
        let ends = [0, 1].map(|axis| {
            let place = |x: f64| {
                ((x - self.low[axis]) / self.step[axis] - 0.5)
                    .ceil()
                    .max(0.0)
            };
            let (first, last) = (place(at[axis] - reach), place(at[axis] + reach));
            (first as usize).min(self.size[axis])..(last as usize).min(self.size[axis])
        });
        for row in ends[1].clone() {
            for column in ends[0].clone() {
                let apart = |axis: usize, number: usize| {
                    self.low[axis] + (number as f64 + 0.5) * self.step[axis] - at[axis]
                };
                let flat = apart(0, column).powi(2) + apart(1, row).powi(2);
                let (distance, k) = ((flat + off * off) as f32, row * self.size[0] + column);
                if flat <= reach * reach && distance < nearest[k] {
                    (nearest[k], self.on[k]) = (distance, value);
                }
            }
        }
    }

    /// Contact at a place, straight between the points of the grid; 0 beyond it.
    pub fn at(&self, at: [f64; 2]) -> f64 {
        let place = [0, 1].map(|axis| (at[axis] - self.low[axis]) / self.step[axis] - 0.5);
        let [x, y] = place.map(f64::floor);
        let is_in = |value: f64, size: usize| value >= 0.0 && value + 1.0 < size as f64;
        if !(is_in(x, self.size[0]) && is_in(y, self.size[1])) {
            return 0.0;
        }
        let (column, row) = (x as usize, y as usize);
        let (right, up) = (place[0] - x, place[1] - y);
        let of = |column: usize, row: usize| f64::from(self.on[row * self.size[0] + column]);
        let below = of(column, row) * (1.0 - right) + of(column + 1, row) * right;
        let above = of(column, row + 1) * (1.0 - right) + of(column + 1, row + 1) * right;
        below * (1.0 - up) + above * up
    }
}
