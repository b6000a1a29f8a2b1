//! A stiff skin over pulp: thickness and modulus ratio, and the equivalent thin plate.

use crate::response::plate_on_layer::Sheet;

/// A skin over pulp, bonded to it, and part of the layer's thickness.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StiffSkin {
    /// mm, less than the layer's.
    pub thickness_mm: f64,
    /// Its modulus over that of pulp, at least 1.
    pub ratio: f64,
}

impl StiffSkin {
    /// The same as a thin plate over pulp of that Poisson's ratio: `D = E t^3 / 9` and `M = 4 E t / 3` with E = 3 G times the ratio.
    pub(super) fn sheet(self, poisson_ratio: f64) -> Sheet {
        let (share, modulus) = (1.0 - poisson_ratio, 3.0 * self.ratio);
        Sheet {
            bending: share * modulus * self.thickness_mm.powi(3) / 9.0,
            stretch: share * modulus * self.thickness_mm * 4.0 / 3.0,
            middle: 0.5 * self.thickness_mm,
            takes: self.thickness_mm * self.beyond(),
            tension: 0.0,
        }
    }

    /// The part by which it is stiffer than pulp.
    pub(super) fn beyond(self) -> f64 {
        1.0 - 1.0 / self.ratio
    }

    /// Stiffness against stretch over G, as far as it is stiffer than pulp, mm.
    pub(super) fn stretch(self) -> f64 {
        self.sheet(0.0).stretch * self.beyond()
    }
}
