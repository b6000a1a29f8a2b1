//! Noise of a mat from repeats: sensel by sensel and frame by frame, part of it constant and part growing with the reading.

use super::repeats::{Group, Scatter, spread};
use crate::observe::{Censoring, Measured, Quantity};

/// Readings below this part of the peak tell the constant part, those above the other one the growing part.
const LOW: f64 = 0.1;
const HIGH: f64 = 0.3;
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
    let (mut gains, mut degrees, mut members) = (0.0, 0.0, Vec::new());
    for group in groups {
        let (cells, gain) = cells(group, measured);
        if cells.is_empty() {
            continue;
        }
        let most = cells.iter().fold(0.0, |most, c| f64::max(most, c.mean));
        let scale = (group.len() as f64 / (group.len() as f64 - 1.0)).sqrt();
        for cell in cells.iter().filter(|c| c.mean > 0.0) {
            let scaled = cell.deviations.iter().map(|u| u * scale);
            match cell.mean {
                mean if mean < LOW * most => low.extend(scaled),
                mean if mean > HIGH * most => high.extend(scaled.map(|u| u / mean)),
                _ => {}
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
    let constant = if low.len() >= LEAST {
        spread(&low)
    } else {
        0.0
    };
    let whole = if high.len() >= LEAST {
        spread(&high)
    } else {
        0.0
    };
    let share = constant / peak;
    // Of readings near the peak the constant part is a share too.
    let proportional = (whole * whole - share * share).max(0.0).sqrt();
    Some(Scatter::of_map(
        &members,
        (share, proportional),
        (low.len() + high.len()) as f64 * degrees / members.len() as f64,
        (gains / degrees * (degrees + 2.0) / degrees).sqrt(),
    ))
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
