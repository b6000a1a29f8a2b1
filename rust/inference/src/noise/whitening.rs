//! Whitening: residuals as independent numbers of variance 1, censored samples included.

use nalgebra::DMatrix;

use crate::distributions::{log_normal_cdf, log_normal_density};
use crate::noise::channel::{CHANNELS, Channel};
use crate::noise::deviations::autocorrelation;
use crate::noise::estimate::Noise;
use crate::observe::measured::{Censoring, Measured};

/// How each sample's residual is whitened: `w_k = (r_k / s_k - c r_j / s_j) / sqrt(1 - c^2)`, j the sample before it.
#[derive(Debug, Clone, PartialEq)]
pub struct Whitening {
    /// Values and limits, all recordings stacked.
    measured: Vec<f64>,
    censoring: Vec<Censoring>,
    channel: Vec<Channel>,
    sigma: Vec<f64>,
    /// Sample before it whose noise it remembers, and how much of it.
    before: Vec<Option<(usize, f64)>>,
    /// By channel, what is left to divide by.
    step: [f64; CHANNELS.len()],
    /// False for samples that are left out.
    is_used: Vec<bool>,
}

/// Whitened residuals, and what makes their derivatives.
#[derive(Debug, Clone, PartialEq)]
pub struct Whitened {
    /// Residual over its noise; of a censored sample the signed root of minus twice the logarithm of its probability.
    pub residual: Vec<f64>,
    /// Derivative of a censored sample's residual by the simulated value, times sigma; 0 for seen ones.
    censored_slope: Vec<f64>,
}

impl Whitening {
    /// For recordings with that noise; those not in use are left out.
    pub fn new(measured: &[Measured], noise: &Noise, is_used: &[bool]) -> Whitening {
        let mut whitening = Whitening {
            measured: Vec::new(),
            censoring: Vec::new(),
            channel: Vec::new(),
            sigma: Vec::new(),
            before: Vec::new(),
            step: noise.step,
            is_used: Vec::new(),
        };
        for (recording, one) in measured.iter().enumerate() {
            let mut last: [Option<usize>; CHANNELS.len()] = [None; CHANNELS.len()];
            let first = whitening.measured.len();
            for (k, sample) in one.samples.iter().enumerate() {
                let channel = Channel::of(sample.quantity);
                let is_seen = sample.censoring == Censoring::Seen;
                let before = last[channel as usize].filter(|_| is_seen).map(|j: usize| {
                    let time = |k: usize| one.moments[one.samples[k].moment as usize].time_s;
                    let carried =
                        autocorrelation(time(k) - time(j), noise.memory_s[channel as usize]);
                    (first + j, carried)
                });
                // Sensels of one frame stand beside each other in the list, not after each other in time.
                let is_series = !matches!(channel, Channel::Pressure | Channel::Scan);
                if is_series && is_seen {
                    last[channel as usize] = Some(k);
                }
                whitening.measured.push(sample.value);
                whitening.censoring.push(sample.censoring);
                whitening.channel.push(channel);
                whitening.sigma.push(noise.sigma[recording][k]);
                whitening.before.push(before);
                whitening.is_used.push(is_used[recording]);
            }
        }
        whitening
    }

    /// Number of samples.
    pub fn len(&self) -> usize {
        self.measured.len()
    }

    /// Number of samples in use.
    pub fn used(&self) -> usize {
        self.is_used.iter().filter(|used| **used).count()
    }

    /// Whitened residuals of stacked predictions.
    pub fn residuals(&self, simulated: &[f64]) -> Whitened {
        let n = self.len();
        let (mut residual, mut censored_slope) = (vec![0.0; n], vec![0.0; n]);
        let scaled = |k: usize| (self.measured[k] - simulated[k]) / self.sigma[k];
        for k in (0..n).filter(|&k| self.is_used[k]) {
            let sign = match self.censoring[k] {
                Censoring::Seen => {
                    residual[k] = self.differenced(k, &scaled);
                    continue;
                }
                Censoring::AtMost => 1.0,
                Censoring::AtLeast => -1.0,
            };
            // Probability that a sample at the simulated value reads beyond the limit (Tobin 1958).
            let z = sign * scaled(k);
            let log = log_normal_cdf(z);
            let root = (-2.0 * log).sqrt();
            residual[k] = -sign * root;
            censored_slope[k] = match root > 1e-8 {
                // The density over the probability, which both vanish far from the limit.
                true => -libm::exp(log_normal_density(z) - log) / root,
                false => 0.0,
            };
        }
        Whitened {
            residual,
            censored_slope,
        }
    }

    /// Whitened derivatives of the residuals' simulated part: `L^-1 J`; columns by parameter.
    pub fn derivatives(&self, jacobian: &DMatrix<f64>, at: &Whitened) -> DMatrix<f64> {
        let mut whitened = DMatrix::zeros(jacobian.nrows(), jacobian.ncols());
        for column in 0..jacobian.ncols() {
            let scaled = |k: usize| jacobian[(k, column)] / self.sigma[k];
            for k in (0..self.len()).filter(|&k| self.is_used[k]) {
                whitened[(k, column)] = match self.censoring[k] {
                    Censoring::Seen => self.differenced(k, &scaled),
                    _ => -at.censored_slope[k] * scaled(k),
                };
            }
        }
        whitened
    }

    /// Whether a sample says something: it is in use, and seen or censored against what the simulation says.
    pub fn counts(&self, k: usize, simulated: f64) -> bool {
        let agrees = match self.censoring[k] {
            Censoring::Seen => false,
            Censoring::AtMost => simulated <= self.measured[k],
            Censoring::AtLeast => simulated >= self.measured[k],
        };
        self.is_used[k] && !agrees
    }

    /// The channel of a sample.
    pub fn channel(&self, k: usize) -> Channel {
        self.channel[k]
    }

    fn differenced(&self, k: usize, scaled: &dyn Fn(usize) -> f64) -> f64 {
        match self.before[k] {
            Some((j, autocorrelation)) => {
                let step = self.step[self.channel[k] as usize]
                    * (1.0 - autocorrelation * autocorrelation).sqrt();
                (scaled(k) - autocorrelation * scaled(j)) / step
            }
            None => scaled(k),
        }
    }
}
