//! A stiff skin bonded to a layer: how both answer a load of one wave number. The layer's modulus G is 1.
//!
//! How far they sink under a pressure is exact: Navier's equations through the skin's own thickness, which lies on the layer's surface
//! compliance `C = (1 - nu) / k [[K, Z], [Z, R]]` (the sibling `bonded_layer`). What a force along the skin moves, and how far the skin's
//! middle moves along itself, are those of a thin plate on the same layer (as in the sibling `sheet`): they count where the contact is
//! wide against the skin.

use nalgebra::{Matrix2, Matrix4, Vector4};

use super::StiffSkin;
use crate::response::bonded_layer::Layer;

/// What a pressure p and a force along the skin f of one wave number move: downwards w, and along itself the skin's middle v.
#[derive(Debug, Clone, Copy)]
pub struct Moved {
    /// w under p, 1/k.
    pub sinks: f64,
    /// w under f.
    pub sinks_along: f64,
    /// v under p.
    pub middle: f64,
    /// v under f.
    pub middle_along: f64,
}

/// How a layer of which the skin is the uppermost part answers at wave number `k`, 1/mm.
pub fn moved(layer: Layer, skin: StiffSkin, k: f64) -> Moved {
    let taken = skin.thickness_mm * skin.beyond();
    let plate = plate(thinner(layer, taken), skin, k);
    let (b11, b12, b22) = (plate[(0, 0)], plate[(0, 1)], plate[(1, 1)]);
    let turn = 0.5 * skin.thickness_mm * k;
    let sinks_along = b12 - turn * b11;
    Moved {
        sinks: sinks(thinner(layer, skin.thickness_mm), skin, k),
        sinks_along,
        middle: sinks_along,
        middle_along: b22 - turn * b12 - turn * sinks_along,
    }
}

/// How far the bare layer sinks under a pressure of wave number `k`.
pub fn bare(layer: Layer, k: f64) -> f64 {
    (1.0 - layer.poisson_ratio) / k * layer.transfer(k)
}

fn thinner(layer: Layer, taken: f64) -> Layer {
    Layer {
        thickness: layer.thickness - taken,
        ..layer
    }
}

fn compliance(layer: Layer, k: f64) -> Matrix2<f64> {
    let [z, r] = layer.along(k);
    Matrix2::new(layer.transfer(k), z, z, r) * ((1.0 - layer.poisson_ratio) / k)
}

/// Inverse of the stiffness of layer and thin plate together, for sinking and for moving the layer's surface along itself.
fn plate(below: Layer, skin: StiffSkin, k: f64) -> Matrix2<f64> {
    let (bending, stretch) = (skin.bending(), skin.stretch());
    let turn = 0.5 * skin.thickness_mm * k;
    let kk = k * k;
    let stiffness = Matrix2::new(
        bending * kk * kk + stretch * kk * turn * turn,
        -stretch * kk * turn,
        -stretch * kk * turn,
        stretch * kk,
    );
    let compliance = compliance(below, k);
    let both = Matrix2::identity() + stiffness * compliance;
    both.try_inverse()
        .map_or(compliance, |inverse| compliance * inverse)
}

/// Sinking under a pressure, of Navier's equations through the skin: waves `exp(k z)` and `exp(-k z)`, four constants; pressure 1 and no
/// force along at the top, and the layer's compliance at the bottom.
fn sinks(below: Layer, skin: StiffSkin, k: f64) -> f64 {
    let nu = below.poisson_ratio;
    let s = k * skin.thickness_mm;
    let (top, bottom) = (waves(nu, 0.0, s), waves(nu, -s, s));
    let compliance = compliance(below, k) * k;
    let g = skin.ratio;
    let matrix = Matrix4::from_fn(|row, column| {
        let [_, _, pull, shear] = top[column];
        let [up, along, pull_below, shear_below] = bottom[column];
        let load = nalgebra::Vector2::new(-g * pull_below, g * shear_below);
        let moved = compliance * load;
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
            let plate = plate(thinner(LAYER, 0.02), thin, k)[(0, 0)];
            assert!((exact / plate - 1.0).abs() < 2e-3, "{k}: {exact} {plate}");
        }
    }
}
