//! Membrane tension of a stiff skin at large deflection (von Karman plate; Timoshenko & Woinowsky-Krieger 1959, 96).
//!
//! Outwards the skin carries `N = M (v' + v / 2r + w'^2 / 2)` per width, v how far its middle moves outwards and w how far down; under a
//! slope w' this tension bears `-(r N w')' / r` of the pressure, and pulls the skin along by the tension of `w'^2 / 2`. Both are found
//! together with the contact: for a known tension everything is linear in the pressure, and the tension is found in turns.

use nalgebra::{DMatrix, DVector};

use super::ring_contact::touch;
use super::ring_quadrature::Rings;
use super::stiff_skin::StiffSkin;
use super::wave_response::moved;
use crate::response::bonded_layer::Layer;

/// Part of a new tension that is taken in a turn, relative change of the force that ends them, and how many there are at most.
const TAKEN: f64 = 0.6;
const SAME: f64 = 1e-4;
const TURNS: usize = 60;

/// What pressures on rings, and tensions of `w'^2 / 2` at their edges, do: matrices, for G = 1.
pub struct MembraneTension {
    /// How far down rings move: under pressures, and under tensions.
    sunk: [DMatrix<f64>; 2],
    /// Slopes at the edges.
    slopes: [DMatrix<f64>; 2],
    /// Strain outwards and half of that all around, at the edges, by the motion along.
    strains: [DMatrix<f64>; 2],
    /// Stiffness against stretch beyond that of pulp, mm.
    stretch: f64,
}

/// A contact under a tension that was known before.
struct Pressed {
    /// On the ball.
    pressure: DVector<f64>,
    /// The part of it that the tension does not bear.
    rest: DVector<f64>,
    /// The tension of `w'^2 / 2` at the edges, over G, mm.
    own: DVector<f64>,
}

/// Tension at the edges, and the part of it that is of `w'^2 / 2`, over G, mm.
struct State {
    tension: DVector<f64>,
    own: DVector<f64>,
}

impl MembraneTension {
    /// Of a layer of which the skin is the uppermost part.
    pub fn new(rings: &Rings, layer: Layer, skin: StiffSkin) -> MembraneTension {
        let down = [
            rings.under_pressure(|k| moved(layer, skin, k).sinks),
            rings.under_tension(|k| moved(layer, skin, k).sinks_along),
        ];
        let along = [
            rings.under_pressure(|k| moved(layer, skin, k).sinks_along),
            rings.under_tension(|k| moved(layer, skin, k).middle_along),
        ];
        MembraneTension {
            sunk: down.each_ref().map(|waves| rings.sunk(waves)),
            slopes: down.each_ref().map(|waves| rings.slopes(waves)),
            strains: along.map(|waves| rings.strains(&waves)),
            stretch: skin.stretch(),
        }
    }

    /// Forces over G, mm2, at rising `depths` of a ball. None where the tension does not settle.
    pub fn forces(&self, rings: &Rings, radius: f64, depths: &[f64]) -> Option<Vec<f64>> {
        let presses = self.presses(rings, radius, depths)?;
        Some(presses.iter().map(|p| rings.force(&p.pressure)).collect())
    }

    fn presses(&self, rings: &Rings, radius: f64, depths: &[f64]) -> Option<Vec<Pressed>> {
        let nothing = DVector::zeros(rings.edges.len());
        let mut state = State {
            tension: nothing.clone(),
            own: nothing,
        };
        let mut last = depths.first().copied()?;
        let one = |depth: &f64| {
            state.tension *= depth / last;
            state.own *= depth / last;
            last = *depth;
            self.settled(rings, &rings.gaps(radius, *depth), &mut state)
        };
        depths.iter().map(one).collect()
    }

    /// The contact whose tension is the one that it gives.
    fn settled(&self, rings: &Rings, gaps: &DVector<f64>, state: &mut State) -> Option<Pressed> {
        let mut before = 0.0;
        for _ in 0..TURNS {
            let pressed = self.pressed(rings, gaps, state)?;
            let tension = self.along(&pressed) * self.stretch + &pressed.own;
            state.tension += (tension - &state.tension) * TAKEN;
            state.own += (&pressed.own - &state.own) * TAKEN;
            let force = rings.force(&pressed.pressure);
            if (force - before).abs() <= SAME * force {
                return Some(pressed);
            }
            before = force;
        }
        None
    }

    /// The contact under the tension that is known.
    fn pressed(&self, rings: &Rings, gaps: &DVector<f64>, state: &State) -> Option<Pressed> {
        let edges = rings.edges.len();
        // The pressure on a ring that the tension bears, by slopes: what flows in at its inner edge less what flows out.
        let bears = DMatrix::from_fn(rings.len(), edges, |ring, edge| {
            let flows = rings.edges[edge] * state.tension[edge] / rings.half_area(ring);
            match edge {
                inner if inner == ring => flows,
                outer if outer == ring + 1 => -flows,
                _ => 0.0,
            }
        });
        let fed_back = DMatrix::identity(edges, edges) + &self.slopes[0] * &bears;
        let inverse = fed_back.try_inverse()?;
        let by_pressure = &inverse * &self.slopes[0];
        let by_own = &inverse * (&self.slopes[1] * &state.own);
        let compliance = &self.sunk[0] - &self.sunk[0] * (&bears * &by_pressure);
        let lifted = &self.sunk[1] * &state.own - &self.sunk[0] * (&bears * &by_own);
        let pressure = touch(&compliance, &(gaps - lifted));
        let slopes = by_pressure * &pressure + by_own;
        Some(Pressed {
            rest: &pressure - bears * &slopes,
            own: slopes.map(|slope| 0.5 * self.stretch * slope * slope),
            pressure,
        })
    }

    /// Strains of the motion along.
    fn along(&self, pressed: &Pressed) -> DVector<f64> {
        &self.strains[0] * &pressed.rest + &self.strains[1] * &pressed.own
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sphere_indentation::ring_quadrature::width;
    use std::f64::consts::TAU;

    /// What the layers store, what the stretch of `w'^2 / 2` stores by itself, and what it stores against the strain of the motion along.
    fn stored(of: &MembraneTension, rings: &Rings, pressed: &Pressed) -> f64 {
        let sunk = &of.sunk[0] * &pressed.rest + &of.sunk[1] * &pressed.own;
        let strain = of.along(pressed);
        let by_ring = |i: usize| TAU * rings.half_area(i) * pressed.rest[i] * sunk[i];
        let by_edge = |i: usize| {
            let own = pressed.own[i];
            TAU * rings.edges[i] * width(&rings.edges, i) * own * (strain[i] + own / of.stretch)
        };
        let rings_store: f64 = (0..rings.len()).map(by_ring).sum();
        let edges_store: f64 = (0..rings.edges.len()).map(by_edge).sum();
        0.5 * (rings_store + edges_store)
    }

    /// Nothing is lost in springs: the force's work is the energy that layers and stretch store. A wrong tension, or one that pulls
    /// otherwise than it stretches, breaks this by more than the steps of depth do.
    #[test]
    fn the_work_of_the_force_is_stored() {
        let layer = Layer {
            thickness: 5.5,
            poisson_ratio: 0.5,
        };
        let depths: Vec<f64> = (1..=60).map(|k| 0.8 * f64::from(k) / 60.0).collect();
        for (radius, thickness_mm, ratio) in
            [(5.0, 0.4, 20.0), (11.0, 0.3, 60.0), (28.0, 0.7, 20.0)]
        {
            let contact = f64::sqrt(0.8 * radius);
            let rings = Rings::new(1.6 * contact, 3.0 * contact + 9.0);
            let skin = StiffSkin {
                thickness_mm,
                ratio,
            };
            let stretching = MembraneTension::new(&rings, layer, skin);
            let presses = stretching.presses(&rings, radius, &depths).unwrap();
            let force = |p: &Pressed| rings.force(&p.pressure);
            let stored = |p: &Pressed| stored(&stretching, &rings, p);
            let worked: f64 = presses
                .windows(2)
                .map(|two| 0.5 * (force(&two[0]) + force(&two[1])) * depths[0])
                .sum();
            let gained = stored(&presses[59]) - stored(&presses[0]);
            println!(
                "ball of {radius} mm: {:+.2} %",
                100.0 * (gained / worked - 1.0)
            );
            assert!(
                (gained / worked - 1.0).abs() < 2e-3,
                "{radius}: {gained} {worked}"
            );
        }
    }
}
