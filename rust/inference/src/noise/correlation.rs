//! Correlation of noise in time: a part that forgets itself, a part that is new in every sample, and a hum.
//!
//! The first is an Ornstein-Uhlenbeck process, the second white; together the noise of a sensor whose zero wanders. The third is a sine of one
//! frequency, of any phase and a normal size in each recording. Innovations are those of a Kalman filter (Kalman 1960; Jones 1980, Technometrics
//! 22:389, for samples at any times; Harvey 1989, Forecasting, Structural Time Series Models and the Kalman Filter, section 2.3, for the sine), which
//! for one part alone are the differences of a first-order autoregression.

use nalgebra::{Matrix3, Vector3};

/// Least part of a sample's variance that the samples before do not determine.
pub(crate) const LEAST_FRESH: f64 = 1e-6;

/// A hum: noise of one frequency.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hum {
    /// Hz.
    pub hz: f64,
    /// Its variance over that of the rest in one reading without load; 0: there is none.
    pub variance: f64,
}

impl Hum {
    /// None.
    pub const NONE: Hum = Hum {
        hz: 0.0,
        variance: 0.0,
    };

    /// Radians turned in a time, s.
    fn turned(self, time_s: f64) -> f64 {
        std::f64::consts::TAU * self.hz * time_s
    }
}

/// Correlation of noise of which one reading without load has variance 1, and a hum in addition.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Correlation {
    /// Time over which the part with memory forgets itself, s; 0: at once.
    pub memory_s: f64,
    /// Share of the variance, without a hum, that is new in every sample; 0 without memory, where all of it is.
    pub white: f64,
    /// Whether the part with memory is nothing at a recording's first sample, as in a sensor that is set to zero before each.
    pub is_tared: bool,
    /// What hums in addition.
    pub hum: Hum,
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
            hum: Hum::NONE,
        }
    }

    /// Whether a sample's noise has parts of which each has a size of its own, next to the one that its profile says.
    pub fn is_mixed(self) -> bool {
        self.white > 0.0 || self.hum.variance > 0.0
    }

    /// Time over which deviations go on, s: the memory, or half a turn of a hum.
    pub fn goes_on_s(self) -> f64 {
        match self.hum.variance > 0.0 {
            true => self.memory_s.max(0.5 / self.hum.hz),
            false => self.memory_s,
        }
    }

    /// Standard deviation of a sample over that of one of profile 1. `profile` is what noise of one kind alone would have there; next to
    /// a part with memory only the white part follows it: a mean of many readings is no surer of where the zero has wandered to.
    pub fn deviation(self, profile: f64) -> f64 {
        match self.is_mixed() {
            true => self.without_hum(profile).hypot(self.hum.variance.sqrt()),
            false => profile,
        }
    }

    fn without_hum(self, profile: f64) -> f64 {
        match self.white > 0.0 {
            true => (1.0 - self.white + self.white * profile * profile).sqrt(),
            false => profile,
        }
    }

    /// Part of a sample's standard deviation that has memory.
    fn slow(self, profile: f64) -> f64 {
        match self.white > 0.0 {
            true => (1.0 - self.white).sqrt() / self.deviation(profile),
            false if self.hum.variance > 0.0 => profile / self.deviation(profile),
            false => 1.0,
        }
    }

    /// Part of a sample's standard deviation that hums.
    fn humming(self, profile: f64) -> f64 {
        self.hum.variance.sqrt() / self.deviation(profile)
    }

    /// Correlation of two samples at times (s) and of profiles; long after the first of a recording where it is set to zero there.
    pub fn between(self, one: (f64, f64), other: (f64, f64)) -> f64 {
        let apart = (one.0 - other.0).abs();
        let slow = self.slow(one.1) * self.slow(other.1) * forgotten(apart, self.memory_s);
        match self.hum.variance > 0.0 {
            true => {
                let humming = self.humming(one.1) * self.humming(other.1);
                slow + humming * libm::cos(self.hum.turned(apart))
            }
            false => slow,
        }
    }

    /// Filter that makes a series of samples independent that stand at times (s), have profiles, and are over their deviations.
    pub fn filter(self, samples: impl Iterator<Item = (f64, f64)>) -> Filter {
        if self.hum.variance > 0.0 {
            return self.filter_of_hum(samples);
        }
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
        Filter {
            steps,
            hums: Vec::new(),
        }
    }

    /// The same with a hum: a state with memory, and the hum and what it is a quarter turn later.
    fn filter_of_hum(self, samples: impl Iterator<Item = (f64, f64)>) -> Filter {
        let slow = if self.is_tared { 0.0 } else { 1.0 };
        let mut spread = Matrix3::from_diagonal(&Vector3::new(slow, 1.0, 1.0));
        let (mut hums, mut last) = (Vec::new(), None);
        for (time, profile) in samples {
            let step: f64 = time - last.unwrap_or(time);
            let carried = forgotten(step, self.memory_s);
            let carried = if last.is_some() { carried } else { 1.0 };
            let (sine, cosine) = libm::sincos(self.hum.turned(step));
            #[rustfmt::skip]
            let carry = Matrix3::new(
                carried, 0.0, 0.0,
                0.0, cosine, sine,
                0.0, -sine, cosine,
            );
            spread = carry * spread * carry.transpose();
            spread[(0, 0)] += 1.0 - carried * carried;
            let shows = Vector3::new(self.slow(profile), self.humming(profile), 0.0);
            let white = (1.0 - shows.norm_squared()).max(0.0);
            let seen = spread * shows;
            let variance = shows.dot(&seen) + white;
            let gain = seen / variance.max(f64::MIN_POSITIVE);
            spread -= gain * seen.transpose();
            last = Some(time);
            hums.push(HumStep {
                carry,
                shows,
                gain,
                variance,
            });
        }
        Filter {
            steps: Vec::new(),
            hums,
        }
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
    /// Instead of these where there is a hum.
    hums: Vec<HumStep>,
}

/// As [`Step`], with a state of three numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
struct HumStep {
    carry: Matrix3<f64>,
    shows: Vector3<f64>,
    gain: Vector3<f64>,
    variance: f64,
}

impl Filter {
    /// Innovations of the values by number.
    pub fn innovations(&self, value: impl Fn(usize) -> f64) -> Vec<f64> {
        if !self.hums.is_empty() {
            let mut state = Vector3::zeros();
            let one = |(k, step): (usize, &HumStep)| {
                state = step.carry * state;
                let innovation = value(k) - step.shows.dot(&state);
                state += step.gain * innovation;
                innovation
            };
            return self.hums.iter().enumerate().map(one).collect();
        }
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
        let hums = self.hums.iter().map(|step| step.variance);
        self.steps.iter().map(|step| step.variance).chain(hums)
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
            (0.5, 0.0, false, even, 0.0),
            (0.5, 0.3, false, even, 0.0),
            (20.0, 0.05, true, uneven, 0.0),
            (2.0, 0.9, true, even, 0.0),
            (2.0, 0.6, false, uneven, 0.0),
            (0.0, 0.0, false, uneven, 4.0),
            (0.5, 0.0, false, uneven, 0.7),
            (2.0, 0.6, false, uneven, 2.0),
            (2.0, 0.6, true, even, 0.5),
        ];
        for (memory_s, white, is_tared, profile, hum) in cases {
            // Without a white part all of the noise follows its profile.
            let (slow_profile, white_part) = match white > 0.0 {
                true => (even, white),
                false => (profile, 0.0),
            };
            let of_slow = |k: usize| (1.0 - white_part) * slow_profile[k] * slow_profile[k];
            let base = |k: usize| of_slow(k) + white_part * profile[k] * profile[k];
            let total = |k: usize| f64::sqrt(base(k) + hum);
            let kept = |time: f64| {
                if memory_s > 0.0 {
                    libm::exp(-time / memory_s)
                } else {
                    f64::from(time == 0.0)
                }
            };
            let covariance = DMatrix::from_fn(8, 8, |i, j| {
                let apart = f64::abs(times[i] - times[j]);
                let taken = match is_tared {
                    true => libm::exp(-(times[i] + times[j]) / memory_s),
                    false => 0.0,
                };
                let slow = f64::sqrt(of_slow(i) * of_slow(j)) * (kept(apart) - taken)
                    + hum * libm::cos(std::f64::consts::TAU * 0.8 * apart);
                let own = if i == j {
                    white * profile[i] * profile[i]
                } else {
                    0.0
                };
                (slow + own) / (total(i) * total(j))
            });
            let root = covariance.clone().cholesky().unwrap();
            let wanted = root
                .l()
                .solve_lower_triangular(&DVector::from_row_slice(&values))
                .unwrap();
            let correlation = Correlation {
                memory_s,
                white,
                is_tared,
                hum: Hum {
                    hz: 0.8,
                    variance: hum,
                },
            };
            for (i, j) in [(0, 3), (5, 6)].into_iter().filter(|_| !is_tared) {
                let found = correlation.between((times[i], profile[i]), (times[j], profile[j]));
                assert!((found - covariance[(i, j)]).abs() < 1e-12, "{found}");
            }
            let filter = correlation.filter(times.into_iter().zip(profile));
            for (own, wanted) in filter.whitened(|k| values[k]).iter().zip(wanted.iter()) {
                assert!((own - wanted).abs() < 1e-9, "{own} {wanted}");
            }
            let log: f64 = filter.variances().map(libm::log).sum();
            assert!((log - libm::log(root.determinant())).abs() < 1e-9);
        }
    }
}
