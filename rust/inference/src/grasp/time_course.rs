//! How scale and posture of every region go on during a hold, from the change of its cells.
//!
//! A change of tissue changes all cells of a region in proportion to what they read; a change of posture changes them as the
//! model's map changes with the region's shift, most at the edge of the contact. The map's own form drops out.

use nalgebra::{DMatrix, DVector};

use crate::grasp::hold::Hold;
use crate::grasp::regional_fit::{Cells, RegionalFit};

/// Noise of a cell in the mean over a stretch, kPa: what mats resolve, and what readings below the floor hide.
const CELL_KPA: f64 = 0.7;
/// Error of the change of a cell, as a share of its reading: where the model's pattern of a change is wrong.
const PATTERN: f64 = 0.02;
/// Prior of a region's motion during a hold, mm.
const MOTION_MM: f64 = 0.5;
/// Prior of the change of a scale.
const CHANGE: f64 = 0.5;

/// Courses of one hold; lists by stretch, then by active region.
#[derive(Debug, Clone)]
pub struct Courses {
    /// Relative change of the scale from that of the mean map.
    pub scale: Vec<Vec<f64>>,
    /// Its variance, whatever the posture did.
    pub variance: Vec<Vec<f64>>,
    /// Shift from that of the mean map, mm.
    pub shift_mm: Vec<Vec<f64>>,
}

/// The courses of a hold around the fit of its mean map.
pub fn courses(hold: &Hold, fit: &RegionalFit, cells: &Cells) -> Courses {
    let (mean, model) = (hold.mean(), fit.sum());
    let regions = fit.active.len();
    let mut found = Courses {
        scale: Vec::new(),
        variance: Vec::new(),
        shift_mm: Vec::new(),
    };
    let count = 2 * regions;
    for map in &hold.maps {
        let mut normal = DMatrix::<f64>::zeros(count, count);
        let mut pull = DVector::<f64>::zeros(count);
        for (cell, (&now, &usual)) in map.iter().zip(&mean).enumerate() {
            let is_clipped = now.max(usual) >= 0.98 * cells.ceiling_kpa;
            if !cells.is_live[cell] || now.is_nan() || is_clipped {
                continue;
            }
            let mut row = vec![0.0; count];
            for r in 0..regions {
                // A cell that two regions touch changes with each by its part of the model's pressure.
                let part = fit.maps[r][cell] / model[cell].max(1e-9);
                row[r] = part * usual;
                row[regions + r] = fit.by_shift[r][cell] * cells.gain[cell];
            }
            let used: Vec<usize> = (0..count).filter(|k| row[*k] != 0.0).collect();
            let deviation = CELL_KPA.max(0.5 * cells.floor_kpa).hypot(PATTERN * usual);
            let weight = deviation.powi(-2);
            for &i in &used {
                pull[i] += weight * row[i] * (now - usual);
                for &j in &used {
                    normal[(i, j)] += weight * row[i] * row[j];
                }
            }
        }
        for r in 0..regions {
            normal[(r, r)] += CHANGE.powi(-2);
            normal[(regions + r, regions + r)] += MOTION_MM.powi(-2);
        }
        let Some(factor) = normal.cholesky() else {
            continue;
        };
        let (solved, inverse) = (factor.solve(&pull), factor.inverse());
        found.scale.push((0..regions).map(|r| solved[r]).collect());
        found
            .variance
            .push((0..regions).map(|r| inverse[(r, r)]).collect());
        found
            .shift_mm
            .push((0..regions).map(|r| solved[regions + r]).collect());
    }
    found
}
