//! Rings about a ball's axis, and the sums over wave numbers between what bears on some and what moves at others.
//!
//! A pressure is even over each ring; slopes, tension and stretch stand at the rings' edges. Fields that are even all around are sums of
//! waves J0(k r), what points outwards of waves J1(k r) (Hankel's transform).

use libm::{j0, j1};
use nalgebra::DMatrix;

/// Rings, the part of them that is evenly wide, and wave numbers.
const RINGS: usize = 72;
const EVEN: usize = 50;
const WAVES: usize = 1500;
/// Wave numbers reach to this over the width of an even ring, and fade from this part of them.
const END_IN_WIDTHS: f64 = 3.2;
const FADE: f64 = 0.6;

/// Rings and wave numbers, with the waves at the rings.
pub struct Rings {
    /// Edges, mm, from 0.
    pub edges: Vec<f64>,
    /// Wave numbers, 1/mm.
    pub waves: Vec<f64>,
    /// By wave: k dk, faded at the end.
    weight: Vec<f64>,
    /// J0 at the middles of rings, by wave and ring.
    middles: DMatrix<f64>,
    /// J0 and J1 at the edges, by wave and edge.
    edges0: DMatrix<f64>,
    edges1: DMatrix<f64>,
}

impl Rings {
    /// Even rings as far as `core`, mm, and wider ones as far as `reach`.
    pub fn new(core: f64, reach: f64) -> Rings {
        let even = (0..=EVEN).map(|n| core * n as f64 / EVEN as f64);
        let wider = (1..=RINGS - EVEN)
            .map(|n| core * (reach / core).powf(n as f64 / (RINGS - EVEN) as f64));
        let edges: Vec<f64> = even.chain(wider).collect();
        let end = END_IN_WIDTHS * EVEN as f64 / core;
        let share = |n: usize| (n as f64 + 0.5) / WAVES as f64;
        let waves: Vec<f64> = (0..WAVES).map(|n| end * share(n).powf(1.5)).collect();
        let weight = |n: usize| {
            let width = end * 1.5 * share(n).sqrt() / WAVES as f64;
            let fades = waves[n] / (FADE * end);
            waves[n] * width * libm::exp(-fades.powi(4))
        };
        let at = |wave: fn(f64) -> f64, places: &[f64]| {
            DMatrix::from_fn(WAVES, places.len(), |n, i| wave(waves[n] * places[i]))
        };
        let middles: Vec<f64> = edges.windows(2).map(|e| 0.5 * (e[0] + e[1])).collect();
        Rings {
            weight: (0..WAVES).map(weight).collect(),
            middles: at(j0, &middles),
            edges0: at(j0, &edges),
            edges1: at(j1, &edges),
            edges,
            waves,
        }
    }

    /// Number of rings.
    pub fn len(&self) -> usize {
        self.edges.len() - 1
    }

    /// Radius of a ring's middle, mm.
    pub fn middle(&self, ring: usize) -> f64 {
        0.5 * (self.edges[ring] + self.edges[ring + 1])
    }

    /// Part of a ring's area over 2 pi, mm2.
    pub fn half_area(&self, ring: usize) -> f64 {
        0.5 * (self.edges[ring + 1].powi(2) - self.edges[ring].powi(2))
    }

    /// By wave and ring: the wave's part of a unit pressure on the ring.
    pub fn pressures(&self) -> DMatrix<f64> {
        DMatrix::from_fn(self.waves.len(), self.len(), |n, i| {
            let part = |edge: usize| self.edges[edge] * self.edges1[(n, edge)];
            (part(i + 1) - part(i)) / self.waves[n]
        })
    }

    /// By wave and edge: the wave's part of the force along the skin that balances a stretch's tension there, which is half as large all
    /// around as outwards: the transform of `(r N)' / r - N / (2 r)`, by parts.
    pub fn tensions(&self) -> DMatrix<f64> {
        let last = self.edges.len() - 1;
        let width = |i: usize| 0.5 * (self.edges[(i + 1).min(last)] - self.edges[i.max(1) - 1]);
        DMatrix::from_fn(self.waves.len(), self.edges.len(), |n, i| {
            let turning = self.waves[n] * self.edges[i] * self.edges0[(n, i)];
            width(i) * (0.5 * self.edges1[(n, i)] - turning)
        })
    }

    /// How far down the middles of rings move under loads given by wave.
    pub fn sunk(&self, waves: &DMatrix<f64>) -> DMatrix<f64> {
        self.sum(&self.middles, |_, _, j| j, waves)
    }

    /// Slope outwards, at the edges, of what moves down so.
    pub fn slopes(&self, waves: &DMatrix<f64>) -> DMatrix<f64> {
        self.sum(&self.edges1, |n, _, j| -self.waves[n] * j, waves)
    }

    /// Strain outwards and half the strain all around, added, at the edges, of what moves outwards so.
    pub fn strains(&self, waves: &DMatrix<f64>) -> DMatrix<f64> {
        let strain = |n: usize, edge: usize, j: f64| {
            let k = self.waves[n];
            let around = match self.edges[edge] {
                0.0 => 0.5 * k,
                r => self.edges1[(n, edge)] / r,
            };
            k * j - 0.5 * around
        };
        self.sum(&self.edges0, strain, waves)
    }

    fn sum(
        &self,
        table: &DMatrix<f64>,
        of: impl Fn(usize, usize, f64) -> f64,
        waves: &DMatrix<f64>,
    ) -> DMatrix<f64> {
        let weighed = DMatrix::from_fn(table.nrows(), table.ncols(), |n, i| {
            self.weight[n] * of(n, i, table[(n, i)])
        });
        weighed.tr_mul(waves)
    }
}
