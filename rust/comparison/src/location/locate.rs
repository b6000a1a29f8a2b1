//! Conducts the location of a mismatch: scan statistics on the projected residual.
//!
//! A look is a disc on the sensor or the skin over a stretch of the protocols, or a stretch alone; its statistic is the mean of
//! the projected residual `r = P L^-1 (measured - simulated)` along the whitened direction `w` in which one unit more on each
//! of its samples would show, `w . r / |P w|`. The price of many looks is paid exactly: noise is drawn as `P n`, all looks are
//! taken at it, and the largest is kept (Kulldorff 1997, Commun. Stat. 26:1481, with a Gaussian model and nuisances taken
//! out). Where the residual is larger everywhere than its noise, the statistic is divided by that: then only what stands out
//! from the rest is a place. What the simulation itself may be off by is allowed for (`model_error.rs`).

use std::collections::BTreeSet;

use thenar_contact::Control;
use thenar_surface::Mesh;

use crate::location::mismatch::{Location, Mismatch, Shown, When};
use crate::location::place_estimate::Scored;
use crate::location::protocol_cells::Cells;
use crate::location::residual_sums::{CellSums, Channel};
use crate::location::scan_statistic::Scan;
use crate::location::scan_windows::{ScanWindow, ScanWindows};
use thenar_inference::errors::InferenceError;
use thenar_inference::fit::result::Fit;

/// What a simulated sensel or force may be off by under smooth factors, of the largest. Against finite elements single sensels are off by
/// up to 0.04 on a fine mesh, and by as much again where a mesh of 1.2 mm meets sensels of 2.5 mm. Set on 36 studies of six
/// pads without a spot at 1 % noise (`tests/trial/scoring/locate.py`, other seeds): places were named in 17 with 0.02, in 5 with 0.05, in none
/// of the 34 that were read with 0.08; of 24 with a spot 21, 20 and 18 were found, and 15 with 0.13.
pub(crate) const MODEL_ERROR: f64 = 0.08;

/// Part of the tissue's thickness to which that holds; it was measured to 0.15.
const MEASURED_STRAIN: f64 = 0.2;
/// By how much it grows with the depth beyond, per part of the thickness: pressures over 24 mm2 are then off by 5 % rms to half of the
/// thickness (`tests/proof/deep_pads`), where within that part it is 1.5 to 3 %, and single sensels with them.
const ERROR_GROWTH: f64 = 0.35;

/// What a simulated sensel may be off by where maps were taken to `strain`, a part of the tissue's thickness.
pub(crate) fn model_error(strain: f64) -> f64 {
    MODEL_ERROR + ERROR_GROWTH * (strain - MEASURED_STRAIN).clamp(0.0, 1.0)
}

/// Part of the largest simulated pressure from which a sensel counts as pressed.
const PRESSED: f64 = 0.02;

/// How a mismatch is looked for.
#[derive(Debug, Clone, Copy)]
pub struct Search<'a> {
    /// The undeformed skin, to say where on it a place lies.
    pub skin: Option<&'a Mesh>,
    /// Sets of noise that are drawn for the law of the maximum.
    pub draws: usize,
    /// Where their stream begins: the same seed, the same bits.
    pub seed: u64,
    /// Probability of naming anything where nothing is amiss, for the whole study.
    pub level: f64,
    /// Most mismatches that are told.
    pub most: usize,
    /// What the simulation may be off by, of the largest value, where nothing is missing; smooth factors come free with it.
    /// None: the simulation is taken as exact.
    pub model_error: Option<f64>,
}

impl Default for Search<'_> {
    fn default() -> Self {
        Search {
            skin: None,
            draws: 999,
            seed: 1,
            level: 0.01,
            most: 5,
            model_error: Some(MODEL_ERROR),
        }
    }
}

/// Finds the places and times whose mismatch neither parameters nor noise explain, paying for every look.
///
/// `fit` as [`Fit`] describes it. Returns the mismatches whose probability over all looks is at most `search.level`.
///
/// # Errors
/// [`InferenceError::Cancelled`].
pub fn locate(
    fit: &Fit,
    search: &Search<'_>,
    control: &Control,
) -> Result<Location, InferenceError> {
    let step = |share| {
        control
            .step("locating", share)
            .map_err(|_| InferenceError::Cancelled)
    };
    step(0.0)?;
    let cells = crate::location::protocol_cells::cut(&fit.measured);
    let cell_sums = crate::location::residual_sums::sum_up(fit, &cells);
    let windows = crate::location::scan_windows::plan(&fit.measured, &cells, &cell_sums);
    let data = (fit.measured.as_slice(), &cells);
    let allowance = crate::location::model_error::allow(
        data,
        (&cell_sums, &windows.sensors),
        search.model_error,
    );
    let scan = Scan::new((&cell_sums, &allowance), &windows);
    step(0.1)?;
    let maxima = scan.null_maxima(search.draws, search.seed);
    step(0.9)?;
    let told = Telling {
        fit,
        search,
        cells: &cells,
        cell_sums: &cell_sums,
        windows: &windows,
        scan: &scan,
        maxima: &maxima,
    };
    let location = told.all();
    step(1.0)?;
    Ok(location)
}

struct Telling<'a> {
    fit: &'a Fit,
    search: &'a Search<'a>,
    cells: &'a Cells,
    cell_sums: &'a CellSums,
    windows: &'a ScanWindows,
    scan: &'a Scan<'a>,
    maxima: &'a [f64],
}

/// A look that stands out.
struct Strongest {
    window: usize,
    /// How much larger than noise all else of its kind is, curves or maps.
    scale: f64,
    /// Its statistic over that.
    score: f64,
}

impl Telling<'_> {
    /// Takes the strongest look, takes it out, and looks again at what shares no sample with it.
    fn all(&self) -> Location {
        let mut values = self.scan.observed();
        let mut taken: BTreeSet<u32> = BTreeSet::new();
        let mut mismatches: Vec<Mismatch> = Vec::new();
        let mut first = None;
        while mismatches.len() < self.search.most.max(1) {
            let scores = self.scan.scores(&values);
            let Some(best) = self.strongest((&values, &scores), &taken) else {
                break;
            };
            let p = self.p(best.score.abs());
            first = first.or(Some(p));
            if p > self.search.level {
                break;
            }
            mismatches.push(self.tell(&best, &scores, p));
            taken.extend(self.scan.atoms_of(&self.windows.list[best.window]));
            values = self.scan.without(&values, best.window);
        }
        let windows = self.scan.count();
        Location {
            sentence: summary(&mismatches, (first, windows), self.search),
            mismatches,
            p: first,
            look_elsewhere_count: windows,
            notes: self.notes(&values),
        }
    }

    /// The strongest look of curves or of maps, each measured by what it leaves of its own kind.
    fn strongest(
        &self,
        (values, scores): (&[f64], &[f64]),
        taken: &BTreeSet<u32>,
    ) -> Option<Strongest> {
        let free = |window: &ScanWindow| {
            let rows = window
                .rows
                .iter()
                .map(|row| &self.windows.rows[*row as usize]);
            taken.is_empty() || !rows.flatten().any(|cell_sum| taken.contains(cell_sum))
        };
        let of_kind = |is_map: bool| {
            let window = (0..scores.len())
                .filter(|at| {
                    scores[*at] != 0.0 && self.is_of_map(&self.windows.list[*at]) == is_map
                })
                .filter(|at| free(&self.windows.list[*at]))
                .max_by(|one, two| scores[*one].abs().total_cmp(&scores[*two].abs()))?;
            let scale = self.excess(&self.scan.without(values, window), is_map);
            Some(Strongest {
                window,
                scale,
                score: scores[window] / scale,
            })
        };
        let both = [false, true].into_iter().filter_map(of_kind);
        both.max_by(|one, two| one.score.abs().total_cmp(&two.score.abs()))
    }

    fn is_of_map(&self, window: &ScanWindow) -> bool {
        let cell_sum = self.windows.rows[window.rows[0] as usize][0];
        self.cell_sums.list[cell_sum as usize].channel.is_of_map()
    }

    /// How much larger than noise and the simulation's own error values of maps, or of all else, are as a whole.
    fn excess(&self, values: &[f64], is_map: bool) -> f64 {
        let is_used = |at: usize| {
            let cell_sum = &self.cell_sums.list[at];
            let is_pressed = cell_sum.simulated > PRESSED * cell_sum.peak;
            cell_sum.channel.is_of_map() == is_map && (is_pressed || !is_map)
        };
        self.scan.excess(values, &is_used)
    }

    /// Share of the draws, the recordings counted as one of them, whose largest look is as large.
    fn p(&self, score: f64) -> f64 {
        let larger = self.maxima.iter().filter(|most| **most >= score).count();
        (larger + 1) as f64 / (self.maxima.len() + 1) as f64
    }

    fn tell(&self, strongest: &Strongest, scores: &[f64], p: f64) -> Mismatch {
        let (best, scale) = (strongest.window, strongest.scale);
        let cell_sums = self.scan.atoms_of(&self.windows.list[best]);
        let scores: Vec<f64> = scores.iter().map(|score| score / scale).collect();
        let (size, spread) = self.size(strongest);
        let half = 1.645 * spread;
        let scored = Scored {
            scan: self.scan,
            windows: self.windows,
            scores: &scores,
        };
        let mut found = Mismatch {
            shown: self.shown(cell_sums[0] as usize),
            place: crate::location::place_estimate::place(
                scored,
                best,
                (&self.fit.measured, self.search.skin),
            ),
            when: self.when(&cell_sums),
            size,
            low: size - half,
            high: size + half,
            score: strongest.score,
            p,
            kept: self.scan.shares[best],
            sentence: String::new(),
        };
        found.sentence = crate::location::sentence::of_mismatch(&found);
        found
    }

    /// Size of a look with its standard deviation. The noise of a curve remembers, so that its whitened residual is no mean of the
    /// residual itself: there the plain mean is told, as sure as its statistic is.
    fn size(&self, strongest: &Strongest) -> (f64, f64) {
        let spread = strongest.scale * self.scan.error(strongest.window);
        let window = &self.windows.list[strongest.window];
        let (mut sum, mut whole) = (0.0, 0.0);
        for at in self.scan.atoms_of(window) {
            let cell_sum = &self.cell_sums.list[at as usize];
            let weight = cell_sum.weight * cell_sum.weight;
            (sum, whole) = (sum + weight * cell_sum.residual, whole + weight);
        }
        let mean = sum / whole;
        if self.is_of_map(window) || mean * strongest.score <= 0.0 {
            (strongest.score * spread, spread)
        } else {
            (mean, mean / strongest.score)
        }
    }

    fn shown(&self, cell_sum: usize) -> Shown {
        let cell_sum = &self.cell_sums.list[cell_sum];
        let recording = self.cells.list[cell_sum.cell].recording;
        match cell_sum.channel {
            Channel::Force => Shown::Force,
            Channel::TangentialForce => Shown::TangentialForce,
            Channel::Area => Shown::Area,
            Channel::Scan => Shown::Scan,
            Channel::Pressure(_) if self.fit.measured[recording].is_calibrated => Shown::Pressure,
            Channel::Pressure(_) => Shown::Counts,
        }
    }

    fn when(&self, cell_sums: &[u32]) -> When {
        let places: BTreeSet<usize> = cell_sums
            .iter()
            .map(|cell_sum| self.cell_sums.list[*cell_sum as usize].cell)
            .collect();
        let cells: Vec<&crate::location::protocol_cells::Cell> =
            places.iter().map(|at| &self.cells.list[*at]).collect();
        let recordings: BTreeSet<usize> = cells.iter().map(|cell| cell.recording).collect();
        let phases: BTreeSet<_> = cells.iter().map(|cell| cell.phase).collect();
        let span = |pairs: Vec<[f64; 2]>| {
            let least = pairs
                .iter()
                .map(|pair| pair[0])
                .fold(f64::INFINITY, f64::min);
            let most = pairs
                .iter()
                .map(|pair| pair[1])
                .fold(f64::NEG_INFINITY, f64::max);
            (least.is_finite() && most.is_finite()).then_some([least, most])
        };
        let cycles = cells.iter().map(|cell| cell.cycle);
        let times = span(cells.iter().map(|cell| cell.time).collect());
        When {
            recordings: recordings
                .iter()
                .map(|at| self.fit.measured[*at].name.clone())
                .collect(),
            phases: phases.into_iter().collect(),
            time_s: times.filter(|_| recordings.len() == 1),
            depth_mm: span(cells.iter().map(|cell| cell.depth).collect()),
            cycles: [cycles.clone().min().unwrap_or(0), cycles.max().unwrap_or(0)],
            rate_mm_s: span(cells.iter().filter_map(|cell| cell.speed).collect()),
        }
    }

    fn notes(&self, values: &[f64]) -> Vec<String> {
        let mut notes = Vec::new();
        if self.cell_sums.hidden > 0 {
            notes.push(format!(
                "{} values that the instrument's limits hide count with their mean, given that they are hidden.",
                self.cell_sums.hidden
            ));
        }
        for (what, is_map) in [("curves", false), ("maps", true)] {
            let factor = self.excess(values, is_map);
            if factor > 1.1 {
                notes.push(format!(
                    "What is left of the {what} is {factor:.1} times what noise and the simulation's own error leave; only what stands \
                     out from that was named."
                ));
            }
        }
        notes
    }
}

fn summary(
    mismatches: &[Mismatch],
    (p, windows): (Option<f64>, usize),
    search: &Search<'_>,
) -> String {
    let allowed = match search.model_error {
        Some(_) => "noise and the simulation's own error would",
        None => "noise would",
    };
    match (mismatches.first(), p) {
        (Some(first), _) => first.sentence.clone(),
        (None, Some(p)) => format!(
            "No place or time carries more than {allowed}: p = {} over {windows} looks.",
            crate::location::sentence::figure(p)
        ),
        (None, None) => "Nothing can be located: no curve or mat has a sample that shows its value and that parameters do not absorb; scans are shown place by place.".to_owned(),
    }
}
