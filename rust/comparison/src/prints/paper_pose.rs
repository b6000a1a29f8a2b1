//! Fit of the paper's pose (shift and turn) with its intervals.

use nalgebra::{Matrix3, Vector3};
use thenar_recordings::handprint::TOUCHED_FROM;

use crate::prints::contact_areas::Areas;
use crate::prints::contact_raster::Field;
use crate::prints::paper_sheet::Sheet;
use crate::prints::printed::PosePart;
use thenar_inference::observe::measured::Mat;

/// Points across a cell at which contact is looked up.
const ACROSS: i32 = 3;
/// The paper may lie this many standard deviations off.
pub const MOST: f64 = 4.0;
/// Starts of the search along each shift and in turn, on both sides of none, over this part of the range.
const STARTS: i32 = 3;
const STARTED: f64 = 0.9;
/// Best starts that are followed.
const FOLLOWED: usize = 4;
/// Finest steps of the search, as parts of a cell.
const FINEST: f64 = 0.01;
/// Sectors about the middle of the ink whose misfits are taken as independent of one another: an edge is off over a stretch and not cell by cell.
const SECTORS: usize = 8;
/// Smallest variance of a cell's share that is believed: that of edges that lie a tenth of a cell's side off.
const LEAST_VARIANCE: f64 = 0.01;
/// Standard deviations on each side of a 90 % interval, of Student's t for what the sectors leave beside three numbers.
const NINETY: f64 = 2.015;

/// Cells of which something is known.
#[derive(Clone)]
pub struct Cells {
    middles: Vec<[f64; 2]>,
    recorded: Vec<f64>,
    areas: Vec<f64>,
    pitch: [f64; 2],
    /// Middle of the ink: the paper turns about it.
    pub center: [f64; 2],
    /// Root of the mean square distance of the ink from it, mm.
    reach: f64,
}

/// A pose with its intervals.
pub struct Fitted {
    /// Along columns and rows, mm, and turn, rad.
    pub parts: [PosePart; 3],
}

impl Cells {
    /// Of a print; None if none of it touched.
    pub fn new(sheet: &Sheet, mat: &Mat, inked: &[f64]) -> Option<Cells> {
        let middles = (0..inked.len()).map(|cell| sheet.middle(cell)).collect();
        Cells::centered(Cells {
            middles,
            recorded: inked.to_vec(),
            areas: mat.areas.clone(),
            pitch: sheet.pitch,
            center: [0.0; 2],
            reach: 0.0,
        })
    }

    fn centered(mut self) -> Option<Cells> {
        let touched = || (0..self.recorded.len()).filter(|k| self.recorded[*k] >= TOUCHED_FROM);
        let all: f64 = touched().map(|k| self.areas[k]).sum();
        let mean =
            |of: &dyn Fn(usize) -> f64| touched().map(|k| self.areas[k] * of(k)).sum::<f64>() / all;
        let center = [mean(&|k| self.middles[k][0]), mean(&|k| self.middles[k][1])];
        let square = mean(&|k| {
            (self.middles[k][0] - center[0]).powi(2) + (self.middles[k][1] - center[1]).powi(2)
        });
        (self.center, self.reach) = (center, square.sqrt().max(self.pitch[0]));
        (all > 0.0).then_some(self)
    }

    /// The same print seen from behind, its ink about where it was.
    pub fn mirrored(&self, sheet: &Sheet) -> Option<Cells> {
        let sum = (2.0 * self.center[0] / self.pitch[0]).round() * self.pitch[0];
        let from = |k: usize| {
            let there = sheet.cell([sum - self.middles[k][0], self.middles[k][1]]);
            there.map_or(f64::NAN, |cell| self.recorded[cell])
        };
        let recorded = (0..self.recorded.len()).map(from).collect();
        Cells::centered(Cells {
            recorded,
            ..self.clone()
        })
    }

    /// Where a place of the paper lies on the product's sheet.
    pub fn moved(&self, at: [f64; 2], [x, y, turn]: &[f64; 3]) -> [f64; 2] {
        let (sin, cos) = (libm::sin(*turn), libm::cos(*turn));
        let from = [at[0] - self.center[0], at[1] - self.center[1]];
        [
            self.center[0] + cos * from[0] - sin * from[1] + x,
            self.center[1] + sin * from[0] + cos * from[1] + y,
        ]
    }

    /// Which place of the paper lies there.
    pub fn back(&self, at: [f64; 2], [x, y, turn]: &[f64; 3]) -> [f64; 2] {
        self.moved([at[0] - x, at[1] - y], &[0.0, 0.0, -turn])
    }

    /// Share of every cell in simulated contact; NaN where nothing is known.
    pub fn shares(&self, field: &Field, pose: &[f64; 3]) -> Vec<f64> {
        let share = |k: usize| match self.recorded[k].is_nan() {
            true => f64::NAN,
            false => self.share(field, (self.middles[k], pose)),
        };
        (0..self.recorded.len()).map(share).collect()
    }

    fn share(&self, field: &Field, (middle, pose): ([f64; 2], &[f64; 3])) -> f64 {
        let [x, y] = self.moved(middle, pose);
        let (sin, cos) = (libm::sin(pose[2]), libm::cos(pose[2]));
        let mut sum = 0.0;
        for i in 0..ACROSS {
            for j in 0..ACROSS {
                let part = |k: i32| (f64::from(k) + 0.5) / f64::from(ACROSS) - 0.5;
                let (u, v) = (part(i) * self.pitch[0], part(j) * self.pitch[1]);
                sum += field.at([x + cos * u - sin * v, y + sin * u + cos * v]);
            }
        }
        sum / f64::from(ACROSS * ACROSS)
    }

    /// Area where both touch over the area where either does.
    pub fn overlap(&self, simulated: &[f64]) -> f64 {
        areas(&self.areas, &self.recorded, simulated).overlap()
    }

    /// Sum of the squared differences of shares.
    fn misfit(&self, field: &Field, pose: &[f64; 3]) -> f64 {
        let mut sum = 0.0;
        for (middle, recorded) in self.middles.iter().zip(&self.recorded) {
            if !recorded.is_nan() {
                sum += (recorded - self.share(field, (*middle, pose))).powi(2);
            }
        }
        sum
    }

    /// Misfit by the middles of cells alone, for a first look.
    fn rough(&self, field: &Field, pose: &[f64; 3]) -> f64 {
        let known = self.middles.iter().zip(&self.recorded);
        known
            .filter(|(_, recorded)| !recorded.is_nan())
            .map(|(middle, recorded)| (recorded - field.at(self.moved(*middle, pose))).powi(2))
            .sum()
    }
}

/// Areas of the cells that touched by their shares; those of which nothing is known count for nothing.
pub fn areas(of_cells: &[f64], recorded: &[f64], simulated: &[f64]) -> Areas {
    let mut sum = Areas::default();
    for (k, area) in of_cells.iter().enumerate() {
        if !recorded[k].is_nan() {
            let touches = [recorded[k], simulated[k]].map(|share| share >= TOUCHED_FROM);
            sum.add(*area, touches);
        }
    }
    sum
}

/// The best pose within [`MOST`] standard deviations (mm, rad) of where the paper is said to lie.
pub fn best(cells: &Cells, field: &Field, sd: (f64, f64)) -> Fitted {
    let field = &field.smeared();
    let sd = [sd.0, sd.0, sd.1];
    let steps = [cells.pitch[0], cells.pitch[1], cells.pitch[0] / cells.reach];
    let free = |pose: &[f64; 3]| cells.misfit(field, pose);
    let mut starts = starts(&|pose| cells.rough(field, pose), sd);
    starts.truncate(FOLLOWED);
    let found = starts
        .iter()
        .map(|start| search(&free, *start, (steps, sd)))
        .min_by(|a, b| a.1.total_cmp(&b.1));
    let pose = found.map_or([0.0; 3], |found| found.0);
    let (_, variance) = information(cells, field, (&pose, &steps));
    let held = |pose: &[f64; 3]| {
        let prior = pose.iter().zip(&sd).map(|(x, sd)| (x / sd).powi(2));
        cells.misfit(field, pose) / variance + prior.sum::<f64>()
    };
    let (pose, _) = search(&held, pose, (steps, sd));
    let (information, variance) = information(cells, field, (&pose, &steps));
    let prior = Matrix3::from_diagonal(&Vector3::from(sd.map(|sd| sd.powi(-2))));
    let spread = (information / variance + prior).try_inverse();
    let part = |k: usize| {
        let own = spread.map_or(sd[k], |spread| spread[(k, k)].max(0.0).sqrt());
        PosePart {
            value: pose[k],
            low: pose[k] - NINETY * own,
            high: pose[k] + NINETY * own,
        }
    };
    Fitted {
        parts: [0, 1, 2].map(part),
    }
}

/// Poses over the whole range, the best first.
fn starts(misfit: &dyn Fn(&[f64; 3]) -> f64, sd: [f64; 3]) -> Vec<[f64; 3]> {
    let place = |number: i32, sd: f64| STARTED * MOST * sd * f64::from(number) / f64::from(STARTS);
    let numbers = || -STARTS..=STARTS;
    let mut all = Vec::new();
    for i in numbers() {
        for j in numbers() {
            for k in numbers() {
                let pose = [place(i, sd[0]), place(j, sd[1]), place(k, sd[2])];
                all.push((misfit(&pose), pose));
            }
        }
    }
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    all.into_iter().map(|(_, pose)| pose).collect()
}

/// Pattern search (Hooke & Jeeves 1961): steps along each number, halved where none helps.
fn search(
    misfit: &dyn Fn(&[f64; 3]) -> f64,
    start: [f64; 3],
    (steps, sd): ([f64; 3], [f64; 3]),
) -> ([f64; 3], f64) {
    let (mut pose, mut least, mut size) = (start, misfit(&start), 2.0);
    while size > FINEST {
        let mut has_moved = false;
        for k in 0..3 {
            for sign in [1.0, -1.0] {
                let mut next = pose;
                next[k] = (pose[k] + sign * size * steps[k]).clamp(-MOST * sd[k], MOST * sd[k]);
                let value = misfit(&next);
                if value < least {
                    (pose, least, has_moved) = (next, value, true);
                    break;
                }
            }
        }
        if !has_moved {
            size *= 0.5;
        }
    }
    (pose, least)
}

/// Products of the derivatives of all shares by the pose, and the variance of a share as if all were independent.
///
/// Misfits hang together along an edge and are summed by sectors first (cluster-robust, Liang & Zeger 1986): what they sum to against what independent ones
/// would is the factor on their variance.
fn information(
    cells: &Cells,
    field: &Field,
    (pose, steps): (&[f64; 3], &[f64; 3]),
) -> (Matrix3<f64>, f64) {
    let side = |k: usize, sign: f64| {
        let mut moved = *pose;
        moved[k] += 0.5 * sign * steps[k];
        cells.shares(field, &moved)
    };
    let slopes = [0, 1, 2].map(|k| (side(k, 1.0), side(k, -1.0)));
    let simulated = cells.shares(field, pose);
    let (mut all, mut sums) = (Matrix3::zeros(), [Vector3::zeros(); SECTORS]);
    for (k, share) in simulated
        .iter()
        .enumerate()
        .filter(|(_, share)| !share.is_nan())
    {
        let slope = |axis: usize| (slopes[axis].0[k] - slopes[axis].1[k]) / steps[axis];
        let slope = Vector3::new(slope(0), slope(1), slope(2));
        all += slope * slope.transpose();
        let from = [0, 1].map(|axis| cells.middles[k][axis] - cells.center[axis]);
        let turn = libm::atan2(from[1], from[0]) / std::f64::consts::TAU + 0.5;
        let sector = ((turn * SECTORS as f64) as usize).min(SECTORS - 1);
        sums[sector] += slope * (cells.recorded[k] - share);
    }
    let squares: Matrix3<f64> = sums.iter().map(|sum| sum * sum.transpose()).sum();
    let told: Vec<f64> = (0..3)
        .filter(|k| all[(*k, *k)] > 0.0)
        .map(|k| squares[(k, k)] / all[(k, k)])
        .collect();
    let few = SECTORS as f64 / (SECTORS - 3) as f64;
    let variance = few * told.iter().sum::<f64>() / told.len().max(1) as f64;
    (all, variance.max(LEAST_VARIANCE))
}
