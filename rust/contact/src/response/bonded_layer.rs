//! The bonded elastic layer over a rigid base: its Fourier transfer function.
//!
//! A soft layer of thickness h, bonded to bone, answers a normal pressure of wave number k with
//! `u = (1 - nu) / (G k) K(k h) p` (Johnson, Contact Mechanics 5.8). For nu = 1/2 the layer keeps its volume: K(0) = 0.
//! K = 1 is the half space.

/// Thickness and Poisson's ratio of a layer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Layer {
    /// Thickness, mm; may be infinite.
    pub thickness: f64,
    /// Poisson's ratio.
    pub poisson_ratio: f64,
}

impl Layer {
    /// Transfer function K at wave number `k` (1/mm); between 0 and 1.
    pub fn transfer(&self, k: f64) -> f64 {
        if self.thickness.is_infinite() {
            return 1.0;
        }
        let s = k * self.thickness;
        if s < 1e-4 {
            // Closed form cancels here; its leading terms: s (kappa - 1) 4 / (kappa + 1)^2, and 2 s^3 / 3 at nu = 1/2.
            let kappa = 3.0 - 4.0 * self.poisson_ratio;
            return 4.0 * s * (kappa - 1.0) / ((kappa + 1.0) * (kappa + 1.0))
                + 2.0 / 3.0 * s * s * s;
        }
        let kappa = 3.0 - 4.0 * self.poisson_ratio;
        let (e2, e4) = ((-2.0 * s).exp(), (-4.0 * s).exp());
        let top = -kappa * (-4.0 * s).exp_m1() - 4.0 * s * e2;
        (top / (kappa * (1.0 + e4) + (4.0 * s * s + 1.0 + kappa * kappa) * e2)).max(0.0)
    }

    /// How far the surface moves along itself, at wave number `k` (1/mm): `[Z, R]` of `v = (1 - nu) / (G k) (Z p + R q)` under a
    /// pressure p and a traction q along the surface, away from where p is largest; Z also is what q sinks.
    ///
    /// From Navier's equations with u = 0 at the bone, as K. On a half space R is 1, and Z, of nu = 1/2, 0.
    pub fn along(&self, k: f64) -> [f64; 2] {
        let kappa = 3.0 - 4.0 * self.poisson_ratio;
        if self.thickness.is_infinite() {
            return [-(kappa - 1.0) / (kappa + 1.0), 1.0];
        }
        let s = k * self.thickness;
        let (e2, e4) = ((-2.0 * s).exp(), (-4.0 * s).exp());
        let below = kappa * (1.0 + e4) + (4.0 * s * s + 1.0 + kappa * kappa) * e2;
        // (cosh(2 s) - 1) e^(-2 s) = (1 - e^(-2 s))^2 / 2.
        let lifted = kappa * (kappa - 1.0) / 4.0 * (-2.0 * s).exp_m1().powi(2);
        let coupled = (2.0 * s * s * e2 - lifted) * 4.0 / (kappa + 1.0);
        let sheared = -kappa * (-4.0 * s).exp_m1() + 4.0 * s * e2;
        [coupled / below, sheared / below]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn incompressible_layer_keeps_its_volume_and_becomes_a_half_space_for_short_waves() {
        let layer = Layer {
            thickness: 7.0,
            poisson_ratio: 0.5,
        };
        assert!(layer.transfer(0.0) == 0.0);
        let s = 0.01;
        let thin = layer.transfer(s / 7.0) / (2.0 * s * s * s / 3.0);
        assert!((thin - 1.0).abs() < 1e-3, "{thin}");
        assert!((layer.transfer(3.0) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn the_series_meets_the_closed_form() {
        for poisson_ratio in [0.3, 0.45, 0.5] {
            let layer = Layer {
                thickness: 1.0,
                poisson_ratio,
            };
            let (below, above) = (layer.transfer(0.999_999e-4), layer.transfer(1.000_001e-4));
            assert!(
                (below / above - 1.0).abs() < 2e-3,
                "{poisson_ratio}: {below} {above}"
            );
        }
    }

    #[test]
    fn a_compressible_layer_under_uniform_pressure_is_a_confined_column() {
        // u = p h (1 - 2 nu) / (2 G (1 - nu)): the oedometer modulus.
        let (nu, k) = (0.3, 1e-6);
        let layer = Layer {
            thickness: 4.0,
            poisson_ratio: nu,
        };
        let u = (1.0 - nu) / k * layer.transfer(k);
        let column = 4.0 * (1.0 - 2.0 * nu) / (2.0 * (1.0 - nu));
        assert!((u / column - 1.0).abs() < 1e-6, "{u} {column}");
    }

    /// Solves Navier's equations through the thickness: waves `exp(k z)` and `exp(-k z)`, four constants, none moves at the bone.
    fn solved(nu: f64, s: f64) -> [f64; 4] {
        let kappa = 3.0 - 4.0 * nu;
        // By column: W, U, their slopes, and nu / (1 - 2 nu) of the divergence, at z (k = G = 1), bone at -s.
        let at = |z: f64| {
            let (up, down) = (z.exp(), (-z).exp());
            [
                [up, -up, up, -up, 0.0],
                [
                    z * up,
                    -(kappa + z) * up,
                    (1.0 + z) * up,
                    -(1.0 + kappa + z) * up,
                    -2.0 * nu * up,
                ],
                [down, down, -down, -down, 0.0],
                [
                    z * down,
                    (z - kappa) * down,
                    (1.0 - z) * down,
                    (1.0 + kappa - z) * down,
                    -2.0 * nu * down,
                ],
            ]
        };
        let (bone, top) = (at(-s), at(0.0));
        let matrix = nalgebra::Matrix4::from_fn(|row, column| match row {
            0 => bone[column][0],
            1 => bone[column][1],
            2 => 2.0 * (top[column][2] + top[column][4]),
            _ => top[column][3] - top[column][0],
        });
        let answer = |pressure: f64, along: f64| {
            let side = nalgebra::Vector4::new(0.0, 0.0, -pressure, along);
            let constants = matrix.lu().solve(&side).unwrap();
            let sum = |n: usize| (0..4).map(|k| constants[k] * top[k][n]).sum::<f64>();
            [-sum(0) / (1.0 - nu), sum(1) / (1.0 - nu)]
        };
        let ([sinks, coupled], [back, sheared]) = (answer(1.0, 0.0), answer(0.0, 1.0));
        [sinks, coupled, back, sheared]
    }

    #[test]
    fn a_layer_moves_along_itself_as_naviers_equations_have_it() {
        for poisson_ratio in [0.2, 0.4, 0.5] {
            let layer = Layer {
                thickness: 2.0,
                poisson_ratio,
            };
            for s in [0.2, 0.7, 1.5, 4.0] {
                let [sinks, coupled, back, sheared] = solved(poisson_ratio, s);
                let [z, r] = layer.along(s / 2.0);
                for (found, wanted) in [
                    (layer.transfer(s / 2.0), sinks),
                    (z, coupled),
                    (z, back),
                    (r, sheared),
                ] {
                    assert!(
                        (found - wanted).abs() < 1e-9,
                        "{poisson_ratio} {s}: {found} {wanted}"
                    );
                }
            }
            let far = layer.along(30.0);
            let half = Layer {
                thickness: f64::INFINITY,
                poisson_ratio,
            };
            assert!((0..2).all(|k| (far[k] - half.along(30.0)[k]).abs() < 1e-9));
        }
    }
}
