//! Correlation of noise in time: a part that forgets itself, and a part that is new in every sample.
//!
//! The first is an Ornstein-Uhlenbeck process, the second white; together the noise of a sensor whose zero wanders. Its innovations
//! are those of a Kalman filter (Kalman 1960; Jones 1980, Technometrics 22:389, for samples at any times), which for one part alone
//! are the differences of a first-order autoregression.

/// Least part of a sample's variance that the samples before do not determine.
pub(crate) const LEAST_FRESH: f64 = 1e-6;

/// Correlation of noise of variance 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Correlation {
    /// Time over which the part with memory forgets itself, s; 0: at once.
    pub memory_s: f64,
    /// Share of the variance that is new in every sample; 0 without memory, where all of it is.
    pub white: f64,
    /// Whether the part with memory is nothing at a recording's first sample, as in a sensor that is set to zero before each.
    pub is_tared: bool,
}

impl Correlation {
    /// Every sample independent.
    pub const NONE: Correlation = Correlation::of_memory(0.0);

    /// All of it with one memory, s.
    pub const fn of_memory(memory_s: f64) -> Correlation {
        Correlation {
            memory_s,
            white: 0.0,
            is_tared: false,
        }
    }

    /// Standard deviation of a sample over that of one of profile 1. `profile` is what noise of one kind alone would have there; next to
    /// a part with memory only the white part follows it: a mean of many readings is no surer of where the zero has wandered to.
    pub fn deviation(self, profile: f64) -> f64 {
        match self.white > 0.0 {
            true => (1.0 - self.white + self.white * profile * profile).sqrt(),
            false => profile,
        }
    }

    /// Part of a sample's standard deviation that has memory.
    fn slow(self, profile: f64) -> f64 {
        match self.white > 0.0 {
            true => (1.0 - self.white).sqrt() / self.deviation(profile),
            false => 1.0,
        }
    }

    /// Correlation of two samples at times (s) and of profiles; long after the first of a recording where it is set to zero there.
    pub fn between(self, one: (f64, f64), other: (f64, f64)) -> f64 {
        self.slow(one.1) * self.slow(other.1) * forgotten((one.0 - other.0).abs(), self.memory_s)
    }

    /// Filter that makes a series of samples independent that stand at times (s), have profiles, and are over their deviations.
    pub fn filter(self, samples: impl Iterator<Item = (f64, f64)>) -> Filter {
        let (mut steps, mut last) = (Vec::new(), None::<(f64, f64)>);
        for (time, profile) in samples {
            let first = if self.is_tared { 0.0 } else { 1.0 };
            let (carried, state) = last.map_or((0.0, first), |(before, left)| {
                let carried = forgotten(time - before, self.memory_s);
                let square = carried * carried;
                (carried, square * left + (1.0 - square))
            });
            let slow = self.slow(profile);
            let (variance, gain) = match self.white > 0.0 {
                true => {
                    let variance = slow * slow * state + (1.0 - slow * slow);
                    (variance, slow * state / variance)
                }
                false => (state, 1.0),
            };
            last = Some((time, (1.0 - gain * slow) * state));
            steps.push(Step {
                carried,
                slow,
                gain,
                variance,
            });
        }
        Filter { steps }
    }
}

/// What is left of the part with memory after `step`, s.
pub(crate) fn forgotten(step: f64, memory_s: f64) -> f64 {
    match memory_s > 0.0 {
        true => libm::exp(-step.max(0.0) / memory_s),
        false => 0.0,
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Step {
    /// Part of the state before that is left.
    carried: f64,
    /// What the state adds to the sample.
    slow: f64,
    /// Part of the innovation that the state takes up.
    gain: f64,
    /// Of the innovation.
    variance: f64,
}

/// Whitening of one series: a linear map, lower triangular.
#[derive(Debug, Clone, PartialEq)]
pub struct Filter {
    steps: Vec<Step>,
}

impl Filter {
    /// Innovations of the values by number.
    pub fn innovations(&self, value: impl Fn(usize) -> f64) -> Vec<f64> {
        let mut state = 0.0;
        let one = |(k, step): (usize, &Step)| {
            let (now, before) = (value(k), step.carried * state);
            let forecast = step.slow * before;
            state = match step.slow == 1.0 {
                true => now,
                false => before + step.gain * (now - forecast),
            };
            now - forecast
        };
        self.steps.iter().enumerate().map(one).collect()
    }

    /// Variances of the innovations.
    pub fn variances(&self) -> impl Iterator<Item = f64> + '_ {
        self.steps.iter().map(|step| step.variance)
    }

    /// Values as independent numbers of variance 1.
    pub fn whitened(&self, value: impl Fn(usize) -> f64) -> Vec<f64> {
        let innovations = self.innovations(value);
        let pairs = innovations.into_iter().zip(self.variances());
        pairs
            .map(|(e, variance)| e / variance.max(LEAST_FRESH).sqrt())
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{DMatrix, DVector};

    /// Against the Cholesky factor of the covariance, written out: squares and determinant, at uneven times and of uneven profiles.
    #[test]
    fn innovations_equal_the_cholesky_factor_of_the_covariance() {
        let times = [0.0, 0.1, 0.15, 0.6, 1.4, 1.41, 3.0, 7.5];
        let values = [0.3, -1.2, 0.4, 2.2, 1.9, -0.7, 0.1, 1.3];
        let even = [1.0; 8];
        let uneven = [1.0, 0.5, 0.5, 0.2, 3.0, 0.7, 1.0, 0.3];
        let cases = [
            (0.5, 0.0, false, even),
            (0.5, 0.3, false, even),
            (20.0, 0.05, true, uneven),
            (2.0, 0.9, true, even),
            (2.0, 0.6, false, uneven),
        ];
        for (memory_s, white, is_tared, profile) in cases {
            let total = |k: usize| f64::sqrt(1.0 - white + white * profile[k] * profile[k]);
            let covariance = DMatrix::from_fn(8, 8, |i, j| {
                let apart = f64::abs(times[i] - times[j]);
                let taken = match is_tared {
                    true => libm::exp(-(times[i] + times[j]) / memory_s),
                    false => 0.0,
                };
                let slow = (1.0 - white) * (libm::exp(-apart / memory_s) - taken);
                let own = if i == j {
                    white * profile[i] * profile[i]
                } else {
                    0.0
                };
                (slow + own) / (total(i) * total(j))
            });
            let root = covariance.cholesky().unwrap();
            let wanted = root
                .l()
                .solve_lower_triangular(&DVector::from_row_slice(&values))
                .unwrap();
            let correlation = Correlation {
                memory_s,
                white,
                is_tared,
            };
            let filter = correlation.filter(times.into_iter().zip(profile));
            for (own, wanted) in filter.whitened(|k| values[k]).iter().zip(wanted.iter()) {
                assert!((own - wanted).abs() < 1e-9, "{own} {wanted}");
            }
            let log: f64 = filter.variances().map(libm::log).sum();
            assert!((log - libm::log(root.determinant())).abs() < 1e-9);
        }
    }
}
