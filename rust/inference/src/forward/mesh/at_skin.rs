//! Load, contact area and displacement at the skin during one recording, before the instrument.

use thenar_surface::Vec3;

/// Part of the largest force below which a moment tells no proportion.
const LEAST_LOAD: f64 = 1e-4;

/// What happens at the skin in one recording, moment by moment.
#[derive(Debug, Clone, PartialEq)]
pub struct AtSkin {
    /// Normal force, N.
    pub force: Vec<f64>,
    /// Force across, N.
    pub tangential: Vec<f64>,
    /// Contact area, mm2.
    pub area: Vec<f64>,
    /// What the mat reads, kPa; empty without a mat.
    pub frames: Vec<Vec<f64>>,
    /// Displacement of the skin at the last moment, mm; empty where nothing is scanned.
    pub displacement: Vec<Vec3>,
}

impl AtSkin {
    /// The same with all moduli so many times as large.
    pub fn scaled(mut self, factor: f64) -> AtSkin {
        let loads = self.force.iter_mut().chain(&mut self.tangential);
        loads
            .chain(self.frames.iter_mut().flatten())
            .for_each(|value| *value *= factor);
        self
    }

    /// This, moved as a model without memory moves from `from` to `to`: forces in proportion, pressures by the same share.
    pub fn moved(mut self, from: &AtSkin, to: &AtSkin) -> AtSkin {
        let most = from
            .force
            .iter()
            .fold(0.0, |most, f| f64::max(most, f.abs()));
        for k in 0..self.force.len() {
            if from.force[k].abs() <= LEAST_LOAD * most {
                continue;
            }
            let (ratio, share) = (to.force[k] / from.force[k], self.force[k] / from.force[k]);
            self.force[k] *= ratio;
            self.tangential[k] *= ratio;
            if from.area[k] > 0.0 {
                self.area[k] *= to.area[k] / from.area[k];
            }
            for (cell, value) in self.frames.get_mut(k).into_iter().flatten().enumerate() {
                *value += share * (to.frames[k][cell] - from.frames[k][cell]);
            }
        }
        for (k, moved) in self.displacement.iter_mut().enumerate() {
            *moved += to.displacement[k] - from.displacement[k];
        }
        self
    }
}
