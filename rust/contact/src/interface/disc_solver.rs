//! The friction solver: minimizes `q A q / 2 + b q` over discs `|q_i| <= r_i`, with a certificate.
//!
//! Semismooth Newton on `q = P(q - g / d)` (Hintermueller, Ito & Kunisch 2003): sites inside their disc are free, those on its
//! rim turn along it, and what remains is symmetric and definite, so conjugate gradients solve it in the tangent space. Where
//! a step does not get better, projected gradients take over, which always do.

use super::shear_matrix::{Planar, ShearMatrix};
use crate::Control;
use crate::solve::row_runs::Entry;

/// Residual that ends a solve, relative to the largest offset.
pub const TOLERANCE: f64 = 1e-10;
/// Most Newton steps.
const MOST_PASSES: usize = 60;
/// Projected-gradient steps after a Newton step that did not get better.
const GRADIENT_STEPS: usize = 12;
/// Loosest accuracy of the inner conjugate gradients.
const LOOSEST: f64 = 0.1;
/// Finest: a system kept in single precision is not worth more.
const FINEST: f64 = 1e-6;
/// Share of the tolerance at which the last correction may end.
const ENOUGH: f64 = 0.1;
/// Share of its residual to which a Newton step must get to need no check of the energy.
const CLEAR_GAIN: f64 = 0.7;

/// Forces in the discs and what is left of the equations.
#[derive(Debug, Clone, PartialEq)]
pub struct DiscSolution {
    /// First components, then second ones, N.
    pub force: Planar,
    /// `A q + b`, mm: zero where `|q_i| < r_i`, else against the force.
    pub slip: Planar,
    /// Largest `d_i |q_i - P(q_i - slip_i / d_i)|`, relative to the largest offset.
    pub residual: f64,
    /// Newton steps.
    pub passes: usize,
    /// Products with the matrix.
    pub products: usize,
}

/// Solves the discs of `radius` (N) under `offset` (mm), from the feasible part of `start`.
///
/// Always ends; how well is in [`DiscSolution::residual`]. When cancelled it ends early: check `control` afterwards.
pub fn solve_discs<T: Entry>(
    matrix: &ShearMatrix<T>,
    offset: &[f64],
    radius: &[f64],
    start: Option<&[f64]>,
    control: &Control,
) -> DiscSolution {
    let n = radius.len();
    let inner = (size_of::<T>() > 4).then(|| matrix.narrow());
    let mut run = Run {
        problem: Discs {
            matrix,
            offset,
            radius,
        },
        force: start.map_or_else(|| vec![0.0; 2 * n], <[f64]>::to_vec),
        slip: vec![0.0; 2 * n],
        products: 0,
        bound: 0.0,
    };
    run.problem.project(&mut run.force);
    run.refresh();
    let scale = largest_pair(offset, n).max(f64::MIN_POSITIVE);
    let mut passes = 0;
    while passes < MOST_PASSES && run.residual() > TOLERANCE * scale && !(control.cancelled)() {
        passes += 1;
        match &inner {
            Some(inner) => run.newton(inner, scale),
            None => run.newton(matrix, scale),
        }
    }
    DiscSolution {
        residual: run.residual() / scale,
        force: run.force,
        slip: run.slip,
        passes,
        products: run.products,
    }
}

/// The problem.
struct Discs<'a, T> {
    matrix: &'a ShearMatrix<T>,
    offset: &'a [f64],
    radius: &'a [f64],
}

impl<T: Entry> Discs<'_, T> {
    /// Into the discs, each to its nearest point.
    fn project(&self, force: &mut [f64]) {
        let (x, y) = force.split_at_mut(self.radius.len());
        for ((x, y), radius) in x.iter_mut().zip(y).zip(self.radius) {
            let length = x.hypot(*y);
            if length > *radius {
                *x *= radius / length;
                *y *= radius / length;
            }
        }
    }
}

struct Run<'a, T> {
    problem: Discs<'a, T>,
    force: Planar,
    slip: Planar,
    products: usize,
    bound: f64,
}

/// How a site may move in a Newton step.
#[derive(Clone, Copy)]
enum Freedom {
    /// Both ways.
    Free,
    /// Along the rim: unit tangent, and the rim's own stiffness, mm/N.
    Rim { tangent: [f64; 2], stiffness: f64 },
    /// Not at all: no friction.
    None,
}

impl<T: Entry> Run<'_, T> {
    /// Slip of the present force.
    fn refresh(&mut self) {
        self.problem.matrix.times(&self.force, &mut self.slip);
        self.products += 1;
        for (slip, b) in self.slip.iter_mut().zip(self.problem.offset) {
            *slip += b;
        }
    }

    /// What site `i` would be without its disc, in units of force.
    fn target(&self, i: usize) -> [f64; 2] {
        let (n, d) = (self.problem.radius.len(), self.problem.matrix.own(i));
        [
            self.force[i] - self.slip[i] / d,
            self.force[n + i] - self.slip[n + i] / d,
        ]
    }

    /// Largest natural residual, mm.
    fn residual(&self) -> f64 {
        let n = self.problem.radius.len();
        let one = |i: usize| {
            let [x, y] = self.target(i);
            let radius = self.problem.radius[i];
            let share = (radius / x.hypot(y)).min(1.0);
            let share = if share.is_nan() { 1.0 } else { share };
            let off = (self.force[i] - x * share).hypot(self.force[n + i] - y * share);
            off * self.problem.matrix.own(i)
        };
        (0..n).map(one).fold(0.0, f64::max)
    }

    fn energy(&self) -> f64 {
        let both = self.slip.iter().zip(self.problem.offset);
        0.5 * self
            .force
            .iter()
            .zip(both)
            .map(|(q, (s, b))| q * (s + b))
            .sum::<f64>()
    }

    /// One step, with `inner` (the matrix, at most less exact) for the correction.
    fn newton<S: Entry>(&mut self, inner: &ShearMatrix<S>, scale: f64) {
        let n = self.problem.radius.len();
        let (before, energy) = (self.residual(), self.energy());
        let (step, freedom, mut right) = self.linearized();
        if step.iter().any(|s| *s != 0.0) {
            let mut image = vec![0.0; 2 * n];
            inner.times(&step, &mut image);
            self.products += 1;
            for (right, image) in right.iter_mut().zip(&image) {
                *right -= image;
            }
        }
        // As accurate as the step before promises, but no finer than the end asks for.
        let finest = FINEST.max(ENOUGH * TOLERANCE * scale / before);
        let wanted = (before / scale).clamp(finest.min(LOOSEST), LOOSEST);
        let correction = Correction {
            matrix: inner,
            freedom: &freedom,
        };
        let (delta, products) = correction.solve(right, wanted);
        self.products += products;
        let old = (self.force.clone(), self.slip.clone());
        for ((q, s), d) in self.force.iter_mut().zip(&step).zip(&delta) {
            *q += s + d;
        }
        self.problem.project(&mut self.force);
        self.refresh();
        if self.residual() > CLEAR_GAIN * before && self.energy() >= energy {
            (self.force, self.slip) = old;
            self.gradient_steps();
        }
    }

    /// The step to the rim that is already known, who may move how, and the right-hand side of the rest.
    fn linearized(&self) -> (Planar, Vec<Freedom>, Planar) {
        let n = self.problem.radius.len();
        let (mut step, mut right) = (vec![0.0; 2 * n], vec![0.0; 2 * n]);
        let mut freedom = Vec::with_capacity(n);
        for i in 0..n {
            let radius = self.problem.radius[i];
            let ([x, y], d) = (self.target(i), self.problem.matrix.own(i));
            let length = x.hypot(y);
            if radius <= 0.0 {
                freedom.push(Freedom::None);
            } else if length <= radius {
                freedom.push(Freedom::Free);
                (right[i], right[n + i]) = (-self.slip[i], -self.slip[n + i]);
            } else {
                let (out, ratio) = ([x / length, y / length], length / radius);
                let tangent = [-out[1], out[0]];
                let inward = radius - (out[0] * self.force[i] + out[1] * self.force[n + i]);
                (step[i], step[n + i]) = (inward * out[0], inward * out[1]);
                // The derivative of the projection, divided by its factor r / |y|: symmetric again.
                let along = tangent[0] * self.slip[i] + tangent[1] * self.slip[n + i];
                (right[i], right[n + i]) =
                    (-ratio * along * tangent[0], -ratio * along * tangent[1]);
                freedom.push(Freedom::Rim {
                    tangent,
                    stiffness: d * (ratio - 1.0),
                });
            }
        }
        (step, freedom, right)
    }

    /// Accelerated projected gradients (Beck & Teboulle 2009), restarted where the energy would grow.
    fn gradient_steps(&mut self) {
        if self.bound == 0.0 {
            self.bound = self.problem.matrix.norm_bound();
        }
        let (mut last, mut pace) = (self.force.clone(), 1.0f64);
        for _ in 0..GRADIENT_STEPS {
            let before = self.force.clone();
            for (q, s) in self.force.iter_mut().zip(&self.slip) {
                *q -= s / self.bound;
            }
            self.problem.project(&mut self.force);
            let reached = self.force.clone();
            let uphill: f64 = (0..reached.len())
                .map(|k| (before[k] - reached[k]) * (reached[k] - last[k]))
                .sum();
            let next = if uphill > 0.0 {
                1.0
            } else {
                0.5 * (1.0 + (1.0 + 4.0 * pace * pace).sqrt())
            };
            let ahead = if uphill > 0.0 {
                0.0
            } else {
                (pace - 1.0) / next
            };
            for (q, l) in self.force.iter_mut().zip(&last) {
                *q += ahead * (*q - l);
            }
            (last, pace) = (reached, next);
            self.refresh();
        }
        self.force = last;
        self.refresh();
    }
}

/// The linear system of a Newton step.
struct Correction<'a, T> {
    matrix: &'a ShearMatrix<T>,
    freedom: &'a [Freedom],
}

impl<T: Entry> Correction<'_, T> {
    /// Keeps what the sites may do.
    fn restrict(&self, v: &mut [f64]) {
        let n = self.freedom.len();
        for (i, freedom) in self.freedom.iter().enumerate() {
            match freedom {
                Freedom::Free => {}
                Freedom::Rim { tangent, .. } => {
                    let along = tangent[0] * v[i] + tangent[1] * v[n + i];
                    (v[i], v[n + i]) = (along * tangent[0], along * tangent[1]);
                }
                Freedom::None => (v[i], v[n + i]) = (0.0, 0.0),
            }
        }
    }

    /// Preconditioned conjugate gradients until the residual is `wanted` of what it was; also the number of products.
    fn solve(&self, mut residual: Planar, wanted: f64) -> (Planar, usize) {
        let n = self.freedom.len();
        self.restrict(&mut residual);
        let stiffness = |i: usize| match self.freedom[i] {
            Freedom::Rim { stiffness, .. } => stiffness,
            _ => 0.0,
        };
        let inverse: Vec<f64> = (0..n)
            .map(|i| 1.0 / (self.matrix.own(i) + stiffness(i)))
            .collect();
        let scaled = |r: &[f64]| -> Planar { (0..2 * n).map(|k| r[k] * inverse[k % n]).collect() };
        let mut x = vec![0.0; 2 * n];
        let mut image = vec![0.0; 2 * n];
        let mut direction = scaled(&residual);
        let mut square = dot(&residual, &direction);
        let end = square * wanted * wanted;
        for product in 0..40 + 4 * n {
            if square <= end || square == 0.0 {
                return (x, product);
            }
            self.matrix.times(&direction, &mut image);
            for i in 0..n {
                image[i] += stiffness(i) * direction[i];
                image[n + i] += stiffness(i) * direction[n + i];
            }
            self.restrict(&mut image);
            let curvature = dot(&direction, &image);
            if curvature <= 0.0 {
                return (x, product + 1);
            }
            let length = square / curvature;
            for k in 0..2 * n {
                x[k] += length * direction[k];
                residual[k] -= length * image[k];
            }
            let next = scaled(&residual);
            let fresh = dot(&residual, &next);
            let beta = fresh / square;
            square = fresh;
            for (d, z) in direction.iter_mut().zip(&next) {
                *d = z + beta * *d;
            }
        }
        (x, 40 + 4 * n)
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

/// Longest vector of a planar field.
pub fn largest_pair(field: &[f64], n: usize) -> f64 {
    (0..n)
        .map(|i| field[i].hypot(field[n + i]))
        .fold(0.0, f64::max)
}
