//! What repeats of one channel show: noise within a recording, and variance of gain, first touch and the zero of the force between recordings.

use crate::noise::correlation::Correlation;
use crate::noise::deviations::NoiseShape;
use crate::noise::periodic_component::Rhythm;

/// What the repeats of a channel show.
#[derive(Debug, Clone, PartialEq)]
pub struct Scatter {
    /// Recording, and its standard deviation as a part of its largest value.
    pub(crate) shares: Vec<(usize, f64)>,
    /// The same of all.
    pub(crate) pooled: f64,
    /// Part of the standard deviation that grows with the value (mats).
    pub proportional: f64,
    /// How the noise of forces and areas differs from sample to sample.
    pub shape: NoiseShape,
    /// Degrees of freedom.
    pub degrees: f64,
    /// Correlation in time.
    pub correlation: Correlation,
    /// Standard deviation between repeats of the logarithm of the gain.
    pub gain: f64,
    /// Standard deviation between repeats of first touch, mm.
    pub zero_mm: Option<f64>,
    /// Standard deviation between repeats of the force's zero, N; None where it cannot be judged.
    pub force_zero_n: Option<f64>,
    /// Whether they differ by clearly more than noise makes them.
    pub has_clear_zeros: bool,
    /// Standard deviation of whitened deviations: 1 if noise is correlated as stated.
    pub step: f64,
    /// Whitened deviations over it, outliers among them.
    pub drawn_from: Vec<f64>,
    /// The clearest rhythm in them.
    pub rhythm: Option<Rhythm>,
}

impl Scatter {
    /// Of maps: shares of the peak that are constant and that grow with the reading.
    pub(crate) fn of_map(members: &[usize], parts: (f64, f64), degrees: f64, gain: f64) -> Scatter {
        Scatter {
            shares: members.iter().map(|k| (*k, parts.0)).collect(),
            pooled: parts.0,
            proportional: parts.1,
            shape: NoiseShape::EVEN,
            degrees,
            correlation: Correlation::NONE,
            gain,
            zero_mm: None,
            force_zero_n: None,
            has_clear_zeros: false,
            step: 1.0,
            drawn_from: Vec::new(),
            rhythm: None,
        }
    }

    /// Standard deviation of a recording's channel as a part of its largest value.
    pub(crate) fn share_of(&self, recording: usize) -> f64 {
        let own = self.shares.iter().find(|(k, _)| *k == recording);
        own.map_or(self.pooled, |(_, share)| *share)
    }
}
