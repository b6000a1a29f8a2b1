//! Mean residual in ranges of time, depth, rate, phase, cycle, and place on sensor and skin; significance with Bonferroni.

use crate::comparison::quantities::Kind;
use crate::comparison::recording_fit::RecordingFit;
use thenar_inference::observe::measured::Quantity;

/// Most ranges of a variable.
const MOST_BINS: usize = 8;
/// Fewest values in a range.
const FEWEST: usize = 6;
/// Standard deviation below which parameters absorb all of a range.
const NOTHING_LEFT: f64 = 1e-6;

/// What a residual may depend on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Variable {
    /// s.
    Time,
    /// mm.
    Depth,
    /// mm/s.
    Rate,
    /// Part of the protocol.
    Phase,
    /// Loadings before, in the recording.
    Cycle,
    /// Row of the sensel.
    SensorRow,
    /// Column of the sensel.
    SensorColumn,
    /// Place on the skin along x, y or z (0, 1, 2), mm.
    Skin(usize),
}

impl Variable {
    const ALL: [Variable; 10] = [
        Variable::Time,
        Variable::Depth,
        Variable::Rate,
        Variable::Phase,
        Variable::Cycle,
        Variable::SensorRow,
        Variable::SensorColumn,
        Variable::Skin(0),
        Variable::Skin(1),
        Variable::Skin(2),
    ];

    /// Name with its unit.
    pub fn name(self) -> &'static str {
        match self {
            Variable::Time => "time_s",
            Variable::Depth => "depth_mm",
            Variable::Rate => "rate_mm_s",
            Variable::Phase => "phase",
            Variable::Cycle => "cycle",
            Variable::SensorRow => "sensor_row",
            Variable::SensorColumn => "sensor_column",
            Variable::Skin(axis) => ["skin_x_mm", "skin_y_mm", "skin_z_mm"][axis.min(2)],
        }
    }

    /// Name and unit for people.
    pub fn label(self) -> &'static str {
        match self {
            Variable::Time => "Time, s",
            Variable::Depth => "Depth, mm",
            Variable::Rate => "Rate, mm/s",
            Variable::Phase => "Phase",
            Variable::Cycle => "Cycle",
            Variable::SensorRow => "Row of the mat",
            Variable::SensorColumn => "Column of the mat",
            Variable::Skin(axis) => ["Skin x, mm", "Skin y, mm", "Skin z, mm"][axis.min(2)],
        }
    }

    fn is_counted(self) -> bool {
        matches!(self, Variable::Phase | Variable::Cycle)
    }
}

/// Residual of one kind of quantity against one variable.
#[derive(Debug, Clone)]
pub struct Trend {
    /// The quantity.
    pub kind: Kind,
    /// What it is told against.
    pub variable: Variable,
    /// Ranges, in order.
    pub bins: Vec<Bin>,
}

/// One range of a variable.
#[derive(Debug, Clone, PartialEq)]
pub struct Bin {
    /// Least and largest value in it; the number of the phase or cycle.
    pub range: [f64; 2],
    /// `load`, or the cycle's number; empty for ranges.
    pub label: String,
    /// Values in it that say something.
    pub count: usize,
    /// Mean of measured minus simulated, in the quantity's unit.
    pub mean: f64,
    /// Standard error of `mean` if the noise of each value is its own, in the quantity's unit; NaN where the noise is not known.
    pub standard_error: f64,
    /// Mean of the whitened residual with all taken out that parameters can absorb, in standard deviations of the noise.
    pub mean_sigma: f64,
    /// Standard deviation of `mean_sigma` under noise alone; NaN where the noise is not known.
    pub standard_error_sigma: f64,
    /// Chance that noise alone gives a mean as far from zero in any of the ranges looked at; 1 where the noise is not known.
    pub p: f64,
}

impl Bin {
    /// Whether the mean differs from the simulation for other reasons than noise.
    pub fn stands_out(&self) -> bool {
        self.p < SIGNIFICANT
    }

    /// How many standard errors the mean lies off the simulation: the lesser of the mean as read and of what is projected.
    ///
    /// What is projected of one recording also moves where parameters that it shares with others would follow those, and the mean
    /// as read knows nothing of noise that repeats share; only what both show is told. 0 if they disagree in sign or the noise
    /// is not known.
    pub fn standard_errors(&self) -> f64 {
        let (read, projected) = (
            self.mean / self.standard_error,
            self.mean_sigma / self.standard_error_sigma,
        );
        let is_told = read * projected > 0.0 && self.standard_error_sigma > NOTHING_LEFT;
        if is_told {
            read.abs().min(projected.abs())
        } else {
            0.0
        }
    }
}

/// Every trend of a recording with two ranges or more; `p` is for one look each.
pub(crate) fn of(recording_fit: &RecordingFit) -> Vec<Trend> {
    let mut trends = Vec::new();
    for kind in Kind::ALL {
        let samples = recording_fit.measured.samples.iter().enumerate();
        let of_kind: Vec<usize> = samples
            .filter(|(k, sample)| Kind::of(sample.quantity) == kind && recording_fit.tells(*k))
            .map(|(k, _)| k)
            .collect();
        for variable in Variable::ALL {
            let mut placed: Vec<(f64, usize)> = of_kind
                .iter()
                .map(|k| (value(recording_fit, variable, *k), *k))
                .filter(|(at, _)| !at.is_nan())
                .collect();
            placed.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            let bins: Vec<Bin> = groups(&placed, variable.is_counted())
                .into_iter()
                .map(|group| bin(recording_fit, variable, group))
                .collect();
            if bins.len() > 1 {
                trends.push(Trend {
                    kind,
                    variable,
                    bins,
                });
            }
        }
    }
    trends
}

/// Pays for the looks (Bonferroni): every probability is multiplied by their number. Returns it.
pub(crate) fn pay<'t>(trends: impl Iterator<Item = &'t mut Trend>) -> usize {
    let mut bins: Vec<&mut Bin> = trends.flat_map(|trend| trend.bins.iter_mut()).collect();
    let looks = bins.len();
    bins.iter_mut()
        .for_each(|bin| bin.p = (bin.p * looks as f64).min(1.0));
    looks
}

fn value(recording_fit: &RecordingFit, variable: Variable, k: usize) -> f64 {
    let sample = &recording_fit.measured.samples[k];
    let moment = &recording_fit.measured.moments[sample.moment as usize];
    let on_mat = || match (sample.quantity, &recording_fit.measured.mat) {
        (Quantity::Pressure(sensel), Some(mat)) => {
            ((sensel as usize) < mat.centers.len()).then_some((mat, sensel as usize))
        }
        _ => None,
    };
    let place = |axis: usize| {
        let place = on_mat().and_then(|(mat, sensel)| mat.places[sensel]);
        place.map_or(f64::NAN, |place| f64::from(place[axis]))
    };
    match variable {
        Variable::Time => moment.time_s,
        Variable::Depth => moment.depth_mm,
        Variable::Rate => moment.rate_mm_s,
        Variable::Phase => f64::from(moment.phase as u8),
        Variable::Cycle => f64::from(moment.cycle),
        Variable::SensorRow => place(0),
        Variable::SensorColumn => place(1),
        Variable::Skin(axis) => match (sample.quantity, &recording_fit.measured.scan) {
            (Quantity::Scan(place), Some(scan)) => {
                let place = scan.places.get(place as usize);
                place.map_or(f64::NAN, |place| place[axis])
            }
            _ => on_mat().map_or(f64::NAN, |(mat, sensel)| {
                mat.centers[sensel][axis] + moment.slide_mm[axis]
            }),
        },
    }
}

/// Parts of about equal size that never divide equal values; one part for each value if they are counted.
fn groups(placed: &[(f64, usize)], is_counted: bool) -> Vec<&[(f64, usize)]> {
    let bins = (placed.len() / FEWEST).min(MOST_BINS);
    let wanted = placed.len().div_ceil(bins.max(1));
    let mut groups = Vec::new();
    let mut start = 0;
    while start < placed.len() {
        let at_least = if is_counted { 1 } else { wanted };
        let last = placed[(start + at_least - 1).min(placed.len() - 1)].0;
        let mut end = start + placed[start..].partition_point(|(at, _)| *at <= last);
        if placed.len() - end < FEWEST && !is_counted {
            end = placed.len();
        }
        groups.push(&placed[start..end]);
        start = end;
    }
    groups.retain(|group| group.len() >= FEWEST);
    groups
}

fn bin(recording_fit: &RecordingFit, variable: Variable, group: &[(f64, usize)]) -> Bin {
    let samples: Vec<usize> = group.iter().map(|(_, k)| *k).collect();
    let (first, last) = (group[0].0, group[group.len() - 1].0);
    let (mean_sigma, error) = recording_fit.mean_projected(&samples);
    let has_noise = recording_fit.has_noise();
    let mut bin = Bin {
        range: [first, last],
        label: match variable {
            Variable::Phase => phase_name(recording_fit, samples[0]).to_string(),
            Variable::Cycle => format!("{}", first as u32 + 1),
            _ => String::new(),
        },
        count: samples.len(),
        mean: samples
            .iter()
            .map(|k| recording_fit.residual[*k])
            .sum::<f64>()
            / samples.len() as f64,
        standard_error: raw_error(recording_fit, &samples),
        mean_sigma: if has_noise { mean_sigma } else { f64::NAN },
        standard_error_sigma: if has_noise { error } else { f64::NAN },
        p: 1.0,
    };
    bin.p = libm::erfc(bin.standard_errors() / std::f64::consts::SQRT_2);
    bin
}

fn raw_error(recording_fit: &RecordingFit, samples: &[usize]) -> f64 {
    let squares: f64 = samples
        .iter()
        .map(|k| recording_fit.sigma[*k].powi(2))
        .sum();
    squares.sqrt() / samples.len() as f64
}

fn phase_name(recording_fit: &RecordingFit, k: usize) -> &'static str {
    let sample = &recording_fit.measured.samples[k];
    recording_fit.measured.moments[sample.moment as usize]
        .phase
        .name()
}

/// Chance at which a difference is called real.
pub const SIGNIFICANT: f64 = 0.01;
