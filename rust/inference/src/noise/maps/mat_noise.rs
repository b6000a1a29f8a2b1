//! Noise of a mat from repeats, sensel by sensel: a constant part and a part proportional to the reading.

use crate::noise::deviations::{Group, robust_deviation};
use crate::noise::scatter::Scatter;
use crate::observe::measured::{Censoring, Measured, Quantity};

/// Readings below this part of the peak, or this much over where a threshold no longer cuts them, tell the constant part.
const LOW: f64 = 0.1;
const LOW_BEYOND: f64 = 0.2;
/// Readings above this part of the peak tell the growing part.
const HIGH: f64 = 0.3;
/// Means below this many thresholds belong to readings that are shown because noise lifted them.
const CUT: f64 = 2.0;
/// Fewest readings from which either is told.
const LEAST: usize = 20;

/// One sensel in one frame: mean of the repeats, and deviations from it with each repeat's gain taken out.
struct Cell {
    mean: f64,
    deviations: Vec<f64>,
}

/// What repeats of maps show; None where no two of them have the same frames.
pub fn scatter(groups: &[Group], measured: &[Measured]) -> Option<Scatter> {
    let (mut low, mut high, mut peak) = (Vec::new(), Vec::new(), 0.0f64);
    let mut inverse = 0.0;
    let (mut gains, mut degrees, mut members) = (0.0, 0.0, Vec::new());
    for group in groups {
        let (cells, gain) = cells(group, measured);
        if cells.is_empty() {
            continue;
        }
        let most = cells.iter().fold(0.0, |most, c| f64::max(most, c.mean));
        let scale = (group.len() as f64 / (group.len() as f64 - 1.0)).sqrt();
        let cut = CUT * threshold(group, measured);
        let until = (LOW * most).max(if cut > 0.0 {
            cut + LOW_BEYOND * most
        } else {
            0.0
        });
        for cell in cells.iter().filter(|c| c.mean > cut) {
            let scaled = cell.deviations.iter().map(|u| u * scale);
            if cell.mean < until {
                low.extend(scaled);
            } else if cell.mean > HIGH * most {
                high.extend(scaled.map(|u| u / cell.mean));
                inverse += cell.deviations.len() as f64 / cell.mean.powi(2);
            }
        }
        let nu = group.len() as f64 - 1.0;
        (gains, degrees) = (
            gains + gain.iter().map(|g| g * g).sum::<f64>(),
            degrees + nu,
        );
        members.extend(group.iter().copied());
        peak = peak.max(most);
    }
    if low.len() + high.len() < LEAST || peak == 0.0 {
        return None;
    }
    let told = |list: &[f64]| {
        if list.len() >= LEAST {
            robust_deviation(list)
        } else {
            0.0
        }
    };
    let (constant, whole) = (told(&low), told(&high));
    let share = constant / peak;
    // Of large readings the constant part is a share, too.
    let known = constant * constant * inverse / (high.len() as f64).max(1.0);
    let proportional = (whole * whole - known).max(0.0).sqrt();
    Some(Scatter::of_map(
        &members,
        (share, proportional),
        (low.len() + high.len()) as f64 * degrees / members.len() as f64,
        (gains / degrees * (degrees + 2.0) / degrees).sqrt(),
    ))
}

/// Largest limit under which a reading of the group is hidden; 0 without one.
fn threshold(group: &Group, measured: &[Measured]) -> f64 {
    let samples = group.iter().flat_map(|k| &measured[*k].samples);
    let hidden = samples.filter(|s| s.censoring == Censoring::AtMost);
    hidden.fold(0.0, |most, s| f64::max(most, s.value))
}

/// Cells that every repeat of a group saw, and each repeat's departure from the mean gain.
fn cells(group: &Group, measured: &[Measured]) -> (Vec<Cell>, Vec<f64>) {
    let sensels = measured[group[0]]
        .mat
        .as_ref()
        .map_or(0, |mat| mat.centers.len());
    let frames = measured[group[0]].moments.len();
    let is_alike = |k: &usize| {
        let other = &measured[*k];
        other.moments.len() == frames
            && other
                .mat
                .as_ref()
                .is_some_and(|mat| mat.centers.len() == sensels)
    };
    if sensels == 0 || !group.iter().all(is_alike) {
        return (Vec::new(), Vec::new());
    }
    let m = group.len() as f64;
    let mut cells = Vec::new();
    for sensel in 0..sensels as u32 {
        let of = |k: &usize| by_moment(&measured[*k], Quantity::Pressure(sensel));
        let series: Vec<Vec<Option<f64>>> = group.iter().map(of).collect();
        for frame in 0..frames {
            let values: Option<Vec<f64>> = series.iter().map(|s| s[frame]).collect();
            if let Some(values) = values {
                let mean = values.iter().sum::<f64>() / m;
                let deviations = values.iter().map(|v| v - mean).collect();
                cells.push(Cell { mean, deviations });
            }
        }
    }
    let square: f64 = cells.iter().map(|c| c.mean * c.mean).sum();
    if square == 0.0 {
        return (Vec::new(), Vec::new());
    }
    let gain = |r: usize| cells.iter().map(|c| c.mean * c.deviations[r]).sum::<f64>() / square;
    let gains: Vec<f64> = (0..group.len()).map(gain).collect();
    for cell in &mut cells {
        for (deviation, gain) in cell.deviations.iter_mut().zip(&gains) {
            *deviation -= gain * cell.mean;
        }
    }
    (cells, gains)
}

/// Values of one quantity by moment; None where it is missing or censored.
fn by_moment(measured: &Measured, quantity: Quantity) -> Vec<Option<f64>> {
    let mut values = vec![None; measured.moments.len()];
    for sample in &measured.samples {
        if sample.quantity == quantity && sample.censoring == Censoring::Seen {
            values[sample.moment as usize] = Some(sample.value);
        }
    }
    values
}
