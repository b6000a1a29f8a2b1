//! Rings about the axis, and the Hankel quadrature between loads and displacements on them.
//!
//! A pressure is even over each ring; slopes, tension and stretch stand at the rings' edges. Fields that are even all around are sums of
//! waves J0(k r), what points outwards of waves J1(k r) (Hankel's transform).

use std::f64::consts::TAU;

use libm::{j0, j1};
use nalgebra::{DMatrix, DVector};

/// Rings, the part of them that is evenly wide, and wave numbers.
const RINGS: usize = 72;
const EVEN: usize = 50;
const WAVES: usize = 1500;
/// Wave numbers reach to this over the width of an even ring, and fade from this part of them.
const END_IN_WIDTHS: f64 = 3.2;
const FADE: f64 = 0.6;

/// Rings and wave numbers, with the waves at the rings; tables are by wave, and by ring or edge.
pub struct Rings {
    /// Edges, mm, from 0.
    pub edges: Vec<f64>,
    /// Wave numbers, 1/mm.
    waves: Vec<f64>,
    /// A wave's part of a unit pressure on a ring.
    pressures: DMatrix<f64>,
    /// A wave's part of the force along the skin that balances a stretch's tension at an edge, which is half as large all around as
    /// outwards: the transform of `(r N)' / r - N / (2 r)`, by parts.
    tensions: DMatrix<f64>,
    /// How far the middle of a ring goes down in a wave that does.
    sinking: DMatrix<f64>,
    /// The slope of that at an edge, outwards.
    sloping: DMatrix<f64>,
    /// Strain outwards and half the strain all around, added, at an edge, in a wave that goes outwards.
    straining: DMatrix<f64>,
}

impl Rings {
    /// Even rings as far as `core`, mm, and wider ones as far as `reach`.
    pub fn new(core: f64, reach: f64) -> Rings {
        let even = (0..=EVEN).map(|n| core * n as f64 / EVEN as f64);
        let growth = |n: usize| (reach / core).powf(n as f64 / (RINGS - EVEN) as f64);
        let edges: Vec<f64> = even
            .chain((1..=RINGS - EVEN).map(|n| core * growth(n)))
            .collect();
        let end = END_IN_WIDTHS * EVEN as f64 / core;
        let share = |n: usize| (n as f64 + 0.5) / WAVES as f64;
        let waves: Vec<f64> = (0..WAVES).map(|n| end * share(n).powf(1.5)).collect();
        // k dk, faded at the end.
        let weight = |n: usize| {
            let width = end * 1.5 * share(n).sqrt() / WAVES as f64;
            waves[n] * width * libm::exp(-(waves[n] / (FADE * end)).powi(4))
        };
        let at = |wave: fn(f64) -> f64, places: &[f64]| {
            DMatrix::from_fn(WAVES, places.len(), |n, i| wave(waves[n] * places[i]))
        };
        let middles: Vec<f64> = edges.windows(2).map(|e| 0.5 * (e[0] + e[1])).collect();
        let (edges0, edges1) = (at(j0, &edges), at(j1, &edges));
        let strain = |n: usize, i: usize| {
            let (k, r) = (waves[n], edges[i]);
            let around = if r > 0.0 { edges1[(n, i)] / r } else { 0.5 * k };
            k * edges0[(n, i)] - 0.5 * around
        };
        let by_edge = |of: &dyn Fn(usize, usize) -> f64| DMatrix::from_fn(WAVES, edges.len(), of);
        Rings {
            pressures: pressures((&edges, &waves), &edges1),
            tensions: tensions((&edges, &waves), (&edges0, &edges1)),
            sinking: at(j0, &middles).map_with_location(|n, _, wave: f64| weight(n) * wave),
            sloping: by_edge(&|n, i| -weight(n) * waves[n] * edges1[(n, i)]),
            straining: by_edge(&|n, i| weight(n) * strain(n, i)),
            edges,
            waves,
        }
    }

    /// Number of rings.
    pub fn len(&self) -> usize {
        self.edges.len() - 1
    }

    /// Part of a ring's area over 2 pi, mm2.
    pub fn half_area(&self, ring: usize) -> f64 {
        0.5 * (self.edges[ring + 1].powi(2) - self.edges[ring].powi(2))
    }

    /// How far a ball of `radius` at `depth`, mm, overlaps rings at rest.
    pub fn gaps(&self, radius: f64, depth: f64) -> DVector<f64> {
        let middle = |ring: usize| 0.5 * (self.edges[ring] + self.edges[ring + 1]);
        let above = |r: f64| match r < radius {
            true => radius - (radius * radius - r * r).sqrt(),
            false => f64::INFINITY,
        };
        DVector::from_fn(self.len(), |ring, _| depth - above(middle(ring)))
    }

    /// Sum of pressures over their rings.
    pub fn force(&self, pressure: &DVector<f64>) -> f64 {
        let one = |(ring, p): (usize, &f64)| TAU * self.half_area(ring) * p;
        pressure.iter().enumerate().map(one).sum()
    }

    /// Waves of unit pressures on rings, each times what `answer` gives for its number.
    pub fn under_pressure(&self, answer: impl Fn(f64) -> f64) -> DMatrix<f64> {
        self.answered(&self.pressures, answer)
    }

    /// Waves of unit tensions at edges, each times what `answer` gives for its number.
    pub fn under_tension(&self, answer: impl Fn(f64) -> f64) -> DMatrix<f64> {
        self.answered(&self.tensions, answer)
    }

    fn answered(&self, loads: &DMatrix<f64>, answer: impl Fn(f64) -> f64) -> DMatrix<f64> {
        let mut waves = loads.clone();
        for (mut row, k) in waves.row_iter_mut().zip(&self.waves) {
            row *= answer(*k);
        }
        waves
    }

    /// How far down the middles of rings move in such waves.
    pub fn sunk(&self, waves: &DMatrix<f64>) -> DMatrix<f64> {
        self.sinking.tr_mul(waves)
    }

    /// Slope outwards, at the edges, of what moves down so.
    pub fn slopes(&self, waves: &DMatrix<f64>) -> DMatrix<f64> {
        self.sloping.tr_mul(waves)
    }

    /// Strain outwards and half the strain all around, added, at the edges, of what moves outwards so.
    pub fn strains(&self, waves: &DMatrix<f64>) -> DMatrix<f64> {
        self.straining.tr_mul(waves)
    }
}

fn pressures((edges, waves): (&[f64], &[f64]), edges1: &DMatrix<f64>) -> DMatrix<f64> {
    DMatrix::from_fn(waves.len(), edges.len() - 1, |n, i| {
        let part = |edge: usize| edges[edge] * edges1[(n, edge)];
        (part(i + 1) - part(i)) / waves[n]
    })
}

fn tensions(
    (edges, waves): (&[f64], &[f64]),
    (edges0, edges1): (&DMatrix<f64>, &DMatrix<f64>),
) -> DMatrix<f64> {
    DMatrix::from_fn(waves.len(), edges.len(), |n, i| {
        let turning = waves[n] * edges[i] * edges0[(n, i)];
        width(edges, i) * (0.5 * edges1[(n, i)] - turning)
    })
}

/// Width of an edge: half of both adjacent rings, mm.
pub fn width(edges: &[f64], edge: usize) -> f64 {
    0.5 * (edges[(edge + 1).min(edges.len() - 1)] - edges[edge.max(1) - 1])
}
