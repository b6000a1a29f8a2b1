//! A mechanism's fitted numbers with their covariance and their profile likelihood, and the intervals that follow in other terms.

use nalgebra::{DMatrix, DVector};
use thenar_inference::forward::surrogate::candidate_model::Model;
use thenar_inference::forward::surrogate::mechanism::Law;
use thenar_inference::forward::surrogate::prepared_study::PreparedStudy;
use thenar_inference::least_squares::surrogate_fit::Refit;
use thenar_inference::parameters::surrogate_parameter::Kind;
use thenar_inference::selection::profile_interval::{Interval, Profiled};
use thenar_inference::selection::scored::Scored;

/// Half width of a 90 % interval in standard errors.
pub const HALF: f64 = 1.645;
/// A number and the ends of its 90 % interval; infinite where it is open.
pub type Three = (f64, f64, f64);

/// A mechanism's free numbers, with what is known of their errors.
pub struct Free {
    /// In the model's order.
    pub values: Vec<f64>,
    /// Covariance of their errors.
    covariance: DMatrix<f64>,
    /// The pulp's modulus at first touch as it was fitted with them, MPa.
    pub shear_mpa: f64,
    /// Their profile likelihood, where it was asked for.
    profiled: Option<Profiled>,
}

impl Free {
    /// Those of mechanism `number` of a model.
    pub fn of(ready: &PreparedStudy, scored: &Scored, number: usize) -> Free {
        let surrogate = ready.surrogate();
        let model = Model::new(&surrogate, &scored.mechanisms);
        let all = model.coordinates.iter().enumerate();
        let own = all.filter(|(_, c)| matches!(c.kind, Kind::Of(of, _) if of == number));
        let own: Vec<usize> = own.map(|(k, _)| k).collect();
        Free::taken(&scored.refit, &own)
    }

    /// The same with their profile likelihood.
    pub fn with(self, profiled: Option<&Profiled>) -> Free {
        Free {
            profiled: profiled.cloned(),
            ..self
        }
    }

    /// Those of a fit.
    fn taken(refit: &Refit, own: &[usize]) -> Free {
        Free {
            values: own.iter().map(|k| refit.at[*k]).collect(),
            covariance: refit.covariance.select_rows(own).select_columns(own),
            shear_mpa: libm::exp(refit.at[0]),
            profiled: None,
        }
    }

    /// A sum of the numbers, each times its weight, and its standard error.
    pub fn sum(&self, weights: &[f64]) -> (f64, f64) {
        let value = self.values.iter().zip(weights).map(|(v, w)| v * w).sum();
        let weights = DVector::from_column_slice(weights);
        let variance = (&self.covariance * &weights).dot(&weights);
        (value, variance.max(0.0).sqrt())
    }

    /// A number's profile-likelihood interval, which holds the fitted value.
    pub fn profile(&self, number: usize) -> Option<Interval> {
        let known = self.profiled.as_ref()?.numbers.get(number)?;
        let value = self.values[number];
        Some(Interval {
            value,
            ends: (known.ends.0.min(value), known.ends.1.max(value)),
            is_open: known.is_open,
        })
    }

    /// The interval of the shortest or the longest time constant's logarithm by the profile likelihood, which holds the fitted value.
    pub fn outer(&self, is_longest: bool, value: f64) -> Option<Interval> {
        let known = self.profiled.as_ref()?.outer.get(usize::from(is_longest))?;
        Some(Interval {
            value,
            ends: (known.ends.0.min(value), known.ends.1.max(value)),
            is_open: known.is_open,
        })
    }

    /// The sum of free shares and the ends of its interval, in other terms: by the profile likelihood of the sum (see
    /// `Profiled::numbers`), or by its standard error where none was asked for.
    pub fn sum_interval(&self, (sum, error): (f64, f64), scale: &dyn Fn(f64) -> f64) -> Three {
        let known = self.profiled.as_ref().and_then(|of| of.numbers.first());
        let Some(known) = known else {
            let ends = [-HALF * error, HALF * error].map(|off| scale(sum + off));
            return (scale(sum), ends[0], ends[1]);
        };
        let end = |end: f64, is_open: bool, open: f64| if is_open { open } else { scale(end) };
        (
            scale(sum),
            end(known.ends.0.min(sum), known.is_open.0, f64::NEG_INFINITY),
            end(known.ends.1.max(sum), known.is_open.1, f64::INFINITY),
        )
    }

    /// The fitted law, and its variants that are not excluded.
    pub fn laws<'a>(&'a self, own: &'a Law) -> Vec<&'a Law> {
        let known = self.profiled.iter().flat_map(|known| &known.variants);
        std::iter::once(own).chain(known.map(|m| &m.law)).collect()
    }

    /// The first number and its standard error.
    pub fn first(&self) -> (f64, f64) {
        let mut weights = vec![0.0; self.values.len()];
        weights[0] = 1.0;
        self.sum(&weights)
    }
}

/// The first number and the ends of its interval, in other terms.
pub fn interval(free: &Free, scale: &dyn Fn(f64) -> f64) -> Three {
    of_number(free, 0, scale)
}

/// A number and the ends of its interval, in other terms: by the profile likelihood, or by the standard error where none was asked for.
pub fn of_number(free: &Free, number: usize, scale: &dyn Fn(f64) -> f64) -> Three {
    let Some(known) = free.profile(number) else {
        let mut weights = vec![0.0; free.values.len()];
        weights[number] = 1.0;
        let (value, error) = free.sum(&weights);
        let ends = [0.0, -HALF * error, HALF * error].map(|off| scale(value + off));
        return (ends[0], ends[1], ends[2]);
    };
    let (low, high) = (scale(known.ends.0), scale(known.ends.1));
    let is_rising = low <= high;
    let (low, high) = (low.min(high), low.max(high));
    let (below, above) = match is_rising {
        true => known.is_open,
        false => (known.is_open.1, known.is_open.0),
    };
    (
        scale(known.value),
        if below { f64::NEG_INFINITY } else { low },
        if above { f64::INFINITY } else { high },
    )
}

/// A number that is tried at a few values: the next values below and above those that are kept; open where there is none.
pub fn tried_interval(value: f64, tried: &[f64], kept: &[f64]) -> Three {
    let is_kept = |t: &f64| kept.iter().any(|k| (k / t - 1.0).abs() < 1e-9);
    let first = tried.iter().position(is_kept).unwrap_or(0);
    let last = tried.iter().rposition(is_kept).unwrap_or(first);
    let low = first.checked_sub(1).map_or(f64::NEG_INFINITY, |k| tried[k]);
    let high = tried.get(last + 1).copied().unwrap_or(f64::INFINITY);
    (value, low, high)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is not excluded lies between the next values that are; beyond the first and the last nothing was tried.
    #[test]
    fn interval_of_tried_values_is_open_at_the_ends() {
        let open = (f64::NEG_INFINITY, f64::INFINITY);
        let of = |kept: &[f64]| {
            let (_, low, high) = tried_interval(kept[0], &[0.3, 0.5, 0.9], kept);
            (low, high)
        };
        assert_eq!(of(&[0.5]), (0.3, 0.9));
        assert_eq!(of(&[0.3]), (open.0, 0.5));
        assert_eq!(of(&[0.9, 0.5]), (0.3, open.1));
        assert_eq!(of(&[0.9, 0.3]), open);
    }

    #[test]
    fn standard_error_of_a_sum_includes_covariance() {
        let refit = Refit {
            at: vec![7.0, 1.0, 2.0],
            deviance: 0.0,
            residual: Vec::new(),
            simulated: Vec::new(),
            covariance: DMatrix::from_row_slice(
                3,
                3,
                &[1.0, 0.5, 0.5, 0.5, 4.0, -2.0, 0.5, -2.0, 9.0],
            ),
        };
        let free = Free::taken(&refit, &[1, 2]);
        assert_eq!(free.first(), (1.0, 2.0));
        assert_eq!(free.sum(&[1.0, 1.0]), (3.0, 3.0));
        assert_eq!(free.sum(&[0.0, 1.0]), (2.0, 3.0));
    }
}
