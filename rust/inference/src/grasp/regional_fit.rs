//! Scale and posture of every region from the mean map of a hold, with where the hand lies along the mat.
//!
//! Scale (tissue, form of the model, gain) raises a region's pressures alike; posture moves the edge of its contact.

use nalgebra::{DMatrix, DVector};
use thenar_contact::instrument::Placement;

use crate::grasp::hold::Hold;
use crate::grasp::product_maps::RegionForces;

/// Regions that bear less than this share of the load of all are left out.
const LEAST_SHARE: f64 = 0.01;
/// Error of the model's pattern, as a share of a cell's pressure: the layer against solids (README, area and pressure of pads).
const PATTERN: f64 = 0.25;
/// Standard deviation of a cell's reading in the mean map, kPa: mats resolve 1 to 2 kPa.
const CELL_KPA: f64 = 2.0;
/// Prior of a region's posture, mm: a posture is known from photographs or a motion capture to about half a millimeter.
const POSTURE_MM: f64 = 0.6;
/// Prior of the logarithm of a region's scale.
const SCALE: f64 = 0.6;
/// Prior of the hand's place along the mat, mm.
const PLACE_MM: f64 = 1.5;
/// Half step of finite differences: of posture and of place, mm.
const STEP_MM: f64 = 0.15;
const ROUNDS: usize = 14;
/// Largest size of the logarithm of a scale.
const MOST_SCALE: f64 = 1.6;
/// A value this near to its bound is at it.
const AT_BOUND: f64 = 1e-6;

/// What explains the mean map of a hold.
#[derive(Debug, Clone)]
pub struct RegionalFit {
    /// Regions that bear load, by number.
    pub active: Vec<usize>,
    /// Logarithm of the scale of each of them.
    pub log_scale: Vec<f64>,
    /// Shift toward the product of each, mm.
    pub shift_mm: Vec<f64>,
    /// Standard deviation of each scale's logarithm, given the model.
    pub deviation: Vec<f64>,
    /// Where the hand lies along the mat.
    pub placement: Placement,
    /// What each region puts on each cell, kPa, with scale and posture.
    pub maps: Vec<Vec<f64>>,
    /// How that changes with its shift, kPa/mm.
    pub by_shift: Vec<Vec<f64>>,
}

impl RegionalFit {
    /// What all regions together put on each cell, kPa.
    pub fn sum(&self) -> Vec<f64> {
        let cells = self.maps.first().map_or(0, Vec::len);
        (0..cells)
            .map(|c| self.maps.iter().map(|m| m[c]).sum())
            .collect()
    }

    /// What of an active region's fit ended at a bound, and is known no better than that it lies there or beyond.
    pub fn at_bound(&self, k: usize, (low, high): (f64, f64)) -> Option<Bound> {
        let (shift, scale) = (self.shift_mm[k], self.log_scale[k]);
        if shift <= low + AT_BOUND || shift >= high - AT_BOUND {
            return Some(Bound::Shift(shift));
        }
        (scale.abs() >= MOST_SCALE - AT_BOUND).then(|| Bound::Scale(scale.exp()))
    }
}

/// A fitted value at the end of its range.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Bound {
    /// Shift toward the product, mm: the tables end there.
    Shift(f64),
    /// Pressure over the model's.
    Scale(f64),
}

/// What is known of the cells.
#[derive(Debug, Clone)]
pub struct Cells {
    /// False for a cell that shows nothing.
    pub is_live: Vec<bool>,
    /// Readings up to this are nothing, kPa.
    pub floor_kpa: f64,
    /// Readings from here on are clipped, kPa.
    pub ceiling_kpa: f64,
    /// Reading over what is there.
    pub gain: Vec<f64>,
}

/// Fits the mean map of a hold.
pub fn fit(hold: &Hold, forces: &RegionForces, cells: &Cells) -> RegionalFit {
    let bears = |r: usize| forces.force_n(r, forces.middle_mm[r], None);
    let whole: f64 = (0..forces.len()).map(bears).sum();
    let active: Vec<usize> = (0..forces.len())
        .filter(|&r| bears(r) > LEAST_SHARE * whole)
        .collect();
    let mean = hold.mean();
    let mut state = State {
        log_scale: vec![0.0; active.len()],
        shift_mm: active.iter().map(|&r| forces.middle_mm[r]).collect(),
        place_mm: [0.0; 2],
    };
    let problem = Problem {
        hold,
        forces,
        cells,
        active: &active,
        mean: &mean,
    };
    let mut deviation = vec![SCALE; active.len()];
    for _ in 0..ROUNDS {
        deviation = problem.step(&mut state);
    }
    let placement = state.placement();
    let unscaled = problem.maps(&state, &placement);
    let scaled = |maps: Vec<Vec<f64>>| -> Vec<Vec<f64>> {
        let each = maps.into_iter().zip(&state.log_scale);
        each.map(|(map, s)| map.into_iter().map(|p| p * s.exp()).collect())
            .collect()
    };
    RegionalFit {
        maps: scaled(unscaled),
        by_shift: scaled(problem.by_shift(&state, &placement)),
        active,
        log_scale: state.log_scale,
        shift_mm: state.shift_mm,
        deviation,
        placement,
    }
}

#[derive(Debug, Clone)]
struct State {
    log_scale: Vec<f64>,
    shift_mm: Vec<f64>,
    place_mm: [f64; 2],
}

impl State {
    fn placement(&self) -> Placement {
        Placement {
            shift_mm: self.place_mm,
            turn_rad: 0.0,
        }
    }
}

struct Problem<'a> {
    hold: &'a Hold,
    forces: &'a RegionForces,
    cells: &'a Cells,
    active: &'a [usize],
    mean: &'a [f64],
}

impl Problem<'_> {
    fn maps(&self, state: &State, placement: &Placement) -> Vec<Vec<f64>> {
        let each = self.active.iter().zip(&state.shift_mm);
        each.map(|(&r, &shift)| self.forces.read(r, shift, (&self.hold.mat, placement)))
            .collect()
    }

    fn by_shift(&self, state: &State, placement: &Placement) -> Vec<Vec<f64>> {
        let moved = |step: f64| {
            let mut other = state.clone();
            other.shift_mm.iter_mut().for_each(|s| *s += step);
            self.maps(&other, placement)
        };
        difference(&moved(STEP_MM), &moved(-STEP_MM), 2.0 * STEP_MM)
    }

    /// One Gauss-Newton step; returns the standard deviation of every scale.
    fn step(&self, state: &mut State) -> Vec<f64> {
        let (regions, cells) = (self.active.len(), self.mean.len());
        let at = state.placement();
        let (maps, by_shift) = (self.maps(state, &at), self.by_shift(state, &at));
        let summed = |placement: &Placement| {
            let maps = self.maps(state, placement);
            weighted(&maps, &state.log_scale)
        };
        let by_place = [0, 1].map(|axis| {
            let moved = |step: f64| {
                let mut shift_mm = state.place_mm;
                shift_mm[axis] += step;
                summed(&Placement {
                    shift_mm,
                    turn_rad: 0.0,
                })
            };
            let (ahead, behind) = (moved(1.0), moved(-1.0));
            let each = ahead.iter().zip(&behind);
            each.map(|(a, b)| 0.5 * (a - b)).collect::<Vec<f64>>()
        });
        let model = weighted(&maps, &state.log_scale);
        let count = 2 * regions + 2;
        let mut normal = DMatrix::<f64>::zeros(count, count);
        let mut pull = DVector::<f64>::zeros(count);
        for cell in 0..cells {
            let Some((residual, weight)) = self.residual(cell, model[cell]) else {
                continue;
            };
            let mut row = vec![0.0; count];
            for r in 0..regions {
                let scale = state.log_scale[r].exp() * self.cells.gain[cell];
                row[r] = scale * maps[r][cell];
                row[regions + r] = scale * by_shift[r][cell];
            }
            row[2 * regions] = by_place[0][cell] * self.cells.gain[cell];
            row[2 * regions + 1] = by_place[1][cell] * self.cells.gain[cell];
            let used: Vec<usize> = (0..count).filter(|k| row[*k] != 0.0).collect();
            for &i in &used {
                pull[i] += weight * row[i] * residual;
                for &j in &used {
                    normal[(i, j)] += weight * row[i] * row[j];
                }
            }
        }
        let mut prior = |k: usize, value: f64, deviation: f64| {
            normal[(k, k)] += deviation.powi(-2);
            pull[k] -= value / (deviation * deviation);
        };
        for r in 0..regions {
            prior(r, state.log_scale[r], SCALE);
            prior(regions + r, state.shift_mm[r], POSTURE_MM);
        }
        prior(2 * regions, state.place_mm[0], PLACE_MM);
        prior(2 * regions + 1, state.place_mm[1], PLACE_MM);
        let Some(factor) = normal.cholesky() else {
            return vec![SCALE; regions];
        };
        let step = factor.solve(&pull);
        for r in 0..regions {
            state.log_scale[r] =
                (state.log_scale[r] + step[r].clamp(-0.4, 0.4)).clamp(-MOST_SCALE, MOST_SCALE);
            let (low, high) = self.forces.range(self.active[r]);
            let shift = state.shift_mm[r] + step[regions + r].clamp(-0.3, 0.3);
            state.shift_mm[r] = shift.clamp(low, high);
        }
        for axis in 0..2 {
            state.place_mm[axis] += step[2 * regions + axis].clamp(-1.0, 1.0);
        }
        let inverse = factor.inverse();
        (0..regions).map(|r| inverse[(r, r)].sqrt()).collect()
    }

    /// Residual of a cell and its weight; None where the instrument hides it.
    fn residual(&self, cell: usize, model: f64) -> Option<(f64, f64)> {
        let read = self.mean[cell];
        if !self.cells.is_live[cell] || read.is_nan() {
            return None;
        }
        let seen = model * self.cells.gain[cell];
        let is_hidden = (read <= self.cells.floor_kpa && seen <= self.cells.floor_kpa)
            || (read >= 0.98 * self.cells.ceiling_kpa && seen >= read);
        if is_hidden {
            return None;
        }
        let deviation = CELL_KPA.hypot(PATTERN * read.max(0.5 * seen));
        Some((read - seen, deviation.powi(-2)))
    }
}

fn weighted(maps: &[Vec<f64>], log_scale: &[f64]) -> Vec<f64> {
    let cells = maps.first().map_or(0, Vec::len);
    let at = |c: usize| {
        maps.iter()
            .zip(log_scale)
            .map(|(m, s)| s.exp() * m[c])
            .sum()
    };
    (0..cells).map(at).collect()
}

fn difference(ahead: &[Vec<f64>], behind: &[Vec<f64>], step: f64) -> Vec<Vec<f64>> {
    let of =
        |(a, b): (&Vec<f64>, &Vec<f64>)| a.iter().zip(b).map(|(a, b)| (a - b) / step).collect();
    ahead.iter().zip(behind).map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_at_the_end_of_their_range_are_known_as_such() {
        let of = |shift: f64, log_scale: f64| {
            let fit = RegionalFit {
                active: vec![3],
                log_scale: vec![log_scale],
                shift_mm: vec![shift],
                deviation: vec![0.1],
                placement: Placement::default(),
                maps: Vec::new(),
                by_shift: Vec::new(),
            };
            fit.at_bound(0, (-0.6, 1.4))
        };
        assert_eq!(of(0.3, 0.1), None);
        assert_eq!(of(1.4, 0.1), Some(Bound::Shift(1.4)));
        assert_eq!(of(-0.6, 0.1), Some(Bound::Shift(-0.6)));
        assert_eq!(of(0.3, -1.6), Some(Bound::Scale((-1.6_f64).exp())));
    }
}
