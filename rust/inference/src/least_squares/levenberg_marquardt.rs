//! Levenberg-Marquardt with bounds, for the mesh model.

use nalgebra::{DMatrix, DVector};

use crate::errors::InferenceError;
use crate::least_squares::objective::{Point, Problem};

/// Most steps.
const MOST_STEPS: usize = 60;
/// Relative gain of the objective below which the fit has settled, twice in a row.
const SETTLED: f64 = 1e-7;
/// The same, once, where every step follows all protocols anew: a hundredth of what a standard error gains.
const SETTLED_SLOWLY: f64 = 1e-5;
/// Part of the promised gain from which derivatives that are long to find are kept.
const KEEPS: f64 = 0.5;
/// Damping at the start, and its smallest and largest.
const DAMPING: (f64, f64, f64) = (1e-3, 1e-9, 1e9);

/// Where a descent ended.
pub struct Descent {
    /// The model there.
    pub point: Point,
    /// Derivatives of predictions there, not whitened.
    pub jacobian: DMatrix<f64>,
    /// Whether it settled within its steps.
    pub has_converged: bool,
}

/// Goes downhill from `start` to where no admissible step gains.
///
/// # Errors
/// Those of a replay, or `Cancelled`.
pub(crate) fn descend(problem: &mut Problem<'_>, start: &[f64]) -> Result<Descent, InferenceError> {
    let mut point = problem.point(start, None)?;
    let mut jacobian = problem.jacobian(&point, None)?;
    let (mut damping, mut small_gains) = (DAMPING.0, 0);
    let (settled, enough) = match problem.replay.remembers() {
        true => (SETTLED_SLOWLY, 1),
        false => (SETTLED, 2),
    };
    for step in 0..MOST_STEPS {
        let share = step as f64 / MOST_STEPS as f64;
        problem
            .control
            .step("fitting", share)
            .map_err(|_| InferenceError::Cancelled)?;
        let system = System::new(problem, (&point, &jacobian));
        let next = system.step(problem, &point, damping);
        let next = match next {
            Some(at) => problem.point(&at, Some(point.threshold))?,
            None => break,
        };
        let gain = point.objective - next.objective;
        let predicted = system.gain(&point.at, &next.at);
        if gain > 0.0 {
            small_gains = match gain <= settled * (1.0 + next.objective) {
                true => small_gains + 1,
                false => 0,
            };
            damping = (damping * 0.2).max(DAMPING.1);
            // The threshold follows the residuals' bulk.
            point = problem.point(&next.at, None)?;
            let is_true = problem.replay.remembers() && gain > KEEPS * predicted;
            jacobian = problem.jacobian(&point, is_true.then_some(&jacobian))?;
            if small_gains >= enough {
                return Ok(Descent::settled(point, jacobian));
            }
        } else {
            if predicted <= settled * (1.0 + point.objective) || damping > DAMPING.2 {
                return Ok(Descent::settled(point, jacobian));
            }
            damping *= 8.0;
        }
    }
    Ok(Descent {
        point,
        jacobian,
        has_converged: false,
    })
}

impl Descent {
    fn settled(point: Point, jacobian: DMatrix<f64>) -> Descent {
        Descent {
            point,
            jacobian,
            has_converged: true,
        }
    }
}

/// The linear problem about a point.
pub struct System {
    /// `J^T W J` with the priors.
    pub normal: DMatrix<f64>,
    /// Half the downhill gradient.
    downhill: DVector<f64>,
}

impl System {
    /// About a point with its derivatives.
    pub fn new(problem: &Problem<'_>, (point, jacobian): (&Point, &DMatrix<f64>)) -> System {
        let whitened = problem.whitening.derivatives(jacobian, &point.whitened);
        let residual = &point.whitened.residual;
        let weight = |r: f64| f64::min(1.0, point.threshold / r.abs().max(f64::MIN_POSITIVE));
        let mut weighted = whitened.clone();
        for (k, r) in residual.iter().enumerate() {
            weighted.row_mut(k).scale_mut(weight(*r));
        }
        let mut normal = whitened.tr_mul(&weighted);
        let mut downhill = weighted.tr_mul(&DVector::from_column_slice(residual));
        for (k, parameter) in problem.parameters.iter().enumerate() {
            if let Some(sd) = parameter.prior {
                normal[(k, k)] += 1.0 / (sd * sd);
                downhill[k] -= point.at[k] / (sd * sd);
            }
        }
        System { normal, downhill }
    }

    /// The damped step within the bounds; None where every direction downhill leads out of them.
    fn step(&self, problem: &Problem<'_>, point: &Point, damping: f64) -> Option<Vec<f64>> {
        let bounds: Vec<(f64, f64)> = problem.parameters.iter().map(|p| p.bounds).collect();
        let mut free: Vec<usize> = (0..bounds.len())
            .filter(|&k| {
                let (low, high) = bounds[k];
                let leads_out = (point.at[k] <= low && self.downhill[k] < 0.0)
                    || (point.at[k] >= high && self.downhill[k] > 0.0);
                !leads_out && self.normal[(k, k)] > 0.0
            })
            .collect();
        let mut at = point.at.clone();
        // What meets a bound stays there, and the rest is solved again.
        while !free.is_empty() {
            let matrix = DMatrix::from_fn(free.len(), free.len(), |a, b| {
                let value = self.normal[(free[a], free[b])];
                if a == b {
                    value * (1.0 + damping)
                } else {
                    value
                }
            });
            let mut side = DVector::from_fn(free.len(), |a, _| self.downhill[free[a]]);
            for k in (0..bounds.len()).filter(|k| !free.contains(k)) {
                let moved = at[k] - point.at[k];
                for (a, row) in free.iter().enumerate() {
                    side[a] -= self.normal[(*row, k)] * moved;
                }
            }
            let step = matrix.cholesky()?.solve(&side);
            let met: Vec<usize> = free
                .iter()
                .enumerate()
                .filter(|(a, k)| {
                    let next = point.at[**k] + step[*a];
                    next < bounds[**k].0 || next > bounds[**k].1
                })
                .map(|(_, k)| *k)
                .collect();
            for (a, k) in free.iter().enumerate() {
                at[*k] = (point.at[*k] + step[a]).clamp(bounds[*k].0, bounds[*k].1);
            }
            if met.is_empty() {
                break;
            }
            free.retain(|k| !met.contains(k));
        }
        (at != point.at).then_some(at)
    }

    /// What the linear problem promises of a step.
    fn gain(&self, from: &[f64], to: &[f64]) -> f64 {
        let step = DVector::from_fn(from.len(), |k, _| to[k] - from[k]);
        2.0 * self.downhill.dot(&step) - (&self.normal * &step).dot(&step)
    }
}
