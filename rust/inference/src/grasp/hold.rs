//! The hold of a grasp: frames from the moment the hand has closed, as means over stretches of time.

use nalgebra::Vector3;
use thenar_contact::instrument::{Mat, MatLayout};
use thenar_recordings::study::{Data, PlacedSensel, StudyRecording};
use thenar_recordings::{Curve, PressureMap, Study};

use crate::errors::InferenceError;

/// Stretches of time of a hold, short ones first: what relaxes does so early.
const STRETCHES: usize = 12;
/// Share of the strong frames' load from which the hand may count as closed, and at whose loss it counts as open.
const CLOSED: (f64, f64) = (0.5, 0.3);
/// A hand that closes raises its load by more than this share within this time, s.
const CLOSES: (f64, f64) = (0.1, 0.5);
/// Share of the frames that are stronger than what is called strong.
const STRONG: f64 = 0.2;

/// A recorded hold.
#[derive(Debug, Clone)]
pub struct Hold {
    /// Number of the recording in the study.
    pub recording: usize,
    /// Name in the study.
    pub name: String,
    /// The mat.
    pub mat: Mat,
    /// Number in the file of each cell of the mat.
    pub kept: Vec<usize>,
    /// Row and column of each cell, where the file numbers them.
    pub places: Vec<Option<[u32; 2]>>,
    /// Mean time of each stretch from the hand's closing, s.
    pub time_s: Vec<f64>,
    /// Time of closing in the recording, s.
    pub closed_s: f64,
    /// Frames in each stretch.
    pub frames: Vec<usize>,
    /// Mean reading by stretch and cell, kPa; NaN for a cell that is missing.
    pub maps: Vec<Vec<f64>>,
    /// Largest and smallest positive reading of each cell in single frames of the hold, kPa.
    pub extremes: Vec<[f64; 2]>,
    /// Share of the frames in which each cell shows its largest reading.
    pub at_largest: Vec<f64>,
    /// Mean force of the trace by stretch, N.
    pub force_n: Option<Vec<f64>>,
    /// Direction across which the trace is measured; None: the sum of normal forces.
    pub force_direction: Option<Vector3<f64>>,
}

impl Hold {
    /// Mean reading of each cell over the stretches, kPa; NaN for a cell that is missing.
    pub fn mean(&self) -> Vec<f64> {
        let count = self.maps.len() as f64;
        let of = |cell: usize| self.maps.iter().map(|map| map[cell]).sum::<f64>() / count;
        (0..self.kept.len()).map(of).collect()
    }

    /// Force that the cells of a map sum to, N.
    pub fn sum_n(&self, map: &[f64]) -> f64 {
        let each = map.iter().zip(self.mat.areas());
        each.filter(|(p, _)| p.is_finite())
            .map(|(p, area)| 1e-3 * p * area)
            .sum()
    }

    /// Length of the hold, s.
    pub fn length_s(&self) -> f64 {
        self.time_s.last().copied().unwrap_or(0.0)
    }
}

/// The holds of a study's grasps, in the order in which they were recorded.
///
/// # Errors
/// [`InferenceError::Contact`] for a mat that cannot be.
pub fn holds(study: &Study) -> Result<Vec<Hold>, InferenceError> {
    let mut order: Vec<usize> = (0..study.recordings.len()).collect();
    let key = |k: &usize| study.recordings[*k].order.unwrap_or(*k as f64);
    order.sort_by(|a, b| key(a).total_cmp(&key(b)));
    let found = order.into_iter().filter_map(|k| {
        let recording = &study.recordings[k];
        match &recording.data {
            Data::Grasp {
                map,
                sensels,
                force,
                force_direction,
            } => {
                let found = hold((k, recording), (map, sensels), force.as_deref());
                Some(found.map(|hold| Hold {
                    force_direction: force_direction.map(Vector3::from),
                    ..hold
                }))
            }
            _ => None,
        }
    });
    found.collect()
}

fn hold(
    (number, recording): (usize, &StudyRecording),
    (map, sensels): (&PressureMap, &[Option<PlacedSensel>]),
    force: Option<&Curve>,
) -> Result<Hold, InferenceError> {
    let kept: Vec<usize> = (0..sensels.len())
        .filter(|&k| sensels[k].is_some())
        .collect();
    let each = || kept.iter().filter_map(|&k| sensels[k].as_ref());
    let normals: Option<Vec<Vector3<f64>>> = each().map(|s| s.normal.map(Vector3::from)).collect();
    let layout = MatLayout {
        centers: each().map(|s| s.center_mm.into()).collect(),
        normals: normals.unwrap_or_default(),
        areas: each().map(|s| s.area_mm2).collect(),
        along: None,
    };
    let what = format!("the mat of '{}'", recording.name);
    let mat = Mat::new(layout).map_err(InferenceError::of_contact(what))?;
    let time = map.time_s.clone().unwrap_or_default();
    let sum = |frame: usize| {
        let cells = map.frame(frame);
        let of = |(&k, area): (&usize, &f64)| (cells[k] * area).max(0.0);
        kept.iter().zip(mat.areas()).map(of).sum::<f64>()
    };
    let sums: Vec<f64> = (0..map.frames()).map(sum).collect();
    let range = closed(&sums, &time);
    let stretches = stretches(&time[range.clone()], range.start);
    let mean = |frames: &std::ops::Range<usize>, cell: usize| {
        let readings = frames.clone().map(|f| map.frame(f)[cell]);
        let (sum, count) = readings
            .filter(|p| p.is_finite())
            .fold((0.0, 0.0), |(sum, count), p| (sum + p, count + 1.0));
        if count > 0.0 { sum / count } else { f64::NAN }
    };
    let maps = stretches
        .iter()
        .map(|frames| kept.iter().map(|&cell| mean(frames, cell)).collect())
        .collect();
    let closed_s = time[range.start];
    let extreme = |&cell: &usize| {
        let readings = range.clone().map(|f| map.frame(f)[cell]);
        readings
            .filter(|p| *p > 0.0)
            .fold([0.0, f64::INFINITY], |[largest, smallest]: [f64; 2], p| {
                [largest.max(p), smallest.min(p)]
            })
    };
    let extremes: Vec<[f64; 2]> = kept.iter().map(extreme).collect();
    let share = |(&cell, extreme): (&usize, &[f64; 2])| {
        let equal = range
            .clone()
            .filter(|&f| extreme[0] > 0.0 && map.frame(f)[cell] >= extreme[0] * (1.0 - 1e-9));
        equal.count() as f64 / range.len().max(1) as f64
    };
    let at_largest = kept.iter().zip(&extremes).map(share).collect();
    let middle = |frames: &std::ops::Range<usize>| {
        time[frames.clone()].iter().sum::<f64>() / frames.len() as f64 - closed_s
    };
    Ok(Hold {
        recording: number,
        name: recording.name.clone(),
        places: kept.iter().map(|&k| map.sensels[k].place).collect(),
        time_s: stretches.iter().map(middle).collect(),
        frames: stretches.iter().map(std::ops::Range::len).collect(),
        closed_s,
        maps,
        extremes,
        at_largest,
        force_n: force
            .map(|curve| {
                trace(curve, &time, &stretches).ok_or_else(|| InferenceError::Grasps {
                    problem: format!(
                        "the force trace of '{}' does not cover the hold with forces above zero; give it on the mat's clock, a push positive, or \
                         leave it out",
                        recording.name
                    ),
                })
            })
            .transpose()?,
        force_direction: None,
        mat,
        kept,
    })
}

/// Frames in which the hand is closed: from the first that bears load and does not go on closing, to where it opens.
fn closed(sums: &[f64], time: &[f64]) -> std::ops::Range<usize> {
    let mut sorted = sums.to_vec();
    sorted.sort_unstable_by(f64::total_cmp);
    let strong = sorted[((1.0 - STRONG) * (sorted.len() - 1) as f64) as usize];
    let closes = |k: usize| {
        let after = time.partition_point(|t| *t < time[k] + CLOSES.1);
        sums[after.min(sums.len() - 1)] > (1.0 + CLOSES.0) * sums[k]
    };
    let first = (0..sums.len()).find(|&k| sums[k] >= CLOSED.0 * strong && !closes(k));
    let last = sums.iter().rposition(|s| *s >= CLOSED.1 * strong);
    let first = first.unwrap_or(0);
    first..(last.unwrap_or(sums.len() - 1) + 1).max(first + 1)
}

/// Frames of a hold as stretches whose lengths grow in proportion to their number.
fn stretches(time: &[f64], first: usize) -> Vec<std::ops::Range<usize>> {
    let length = time[time.len() - 1] - time[0];
    let edge = |k: usize| time[0] + length * (k as f64 / STRETCHES as f64).powi(2);
    let at = |t: f64| time.partition_point(|each| *each < t);
    let mut edges: Vec<usize> = (0..STRETCHES).map(|k| at(edge(k))).collect();
    edges.push(time.len());
    edges.dedup();
    let ends = edges.windows(2).filter(|pair| pair[1] > pair[0]);
    ends.map(|pair| first + pair[0]..first + pair[1]).collect()
}

/// Means of the force trace over the stretches, between two of its readings where a stretch holds none; None where it does not last as long as
/// the hold, or is not above zero.
fn trace(curve: &Curve, time: &[f64], stretches: &[std::ops::Range<usize>]) -> Option<Vec<f64>> {
    let (at, force) = (curve.channel("time_s")?, curve.channel("force_n")?);
    let mean = |frames: &std::ops::Range<usize>| {
        let (from, to) = (time[frames.start], time[frames.end - 1]);
        let (a, b) = (
            at.partition_point(|t| *t < from - 1e-9),
            at.partition_point(|t| *t <= to + 1e-9),
        );
        if b > a {
            return Some(force[a..b].iter().sum::<f64>() / (b - a) as f64);
        }
        let before = a.checked_sub(1)?;
        let share = (0.5 * (from + to) - at[before]) / (at.get(a)? - at[before]);
        Some(force[before] + share * (force[a] - force[before]))
    };
    let found: Option<Vec<f64>> = stretches.iter().map(mean).collect();
    found.filter(|means| means.iter().all(|mean| *mean > 0.0))
}
