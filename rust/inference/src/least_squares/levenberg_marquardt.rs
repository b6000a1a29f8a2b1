//! Levenberg-Marquardt with bounds, priors and Huber loss, for any model whose residuals can be whitened.

use std::ops::Range;

use nalgebra::{DMatrix, DVector};

use crate::least_squares::huber::huber;
use crate::noise::whitening::{Whitened, Whitening, span};

/// Most steps.
const MOST_STEPS: usize = 60;
/// Part of the promised gain from which a model may keep derivatives that are long to find.
const KEEPS: f64 = 0.5;
/// Damping at the start, and its smallest and largest.
const DAMPING: (f64, f64, f64) = (1e-3, 1e-9, 1e9);

/// What a free number is held by.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Smallest and largest value.
    pub bounds: (f64, f64),
    /// Standard deviation about 0 before data are seen; None: anything within the bounds.
    pub prior: Option<f64>,
}

/// When a descent ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stopping {
    /// A smaller gain is small.
    pub small: f64,
    /// Small gains in a row after which the fit has settled.
    pub enough: usize,
    /// Gain that a step must promise to be tried.
    pub promised: f64,
}

/// A model and the data that it is fitted to.
pub trait Objective {
    /// What may go wrong.
    type Error;

    /// Limits of its numbers.
    fn limits(&self) -> Vec<Limits>;

    /// How residuals are whitened.
    fn whitening(&self) -> &Whitening;

    /// Predictions by recording.
    ///
    /// # Errors
    /// The model's own.
    fn predictions(&mut self, at: &[f64]) -> Result<Vec<Vec<f64>>, Self::Error>;

    /// Predictions of all samples, as they are whitened.
    fn stacked(&self, predictions: &[Vec<f64>]) -> Vec<f64>;

    /// From where a residual pulls with a constant force.
    fn threshold(&self, residual: &[f64], predictions: &[Vec<f64>]) -> f64;

    /// Derivatives of the stacked predictions, not whitened. `kept` are those of the point before, where its steps held what they promised.
    ///
    /// # Errors
    /// The model's own.
    fn jacobian(
        &mut self,
        point: &Point,
        kept: Option<&DMatrix<f64>>,
    ) -> Result<DMatrix<f64>, Self::Error>;

    /// When a descent ends that has come to this objective.
    fn stopping(&self, objective: f64) -> Stopping;

    /// Called before every step with the share of the steps that may be taken.
    ///
    /// # Errors
    /// Where the caller asked to stop.
    fn before_step(&self, _share: f64) -> Result<(), Self::Error> {
        Ok(())
    }

    /// The model at `at`; `threshold` as [`Point::threshold`], None: from its own residuals.
    ///
    /// # Errors
    /// The model's own.
    fn point(&mut self, at: &[f64], threshold: Option<f64>) -> Result<Point, Self::Error> {
        let simulated = self.predictions(at)?;
        let whitened = self.whitening().residuals(&self.stacked(&simulated));
        let mut point = Point {
            at: at.to_vec(),
            simulated,
            whitened,
            objective: f64::INFINITY,
            threshold: 0.0,
        };
        let own = || self.threshold(&point.whitened.residual, &point.simulated);
        let threshold = threshold.unwrap_or_else(own);
        point.weigh(&self.limits(), threshold);
        Ok(point)
    }
}

/// The model at one place.
#[derive(Debug, Clone)]
pub struct Point {
    /// Coordinates.
    pub at: Vec<f64>,
    /// Predictions by recording.
    pub simulated: Vec<Vec<f64>>,
    /// Whitened residuals, stacked.
    pub whitened: Whitened,
    /// What the fit makes small: sum of Huber's function over residuals, and of squares over priors.
    pub objective: f64,
    /// Threshold of that function.
    pub threshold: f64,
}

impl Point {
    fn weigh(&mut self, limits: &[Limits], threshold: f64) {
        let residual = self.whitened.residual.iter();
        let misfit: f64 = residual.map(|r| huber(*r, threshold)).sum();
        let prior = limits.iter().zip(&self.at);
        let prior: f64 = prior
            .filter_map(|(one, x)| one.prior.map(|sd| (x / sd).powi(2)))
            .sum();
        self.threshold = threshold;
        self.objective = match misfit.is_finite() {
            true => misfit + prior,
            false => f64::INFINITY,
        };
    }
}

/// Where a descent ended.
pub struct Descent {
    /// The model there.
    pub point: Point,
    /// Derivatives of predictions there, not whitened.
    pub jacobian: DMatrix<f64>,
    /// The linear problem there.
    pub system: System,
    /// Whether it settled within its steps.
    pub has_converged: bool,
}

/// Goes downhill from `start` to where no admissible step gains.
///
/// # Errors
/// The model's own.
pub fn descend<O: Objective>(model: &mut O, start: &[f64]) -> Result<Descent, O::Error> {
    let limits = model.limits();
    let point = model.point(start, None)?;
    let jacobian = model.jacobian(&point, None)?;
    let system = System::new((&limits, model.whitening()), (&point, &jacobian));
    let mut now = Descent {
        point,
        jacobian,
        system,
        has_converged: false,
    };
    let (mut damping, mut small_gains) = (DAMPING.0, 0);
    for step in 0..MOST_STEPS {
        model.before_step(step as f64 / MOST_STEPS as f64)?;
        // A step that meets bounds may promise more when it is shorter.
        let least = model.stopping(now.point.objective).promised;
        let found = loop {
            if damping > DAMPING.2 {
                now.has_converged = true;
                break None;
            }
            let Some(at) = now.system.step(&limits, &now.point.at, damping) else {
                break None;
            };
            let promised = now.system.gain(&now.point.at, &at);
            if promised > least {
                break Some((at, promised));
            }
            now.has_converged = true;
            damping *= 8.0;
        };
        let Some((at, promised)) = found else {
            break;
        };
        now.has_converged = false;
        let mut next = model.point(&at, Some(now.point.threshold))?;
        let gain = now.point.objective - next.objective;
        if gain > 0.0 {
            let stopping = model.stopping(next.objective);
            let is_small = gain <= stopping.small;
            small_gains = if is_small { small_gains + 1 } else { 0 };
            damping = (damping * 0.2).max(DAMPING.1);
            // The threshold follows the residuals' bulk.
            let threshold = model.threshold(&next.whitened.residual, &next.simulated);
            next.weigh(&limits, threshold);
            let kept = (gain > KEEPS * promised).then_some(&now.jacobian);
            now.jacobian = model.jacobian(&next, kept)?;
            now.point = next;
            now.system = System::new((&limits, model.whitening()), (&now.point, &now.jacobian));
            now.has_converged = small_gains >= stopping.enough;
            if now.has_converged {
                break;
            }
        } else {
            damping *= 8.0;
        }
    }
    Ok(now)
}

/// The linear problem about a point.
pub struct System {
    /// `J^T W J` with the priors.
    pub normal: DMatrix<f64>,
    /// Half the downhill gradient.
    downhill: DVector<f64>,
}

impl System {
    /// About a point with its derivatives, which are not whitened.
    pub fn new(
        (limits, whitening): (&[Limits], &Whitening),
        (point, jacobian): (&Point, &DMatrix<f64>),
    ) -> System {
        let whitened = whitening.derivatives(jacobian, &point.whitened);
        let residual = &point.whitened.residual;
        let weight = |r: f64| f64::min(1.0, point.threshold / r.abs().max(f64::MIN_POSITIVE));
        let weights: Vec<f64> = residual.iter().map(|r| weight(*r)).collect();
        let (mut normal, mut downhill) = weighted_products(&whitened, &weights, residual);
        for (k, one) in limits.iter().enumerate() {
            if let Some(sd) = one.prior {
                normal[(k, k)] += 1.0 / (sd * sd);
                downhill[k] -= point.at[k] / (sd * sd);
            }
        }
        System { normal, downhill }
    }

    /// The damped step within the bounds; None where every direction downhill leads out of them.
    fn step(&self, limits: &[Limits], from: &[f64], damping: f64) -> Option<Vec<f64>> {
        let bounds: Vec<(f64, f64)> = limits.iter().map(|one| one.bounds).collect();
        let mut free: Vec<usize> = (0..bounds.len())
            .filter(|&k| {
                let (low, high) = bounds[k];
                let leads_out = (from[k] <= low && self.downhill[k] < 0.0)
                    || (from[k] >= high && self.downhill[k] > 0.0);
                !leads_out && self.normal[(k, k)] > 0.0
            })
            .collect();
        let mut at = from.to_vec();
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
                let moved = at[k] - from[k];
                for (a, row) in free.iter().enumerate() {
                    side[a] -= self.normal[(*row, k)] * moved;
                }
            }
            let step = matrix.cholesky()?.solve(&side);
            let mut met = Vec::new();
            for (a, k) in free.iter().enumerate() {
                let next = from[*k] + step[a];
                if next < bounds[*k].0 || next > bounds[*k].1 {
                    met.push(*k);
                }
                at[*k] = next.clamp(bounds[*k].0, bounds[*k].1);
            }
            if met.is_empty() {
                break;
            }
            free.retain(|k| !met.contains(k));
        }
        (at != from).then_some(at)
    }

    /// What the linear problem promises of a step.
    fn gain(&self, from: &[f64], to: &[f64]) -> f64 {
        let step = DVector::from_fn(from.len(), |k, _| to[k] - from[k]);
        2.0 * self.downhill.dot(&step) - (&self.normal * &step).dot(&step)
    }
}

/// `J^T W J` and `J^T W r`. Numbers of one recording or one tool leave most of a column 0: rows before its first and after its last that is not 0
/// are passed over.
fn weighted_products(
    whitened: &DMatrix<f64>,
    weights: &[f64],
    residual: &[f64],
) -> (DMatrix<f64>, DVector<f64>) {
    let count = whitened.ncols();
    let spans: Vec<Range<usize>> = (0..count)
        .map(|column| span(column_of(whitened, column)))
        .collect();
    let (mut normal, mut downhill) = (DMatrix::zeros(count, count), DVector::zeros(count));
    let mut weighted = vec![0.0; weights.len()];
    for a in 0..count {
        let rows = spans[a].clone();
        let own = &column_of(whitened, a)[rows.clone()];
        let each = own.iter().zip(&weights[rows.clone()]);
        for (to, (value, weight)) in weighted[rows.clone()].iter_mut().zip(each) {
            *to = value * weight;
        }
        downhill[a] = dot(&weighted[rows.clone()], &residual[rows.clone()]);
        for b in 0..=a {
            let both = rows.start.max(spans[b].start)..rows.end.min(spans[b].end);
            if both.is_empty() {
                continue;
            }
            let product = dot(&weighted[both.clone()], &column_of(whitened, b)[both]);
            normal[(a, b)] = product;
            normal[(b, a)] = product;
        }
    }
    (normal, downhill)
}

fn column_of(matrix: &DMatrix<f64>, column: usize) -> &[f64] {
    let rows = matrix.nrows();
    &matrix.as_slice()[column * rows..(column + 1) * rows]
}

/// Sum of products, in eight sums side by side, which is as the processor adds.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let (mut sums, whole) = ([0.0; 8], a.len() / 8 * 8);
    for (x, y) in a.chunks_exact(8).zip(b.chunks_exact(8)) {
        for (sum, (x, y)) in sums.iter_mut().zip(x.iter().zip(y)) {
            *sum += x * y;
        }
    }
    let rest = a[whole..].iter().zip(&b[whole..]);
    sums.iter().sum::<f64>() + rest.map(|(x, y)| x * y).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Against the products of the whole matrices, with columns that are 0 before, after, nowhere and everywhere.
    #[test]
    fn products_of_parts_equal_those_of_the_whole() {
        let spans = [0..41, 3..20, 20..41, 19..21, 7..7, 40..41, 0..1];
        let value = |row: usize, column: usize| f64::sin((1 + row * (3 + column)) as f64);
        let jacobian = DMatrix::from_fn(41, spans.len(), |row, column| {
            match spans[column].contains(&row) {
                true => value(row, column),
                false => 0.0,
            }
        });
        let weights: Vec<f64> = (0..41).map(|row| 0.1 + value(row, 11).abs()).collect();
        let residual: Vec<f64> = (0..41).map(|row| value(row, 17)).collect();
        let (normal, downhill) = weighted_products(&jacobian, &weights, &residual);
        let weighted = DMatrix::from_diagonal(&DVector::from_vec(weights)) * &jacobian;
        let off = normal - jacobian.transpose() * &weighted;
        assert!(off.amax() < 1e-13, "{}", off.amax());
        let off = downhill - weighted.transpose() * DVector::from_vec(residual);
        assert!(off.amax() < 1e-13, "{}", off.amax());
    }
}
