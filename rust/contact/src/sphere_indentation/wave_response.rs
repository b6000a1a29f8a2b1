//! Response of a stiff skin on a layer to a load of one wave number. The layer's modulus G is 1.
//!
//! How far they sink under a pressure is exact: Navier's equations through the skin's own thickness, which lies on the layer's surface
//! compliance `C = (1 - nu) / k [[K, Z], [Z, R]]` (`response::bonded_layer`). What a force along the skin moves, and how far the skin's
//! middle moves along itself, are those of a thin plate on the same layer (`response::plate_on_layer`): they count where the contact is
//! wide against the skin.

use nalgebra::{Matrix2, Matrix4, Vector2, Vector4};

use super::stiff_skin::StiffSkin;
use crate::response::bonded_layer::Layer;

/// What a pressure p and a force along the skin f of one wave number move: downwards w, and along itself the skin's middle v.
#[derive(Debug, Clone, Copy)]
pub struct WaveResponse {
    /// w under p, 1/k.
    pub sinks: f64,
    /// w under f, and v under p.
    pub sinks_along: f64,
    /// v under f.
    pub middle_along: f64,
}

/// How a layer of which the skin is the uppermost part answers at wave number `k`, 1/mm.
pub fn moved(layer: Layer, skin: StiffSkin, k: f64) -> WaveResponse {
    let sheet = skin.sheet(layer.poisson_ratio);
    let [sinks_under, coupled, along] = sheet.moves(&layer, k).map(|part| per(layer, k) * part);
    // The skin's middle lies half a thickness above the layer's surface.
    let turn = sheet.middle * k;
    let sinks_along = coupled - turn * sinks_under;
    WaveResponse {
        sinks: sinks(layer, skin, k),
        sinks_along,
        middle_along: along - turn * (coupled + sinks_along),
    }
}

/// How far the bare layer sinks under a pressure of wave number `k`.
pub fn bare(layer: Layer, k: f64) -> f64 {
    per(layer, k) * layer.transfer(k)
}

/// What transfer functions are over: `(1 - nu) / (G k)`.
fn per(layer: Layer, k: f64) -> f64 {
    (1.0 - layer.poisson_ratio) / k
}

/// Sinking under a pressure, of Navier's equations through the skin: waves `exp(k z)` and `exp(-k z)`, four constants; pressure 1 and no
/// force along at the top, and the layer's compliance at the bottom.
fn sinks(layer: Layer, skin: StiffSkin, k: f64) -> f64 {
    let below = Layer {
        thickness: layer.thickness - skin.thickness_mm,
        ..layer
    };
    let s = k * skin.thickness_mm;
    let nu = layer.poisson_ratio;
    let (top, bottom) = (waves(nu, 0.0, s), waves(nu, -s, s));
    let [z, r] = below.along(k);
    let compliance = Matrix2::new(below.transfer(k), z, z, r) * (1.0 - nu);
    let g = skin.ratio;
    let matrix = Matrix4::from_fn(|row, column| {
        let [_, _, pull, shear] = top[column];
        let [up, along, pull_below, shear_below] = bottom[column];
        let moved = compliance * Vector2::new(-g * pull_below, g * shear_below);
        match row {
            0 => g * pull,
            1 => g * shear,
            2 => up + moved.x,
            _ => along - moved.y,
        }
    });
    let side = Vector4::new(-1.0, 0.0, 0.0, 0.0);
    let constants = matrix.lu().solve(&side).unwrap_or_else(Vector4::zeros);
    -(0..4).map(|n| constants[n] * top[n][0]).sum::<f64>() / k
}

/// By constant: how far up and along a wave moves at height `z` (in 1/k) in a skin of thickness `s` (in 1/k), and over G its pull across
/// and along a level.
fn waves(nu: f64, z: f64, s: f64) -> [[f64; 4]; 4] {
    let kappa = 3.0 - 4.0 * nu;
    let (up, down) = (libm::exp(z), libm::exp(-z - s));
    [
        [up, -up, 2.0 * up, -2.0 * up],
        [
            z * up,
            -(kappa + z) * up,
            2.0 * (1.0 + z - 2.0 * nu) * up,
            -(1.0 + kappa + 2.0 * z) * up,
        ],
        [down, down, -2.0 * down, -2.0 * down],
        [
            z * down,
            (z - kappa) * down,
            2.0 * (1.0 - z - 2.0 * nu) * down,
            (1.0 + kappa - 2.0 * z) * down,
        ],
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    const LAYER: Layer = Layer {
        thickness: 5.0,
        poisson_ratio: 0.5,
    };

    fn skin(ratio: f64) -> StiffSkin {
        StiffSkin {
            thickness_mm: 0.8,
            ratio,
        }
    }

    #[test]
    fn a_skin_as_soft_as_the_layer_is_the_layer() {
        for nu in [0.5, 0.4] {
            let layer = Layer {
                poisson_ratio: nu,
                ..LAYER
            };
            for k in [0.05, 0.4, 2.0, 9.0] {
                let found = moved(layer, skin(1.0), k).sinks / bare(layer, k);
                assert!((found - 1.0).abs() < 1e-9, "{nu} {k}: {found}");
            }
        }
    }

    /// A force along the skin acts at its middle, half a thickness above the layer: the layer bears it with its moment, and the middle
    /// moves less than the layer where the skin turns.
    #[test]
    fn what_acts_along_a_skin_acts_at_its_middle() {
        let layer = Layer {
            poisson_ratio: 0.4,
            ..LAYER
        };
        let skin = skin(12.0);
        for k in [0.2, 0.9, 3.0] {
            let [w, coupled, v] = skin.sheet(0.4).moves(&layer, k);
            let both = Matrix2::new(w, coupled, coupled, v) * (0.6 / k);
            let at_middle = Vector2::new(-0.4 * k, 1.0);
            let found = moved(layer, skin, k);
            let wanted = [(both * at_middle).x, at_middle.dot(&(both * at_middle))];
            for (found, wanted) in [found.sinks_along, found.middle_along].iter().zip(wanted) {
                assert!((found / wanted - 1.0).abs() < 1e-9, "{k}: {found} {wanted}");
            }
        }
    }

    /// Waves that are short against the skin see a half space of the skin, long ones a thin plate on the layer.
    #[test]
    fn short_waves_see_the_skin_and_long_ones_a_plate() {
        let short = moved(LAYER, skin(20.0), 60.0).sinks * 60.0 / 0.5;
        assert!((short * 20.0 - 1.0).abs() < 1e-6, "{short}");
        let thin = StiffSkin {
            thickness_mm: 0.02,
            ratio: 4e4,
        };
        for k in [0.1, 0.5, 1.5] {
            let exact = moved(LAYER, thin, k).sinks;
            let plate = per(LAYER, k) * thin.sheet(0.5).transfer(&LAYER, k);
            assert!((exact / plate - 1.0).abs() < 2e-3, "{k}: {exact} {plate}");
        }
    }
}
