//! Energy, stress and stiffness of soft tissue at one point.

use crate::matrix3::{Matrix3, cofactors};

/// Stiffness of a point's own volume over the shear modulus: `U = c mu (J - 1 - ln J)` keeps single points from collapsing, and is small
/// against the bulk modulus of the group.
const OWN_VOLUME: f64 = 0.3;
/// Largest exponent: beyond it the tissue is treated as at it.
const MOST_EXPONENT: f64 = 40.0;

/// Strain and stress of tissue at one point, shear part.
pub struct Point {
    /// Deformation gradient.
    f: Matrix3,
    /// Its inverse's transpose.
    t: Matrix3,
    /// The same times its determinant.
    pub cofactor: Matrix3,
    determinant: f64,
    /// J^(-2/3).
    scale: f64,
    /// Trace of F^T F.
    first: f64,
    /// dW/dI1, MPa, and its factor b.
    slope: f64,
    stiffening: f64,
    pub energy: f64,
    /// First Piola-Kirchhoff stress without the group's pressure, MPa.
    pub stress: Matrix3,
    /// Pressure of the point's own volume, and how it grows (times J squared), MPa.
    own: (f64, f64),
}

impl Point {
    #[inline(always)]
    pub fn new(f: &Matrix3, determinant: f64, shear_modulus: f64, stiffening: f64) -> Point {
        let cofactor = cofactors(f);
        let t = cofactor.map(|row| row.map(|value| value / determinant));
        let first = f.iter().flatten().map(|value| value * value).sum::<f64>();
        let scale = determinant.cbrt().powi(-2);
        let strain = (scale * first - 3.0).max(0.0);
        let (growth, energy) = if stiffening > 1e-8 {
            let growth = (stiffening * strain).min(MOST_EXPONENT).exp();
            (growth, shear_modulus / (2.0 * stiffening) * (growth - 1.0))
        } else {
            (1.0, 0.5 * shear_modulus * strain)
        };
        let slope = 0.5 * shear_modulus * growth;
        let own = OWN_VOLUME * shear_modulus;
        let energy = energy + own * (determinant - 1.0 - determinant.ln());
        let own_pressure = own * (1.0 - 1.0 / determinant);
        let direction: Matrix3 = std::array::from_fn(|i| {
            std::array::from_fn(|j| 2.0 * scale * (f[i][j] - first / 3.0 * t[i][j]))
        });
        Point {
            f: *f,
            t,
            cofactor,
            determinant,
            scale,
            first,
            slope,
            stiffening,
            energy,
            stress: std::array::from_fn(|i| {
                std::array::from_fn(|j| slope * direction[i][j] + own_pressure * cofactor[i][j])
            }),
            own: (own_pressure, own),
        }
    }

    /// What the stiffness of the point is made from, under the group's pressure.
    ///
    /// With `f = F G` and `g = F^-T G` of the gradients G of two shape functions a and b, the derivative of the stress is
    /// `k1 f f + k2 (f g + g f) + k3 g g + k4 (g g)^T + k5 (G . G) 1`, each product of a vector of a and one of b.
    #[inline(always)]
    pub fn moduli(&self, pressure: f64) -> [f64; 5] {
        let shear = 2.0 * self.scale * self.slope;
        let volume = (pressure + self.own.0) * self.determinant;
        let third = self.first / 3.0;
        let hardening = 4.0 * self.scale * self.scale * self.slope * self.stiffening;
        [
            hardening,
            -hardening * third - 2.0 / 3.0 * shear,
            hardening * third * third + 2.0 / 3.0 * shear * third + volume + self.own.1,
            shear * third - volume,
            shear,
        ]
    }

    /// The deformation gradient, and its inverse's transpose.
    #[inline(always)]
    pub fn gradients(&self) -> (&Matrix3, &Matrix3) {
        (&self.f, &self.t)
    }
}
