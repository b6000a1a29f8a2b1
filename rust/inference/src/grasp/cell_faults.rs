//! Faults of single cells and of parts of a mat: a ceiling, a floor, cells that show nothing, a part with another gain.

use std::collections::BTreeMap;

use crate::grasp::hold::Hold;
use crate::grasp::regional_fit::{Cells, RegionalFit};

/// Cells at one value that make a ceiling, and the share of frames in which each must stand there.
const AT_CEILING: (usize, f64) = (3, 0.05);
/// A smallest reading is a floor from this many kPa, and from this many steps of the readings.
const FLOOR: (f64, f64) = (1.8, 2.9);
/// Cells that must read between one and two floors.
const NEAR_FLOOR: usize = 8;
/// kPa that the neighbors of a dead cell read, and that the model puts on it.
const AROUND_DEAD: (f64, f64) = (12.0, 8.0);
/// The same in floors of the readings, where those have one.
const ABOVE_FLOOR: f64 = 3.0;
/// Cells that read less than this in every frame show nothing, kPa.
const NOTHING_KPA: f64 = 0.5;
/// Cells of a row or column that make a dead line.
const DEAD_LINE: usize = 3;
/// Cells that are compared for the gain of a part read, and are simulated, with more than this, kPa.
const COMPARED_KPA: f64 = 8.0;
/// Cells that a part and what is next to it must have.
const LEAST_CELLS: usize = 8;
/// Logarithm of a part's gain from which it is a fault, and its size in standard deviations.
const PART: (f64, f64) = (0.2, 6.0);

/// Limits that the readings show.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Limits {
    /// Value at which several cells stop, kPa.
    pub ceiling_kpa: Option<f64>,
    /// Smallest reading that is passed on, kPa.
    pub floor_kpa: Option<f64>,
}

/// Cells in a band of rows or columns that read by another factor than the rest.
#[derive(Debug, Clone, PartialEq)]
pub struct PartGain {
    /// True for columns.
    pub is_columns: bool,
    /// First and last row or column of the band, as the file numbers them.
    pub band: (u32, u32),
    /// Reading over what is there.
    pub gain: f64,
    /// Ends of its 90 % interval.
    pub interval: (f64, f64),
    /// Cells by recording, true in the band.
    pub is_in: Vec<bool>,
}

/// Ceiling and floor of the readings of all holds.
pub fn limits(holds: &[Hold]) -> Limits {
    let largest = |hold: &Hold| hold.extremes.iter().map(|e| e[0]).fold(0.0, f64::max);
    let top = holds.iter().map(largest).fold(0.0, f64::max);
    let stands = |hold: &Hold| {
        let each = hold.extremes.iter().zip(&hold.at_largest);
        each.filter(|(e, share)| e[0] >= top * (1.0 - 1e-9) && **share >= AT_CEILING.1)
            .count()
    };
    let ceiling = holds.iter().map(stands).max().unwrap_or(0) >= AT_CEILING.0;
    let positive: Vec<f64> = holds
        .iter()
        .flat_map(|hold| hold.extremes.iter().map(|e| e[1]))
        .filter(|e| e.is_finite())
        .collect();
    let least = positive.iter().copied().fold(f64::INFINITY, f64::min);
    let near = positive.iter().filter(|p| **p < 2.0 * least).count();
    let step = step(holds);
    let is_floor = least >= FLOOR.0 && least >= FLOOR.1 * step && near >= NEAR_FLOOR;
    Limits {
        ceiling_kpa: ceiling.then_some(top),
        floor_kpa: (is_floor && least.is_finite()).then_some(least),
    }
}

/// Step of the readings, kPa: the smallest difference of two largest readings; 0 where they are not rounded.
fn step(holds: &[Hold]) -> f64 {
    let mut values: Vec<f64> = holds
        .iter()
        .flat_map(|hold| hold.extremes.iter().map(|e| e[0]))
        .filter(|v| *v > 0.0)
        .collect();
    values.sort_unstable_by(f64::total_cmp);
    let apart = values.windows(2).map(|w| w[1] - w[0]).filter(|d| *d > 1e-6);
    let least = apart.fold(f64::INFINITY, f64::min);
    if least.is_finite() { least } else { 0.0 }
}

/// Cells that show nothing in any hold though cells around them and the model are under load: by recording's mat.
pub fn dead(holds: &[Hold], fits: &[RegionalFit], floor_kpa: f64) -> Vec<bool> {
    let Some(first) = holds.first() else {
        return Vec::new();
    };
    let cells = first.kept.len();
    let is_same = holds.iter().all(|hold| hold.kept == first.kept);
    if !is_same {
        return vec![false; cells];
    }
    let largest = |cell: usize| {
        holds
            .iter()
            .map(|h| h.extremes[cell][0])
            .fold(0.0, f64::max)
    };
    let hidden = ABOVE_FLOOR * floor_kpa;
    let least = (AROUND_DEAD.0.max(hidden), AROUND_DEAD.1.max(hidden));
    let means: Vec<Vec<f64>> = holds.iter().map(Hold::mean).collect();
    let sums: Vec<Vec<f64>> = fits.iter().map(RegionalFit::sum).collect();
    let over = |maps: &[Vec<f64>], cell: usize| maps.iter().map(|m| m[cell]).fold(0.0, f64::max);
    let (mut is_dead, mut is_suspect) = (vec![false; cells], vec![false; cells]);
    for cell in 0..cells {
        if largest(cell) > NOTHING_KPA || means[0][cell].is_nan() {
            continue;
        }
        let loaded: Vec<usize> = first
            .mat
            .neighbors(cell)
            .filter(|&n| over(&means, n) > least.0)
            .collect();
        let is_under = over(&sums, cell) > least.1;
        is_dead[cell] = loaded.len() >= 3 && is_under;
        is_suspect[cell] = is_dead[cell] || (loaded.len() >= 2 && is_under);
    }
    for line in 0..2 {
        let mut by_line: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
        for cell in (0..cells).filter(|c| is_suspect[*c]) {
            if let Some(place) = first.places[cell] {
                by_line.entry(place[line]).or_default().push(cell);
            }
        }
        for (number, suspects) in by_line {
            let own = (0..cells).filter(|c| first.places[*c].is_some_and(|p| p[line] == number));
            let own: Vec<usize> = own.collect();
            if suspects.len() >= DEAD_LINE && own.iter().all(|c| largest(*c) <= NOTHING_KPA) {
                own.iter().for_each(|c| is_dead[*c] = true);
            }
        }
    }
    is_dead
}

/// A band of rows or columns whose cells read by another factor than the same regions' cells outside of it.
pub fn part_gain(holds: &[Hold], fits: &[RegionalFit], cells: &Cells) -> Option<PartGain> {
    let first = holds.first()?;
    if holds.iter().any(|hold| hold.kept != first.kept) {
        return None;
    }
    let ratios = ratios(holds, fits, cells);
    let compared: Vec<usize> = (0..ratios.len()).filter(|c| ratios[*c].is_some()).collect();
    let mut best: Option<(f64, PartGain)> = None;
    for line in 0..2 {
        let mut numbers: Vec<u32> = first.places.iter().flatten().map(|p| p[line]).collect();
        numbers.sort_unstable();
        numbers.dedup();
        // A band that begins or ends with lines without compared cells is the same as one that was tried.
        let has_compared = |number: u32| {
            compared
                .iter()
                .any(|c| first.places[*c].is_some_and(|p| p[line] == number))
        };
        let bears: Vec<bool> = numbers.iter().map(|n| has_compared(*n)).collect();
        for (i, &from) in numbers.iter().enumerate() {
            if i > 0 && !bears[i - 1] {
                continue;
            }
            for (j, &to) in numbers.iter().enumerate().skip(i + 1) {
                if j > i + 1 && !bears[j] {
                    continue;
                }
                let is_within =
                    |p: &Option<[u32; 2]>| p.is_some_and(|p| (from..=to).contains(&p[line]));
                let parted = compared
                    .iter()
                    .filter_map(|c| ratios[*c].map(|ratio| (ratio, is_within(&first.places[*c]))));
                let Some((size, deviation)) = step_of(parted) else {
                    continue;
                };
                let strength = (size / deviation).abs();
                let is_fault = size.abs() > PART.0 && strength > PART.1;
                if is_fault && best.as_ref().is_none_or(|(most, _)| strength > *most) {
                    let ends = (
                        (size - 1.645 * deviation).exp(),
                        (size + 1.645 * deviation).exp(),
                    );
                    let found = PartGain {
                        is_columns: line == 1,
                        band: (from, to),
                        gain: size.exp(),
                        interval: ends,
                        is_in: first.places.iter().map(is_within).collect(),
                    };
                    best = Some((strength, found));
                }
            }
        }
    }
    best.map(|(_, found)| found)
}

/// Logarithm of reading over model of every cell that bears load, with the region that bears most of it.
fn ratios(holds: &[Hold], fits: &[RegionalFit], cells: &Cells) -> Vec<Option<(usize, f64)>> {
    let means: Vec<Vec<f64>> = holds.iter().map(Hold::mean).collect();
    let sums: Vec<Vec<f64>> = fits.iter().map(RegionalFit::sum).collect();
    let of = |cell: usize| {
        let read: f64 = means.iter().map(|m| m[cell]).sum::<f64>() / means.len() as f64;
        let model: f64 = sums.iter().map(|m| m[cell]).sum::<f64>() / sums.len() as f64;
        let is_compared = cells.is_live[cell]
            && read > COMPARED_KPA
            && model > COMPARED_KPA
            && read < 0.95 * cells.ceiling_kpa;
        let by = |r: usize| fits[0].maps[r][cell];
        let most = (0..fits[0].active.len()).max_by(|a, b| by(*a).total_cmp(&by(*b)))?;
        is_compared.then(|| (most, (read / model).ln()))
    };
    (0..means[0].len()).map(of).collect()
}

/// Mean step of the ratios into a part, over regions with cells on both sides, and its standard deviation.
fn step_of(parted: impl Iterator<Item = ((usize, f64), bool)>) -> Option<(f64, f64)> {
    let mut by_region: BTreeMap<usize, [Vec<f64>; 2]> = BTreeMap::new();
    for ((region, value), is_in) in parted {
        by_region.entry(region).or_default()[usize::from(is_in)].push(value);
    }
    let (mut sum, mut weights, mut inside, mut squares) = (0.0, 0.0, 0, 0.0);
    let mut steps = Vec::new();
    for [out, within] in by_region.values() {
        if out.len() < 2 || within.len() < 2 {
            continue;
        }
        let mean = |of: &[f64]| of.iter().sum::<f64>() / of.len() as f64;
        let (a, b) = (mean(out), mean(within));
        let weight = 1.0 / (1.0 / out.len() as f64 + 1.0 / within.len() as f64);
        sum += weight * (b - a);
        weights += weight;
        inside += within.len();
        squares += out.iter().map(|v| (v - a).powi(2)).sum::<f64>();
        squares += within.iter().map(|v| (v - b).powi(2)).sum::<f64>();
        steps.push((b - a, out.len() + within.len()));
    }
    let outside: usize = steps.iter().map(|s| s.1).sum::<usize>() - inside;
    if steps.len() < 2 || inside < LEAST_CELLS || outside < LEAST_CELLS {
        return None;
    }
    let step = sum / weights;
    let freedom = (inside + outside - 2 * steps.len()) as f64;
    // Neighboring cells share the error of the model's pattern: they count as half as many.
    let variance = 2.0 * squares / freedom / weights;
    // Regions that disagree on the step are no part of the mat.
    let agree = steps
        .iter()
        .filter(|s| s.0.signum() == step.signum())
        .count();
    (10 * agree >= 8 * steps.len()).then(|| (step, variance.sqrt()))
}
