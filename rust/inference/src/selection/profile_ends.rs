//! The ends of a parameter's profile-likelihood interval (Venzon & Moolgavkar 1988): where the deviance has risen enough while the other
//! parameters are fitted again.

use crate::forward::surrogate::candidate_model::Model;
use crate::forward::surrogate::surrogate_data::Surrogate;
use crate::least_squares::surrogate_fit::{Refit, refit};
use crate::parameters::surrogate_parameter::Kind;

/// Root of the rise of the deviance at the ends of a 90 % interval: 1.645^2 is the 90 % point of chi-squared with one degree of freedom.
pub(crate) const ROOT: f64 = 1.644_854;
/// Part of it within which an end is found.
pub(crate) const NEAR: f64 = 0.04;
/// Most fits for one end.
const MOST_FITS: usize = 8;
/// Part of a bracket that a step leaves on either side.
const INSIDE: f64 = 0.1;

/// The 90 % interval of one parameter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Interval {
    /// Value at the optimum.
    pub value: f64,
    /// Its ends; an end that is open is that of the admissible range.
    pub ends: (f64, f64),
    /// Whether the recordings leave the lower and the upper end open.
    pub is_open: (bool, bool),
}

impl Interval {
    /// Both intervals and what is between them.
    pub(crate) fn joined(self, other: Interval) -> Interval {
        Interval {
            value: self.value,
            ends: (self.ends.0.min(other.ends.0), self.ends.1.max(other.ends.1)),
            is_open: (
                self.is_open.0 || other.is_open.0,
                self.is_open.1 || other.is_open.1,
            ),
        }
    }
}

/// The profile likelihood about an optimum.
pub(crate) struct Profile<'a> {
    pub(crate) surrogate: &'a Surrogate<'a>,
    pub(crate) model: Model<'a>,
    pub(crate) best: Refit,
    /// Deviance of the best variant.
    pub(crate) least: f64,
    pub(crate) overdispersion: f64,
}

impl Profile<'_> {
    /// Root of a deviance's rise over the least.
    pub(crate) fn root(&self, deviance: f64) -> f64 {
        ((deviance - self.least) / self.overdispersion)
            .max(0.0)
            .sqrt()
    }

    /// Of every parameter of one mechanism.
    pub(crate) fn intervals(&mut self, mechanism: usize) -> Vec<Interval> {
        let all = self.model.coordinates.iter().enumerate();
        let own: Vec<usize> = all
            .filter(|(_, c)| matches!(c.kind, Kind::Of(of, _) if of == mechanism))
            .map(|(k, _)| k)
            .collect();
        own.into_iter().map(|k| self.interval(k)).collect()
    }

    pub(crate) fn interval(&mut self, coordinate: usize) -> Interval {
        let bounds = self.model.coordinates[coordinate].bounds;
        let ends = [bounds.0, bounds.1].map(|bound| self.end(coordinate, bound));
        self.model.coordinates[coordinate].bounds = bounds;
        Interval {
            value: self.best.at[coordinate],
            ends: (ends[0].unwrap_or(bounds.0), ends[1].unwrap_or(bounds.1)),
            is_open: (ends[0].is_none(), ends[1].is_none()),
        }
    }

    /// The end toward a bound; None where the deviance does not rise enough as far as there.
    fn end(&mut self, coordinate: usize, bound: f64) -> Option<f64> {
        let from = self.best.at[coordinate];
        let own = self.root(self.best.deviance);
        let error = self.best.covariance[(coordinate, coordinate)]
            .max(0.0)
            .sqrt();
        let toward = |step: f64| match bound < from {
            true => (from - step).max(bound),
            false => (from + step).min(bound),
        };
        let mut at = self.best.at.clone();
        let (mut inner, mut outer) = ((from, own), None::<(f64, f64)>);
        let mut next = toward(ROOT * error);
        for _ in 0..MOST_FITS {
            if next == from {
                return None;
            }
            self.model.coordinates[coordinate].bounds = (next, next);
            let held = refit(self.surrogate, &self.model, &at);
            let root = self.root(held.deviance);
            if (root / ROOT - 1.0).abs() < NEAR {
                return Some(next);
            }
            if root > ROOT {
                outer = Some((next, root));
            } else {
                if next == bound {
                    return None;
                }
                (inner, at) = ((next, root), held.at);
            }
            next = match outer {
                Some((far, rise)) => {
                    let share = (ROOT - inner.1) / (rise - inner.1).max(f64::MIN_POSITIVE);
                    inner.0 + (far - inner.0) * share.clamp(INSIDE, 1.0 - INSIDE)
                }
                None => {
                    let factor = (ROOT / root.max(0.1 * ROOT)).clamp(1.2, 4.0);
                    toward((next - from).abs() * factor)
                }
            };
        }
        // The last value that is excluded, or, where none was met, the bound.
        outer.map(|(far, _)| far)
    }
}
