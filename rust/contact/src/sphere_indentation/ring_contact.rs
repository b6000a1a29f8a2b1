//! Contact of rings: pressures that keep touching rings at their gaps, by exchange of the contact set.

use nalgebra::{DMatrix, DVector};

/// Exchanges of a contact, at most.
const EXCHANGES: usize = 100;

/// Pressures that hold rings at their gaps where they touch, none elsewhere: exchanged until none pulls and none overlaps.
pub fn touch(compliance: &DMatrix<f64>, gaps: &DVector<f64>) -> DVector<f64> {
    let mut touches: Vec<bool> = gaps.iter().map(|g| *g > 0.0).collect();
    let mut pressure = DVector::zeros(gaps.len());
    for _ in 0..EXCHANGES {
        let kept: Vec<usize> = (0..gaps.len()).filter(|i| touches[*i]).collect();
        if kept.is_empty() {
            return DVector::zeros(gaps.len());
        }
        let part = compliance.select_rows(&kept).select_columns(&kept);
        let wanted = gaps.select_rows(&kept);
        pressure.fill(0.0);
        if let Some(found) = part.lu().solve(&wanted) {
            kept.iter()
                .zip(found.iter())
                .for_each(|(i, p)| pressure[*i] = *p);
        }
        let left = gaps - compliance * &pressure;
        let next: Vec<bool> = (0..gaps.len())
            .map(|i| match touches[i] {
                true => pressure[i] >= 0.0,
                false => left[i] > 1e-12,
            })
            .collect();
        if next == touches {
            break;
        }
        touches = next;
    }
    pressure.map(|p: f64| p.max(0.0))
}
