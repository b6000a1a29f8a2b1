//! Sums of the projected residual per cell and channel, the input of the scan statistic.

use std::collections::BTreeMap;

use nalgebra::DMatrix;

use crate::location::censored_residuals;
use crate::location::protocol_cells::Cells;
use thenar_inference::fit::result::Fit;
use thenar_inference::observe::measured::{Censoring, Measured, Quantity};

/// What an atom is of. Scanned points have no order on the skin here, and are taken together.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Channel {
    Force,
    TangentialForce,
    Area,
    Scan,
    /// The sensel of this number.
    Pressure(u32),
}

impl Channel {
    /// True of a sensel.
    pub(crate) fn is_of_map(self) -> bool {
        matches!(self, Channel::Pressure(_))
    }

    fn of(quantity: Quantity) -> Channel {
        match quantity {
            Quantity::Force => Channel::Force,
            Quantity::TangentialForce => Channel::TangentialForce,
            Quantity::Area => Channel::Area,
            Quantity::Scan(_) => Channel::Scan,
            Quantity::Pressure(sensel) => Channel::Pressure(sensel),
        }
    }
}

/// All samples of one channel in one cell, along the direction in which one unit more on each of them would show.
#[derive(Debug, Clone, Copy)]
pub(crate) struct CellSum {
    pub cell: usize,
    pub channel: Channel,
    /// Length of that direction, 1 / unit: root of the sum of 1 / sigma^2.
    pub weight: f64,
    /// The projected residual along it, over its length.
    pub value: f64,
    /// Mean of the simulated value over its samples, in their unit.
    pub simulated: f64,
    /// Mean depth over the largest of the study, or force asked for where no depth is known.
    pub depth: f64,
    /// Mean over its samples of the largest simulated pressure of their moment, kPa; of another channel its largest simulated value.
    pub peak: f64,
    /// Mean of measured minus simulated, in their unit.
    pub residual: f64,
    /// Number of samples, and sum of the squares of what they scatter about the value.
    pub scatter: (f64, f64),
}

/// Atoms ordered by channel and cell.
pub(crate) struct CellSums {
    pub list: Vec<CellSum>,
    /// What parameters absorb, along the atoms: a row per atom.
    pub absorbed: DMatrix<f64>,
    /// Samples that an instrument's limits hide.
    pub hidden: usize,
}

/// What is summed up of one atom.
struct Sum {
    square: f64,
    value: f64,
    simulated: f64,
    depth: f64,
    peak: f64,
    residual: f64,
    samples: f64,
    squares: f64,
    along: Vec<f64>,
}

/// Sums up a fit.
pub(crate) fn sum_up(fit: &Fit, cells: &Cells) -> CellSums {
    let directions = fit.absorbed.ncols();
    let mut sums: BTreeMap<(Channel, usize), Sum> = BTreeMap::new();
    let mut hidden = 0;
    let mut row = 0;
    let projected = censored_residuals::projected(fit);
    for (recording, one) in fit.measured.iter().enumerate() {
        let peaks = Peaks::new(one, &fit.simulated[recording]);
        for (at, sample) in one.samples.iter().enumerate() {
            let inverse = 1.0 / fit.sigma[recording][at];
            let value = projected[recording][at];
            row += 1;
            hidden += usize::from(sample.censoring != Censoring::Seen);
            if !(inverse.is_finite() && inverse > 0.0 && value.is_finite()) {
                continue;
            }
            let channel = Channel::of(sample.quantity);
            let moment = sample.moment as usize;
            let sum = sums
                .entry((channel, cells.of[recording][moment]))
                .or_insert_with(|| Sum::none(directions));
            let weight = inverse * inverse;
            sum.square += weight;
            sum.value += inverse * value;
            sum.simulated += weight * fit.simulated[recording][at];
            sum.depth += weight * cells.reach[recording][moment];
            sum.residual += weight * (sample.value - fit.simulated[recording][at]);
            sum.peak += weight * peaks.of(channel, moment);
            sum.samples += 1.0;
            sum.squares += value * value;
            for (column, total) in sum.along.iter_mut().enumerate() {
                *total += inverse * fit.absorbed[(row - 1, column)];
            }
        }
    }
    let mut cell_sums = CellSums {
        list: Vec::with_capacity(sums.len()),
        absorbed: DMatrix::zeros(sums.len(), directions),
        hidden,
    };
    for ((channel, cell), sum) in sums {
        let weight = sum.square.sqrt();
        for (column, total) in sum.along.iter().enumerate() {
            cell_sums.absorbed[(cell_sums.list.len(), column)] = total / weight;
        }
        cell_sums.list.push(CellSum {
            cell,
            channel,
            weight,
            value: sum.value / weight,
            simulated: sum.simulated / sum.square,
            depth: sum.depth / sum.square,
            peak: sum.peak / sum.square,
            residual: sum.residual / sum.square,
            scatter: (
                sum.samples,
                (sum.squares - sum.value * sum.value / sum.square).max(0.0),
            ),
        });
    }
    cell_sums
}

impl Sum {
    fn none(directions: usize) -> Sum {
        Sum {
            square: 0.0,
            value: 0.0,
            simulated: 0.0,
            depth: 0.0,
            peak: 0.0,
            residual: 0.0,
            samples: 0.0,
            squares: 0.0,
            along: vec![0.0; directions],
        }
    }
}

/// Largest simulated values of a recording.
struct Peaks {
    /// Pressure, by moment.
    pressure: Vec<f64>,
    /// Magnitude, by other channel.
    series: BTreeMap<Channel, f64>,
}

impl Peaks {
    fn new(measured: &Measured, simulated: &[f64]) -> Peaks {
        let mut peaks = Peaks {
            pressure: vec![0.0; measured.moments.len()],
            series: BTreeMap::new(),
        };
        for (sample, value) in measured.samples.iter().zip(simulated) {
            let channel = Channel::of(sample.quantity);
            let peak = match channel.is_of_map() {
                true => &mut peaks.pressure[sample.moment as usize],
                false => peaks.series.entry(channel).or_default(),
            };
            *peak = peak.max(value.abs());
        }
        peaks
    }

    fn of(&self, channel: Channel, moment: usize) -> f64 {
        match channel.is_of_map() {
            true => self.pressure[moment],
            false => self.series.get(&channel).copied().unwrap_or(0.0),
        }
    }
}
