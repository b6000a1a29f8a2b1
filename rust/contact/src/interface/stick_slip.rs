//! One stick-slip step of a contact under a drag (Coulomb's law by increments), and the state of each site after it.
//!
//! Coulomb's law by increments: the shear force on the skin stays within `mu p`, and where it is `mu p` the skin slips against
//! it. Given the normal forces, a step is one convex problem over discs; backward Euler, so no closed path gives energy.

use thenar_surface::Vec3;

use super::disc_solver::{DiscSolution, largest_pair, solve_discs};
use super::shear_matrix::ShearMatrix;
use crate::Control;

/// Share of the limit from which a site counts as slipping.
const RIM: f64 = 1.0 - 1e-9;
/// Memory of a site in contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SiteFriction {
    /// Shear force on the skin, N.
    pub force: Vec3,
    /// Slip of the skin over the product so far, mm.
    pub slip: Vec3,
    /// Travel of the product over this site by the posture's own motion, since the site came to touch, mm.
    pub strayed: Vec3,
}

/// The contact of one step: sites with their compliance, planes and limits.
#[derive(Debug, Clone, Copy)]
pub struct StickSlipProblem<'a> {
    /// Compliance in the tangent planes.
    pub matrix: &'a ShearMatrix<f32>,
    /// The plane of each site.
    pub tangents: &'a [[Vec3; 2]],
    /// Largest shear force of each site, N.
    pub limit: &'a [f64],
    /// Memory of each site; None for those that were not in contact.
    pub before: &'a [Option<SiteFriction>],
}

/// The end of a step.
#[derive(Debug, Clone, PartialEq)]
pub struct StickSlipStep {
    /// Memory of every site.
    pub traces: Vec<SiteFriction>,
    /// Displacement of the skin in the plane of each site, mm.
    pub displacement: Vec<Vec3>,
    /// True where the force is within its limit.
    pub is_sticking: Vec<bool>,
    /// Energy turned into heat in this step, N mm, never negative.
    pub dissipated: f64,
    /// Energy stored in the sheared skin, N mm.
    pub stored: f64,
    /// Natural residual relative to the largest travel.
    pub residual: f64,
    /// Newton steps.
    pub passes: usize,
    /// Products with the matrix.
    pub products: usize,
}

impl StickSlipStep {
    /// Sum of the shear forces on the skin, N.
    pub fn force(&self) -> Vec3 {
        self.traces.iter().map(|t| t.force).sum()
    }
}

impl StickSlipProblem<'_> {
    /// Drags the product from the travel `from` to the travel `to` (mm, each by site).
    ///
    /// A site that was not in contact starts without slip where it then was.
    pub fn drag(&self, from: &[Vec3], to: &[Vec3], control: &Control) -> StickSlipStep {
        let start = self.start();
        let before = self.slip_before(&start, from);
        self.drag_on((&before, &start), to, control)
    }

    pub(super) fn drag_on(
        &self,
        (before, start): (&[f64], &[f64]),
        to: &[Vec3],
        control: &Control,
    ) -> StickSlipStep {
        let offset: Vec<f64> = self
            .flat(to)
            .iter()
            .zip(before)
            .map(|(to, before)| -to - before)
            .collect();
        let solution = solve_discs(self.matrix, &offset, self.limit, Some(start), control);
        self.dragged((&offset, before), solution)
    }

    fn dragged(&self, (offset, before): (&[f64], &[f64]), solution: DiscSolution) -> StickSlipStep {
        let n = self.limit.len();
        let DiscSolution { force, slip, .. } = solution;
        let point = |field: &[f64], i: usize| {
            self.tangents[i][0] * field[i] + self.tangents[i][1] * field[n + i]
        };
        let trace = |i: usize| SiteFriction {
            force: point(&force, i),
            slip: point(&slip, i) + point(before, i),
            strayed: Vec3::zeros(),
        };
        let dissipated = -(0..2 * n).map(|k| force[k] * slip[k]).sum::<f64>();
        let moved: Vec<f64> = slip.iter().zip(offset).map(|(s, b)| s - b).collect();
        let stored = 0.5 * force.iter().zip(&moved).map(|(q, u)| q * u).sum::<f64>();
        StickSlipStep {
            traces: (0..n).map(trace).collect(),
            displacement: (0..n).map(|i| point(&moved, i)).collect(),
            is_sticking: (0..n)
                .map(|i| force[i].hypot(force[n + i]) < RIM * self.limit[i])
                .collect(),
            dissipated: dissipated.max(0.0),
            stored,
            residual: solution.residual,
            passes: solution.passes,
            products: solution.products,
        }
    }

    /// Remembered forces in the planes of today.
    pub(super) fn start(&self) -> Vec<f64> {
        let remembered: Vec<Vec3> = self
            .before
            .iter()
            .map(|t| t.map_or_else(Vec3::zeros, |t| t.force))
            .collect();
        self.flat(&remembered)
    }

    /// Slip so far in the planes of today.
    pub(super) fn slip_before(&self, start: &[f64], from: &[Vec3]) -> Vec<f64> {
        let n = self.limit.len();
        let remembered: Vec<Vec3> = self
            .before
            .iter()
            .map(|t| t.map_or_else(Vec3::zeros, |t| t.slip))
            .collect();
        let mut slip = self.flat(&remembered);
        if self.before.iter().all(Option::is_some) {
            return slip;
        }
        let mut moved = vec![0.0; 2 * n];
        if largest_pair(start, n) > 0.0 {
            self.matrix.times(start, &mut moved);
        }
        let from = self.flat(from);
        for i in (0..n).filter(|&i| self.before[i].is_none()) {
            for k in [i, n + i] {
                slip[k] = moved[k] - from[k];
            }
        }
        slip
    }

    pub(super) fn flat(&self, field: &[Vec3]) -> Vec<f64> {
        let component = |c: usize| {
            self.tangents
                .iter()
                .zip(field)
                .map(move |(tangents, v)| tangents[c].dot(v))
        };
        component(0).chain(component(1)).collect()
    }
}
