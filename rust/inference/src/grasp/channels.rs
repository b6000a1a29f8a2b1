//! The rows of a grasp study's linear model: levels and courses of regions, and the force trace over the cells' sum.
//!
//! Each channel has its nuisances: form of the model by region, the model's error in what a shift does, slow wandering, the
//! mat's gain within its data sheet. What they can explain is no cause.

use crate::grasp::hold::Hold;
use crate::grasp::linear_evidence::Rows;
use crate::grasp::regional_fit::RegionalFit;
use crate::grasp::time_course::Courses;

/// Standard deviation of the logarithm of the fast model's force over a reference solve: by region, and over all regions (0.84 to
/// 1.19 on seven grasps, README).
const FORM: (f64, f64) = (0.17, 0.15);
/// The same of the level of a region from grasp to grasp, of what a shift is taken to do, /mm, by region and over all.
const REGRASP: f64 = 0.07;
const BY_SHIFT: (f64, f64) = (0.3, 0.4);
/// Wandering of a region's scale within a hold, fast at first and evenly: what a finger's motion is mistaken for where its pad covers three cells
/// across and the edge of contact shows little of it; and what of that is the same in every hold.
const WANDER: ([f64; 2], [f64; 2]) = ([0.07, 0.12], [0.05, 0.07]);
/// The same of all regions together, in one hold and in every hold.
const TOGETHER: ([f64; 2], [f64; 2]) = ([0.012, 0.02], [0.015, 0.025]);
/// Gain of a mat whose data sheet gives none, and its change from hold to hold and within one.
const GAIN: (f64, f64, f64) = (0.05, 0.02, 0.012);
/// Creep of a sound mat within a hold: 2.9 % in 30 s on a hand-handle sensor (Yao 2019, Measurement 145:525).
const CREEP: f64 = 0.02;
/// Noise of one stretch of a course that is not in the scatter of its cells.
const LEAST_NOISE: f64 = 0.004;
/// Time constants of slow wandering, s.
const SLOW_S: f64 = 8.0;

/// What a row is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Channel {
    /// Logarithm of a region's scale in a hold: hold, region.
    Level(usize, usize),
    /// Change of a region's scale in a hold: hold, region, stretch.
    Course(usize, usize, usize),
    /// Logarithm of the trace over the force that the mat should read of it: hold, stretch.
    Trace(usize, usize),
}

impl Channel {
    /// Number of the hold.
    pub fn hold(self) -> usize {
        match self {
            Channel::Level(hold, _) | Channel::Course(hold, ..) | Channel::Trace(hold, _) => hold,
        }
    }
}

/// All rows, and what they are.
pub struct Channels {
    /// What each row is.
    pub rows: Vec<Channel>,
    /// The linear model without a cause.
    pub model: Rows,
    /// Shift of the region at each row, mm: from its mean over holds for a level, within the hold for a course.
    pub shift_mm: Vec<f64>,
    /// Time of each row from closing, s; 0 for a level.
    pub time_s: Vec<f64>,
}

/// What the holds were found to be.
pub struct Found<'a> {
    /// The holds.
    pub holds: &'a [Hold],
    /// Their mean maps explained.
    pub fits: &'a [RegionalFit],
    /// Their courses.
    pub courses: &'a [Courses],
    /// By hold: logarithm of the part of the trace's force that the mat can read.
    pub readable: &'a [f64],
    /// Data sheet: uncertainty of the mat's gain.
    pub gain: Option<f64>,
}

/// A row's number with its variance, and where it stands.
struct RowValue {
    y: f64,
    variance: f64,
    shift_mm: f64,
    time_s: f64,
}

/// Builds the rows with their nuisances.
pub fn channels(found: &Found<'_>) -> Channels {
    let mut built = Channels {
        rows: Vec::new(),
        model: Rows {
            y: Vec::new(),
            variance: Vec::new(),
            nuisances: Vec::new(),
        },
        shift_mm: Vec::new(),
        time_s: Vec::new(),
    };
    let regions: Vec<usize> = regions(found.fits);
    let mean_shift = |region: usize| {
        let each = found
            .fits
            .iter()
            .filter_map(|fit| place(fit, region).map(|k| fit.shift_mm[k]));
        let all: Vec<f64> = each.collect();
        all.iter().sum::<f64>() / all.len() as f64
    };
    for (hold, fit) in found.fits.iter().enumerate() {
        for (k, &region) in fit.active.iter().enumerate() {
            let noise = fit.deviation[k].powi(2) * 0.1 + REGRASP.powi(2);
            let shift = fit.shift_mm[k] - mean_shift(region);
            let reading = RowValue {
                y: fit.log_scale[k],
                variance: noise,
                shift_mm: shift,
                time_s: 0.0,
            };
            built.push(Channel::Level(hold, region), reading);
        }
    }
    for (hold, course) in found.courses.iter().enumerate() {
        for (k, &region) in found.fits[hold].active.iter().enumerate() {
            let of = |list: &[Vec<f64>]| -> Vec<f64> { list.iter().map(|b| b[k]).collect() };
            let (scale, shift) = (of(&course.scale), of(&course.shift_mm));
            let rough = roughness(&scale);
            for stretch in 0..scale.len() {
                let noise = course.variance[stretch][k]
                    .max(rough)
                    .max(LEAST_NOISE.powi(2));
                let reading = RowValue {
                    y: scale[stretch],
                    variance: noise,
                    shift_mm: shift[stretch],
                    time_s: found.holds[hold].time_s[stretch],
                };
                built.push(Channel::Course(hold, region, stretch), reading);
            }
        }
    }
    for (hold, each) in found.holds.iter().enumerate() {
        let Some(force) = &each.force_n else { continue };
        let ratio: Vec<f64> = force
            .iter()
            .zip(&each.maps)
            .map(|(f, map)| (f / each.sum_n(map)).ln() + found.readable[hold])
            .collect();
        let noise = roughness(&ratio).max(0.003f64.powi(2));
        for (stretch, value) in ratio.iter().enumerate() {
            let reading = RowValue {
                y: *value,
                variance: noise,
                shift_mm: 0.0,
                time_s: each.time_s[stretch],
            };
            built.push(Channel::Trace(hold, stretch), reading);
        }
    }
    built.add_nuisances(&regions, found);
    built
}

impl Channels {
    fn push(&mut self, row: Channel, value: RowValue) {
        self.rows.push(row);
        self.model.y.push(value.y);
        self.model.variance.push(value.variance);
        self.shift_mm.push(value.shift_mm);
        self.time_s.push(value.time_s);
    }

    /// A column by row.
    pub fn column(&self, of: impl Fn(Channel, usize) -> f64) -> Vec<f64> {
        self.rows
            .iter()
            .enumerate()
            .map(|(k, row)| of(*row, k))
            .collect()
    }

    fn add_nuisances(&mut self, regions: &[usize], found: &Found<'_>) {
        let mut all: Vec<(Vec<f64>, f64)> = Vec::new();
        let level = |row: Channel| f64::from(matches!(row, Channel::Level(..)));
        all.push((self.column(|row, _| level(row)), FORM.1));
        let shifted = |row: Channel, k: usize| match row {
            Channel::Trace(..) => 0.0,
            _ => self.shift_mm[k],
        };
        all.push((self.column(shifted), BY_SHIFT.1));
        for &region in regions {
            let is_own = |row: Channel| match row {
                Channel::Level(_, r) | Channel::Course(_, r, _) => r == region,
                Channel::Trace(..) => false,
            };
            let own = self.column(|row, _| if is_own(row) { level(row) } else { 0.0 });
            all.push((own, FORM.0));
            let own = self.column(|row, k| if is_own(row) { self.shift_mm[k] } else { 0.0 });
            all.push((own, BY_SHIFT.0));
        }
        for hold in 0..found.holds.len() {
            self.add_of_hold(&mut all, (hold, regions), found);
        }
        let trace = |row: Channel| f64::from(matches!(row, Channel::Trace(..)));
        all.push((
            self.column(|row, _| trace(row)),
            found.gain.unwrap_or(GAIN.0),
        ));
        self.model.nuisances = all;
    }

    /// What wanders in one hold: every region and all together, twice as fast and slow; the mat's gain.
    fn add_of_hold(
        &self,
        all: &mut Vec<(Vec<f64>, f64)>,
        (hold, regions): (usize, &[usize]),
        found: &Found<'_>,
    ) {
        let time = &found.holds[hold].time_s;
        let length = found.holds[hold].length_s().max(1e-6);
        let centered = |shape: &dyn Fn(f64) -> f64| -> Vec<f64> {
            let mean = time.iter().map(|t| shape(*t)).sum::<f64>() / time.len() as f64;
            time.iter().map(|t| shape(*t) - mean).collect()
        };
        let shapes = [
            centered(&|t| shape_at(0, (t, length))),
            centered(&|t| shape_at(1, (t, length))),
        ];
        for (number, shape) in shapes.iter().enumerate() {
            let course = |of: Option<usize>| {
                self.column(|row, _| match row {
                    Channel::Course(h, r, b) if h == hold && of.is_none_or(|of| of == r) => {
                        shape[b]
                    }
                    _ => 0.0,
                })
            };
            all.push((course(None), TOGETHER.0[number]));
            for &region in regions {
                all.push((course(Some(region)), WANDER.0[number]));
            }
            let trace = self.column(|row, _| match row {
                Channel::Trace(h, b) if h == hold => shape[b],
                _ => 0.0,
            });
            all.push((trace, GAIN.2));
        }
        let creep = centered(&|t| (1.0 + t).ln() / (1.0 + length).ln());
        let crept = self.column(|row, _| match row {
            Channel::Course(h, _, b) if h == hold => creep[b],
            Channel::Trace(h, b) if h == hold => -creep[b],
            _ => 0.0,
        });
        all.push((crept, CREEP));
        for &region in regions {
            let free = self.column(|row, _| match row {
                Channel::Course(h, r, _) => f64::from(h == hold && r == region),
                _ => 0.0,
            });
            all.push((free, 1.0));
        }
        let own = self.column(|row, _| match row {
            Channel::Trace(h, _) => f64::from(h == hold),
            _ => 0.0,
        });
        all.push((own, GAIN.1));
    }
}

/// How a course wanders: fast at first, and evenly.
fn shape_at(number: usize, (time, length): (f64, f64)) -> f64 {
    match number {
        0 => 1.0 - (-time / SLOW_S).exp(),
        _ => time / length,
    }
}

/// Regions that bear load in some hold, in their order.
pub fn regions(fits: &[RegionalFit]) -> Vec<usize> {
    let mut all: Vec<usize> = fits
        .iter()
        .flat_map(|fit| fit.active.iter().copied())
        .collect();
    all.sort_unstable();
    all.dedup();
    all
}

/// Place of a region among the active ones of a fit.
pub fn place(fit: &RegionalFit, region: usize) -> Option<usize> {
    fit.active.iter().position(|r| *r == region)
}

/// Variance of what changes from one stretch to the next without a trend, from second differences.
fn roughness(values: &[f64]) -> f64 {
    let bends: Vec<f64> = values
        .windows(3)
        .map(|w| (w[0] - 2.0 * w[1] + w[2]).powi(2) / 6.0)
        .collect();
    match bends.len() {
        0 => 0.0,
        count => bends.iter().sum::<f64>() / count as f64,
    }
}
