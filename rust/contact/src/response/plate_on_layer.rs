//! A thin stiff plate bonded to a layer: the transfer function of both together.
//!
//! A plate on top has a bending stiffness D, a stiffness M against stretch (force per width and strain), a tension N, and lies with its
//! middle c above the layer's surface (Timoshenko & Woinowsky-Krieger 1959, 1 and 8; Kirchhoff). With K, Z and R of the layer (the sibling
//! `bonded_layer`), Q = K R - Z^2, b = (1 - nu) D / G, t = (1 - nu) N / G, m = (1 - nu) M / G and f = b k^3 + t k, layer and plate
//! together sink by the transfer function
//!
//!   (K + m k Q) / (1 + m k R + K (f + m c^2 k^3) - 2 Z m c k^2 + Q m k f),
//!
//! the sinking part of the inverse of `C^-1 + S`, C the layer's compliance and S the plate's stiffness for sinking and for moving
//! along. A layer that is thin against the contact gives way by flowing along itself, which the plate hinders; without M it is
//! `K / (1 + K f)`. The thickness of soft tissue over bone is measured from the skin's outer side, so that the layer is what the plate
//! leaves of it. Under f along the skin and in how far the layer's surface moves along itself, both together have `Z + m c k Q` and
//! `R + Q (f + m c^2 k^3)` over the same.

use super::bonded_layer::Layer;

/// A stiff skin in terms of the tissue below.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sheet {
    /// b = (1 - nu) D / G, mm3.
    pub bending: f64,
    /// t = (1 - nu) N / G, mm.
    pub tension: f64,
    /// m = (1 - nu) M / G, mm.
    pub stretch: f64,
    /// c, mm.
    pub middle: f64,
    /// What the skin takes of the thickness, mm.
    pub takes: f64,
}

/// Most of a layer's thickness that skins take.
const MOST_TAKEN: f64 = 0.5;

impl Sheet {
    /// No skin of its own.
    pub const NONE: Sheet = Sheet {
        bending: 0.0,
        tension: 0.0,
        stretch: 0.0,
        middle: 0.0,
        takes: 0.0,
    };

    /// Two skins in one place: their stiffness adds up, about the middle of both.
    pub fn with(&self, more: &Sheet) -> Sheet {
        let stretch = self.stretch + more.stretch;
        let moment = self.middle * self.stretch + more.middle * more.stretch;
        Sheet {
            bending: self.bending + more.bending,
            tension: self.tension + more.tension,
            stretch,
            middle: if stretch > 0.0 { moment / stretch } else { 0.0 },
            takes: self.takes + more.takes,
        }
    }

    /// Transfer function of a layer with it at wave number `k` (1/mm).
    pub fn transfer(&self, layer: &Layer, k: f64) -> f64 {
        self.moves(layer, k)[0]
    }

    /// How a layer with it moves at wave number `k` (1/mm): `[K, Z, R]`, as those of the layer (`Layer::along`).
    pub fn moves(&self, layer: &Layer, k: f64) -> [f64; 3] {
        let taken = self.takes.min(MOST_TAKEN * layer.thickness);
        let below = Layer {
            thickness: layer.thickness - taken,
            ..*layer
        };
        let bare = below.transfer(k);
        let [z, r] = below.along(k);
        let (m, c) = (self.stretch * k, self.middle * k);
        let f = k * (self.bending * k * k + self.tension);
        let q = bare * r - z * z;
        let whole = 1.0 + m * r + bare * (f + m * c * c) - 2.0 * z * m * c + q * m * f;
        [bare + m * q, z + m * c * q, r + (f + m * c * c) * q].map(|part| part / whole)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HALF_SPACE: Layer = Layer {
        thickness: f64::INFINITY,
        poisson_ratio: 0.5,
    };

    /// A skin that cannot be stretched holds the surface, so that the layer sinks as one between two plates: for long waves a fourth
    /// as far (lubrication: h^3 / 12 instead of h^3 / 3).
    #[test]
    fn a_skin_that_is_not_stretched_makes_a_thin_layer_four_times_as_stiff() {
        let layer = Layer {
            thickness: 5.0,
            poisson_ratio: 0.5,
        };
        let sheet = Sheet {
            stretch: 1e9,
            ..Sheet::NONE
        };
        let k = 0.01 / layer.thickness;
        let share = sheet.transfer(&layer, k) / layer.transfer(k);
        assert!((share - 0.25).abs() < 1e-3, "{share}");
        // Under a half space with nu = 1/2 the surface moves along itself only where the plate turns about its middle.
        let short = Sheet {
            stretch: 3.0,
            ..Sheet::NONE
        };
        assert!((short.transfer(&HALF_SPACE, 0.7) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn a_skin_leaves_a_thinner_layer_and_at_least_half_of_it() {
        let layer = |thickness| Layer {
            thickness,
            poisson_ratio: 0.5,
        };
        for (takes, left) in [(1.0, 4.0), (4.0, 2.5)] {
            let sheet = Sheet {
                takes,
                ..Sheet::NONE
            };
            let found = sheet.transfer(&layer(5.0), 0.3);
            assert_eq!(found, layer(left).transfer(0.3));
        }
        let half_space = Sheet {
            takes: 0.5,
            ..Sheet::NONE
        };
        assert_eq!(half_space.transfer(&HALF_SPACE, 0.3), 1.0);
    }

    /// The plate's stiffness from its energy: `D k^4 w^2 + N k^2 w^2 + M k^2 (v - c k w)^2`, halved, w how far it sinks and v how far
    /// the layer's surface moves along itself; as it sinks, its lower side is stretched.
    #[test]
    fn layer_and_plate_sink_by_the_inverse_of_their_stiffness() {
        let layer = Layer {
            thickness: 2.0,
            poisson_ratio: 0.4,
        };
        let sheet = Sheet {
            bending: 0.7,
            tension: 0.2,
            stretch: 1.5,
            middle: 0.4,
            takes: 0.0,
        };
        for k in [0.2, 0.8, 2.0] {
            let [z, r] = layer.along(k);
            let compliance = nalgebra::Matrix2::new(layer.transfer(k), z, z, r);
            let turn = nalgebra::Vector2::new(-sheet.middle * k, 1.0);
            let mut stiffness = sheet.stretch * k * turn * turn.transpose();
            stiffness[(0, 0)] += sheet.bending * k.powi(3) + sheet.tension * k;
            let both = compliance.try_inverse().unwrap() + stiffness;
            let wanted = both.try_inverse().unwrap();
            let found = sheet.moves(&layer, k);
            for (found, place) in found.iter().zip([(0, 0), (0, 1), (1, 1)]) {
                let wanted = wanted[place];
                assert!((found - wanted).abs() < 1e-12, "{k}: {found} {wanted}");
            }
            assert_eq!(sheet.transfer(&layer, k), found[0]);
        }
    }

    #[test]
    fn two_skins_are_one_of_both() {
        let one = Sheet {
            bending: 1.0,
            tension: 2.0,
            stretch: 3.0,
            middle: 0.1,
            takes: 0.5,
        };
        let both = one.with(&Sheet { middle: 0.3, ..one });
        let wanted = Sheet {
            bending: 2.0,
            tension: 4.0,
            stretch: 6.0,
            middle: 0.2,
            takes: 1.0,
        };
        assert!((both.middle - wanted.middle).abs() < 1e-12);
        assert_eq!(
            Sheet {
                middle: 0.2,
                ..both
            },
            wanted
        );
        assert_eq!(Sheet::NONE.with(&Sheet::NONE), Sheet::NONE);
    }
}
