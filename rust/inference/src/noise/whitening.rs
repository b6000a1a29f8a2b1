//! Whitening: residuals as independent numbers of variance 1, censored samples included.

use std::ops::Range;

use nalgebra::DMatrix;

use crate::distributions::{log_normal_cdf, log_normal_density};
use crate::noise::channel::Channel;
use crate::noise::correlation::Filter;
use crate::noise::estimate::Noise;
use crate::observe::measured::{Censoring, Measured, Sample};

/// How each sample's residual is whitened: the innovations of `r_k / s_k` along the samples of one channel, over their deviations.
#[derive(Debug, Clone, PartialEq)]
pub struct Whitening {
    /// Values and limits, all recordings stacked.
    measured: Vec<f64>,
    censoring: Vec<Censoring>,
    channel: Vec<Channel>,
    sigma: Vec<f64>,
    /// Half of the step to which a sample is rounded, where it is larger than the noise; else 0.
    half_step: Vec<f64>,
    /// Samples of one channel of one recording in the order of time, and their filter.
    series: Vec<Series>,
    /// False for samples that are left out.
    is_used: Vec<bool>,
}

/// One channel of one recording.
#[derive(Debug, Clone, PartialEq)]
struct Series {
    samples: Vec<usize>,
    filter: Filter,
    /// By sample, what an innovation is divided by.
    deviation: Vec<f64>,
}

/// Whitened residuals, and what makes their derivatives.
#[derive(Debug, Clone, PartialEq)]
pub struct Whitened {
    /// Residual over its noise; of a censored sample the signed root of minus twice the logarithm of its probability.
    pub residual: Vec<f64>,
    /// Derivative of a censored sample's residual by the simulated value, times sigma; 0 for seen ones.
    censored_slope: Vec<f64>,
}

/// Channels whose samples follow each other in time; sensels of one frame and points of one scan do not.
const IN_TIME: [Channel; 3] = [Channel::Force, Channel::Tangential, Channel::Area];

impl Series {
    /// Of the seen samples of `channel`; `at` are the numbers of the recording and of its first sample.
    fn of(one: &Measured, channel: Channel, at: (usize, usize), noise: &Noise) -> Series {
        let is_it = |(_, s): &(usize, &Sample)| {
            Channel::of(s.quantity) == channel && s.censoring == Censoring::Seen
        };
        let samples = || one.samples.iter().enumerate().filter(is_it);
        let (recording, first) = at;
        let profile = &noise.profile[recording];
        let each = samples().map(|(k, s)| (one.moments[s.moment as usize].time_s, profile[k]));
        let filter = noise.correlation[channel as usize].filter(each);
        let step = noise.step[channel as usize];
        let deviation = filter.variances().enumerate().map(|(k, variance)| match k {
            0 => variance.sqrt(),
            _ => step * variance.sqrt(),
        });
        Series {
            samples: samples().map(|(k, _)| first + k).collect(),
            deviation: deviation.collect(),
            filter,
        }
    }
}

impl Whitening {
    /// For recordings with that noise; those not in use are left out.
    pub fn new(measured: &[Measured], noise: &Noise, is_used: &[bool]) -> Whitening {
        let mut whitening = Whitening {
            measured: Vec::new(),
            censoring: Vec::new(),
            channel: Vec::new(),
            sigma: Vec::new(),
            half_step: Vec::new(),
            series: Vec::new(),
            is_used: Vec::new(),
        };
        for (recording, one) in measured.iter().enumerate() {
            let first = whitening.measured.len();
            for (k, sample) in one.samples.iter().enumerate() {
                whitening.measured.push(sample.value);
                whitening.censoring.push(sample.censoring);
                whitening.channel.push(Channel::of(sample.quantity));
                whitening.sigma.push(noise.sigma[recording][k]);
                whitening.half_step.push(one.half_step_n(sample));
                whitening.is_used.push(is_used[recording]);
            }
            if is_used[recording] {
                let series =
                    IN_TIME.map(|channel| Series::of(one, channel, (recording, first), noise));
                whitening
                    .series
                    .extend(series.into_iter().filter(|s| !s.samples.is_empty()));
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
    ///
    /// Of a sample that is rounded nobody knows where within half a step of its reading it was, so that only what is farther off counts (grouped
    /// data: Heitjan 1989, Statistical Science 4:164). Derivatives are those of the prediction all the same: a residual of 0 pulls at nothing, and
    /// a curvature that is too large only shortens the way of a fit.
    pub fn residuals(&self, simulated: &[f64]) -> Whitened {
        let n = self.len();
        let (mut residual, mut censored_slope) = (vec![0.0; n], vec![0.0; n]);
        let scaled = |k: usize| {
            let off = self.measured[k] - simulated[k];
            let within = off.clamp(-self.half_step[k], self.half_step[k]);
            (off - within) / self.sigma[k]
        };
        self.seen((0..n, &scaled), &mut |k, white| residual[k] = white);
        for k in (0..n).filter(|&k| self.is_used[k]) {
            let sign = match self.censoring[k] {
                Censoring::Seen => continue,
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
        if jacobian.is_empty() {
            return whitened;
        }
        let columns = jacobian.as_slice().chunks_exact(jacobian.nrows());
        let mut white = whitened.as_mut_slice().chunks_exact_mut(jacobian.nrows());
        for (column, white) in columns.zip(&mut white) {
            let set = span(column);
            let scaled = |k: usize| column[k] / self.sigma[k];
            for k in set.clone().filter(|&k| self.is_used[k]) {
                if self.censoring[k] != Censoring::Seen {
                    white[k] = -at.censored_slope[k] * scaled(k);
                }
            }
            self.seen((set, &scaled), &mut |k, value| white[k] = value);
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

    /// Gives every seen sample in use with its whitened value; those outside of the samples `set` are 0 before, and not given unless they
    /// follow one of `set`.
    fn seen(
        &self,
        (set, scaled): (Range<usize>, impl Fn(usize) -> f64),
        give: &mut impl FnMut(usize, f64),
    ) {
        for k in set.clone().filter(|&k| self.is_used[k]) {
            if self.censoring[k] == Censoring::Seen && !IN_TIME.contains(&self.channel[k]) {
                give(k, scaled(k));
            }
        }
        for series in &self.series {
            let ends = series.samples.first().zip(series.samples.last());
            if ends.is_none_or(|(first, last)| set.end <= *first || *last < set.start) {
                continue;
            }
            let innovations = series.filter.innovations(|k| scaled(series.samples[k]));
            for (k, innovation) in innovations.into_iter().enumerate() {
                give(series.samples[k], innovation / series.deviation[k]);
            }
        }
    }
}

/// Samples from the first that is not 0 to behind the last.
pub(crate) fn span(column: &[f64]) -> Range<usize> {
    let is_set = |x: &f64| *x != 0.0;
    let first = column.iter().position(is_set).unwrap_or(0);
    let last = column.iter().rposition(is_set).map_or(0, |k| k + 1);
    first..last.max(first)
}
