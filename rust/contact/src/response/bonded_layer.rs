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
}
