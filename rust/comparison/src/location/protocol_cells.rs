//! Cells: parts of the recordings' protocols, and the groups of cells that are scanned.

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::Vector3;

use thenar_inference::observe::measured::{Measured, Moment, Phase};

/// Parts into which a stroke is cut by depth, and a hold by the logarithm of its time.
const LEVELS: usize = 3;
/// Most parts of one recording of which every unbroken run is a group; beyond, only its own groups are.
const MOST_RUNS: usize = 16;

/// A part of one recording: one phase of one cycle, at one level of depth.
#[derive(Debug, Clone)]
pub(crate) struct Cell {
    /// Number of the recording.
    pub recording: usize,
    /// Phase of the protocol.
    pub phase: Phase,
    /// Loadings before.
    pub cycle: u32,
    /// Third of the largest depth (a hold: third of its time, on a log scale; a slide: of its way).
    level: usize,
    /// Binary logarithm of the speed, rounded; None where the tool stands.
    rate: Option<i32>,
    /// First and last time, s.
    pub time: [f64; 2],
    /// Smallest and largest depth, mm; NaN if unknown.
    pub depth: [f64; 2],
    /// Slowest and fastest, mm/s; None where the tool stands or no depth is known.
    pub speed: Option<[f64; 2]>,
    /// Mean travel along the skin, mm.
    pub slide: Vector3<f64>,
}

/// The cells of all recordings, in order.
pub(crate) struct Cells {
    pub list: Vec<Cell>,
    /// Cell of each moment, by recording.
    pub of: Vec<Vec<usize>>,
    /// Depth of each moment over the largest, by recording; force asked for where no depth is known.
    pub reach: Vec<Vec<f64>>,
}

/// Cuts every recording's moments into cells.
pub(crate) fn cut(measured: &[Measured]) -> Cells {
    let deepest = measured
        .iter()
        .flat_map(|one| one.moments.iter().map(reach))
        .fold(0.0, f64::max);
    let mut list: Vec<Cell> = Vec::new();
    let mut of = Vec::with_capacity(measured.len());
    for (recording, one) in measured.iter().enumerate() {
        let mut cells = Vec::with_capacity(one.moments.len());
        let first = list.len();
        let spans = spans(&one.moments);
        let longest = one
            .moments
            .iter()
            .map(|m| m.slide_mm.norm())
            .fold(0.0, f64::max);
        for (at, moment) in one.moments.iter().enumerate() {
            let level = match moment.phase {
                Phase::Load | Phase::Unload => third(reach(moment) / deepest),
                Phase::Hold => hold_level(moment.time_s, spans[at]),
                Phase::Slide => third(moment.slide_mm.norm() / longest),
                Phase::Apart => 0,
            };
            let same = |cell: &Cell| {
                (cell.phase, cell.cycle, cell.level) == (moment.phase, moment.cycle, level)
            };
            if list.len() == first || !list.last().is_some_and(same) {
                list.push(Cell::new(recording, moment, level));
            }
            let here = list.len() - 1;
            list[here].take(moment);
            cells.push(here);
        }
        average_slides(&mut list[first..], first, (&one.moments, &cells));
        of.push(cells);
    }
    let share = |moment: &Moment| reach(moment) / deepest.max(f64::MIN_POSITIVE);
    let reach = measured
        .iter()
        .map(|one| one.moments.iter().map(share).collect())
        .collect();
    Cells { list, of, reach }
}

impl Cell {
    fn new(recording: usize, moment: &Moment, level: usize) -> Cell {
        let speed = speed(moment);
        Cell {
            recording,
            phase: moment.phase,
            cycle: moment.cycle,
            level,
            rate: speed.map(|speed| speed.log2().round() as i32),
            time: [moment.time_s; 2],
            depth: [moment.depth_mm; 2],
            speed: speed.map(|speed| [speed; 2]),
            slide: Vector3::zeros(),
        }
    }

    fn take(&mut self, moment: &Moment) {
        self.time[1] = moment.time_s;
        self.depth[0] = self.depth[0].min(moment.depth_mm);
        self.depth[1] = self.depth[1].max(moment.depth_mm);
        if let (Some(known), Some(speed)) = (&mut self.speed, speed(moment)) {
            *known = [known[0].min(speed), known[1].max(speed)];
        }
    }
}

/// Speed of a tool that moves in or out; None where it stands, or no depth is known.
fn speed(moment: &Moment) -> Option<f64> {
    let speed = moment.rate_mm_s.abs();
    let moves = matches!(moment.phase, Phase::Load | Phase::Unload);
    (moves && speed > 1e-6 && speed.is_finite()).then_some(speed)
}

fn average_slides(list: &mut [Cell], first: usize, (moments, cells): (&[Moment], &[usize])) {
    let mut counts = vec![0.0_f64; list.len()];
    for (moment, cell) in moments.iter().zip(cells) {
        list[cell - first].slide += moment.slide_mm;
        counts[cell - first] += 1.0;
    }
    for (cell, count) in list.iter_mut().zip(counts) {
        cell.slide /= count.max(1.0);
    }
}

/// Depth, or the force asked for where no depth is known; 0 if neither is.
fn reach(moment: &Moment) -> f64 {
    [moment.depth_mm, moment.demand_n]
        .into_iter()
        .find(|value| value.is_finite())
        .unwrap_or(0.0)
        .max(0.0)
}

fn third(share: f64) -> usize {
    if share.is_finite() {
        ((share * LEVELS as f64) as usize).min(LEVELS - 1)
    } else {
        0
    }
}

/// First and last time of the phase that each moment belongs to.
fn spans(moments: &[Moment]) -> Vec<[f64; 2]> {
    let ends = |run: &[Moment]| [run[0].time_s, run[run.len() - 1].time_s];
    moments
        .chunk_by(|one, next| one.phase == next.phase)
        .flat_map(|run| vec![ends(run); run.len()])
        .collect()
}

/// Which third of the hold on a log scale: to 1/9 of its time, to 1/3, and the rest.
fn hold_level(time: f64, [begin, end]: [f64; 2]) -> usize {
    let share = (time - begin) / (end - begin);
    if !share.is_finite() || share <= 1.0 / 9.0 {
        0
    } else if share <= 1.0 / 3.0 {
        1
    } else {
        2
    }
}

/// Groups of cells over which a mismatch may last: all; one recording, protocol, tool and site; a phase, a level of depth, a speed, the
/// first or the later cycles, over all recordings, and a phase of one protocol. Each group once.
pub(crate) fn broad_groups(cells: &[Cell], measured: &[Measured]) -> BTreeSet<Vec<usize>> {
    let mut groups: BTreeMap<String, Vec<usize>> = BTreeMap::new();
    for (at, cell) in cells.iter().enumerate() {
        let one = &measured[cell.recording];
        let (phase, when) = (cell.phase, if cell.cycle == 0 { "first" } else { "later" });
        let mut names = vec![
            "all".to_owned(),
            format!("recording {}", cell.recording),
            format!("protocol {}", one.protocol),
            format!("indenter {}", one.indenter),
            format!("site {}", one.site),
            format!("phase {phase:?}"),
            format!("phase {phase:?} of {}", one.protocol),
            format!("level {} of {}", cell.level, phase == Phase::Hold),
            format!("cycles {when}"),
        ];
        names.extend(cell.rate.map(|rate| format!("rate {rate}")));
        for name in names {
            groups.entry(name).or_default().push(at);
        }
    }
    groups.into_values().collect()
}

/// Every unbroken run of cells of one recording, and of one phase over the recordings of a protocol.
pub(crate) fn runs(cells: &[Cell], recordings: usize) -> BTreeSet<Vec<usize>> {
    let mut groups = BTreeSet::new();
    for recording in 0..recordings {
        let own: Vec<usize> = (0..cells.len())
            .filter(|cell| cells[*cell].recording == recording)
            .collect();
        if own.len() > MOST_RUNS {
            continue;
        }
        for from in 0..own.len() {
            for to in from..own.len() {
                groups.insert(own[from..=to].to_vec());
            }
        }
    }
    groups
}
