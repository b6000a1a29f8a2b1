//! A mat that reads too much or too little by one factor: what its cells bear together against the load cell, in presses of one protocol.

use thenar_inference::observe::robust_scale::{median, median_deviation};
use thenar_recordings::study::{Data, PlacedSensel, StudyRecording};
use thenar_recordings::{Curve, PressureMap, PressureUnit, Study};

use crate::findings::{Diagnosis, Finding, Number, Verdict};
use crate::track_record::{Confidence, Kind};

/// Uncertainty of the gain of a mat whose data sheet is not stated: combinations of hardware differ by 5 to 32 % (Morin 2000).
const UNSTATED: f64 = 0.1;
/// Uncertainties of the gain beyond which it is a fault, and what sensels and a depth that is off by 20 um add to the logarithm of a sum.
const CLEAR: (f64, f64) = (3.0, 0.06);
/// Part of the largest force from which a frame is used: below, many cells are under the mat's threshold.
const LOADED: f64 = 0.25;
/// Fewest frames, and largest deviation among them as a part of what they show: a gain is one factor at every load.
const FRAMES: usize = 4;
const UNEVEN: f64 = 0.25;
/// Part of a frame's load that the cells of the border bear together, from which the mat may not cover all of it: noise above the threshold
/// puts less there.
const BORDER: f64 = 0.03;
/// Part of a frame's peak from which a cell bears clearly: one that is silent between two such is dead.
const CLEARLY: f64 = 0.1;
/// Readings at one side of a depth from which the force there is taken, and part of the largest depth from which loading has ended.
const NEAR: usize = 2;
const TOP: f64 = 0.98;

/// Logarithm of what the mat reads over what the load cell reads: the middle of the frames, its deviation among them, and their number.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ratio {
    /// Middle of what is nearest to 0 of both ends of a frame.
    pub log: f64,
    /// Middles of what was read, and of that with what cells below the threshold may bear.
    pub ends: [f64; 2],
    /// Standard deviation, from the median one.
    pub spread: f64,
    /// How many frames.
    pub frames: usize,
}

impl Ratio {
    /// Whether it is one factor at every load, beyond a gain's stated uncertainty.
    fn is_fault(self, gain: f64) -> bool {
        self.frames >= FRAMES
            && self.log.abs() > CLEAR.0 * gain + CLEAR.1
            && self.spread < UNEVEN * self.log.abs()
    }
}

/// What the maps of a study show; None where no frame of loading can be held against a load cell.
pub fn ratio(study: &Study) -> Option<Ratio> {
    let threshold = study.instrument.as_ref().and_then(|i| i.threshold_kpa);
    let limit = study.instrument.as_ref().and_then(|i| i.saturation_kpa);
    let mut all = Vec::new();
    for recording in &study.recordings {
        let Data::PressureMap { map, sensels, .. } = &recording.data else {
            continue;
        };
        let curves = of_protocol(study, recording);
        let Some(mat) = Mat::of(map, sensels.as_deref(), threshold.unwrap_or(0.0)) else {
            continue;
        };
        if curves.is_empty() || map.phases.len() != map.frames() {
            continue;
        }
        let Some(depths) = map.channels.iter().find(|c| c.name == "depth_mm") else {
            continue;
        };
        for frame in (0..map.frames()).filter(|&k| map.phases[k] == "load") {
            let values = map.frame(frame);
            let clips = limit.is_some_and(|limit| map.peak(frame) >= limit) || shares_peak(values);
            let forces: Vec<f64> = curves
                .iter()
                .filter_map(|curve| force_at(curve, depths.values[frame]))
                .collect();
            let force = forces.iter().sum::<f64>() / forces.len() as f64;
            if let Some(load) = mat.load_n(values).filter(|_| !clips && force > 0.0) {
                all.push((force, load));
            }
        }
    }
    let most = all
        .iter()
        .fold(0.0, |most, (force, _)| f64::max(most, *force));
    let ends: Vec<[f64; 2]> = all
        .iter()
        .filter(|(force, _)| *force > LOADED * most)
        .map(|(force, load)| load.map(|n| libm::log(n / force)))
        .collect();
    let middle =
        |of: &dyn Fn(&[f64; 2]) -> f64| median(&mut ends.iter().map(of).collect::<Vec<f64>>());
    let log = middle(&|frame| beyond(*frame));
    let mut off: Vec<f64> = ends
        .iter()
        .map(|frame| (beyond(*frame) - log).abs())
        .collect();
    (!ends.is_empty()).then(|| Ratio {
        log,
        ends: [middle(&|frame| frame[0]), middle(&|frame| frame[1])],
        spread: median_deviation(&mut off),
        frames: ends.len(),
    })
}

/// What is nearest to 0 between two ends.
fn beyond([low, high]: [f64; 2]) -> f64 {
    low.max(0.0) + high.min(0.0)
}

/// Curves of a map's protocol, under its tool, at its site.
fn of_protocol<'a>(study: &'a Study, map: &StudyRecording) -> Vec<&'a Curve> {
    let is_own = |r: &&StudyRecording| {
        !map.protocol.is_empty()
            && r.protocol == map.protocol
            && r.indenter == map.indenter
            && r.site == map.site
            && (&r.subject, &r.day) == (&map.subject, &map.day)
    };
    let curves = study.recordings.iter().filter(is_own);
    curves
        .filter_map(|r| match &r.data {
            Data::Indentation(curve) => Some(curve),
            _ => None,
        })
        .collect()
}

/// Force at a depth while the tool goes down: the line through the readings next to it.
fn force_at(curve: &Curve, depth: f64) -> Option<f64> {
    let (depths, forces) = (curve.channel("depth_mm")?, curve.channel("force_n")?);
    let most = depths.iter().copied().fold(0.0, f64::max);
    let end = depths.iter().position(|d| *d >= TOP * most)? + 1;
    let least = depths[..end].iter().copied().fold(f64::INFINITY, f64::min);
    if depth < least || depth > most + (1.0 - TOP) * most {
        return None;
    }
    let after = depths[..end]
        .iter()
        .position(|d| *d >= depth)
        .unwrap_or(end - 1);
    let near = after.saturating_sub(NEAR)..(after + NEAR).min(end);
    let n = near.len() as f64;
    if near.len() < NEAR {
        return None;
    }
    let mean = |of: &[f64]| of[near.clone()].iter().sum::<f64>() / n;
    let (x, y) = (mean(depths), mean(forces));
    let (mut xx, mut xy) = (0.0, 0.0);
    for k in near.clone() {
        xx += (depths[k] - x).powi(2);
        xy += (depths[k] - x) * (forces[k] - y);
    }
    Some(y + xy / xx.max(f64::MIN_POSITIVE) * (depth - x))
}

/// Whether two cells read the largest value: what clips does.
fn shares_peak(values: &[f64]) -> bool {
    let most = values.iter().copied().fold(0.0, f64::max);
    values
        .iter()
        .filter(|v| v.to_bits() == most.to_bits())
        .count()
        > 1
}

/// A mat's grid and areas.
struct Mat {
    rows: usize,
    columns: usize,
    /// By row and column: the sensel, and its area, mm2.
    cells: Vec<(usize, f64)>,
    threshold: f64,
}

impl Mat {
    /// None where the cells fill no rectangle, are not calibrated, or have no known area.
    fn of(
        map: &PressureMap,
        sensels: Option<&[Option<PlacedSensel>]>,
        threshold: f64,
    ) -> Option<Mat> {
        if map.unit != PressureUnit::Kilopascal {
            return None;
        }
        let mut placed = Vec::new();
        for (k, (sensel, place)) in map.sensels.iter().zip(sensels?).enumerate() {
            placed.push((sensel.place?, k, place.as_ref()?.area_mm2));
        }
        placed.sort_unstable_by_key(|(place, ..)| *place);
        let ([first_row, first_column], ..) = *placed.first()?;
        let ([last_row, last_column], ..) = *placed.last()?;
        let rows = (last_row - first_row + 1) as usize;
        let columns = (last_column.checked_sub(first_column)? + 1) as usize;
        (placed.len() == rows * columns).then(|| Mat {
            rows,
            columns,
            cells: placed.into_iter().map(|(_, k, area)| (k, area)).collect(),
            threshold,
        })
    }

    /// Load of a frame, N: what was read, and with what cells next to these may bear below the threshold. None where the border bears some
    /// of it, and where a cell reads nothing between others that do.
    fn load_n(&self, values: &[f64]) -> Option<[f64; 2]> {
        let read = |row: usize, column: usize| {
            let value = values[self.cells[row * self.columns + column].0];
            if value.is_finite() { value } else { 0.0 }
        };
        let peak = values.iter().copied().fold(0.0, f64::max);
        let (mut load, mut border, mut hidden) = (0.0, 0.0, 0.0);
        for row in 0..self.rows {
            for column in 0..self.columns {
                let (value, area) = (read(row, column), self.cells[row * self.columns + column].1);
                let is_border =
                    row % (self.rows - 1).max(1) == 0 || column % (self.columns - 1).max(1) == 0;
                load += value * area * 1e-3;
                border += if is_border { value * area * 1e-3 } else { 0.0 };
                if value > 0.0 {
                    continue;
                }
                let neighbors = [
                    (row > 0).then(|| read(row - 1, column)),
                    (row + 1 < self.rows).then(|| read(row + 1, column)),
                    (column > 0).then(|| read(row, column - 1)),
                    (column + 1 < self.columns).then(|| read(row, column + 1)),
                ];
                let bear = neighbors.iter().flatten().filter(|v| **v > 0.0).count();
                let is_loaded = |k: usize| neighbors[k].is_some_and(|v| v > CLEARLY * peak);
                if (is_loaded(0) && is_loaded(1)) || (is_loaded(2) && is_loaded(3)) {
                    return None;
                }
                if bear > 0 {
                    hidden += self.threshold * area * 1e-3;
                }
            }
        }
        (load > 0.0 && border < BORDER * load).then_some([load, load + hidden])
    }
}

/// Adds the gain of a mat to the diagnosis: the instrument's fault, alone or with what else is missing. Maps of tissue that softens by use
/// may have been taken at another time than the curves.
pub fn add_gain(study: &Study, found: &mut Diagnosis) {
    let stated = study.instrument.as_ref().and_then(|i| i.gain_percent);
    let gain = stated.map_or(UNSTATED, |percent| 0.01 * percent);
    let Some(seen) = ratio(study).filter(|seen| seen.is_fault(gain)) else {
        return;
    };
    let factor = libm::exp(0.5 * (seen.ends[0] + seen.ends[1]));
    found.notes.push(format!(
        "together the cells of the mat bear {factor:.2} times what the load cell reads at the same depth of the same protocol, in {} frames \
         above a quarter of the largest load: the gain of one of the two is off",
        seen.frames
    ));
    let is_other = |f: &Finding| f.effect == "cycle_softening" || f.effect == "gain";
    if found.findings.iter().any(is_other) {
        return;
    }
    match found.verdict {
        Verdict::NothingMissing | Verdict::Parameters => {
            found.verdict = Verdict::Instrument;
            found.names_90 = vec![vec!["gain"]];
        }
        Verdict::MissingPhysics | Verdict::Instrument => {
            found
                .names_90
                .iter_mut()
                .for_each(|names| names.push("gain"));
        }
        _ => return,
    }
    let error = 1.645 * 1.2533 * seen.spread / libm::sqrt(seen.frames as f64);
    let [low, high] = [seen.ends[0] - error, seen.ends[1] + error].map(|log| libm::exp(log) - 1.0);
    found.findings.push(Finding {
        effect: "gain",
        kind: "instrument",
        channel: "map",
        confidence: Confidence::new(0.99, Kind::MatGain),
        numbers: vec![Number {
            name: "error",
            value: factor - 1.0,
            interval: (low, high),
            unit: "1",
        }],
        place: None,
        when: None,
        depends_on: vec!["pressure"],
        consequences: vec![(
            "the sum of the map and the load cell differ by that factor".to_owned(),
            true,
        )],
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mat(threshold: f64) -> Mat {
        Mat {
            rows: 4,
            columns: 4,
            cells: (0..16).map(|k| (k, 4.0)).collect(),
            threshold,
        }
    }

    #[test]
    fn load_of_a_mat_has_what_lies_below_its_threshold() {
        let mut values = vec![0.0; 16];
        for k in [5, 6, 9, 10] {
            values[k] = 10.0;
        }
        let [low, high] = mat(0.5).load_n(&values).expect("it lies inside");
        // Eight cells border on the four that read.
        assert!((low - 0.16).abs() < 1e-12 && (high - low - 8.0 * 0.5 * 4e-3).abs() < 1e-12);
        values[0] = 2.0;
        assert_eq!(
            mat(0.5).load_n(&values),
            None,
            "it may lie beyond the border"
        );
        assert_eq!(beyond([-0.2, 0.1]), 0.0);
        assert_eq!(beyond([-0.3, -0.2]), -0.2);
        assert_eq!(beyond([0.2, 0.3]), 0.2);
    }

    #[test]
    fn a_cell_that_reads_nothing_among_others_leaves_no_sum() {
        let mat = Mat {
            rows: 5,
            columns: 5,
            cells: (0..25).map(|k| (k, 4.0)).collect(),
            threshold: 0.0,
        };
        let mut values = vec![0.0; 25];
        for k in [6, 7, 8, 11, 13, 16, 17, 18] {
            values[k] = 10.0;
        }
        assert_eq!(mat.load_n(&values), None);
        values[12] = 1.0;
        assert!(mat.load_n(&values).is_some());
        // A dead row between two that read, and two dead cells next to each other.
        let mut line = vec![0.0; 25];
        for k in [6, 7, 8, 16, 17, 18] {
            line[k] = 10.0;
        }
        assert_eq!(mat.load_n(&line), None);
        line[11] = 10.0;
        assert_eq!(mat.load_n(&line), None);
        // Noise in a cell apart from the contact is no dead cell next to it.
        let mut apart = vec![0.0; 25];
        for k in [6, 7, 11, 12] {
            apart[k] = 10.0;
        }
        apart[14] = 0.1;
        assert!(mat.load_n(&apart).is_some());
    }

    #[test]
    fn one_factor_beyond_the_data_sheet_is_a_fault() {
        let of = |log: f64, spread| Ratio {
            log,
            ends: [log; 2],
            spread,
            frames: 8,
        };
        assert!(of(-0.3, 0.02).is_fault(0.03) && of(0.3, 0.02).is_fault(0.03));
        assert!(
            !of(-0.14, 0.01).is_fault(0.03),
            "within three times what is stated"
        );
        assert!(!of(-0.3, 0.02).is_fault(0.1));
        assert!(!of(-0.3, 0.1).is_fault(0.03), "it grows with the load");
    }
}
