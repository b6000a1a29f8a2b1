//! The contact solver: block principal pivoting with conjugate gradients and warm starts.
//!
//! Finds `p >= 0`, `s = A p + d >= 0`, `p s = 0` (Xie Eq. 13-14). Loose passes find the set, tight ones the forces
//! (Kostreva 1978; Judice & Pires 1994). Where the set cycles, or the matrix proves not definite, MPRGP takes over.

use super::conjugate_gradient::{CgEnd, CgLimits, conjugate_gradient};
use super::lcp::{Accuracy, Compliance, Solution};
use super::mprgp::mprgp;
use super::submatrix::Submatrix;
use super::tolerances::{EXACT, ROUGH};
use crate::Control;

/// Passes that may go without fewer infeasible entries before single pivots are taken.
const PATIENCE: usize = 8;
/// Passes in all before the fallback.
const MOST_PASSES: usize = 120;

/// Solves the contact of `matrix` (mm/N) under `gap` (mm, negative: penetrating), starting from the forces `start`.
///
/// Always ends; how well is in [`Solution::complementarity`]. When cancelled it ends early: check `control` afterwards.
pub fn solve_contact<M: Compliance>(
    matrix: &M,
    gap: &[f64],
    start: Option<&[f64]>,
    (accuracy, control): (Accuracy, &Control),
) -> Solution {
    let n = matrix.diagonal().len();
    let scale = gap.iter().fold(0.0, |most, d| f64::max(most, -d));
    let mut run = Run {
        matrix,
        gap,
        control,
        force: vec![0.0; n],
        slack: gap.to_vec(),
        in_contact: vec![false; n],
        pivots: 0,
        steps: 0,
        kept: None,
    };
    if scale > 0.0 {
        run.start(start);
    }
    let fell_back = scale > 0.0 && !run.pivot(scale, accuracy);
    if fell_back {
        let limits = CgLimits {
            tolerance: EXACT * scale,
            steps: 200 * n + 2000,
            cancelled: &control.cancelled,
        };
        run.steps += mprgp(matrix, gap, &mut run.force, limits);
        run.find_slack();
    }
    let complementarity =
        natural_residual(matrix, &run.force, &run.slack) / scale.max(f64::MIN_POSITIVE);
    let Run {
        force,
        slack,
        pivots,
        steps,
        ..
    } = run;
    Solution {
        force,
        slack,
        complementarity,
        pivots,
        steps,
        fell_back,
    }
}

/// Largest |min(A_ii p_i, s_i)|, mm.
fn natural_residual<M: Compliance>(matrix: &M, force: &[f64], slack: &[f64]) -> f64 {
    let terms = force
        .iter()
        .zip(matrix.diagonal())
        .zip(slack)
        .map(|((p, a), s)| (p * a).min(*s).abs());
    terms.fold(0.0, f64::max)
}

struct Run<'a, M> {
    matrix: &'a M,
    gap: &'a [f64],
    control: &'a Control<'a>,
    force: Vec<f64>,
    slack: Vec<f64>,
    in_contact: Vec<bool>,
    pivots: usize,
    steps: usize,
    kept: Option<Submatrix<'a>>,
}

impl<M: Compliance> Run<'_, M> {
    fn start(&mut self, start: Option<&[f64]>) {
        match start {
            Some(force) if force.iter().any(|p| *p > 0.0) => {
                for (i, p) in force.iter().enumerate() {
                    self.in_contact[i] = *p > 0.0;
                    self.force[i] = p.max(0.0);
                }
            }
            _ => {
                for (inside, d) in self.in_contact.iter_mut().zip(self.gap) {
                    *inside = *d < 0.0;
                }
            }
        }
    }

    /// True if the set was found and the forces are tight.
    fn pivot(&mut self, scale: f64, accuracy: Accuracy) -> bool {
        let levels = accuracy.levels(self.matrix.is_costly());
        let finest = levels.len() - 1;
        let (mut fewest, mut stalled, mut level) = (usize::MAX, 0, 0);
        let mut tolerance = levels[0] * scale;
        for _ in 0..MOST_PASSES {
            if (self.control.cancelled)() {
                return true;
            }
            let is_rough = levels[level] >= ROUGH;
            if !self.solve_set(tolerance, is_rough) {
                return false;
            }
            self.find_outer_slack();
            if level == finest {
                self.find_inner_slack();
            }
            let wrong = self.infeasible(tolerance);
            if wrong.is_empty() {
                if level >= finest {
                    return true;
                }
                level += 1;
                tolerance = levels[level] * scale;
                continue;
            }
            // An unchanged set at a loose level is no cycle: count only passes that do not get better.
            if wrong.len() < fewest {
                (fewest, stalled) = (wrong.len(), 0);
            } else {
                stalled += 1;
            }
            if stalled > PATIENCE {
                (level, tolerance) = (finest, EXACT * scale);
                self.flip(wrong[0]);
            } else {
                wrong.iter().for_each(|&i| self.flip(i));
            }
        }
        false
    }

    fn flip(&mut self, i: u32) {
        let inside = &mut self.in_contact[i as usize];
        *inside = !*inside;
        if !*inside {
            self.force[i as usize] = 0.0;
        }
        self.pivots += 1;
    }

    fn solve_set(&mut self, tolerance: f64, is_rough: bool) -> bool {
        let (matrix, gap) = (self.matrix, self.gap);
        let set: Vec<u32> = (0..self.force.len() as u32)
            .filter(|&i| self.in_contact[i as usize])
            .collect();
        let limits = CgLimits {
            tolerance,
            steps: 40 + 6 * set.len(),
            cancelled: &self.control.cancelled,
        };
        // Single precision suffices to find the set.
        let kept = match self.kept.take() {
            Some(kept) if kept.is_narrow == matrix.is_narrow(is_rough) && kept.holds(&set) => kept,
            _ => matrix.submatrix(&set, is_rough),
        };
        let right: Vec<f64> = kept.rows.iter().map(|&i| -gap[i as usize]).collect();
        let mut x: Vec<f64> = kept.rows.iter().map(|&i| self.force[i as usize]).collect();
        let places: Vec<u32> = (0..kept.rows.len() as u32)
            .filter(|&k| self.in_contact[kept.rows[k as usize] as usize])
            .collect();
        let (end, steps) = conjugate_gradient(&*kept.matrix, &right, (&mut x, &places), limits);
        self.steps += steps;
        for (&i, x) in kept.rows.iter().zip(&x) {
            self.force[i as usize] = *x;
        }
        self.kept = Some(kept);
        end == CgEnd::Converged
    }

    fn find_slack(&mut self) {
        self.matrix.times(&self.force, &mut self.slack);
        for (s, d) in self.slack.iter_mut().zip(self.gap) {
            *s += d;
        }
    }

    /// The slack outside the contact set, which is all that finding the set needs.
    fn find_outer_slack(&mut self) {
        let outer: Vec<u32> = (0..self.force.len() as u32)
            .filter(|&i| !self.in_contact[i as usize])
            .collect();
        let mut image = vec![0.0; outer.len()];
        self.matrix.times_rows(&outer, &self.force, &mut image);
        for (&i, image) in outer.iter().zip(&image) {
            self.slack[i as usize] = image + self.gap[i as usize];
        }
    }

    /// The slack within the contact set, by the part of the matrix that it was solved on.
    fn find_inner_slack(&mut self) {
        let Some(kept) = &self.kept else { return };
        let force: Vec<f64> = kept.rows.iter().map(|&i| self.force[i as usize]).collect();
        let mut image = vec![0.0; kept.rows.len()];
        kept.matrix.times(&force, &mut image);
        for (&i, image) in kept.rows.iter().zip(&image) {
            if self.in_contact[i as usize] {
                self.slack[i as usize] = image + self.gap[i as usize];
            }
        }
    }

    fn infeasible(&self, tolerance: f64) -> Vec<u32> {
        let wrong = |i: &u32| {
            let i = *i as usize;
            if self.in_contact[i] {
                self.force[i] < 0.0
            } else {
                self.slack[i] < -tolerance
            }
        };
        (0..self.force.len() as u32).filter(wrong).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solve::row_runs::RowRuns;

    const FULL: (Accuracy, &Control<'static>) = (
        Accuracy::Full,
        &Control {
            cancelled: &|| false,
            progress: &|_, _| {},
        },
    );

    /// A compliance like the half space's on a line, and a paraboloid gap.
    fn problem(n: usize) -> (Vec<f64>, Vec<f64>) {
        let entry = |i: usize, j: usize| {
            if i == j {
                3.0
            } else {
                1.0 / (i as f64 - j as f64).abs()
            }
        };
        let matrix = (0..n * n).map(|k| entry(k / n, k % n)).collect();
        let gap = (0..n)
            .map(|i| (i as f64 / n as f64 - 0.4).powi(2) * 20.0 - 1.0)
            .collect();
        (matrix, gap)
    }

    #[test]
    fn complementarity_holds_and_the_fallback_agrees() {
        let (matrix, gap) = problem(80);
        let rows = RowRuns::dense(matrix, 80);
        let solution = solve_contact(&rows, &gap, None, FULL);
        assert!(!solution.fell_back);
        assert!(
            solution.complementarity < 1e-11,
            "{}",
            solution.complementarity
        );
        assert!(solution.force.iter().all(|p| *p >= 0.0));
        let mut other = vec![0.0; 80];
        let limits = CgLimits {
            tolerance: 1e-13,
            steps: 100_000,
            cancelled: &|| false,
        };
        mprgp(&rows, &gap, &mut other, limits);
        for (a, b) in solution.force.iter().zip(&other) {
            assert!((a - b).abs() < 1e-9, "{a} {b}");
        }
    }

    #[test]
    fn a_warm_start_changes_nothing_but_the_work() {
        let (matrix, gap) = problem(60);
        let rows = RowRuns::dense(matrix, 60);
        let cold = solve_contact(&rows, &gap, None, FULL);
        let moved: Vec<f64> = gap.iter().map(|d| d - 0.01).collect();
        let warm = solve_contact(&rows, &moved, Some(&cold.force), FULL);
        let fresh = solve_contact(&rows, &moved, None, FULL);
        for (a, b) in warm.force.iter().zip(&fresh.force) {
            assert!((a - b).abs() < 1e-10);
        }
    }

    #[test]
    fn without_penetration_there_is_no_force() {
        let (matrix, _) = problem(10);
        let solution = solve_contact(
            &RowRuns::dense(matrix, 10),
            &[0.5; 10],
            Some(&[1.0; 10]),
            FULL,
        );
        assert_eq!(solution.force, vec![0.0; 10]);
        assert_eq!(solution.complementarity, 0.0);
    }

    #[test]
    fn an_indefinite_matrix_ends_all_the_same() {
        let matrix = vec![1.0, 2.0, 2.0, 1.0];
        let solution = solve_contact(&RowRuns::dense(matrix, 2), &[-1.0, -1.0], None, FULL);
        assert!(solution.force.iter().all(|p| p.is_finite() && *p >= 0.0));
    }
}
