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
    /// dI1/dF at constant volume.
    direction: Matrix3,
    /// First Piola-Kirchhoff stress without the group's pressure, MPa.
    pub stress: Matrix3,
    /// Pressure of the point's own volume, and how it grows (times J squared), MPa.
    own: (f64, f64),
}

impl Point {
    pub fn new(f: &Matrix3, determinant: f64, shear_modulus: f64, stiffening: f64) -> Point {
        let cofactor = cofactors(f);
        let t = cofactor.map(|row| row.map(|value| value / determinant));
        let first = f.iter().flatten().map(|value| value * value).sum::<f64>();
        let scale = determinant.powf(-2.0 / 3.0);
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
            direction,
            stress: std::array::from_fn(|i| {
                std::array::from_fn(|j| slope * direction[i][j] + own_pressure * cofactor[i][j])
            }),
            own: (own_pressure, own),
        }
    }

    /// dP/dF with the mean pressure's own part, nine by nine, lower half.
    pub fn moduli(&self, pressure: f64) -> [[f64; 9]; 9] {
        let (f, t) = (&self.f, &self.t);
        let mut moduli = [[0.0; 9]; 9];
        let shear = 2.0 * self.scale * self.slope;
        let hardening = self.slope * self.stiffening;
        for m in 0..9 {
            let (i, j) = (m / 3, m % 3);
            for n in 0..=m {
                let (k, l) = (n / 3, n % 3);
                let crossed = t[i][l] * t[k][j];
                let both = t[i][j] * t[k][l];
                let mixed = f[i][j] * t[k][l] + t[i][j] * f[k][l];
                let mut value = hardening * self.direction[i][j] * self.direction[k][l];
                value += shear
                    * (f64::from(u8::from(m == n)) - 2.0 / 3.0 * mixed
                        + self.first * (2.0 / 9.0 * both + crossed / 3.0));
                value += (pressure + self.own.0) * self.determinant * (both - crossed);
                value += self.own.1 * both;
                moduli[m][n] = value;
            }
        }
        for m in 0..9 {
            for n in m + 1..9 {
                moduli[m][n] = moduli[n][m];
            }
        }
        moduli
    }
}
