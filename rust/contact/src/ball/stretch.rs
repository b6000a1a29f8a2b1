//! The stretch of a stiff skin that is pressed deep: a plate of large deflections (von Karman; Timoshenko & Woinowsky-Krieger 1959, 96).
//!
//! Outwards the skin carries `N = M (v' + v / 2r + w'^2 / 2)` per width, v how far its middle moves outwards and w how far down; under a
//! slope w' this tension bears `-(r N w')' / r` of the pressure, and pulls the skin along by the tension of `w'^2 / 2`. Both are found
//! together with the contact: for a known tension everything is linear in the pressure, and the tension is found in turns.

use nalgebra::{DMatrix, DVector};

use super::StiffSkin;
use super::layers::{Moved, moved};
use super::rings::Rings;
use crate::response::bonded_layer::Layer;

/// Part of a new tension that is taken in a turn, relative change of the force that ends them, and how many there are at most.
const TAKEN: f64 = 0.6;
const SAME: f64 = 1e-4;
const TURNS: usize = 60;

/// What pressures on rings, and tensions of `w'^2 / 2` at their edges, do: matrices, for G = 1.
pub struct Stretching {
    /// How far down rings move: under pressures, and under tensions.
    pub sunk: [DMatrix<f64>; 2],
    /// Slopes at the edges.
    slopes: [DMatrix<f64>; 2],
    /// Tension at the edges by the motion along, without that of `w'^2 / 2`, N/mm.
    tension: [DMatrix<f64>; 2],
    /// Stiffness against stretch beyond that of pulp, mm.
    stretch: f64,
}

impl Stretching {
    /// Of a layer of which the skin is the uppermost part.
    pub fn new(rings: &Rings, layer: Layer, skin: StiffSkin) -> Stretching {
        let answers: Vec<Moved> = rings.waves.iter().map(|k| moved(layer, skin, *k)).collect();
        let by_wave = |loads: &DMatrix<f64>, of: fn(&Moved) -> f64| {
            DMatrix::from_fn(loads.nrows(), loads.ncols(), |n, i| {
                of(&answers[n]) * loads[(n, i)]
            })
        };
        let (pressures, tensions) = (rings.pressures(), rings.tensions());
        let down = [
            by_wave(&pressures, |m| m.sinks),
            by_wave(&tensions, |m| m.sinks_along),
        ];
        let along = [
            by_wave(&pressures, |m| m.middle),
            by_wave(&tensions, |m| m.middle_along),
        ];
        let stretch = skin.stretch() * skin.beyond();
        Stretching {
            sunk: [rings.sunk(&down[0]), rings.sunk(&down[1])],
            slopes: [rings.slopes(&down[0]), rings.slopes(&down[1])],
            tension: along.map(|waves| rings.strains(&waves) * stretch),
            stretch,
        }
    }

    /// Forces over G, mm2, at rising `depths` of a ball; `touch` solves the contact of a compliance and gaps. None where the tension
    /// does not settle.
    pub fn forces(
        &self,
        rings: &Rings,
        gap: &dyn Fn(f64) -> DVector<f64>,
        (depths, touch): (&[f64], Touch<'_>),
    ) -> Option<Vec<f64>> {
        let mut state = State {
            tension: DVector::zeros(rings.edges.len()),
            own: DVector::zeros(rings.edges.len()),
        };
        let mut last = 0.0f64;
        depths
            .iter()
            .map(|&depth| {
                if last > 0.0 {
                    state.tension *= depth / last;
                    state.own *= depth / last;
                }
                last = depth;
                let gaps = gap(depth);
                let mut force = 0.0;
                for _ in 0..TURNS {
                    let before = force;
                    force = self.turn(rings, (&gaps, touch), &mut state)?;
                    if (force - before).abs() <= SAME * force {
                        return Some(force);
                    }
                }
                None
            })
            .collect()
    }

    /// One turn: the contact under the tension that is known, then the tension of this contact. Returns the force.
    fn turn(
        &self,
        rings: &Rings,
        (gaps, touch): (&DVector<f64>, Touch<'_>),
        state: &mut State,
    ) -> Option<f64> {
        let edges = rings.edges.len();
        // Pressure that the tension bears, by slopes.
        let borne = |slopes: &DMatrix<f64>| {
            DMatrix::from_fn(rings.len(), slopes.ncols(), |i, j| {
                let flux = |e: usize| rings.edges[e] * state.tension[e] * slopes[(e, j)];
                (flux(i) - flux(i + 1)) / rings.half_area(i)
            })
        };
        let bears = borne(&DMatrix::identity(edges, edges));
        let loop_back = DMatrix::identity(edges, edges) + &self.slopes[0] * &bears;
        let inverse = loop_back.try_inverse()?;
        let under_pressure = &inverse * &self.slopes[0];
        let under_own = &inverse * (&self.slopes[1] * &state.own);
        let compliance = &self.sunk[0] - &self.sunk[0] * (&bears * &under_pressure);
        let lifted = &self.sunk[1] * &state.own - &self.sunk[0] * (&bears * &under_own);
        let pressure = touch(&compliance, &(gaps - lifted));
        let slopes = under_pressure * &pressure + under_own;
        let own = slopes.map(|slope| 0.5 * self.stretch * slope * slope);
        let rest = &pressure - bears * slopes;
        let tension = &self.tension[0] * rest + &self.tension[1] * &own + &own;
        state.tension += (tension - &state.tension) * TAKEN;
        state.own += (own - &state.own) * TAKEN;
        Some(rings.force(&pressure))
    }
}

/// Pressures on rings of a compliance and gaps.
pub type Touch<'a> = &'a dyn Fn(&DMatrix<f64>, &DVector<f64>) -> DVector<f64>;

/// Tension at the edges, and the part of it that is of `w'^2 / 2`, over G, mm.
struct State {
    tension: DVector<f64>,
    own: DVector<f64>,
}
