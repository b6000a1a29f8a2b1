//! The noise model of a study: standard deviation of every sample, from repeats where there are any.

use crate::noise::channel::{CHANNELS, Channel};
use crate::noise::correlation::{Correlation, forgotten};
use crate::noise::deviations::{FLOOR, NoiseShape};
use crate::noise::maps::mat_smoothing::smoothed;
use crate::noise::periodic_component::Rhythm;
use crate::noise::repeat_scatter::Repeats;
use crate::noise::scatter::Scatter;
use crate::number_format::number;
use crate::observe::measured::{Measured, Quantity, Sample};
use crate::observe::robust_scale::{median, noise_of};

/// Standard deviation taken for a mat whose frames cannot tell it, as a part of the largest reading. A good film's
/// coefficient of variation is 1.5 % (Yao 2019, Measurement 145:525), a common one's calibration error 2.7 % rms.
const UNKNOWN_MAT: f64 = 0.03;

/// Time over which a wandering zero is stated, s.
const WANDER_S: f64 = 1.0;

/// What is known of the noise of a study.
#[derive(Debug, Clone, PartialEq)]
pub struct Noise {
    /// Standard deviation of every sample, in its unit, by recording.
    pub sigma: Vec<Vec<f64>>,
    /// Profile of every sample: what its standard deviation would be without a part with memory or a hum, over that of one reading without load.
    pub profile: Vec<Vec<f64>>,
    /// Correlation in time, by [`CHANNELS`].
    pub correlation: [Correlation; CHANNELS.len()],
    /// Degrees of freedom of the standard deviation; None without repeats.
    pub degrees: Option<f64>,
    /// Standard deviation between repeats of the logarithm of the gain; 0 where it cannot be told.
    pub gain: f64,
    /// Standard deviation between repeats of the depth of first touch, mm; None where it cannot be told.
    pub zero_mm: Option<f64>,
    /// Standard deviation between repeats of the force's zero, N; None where it cannot be judged.
    pub force_zero_n: Option<f64>,
    /// Whether the force's zeros differ by clearly more than noise makes them.
    pub has_clear_zeros: bool,
    /// By [`CHANNELS`]: standard deviation of what noise adds from sample to sample, over what the correlation says.
    pub step: [f64; CHANNELS.len()],
    /// By [`CHANNELS`]: whitened deviations of repeats from their mean, from which noise can be drawn with its outliers.
    pub drawn_from: [Vec<f64>; CHANNELS.len()],
    /// The clearest rhythm in which the forces of repeats differ.
    pub rhythm: Option<Rhythm>,
    /// A hum of the force's instrument: its frequency, Hz, and amplitude, N.
    pub hum: Option<(f64, f64)>,
    /// Whether depths are known with an error, which acts on the forces through their slope.
    pub has_depth_error: bool,
    /// What a reader should be told.
    pub notes: Vec<String>,
}

/// Noise of a study's recordings.
///
/// `simulated` are predictions by recording, and `slopes` their derivatives by depth (per mm): along these the repeats of a protocol may
/// differ as a whole (gain, contact zero, zero of the force) without being noisy. `is_used` says which recordings may be looked at; `noise_n` is the
/// data sheet's noise of a force.
pub fn noise(
    measured: &[Measured],
    (simulated, slopes): (&[Vec<f64>], &[Vec<f64>]),
    is_used: &[bool],
    noise_n: Option<f64>,
) -> Noise {
    let groups = crate::noise::repeat_scatter::groups(measured, is_used);
    let scatter = CHANNELS.map(|channel| {
        Repeats::new(channel, &groups, measured).scatter(measured, (simulated, slopes))
    });
    let degrees: f64 = scatter.iter().flatten().map(|s| s.degrees).sum();
    let forces = scatter[0].as_ref();
    let mut notes = Vec::new();
    if degrees == 0.0 {
        notes.push(
            "no protocol was repeated: noise is judged by how rough each recording is, and whether the misfit is more than noise cannot be tested"
                .to_owned(),
        );
    }
    let (sigma, profile): (Vec<Vec<f64>>, Vec<Vec<f64>>) = measured
        .iter()
        .enumerate()
        .map(|(recording, one)| sigma(one, recording, &scatter, noise_n))
        .unzip();
    let mut sigma = sigma;
    let hum = forces.and_then(|s| hum(s, measured, (&sigma, &profile)));
    let is_off = |(_, one): &(usize, &Measured)| one.depth_error_mm > 0.0;
    for (recording, one) in measured.iter().enumerate().filter(is_off) {
        let found = (&simulated[recording][..], &slopes[recording][..]);
        add_depth_error(&mut sigma[recording], one, found);
    }
    Noise {
        sigma,
        profile,
        correlation: [0, 1, 2, 3, 4].map(|c| {
            scatter[c]
                .as_ref()
                .map_or(Correlation::NONE, |s| s.correlation)
        }),
        degrees: (degrees > 0.0).then_some(degrees),
        gain: forces.or(scatter[3].as_ref()).map_or(0.0, |s| s.gain),
        zero_mm: forces.and_then(|s| s.zero_mm),
        force_zero_n: forces.and_then(|s| s.force_zero_n),
        has_clear_zeros: forces.is_some_and(|s| s.has_clear_zeros),
        step: [0, 1, 2, 3, 4].map(|c| scatter[c].as_ref().map_or(1.0, |s| s.step)),
        drawn_from: [0, 1, 2, 3, 4].map(|c| {
            scatter[c]
                .as_ref()
                .map_or_else(Vec::new, |s| s.drawn_from.clone())
        }),
        rhythm: forces.and_then(|s| s.rhythm),
        hum,
        has_depth_error: measured.iter().any(|one| one.depth_error_mm > 0.0),
        notes,
    }
}

impl Noise {
    /// How far the force's zeros of recordings lie apart; None where noise alone may make them differ so.
    pub fn zero_note(&self) -> Option<String> {
        let sd = self.force_zero_n.filter(|_| self.has_clear_zeros)?;
        let sd = number(1000.0 * sd);
        Some(format!(
            "the zero of the force differs from recording to recording by {sd} mN (standard deviation); each has its own in the fit. Tare before each \
             recording to have smaller effects seen"
        ))
    }

    /// What the force hums; None where it does not.
    pub fn hum_note(&self) -> Option<String> {
        let (hz, mn) = (number(self.hum?.0), number(1000.0 * self.hum?.1));
        Some(format!(
            "the force hums at {hz} Hz by {mn} mN (amplitude), under load and without alike: that comes from the instrument or its mount, not from the \
             skin, and counts as noise. Remove it to have smaller effects seen"
        ))
    }

    /// How far repeats drift apart, as where the force's zero wanders, and how noisy each reading is; None where they do not.
    ///
    /// What rounded depths leave drifts apart too, so where depths have an error the zero is not said to wander.
    /// `forces` are samples of the force, each by its recording and its number there.
    pub fn wander_note(&self, forces: impl Iterator<Item = (usize, usize)>) -> Option<String> {
        let correlation = self.correlation[Channel::Force as usize];
        let size =
            |(r, k): (usize, usize)| self.sigma[r][k] / correlation.deviation(self.profile[r][k]);
        let mut sizes: Vec<f64> = forces.map(size).collect();
        if correlation.white == 0.0 || sizes.is_empty() {
            return None;
        }
        let size = median(&mut sizes);
        let left = forgotten(WANDER_S, correlation.memory_s);
        let wander = size * (2.0 * (1.0 - correlation.white) * (1.0 - left)).sqrt();
        let (wander, white) = (
            number(1000.0 * wander),
            number(1000.0 * size * correlation.white.sqrt()),
        );
        Some(if self.has_depth_error {
            format!(
                "repeats of one protocol drift apart by {wander} mN in {WANDER_S} s, in addition to {white} mN of noise in each reading: a zero of \
                 the force that wanders, or what depths read in steps leave; what drifts no further is not taken for an effect"
            )
        } else {
            format!(
                "the zero of the force wanders, in repeats of one protocol by {wander} mN in {WANDER_S} s, in addition to {white} mN of noise in \
                 each reading; what wanders no further is not taken for an effect"
            )
        })
    }
}

/// Frequency (Hz) and amplitude (N) of a hum, by standard deviations and profiles of all samples; None where there is none.
fn hum(
    scatter: &Scatter,
    measured: &[Measured],
    (sigma, profile): (&[Vec<f64>], &[Vec<f64>]),
) -> Option<(f64, f64)> {
    let correlation = scatter.correlation;
    let hum = Some(correlation.hum).filter(|hum| hum.variance > 0.0)?;
    let first = |(r, one): (usize, &Measured)| {
        let mut samples = one.samples.iter();
        let k = samples.position(|s| s.quantity == Quantity::Force)?;
        Some(sigma[r][k] / correlation.deviation(profile[r][k]))
    };
    let mut sizes: Vec<f64> = measured.iter().enumerate().filter_map(first).collect();
    Some((hum.hz, (2.0 * hum.variance).sqrt() * median(&mut sizes)))
}

/// Adds to the forces' noise what an error of the depth does through their slope (per mm), as large as the forces were.
fn add_depth_error(sigma: &mut [f64], one: &Measured, (simulated, slopes): (&[f64], &[f64])) {
    let is_force = |k: &usize| one.samples[*k].quantity == Quantity::Force;
    let forces = || (0..sigma.len()).filter(is_force);
    let over = |k: usize| one.samples[k].value / simulated[k];
    let most = forces().map(|k| simulated[k]).fold(0.0, f64::max);
    let pressed = forces().filter(|k| simulated[*k] > 0.5 * most);
    let mut ratios: Vec<f64> = pressed.map(over).collect();
    if most <= 0.0 || ratios.is_empty() {
        return;
    }
    let scale = median(&mut ratios);
    for k in (0..sigma.len()).filter(is_force) {
        sigma[k] = sigma[k].hypot(slopes[k] * scale * one.depth_error_mm);
    }
}

/// Standard deviation and profile of every sample of a recording.
fn sigma(
    measured: &Measured,
    recording: usize,
    scatter: &[Option<Scatter>; CHANNELS.len()],
    noise_n: Option<f64>,
) -> (Vec<f64>, Vec<f64>) {
    let of_channel = CHANNELS.map(|channel| {
        let is_it = |q: Quantity| Channel::of(q) == channel;
        let samples = measured.samples.iter().filter(|s| is_it(s.quantity));
        let values: Vec<f64> = samples.map(|s| s.value).collect();
        let most = values.iter().fold(0.0, |most, v| f64::max(most, v.abs()));
        if channel == Channel::Scan {
            // In mm: a scanner's noise does not grow with how far the skin was moved.
            let single = measured.scan.as_ref().map_or(0.0, |scan| scan.scatter_mm);
            let repeats = scatter[channel as usize].as_ref();
            return (
                repeats.map_or(single, |s| s.share_of(recording)),
                0.0,
                NoiseShape::EVEN,
            );
        }
        let found = scatter[channel as usize].as_ref();
        let shape = found.map_or(NoiseShape::EVEN, |scatter| scatter.shape);
        let (share, proportional) = match found {
            Some(scatter) => {
                let share = scatter.share_of(recording);
                (share, f64::max(scatter.proportional, share * shape.ratio))
            }
            None if channel == Channel::Pressure => (UNKNOWN_MAT, 0.0),
            None => (noise_of(&values) / most.max(f64::MIN_POSITIVE), 0.0),
        };
        let floor = match channel {
            Channel::Force if scatter[0].is_none() => noise_n.unwrap_or(0.0),
            _ => 0.0,
        };
        ((share.max(FLOOR) * most).max(floor), proportional, shape)
    });
    let one = |sample: &Sample, value: f64| {
        let (constant, proportional, shape) = of_channel[Channel::of(sample.quantity) as usize];
        let readings = f64::from(measured.moments[sample.moment as usize].readings);
        let mean = shape.at(0.0, readings);
        let alone = (constant.hypot(proportional * value) * mean).max(f64::MIN_POSITIVE);
        let profile = alone / constant.max(f64::MIN_POSITIVE);
        match scatter[Channel::of(sample.quantity) as usize].as_ref() {
            Some(s) if s.correlation.is_mixed() => {
                (constant * s.correlation.deviation(profile), profile)
            }
            _ => (alone, profile),
        }
    };
    let judged = smoothed(measured);
    let samples = measured.samples.iter().zip(&judged);
    // Rounding is no noise that a mean of equal readings is free of.
    let of_rounding = |s: &Sample| match s.quantity {
        Quantity::Force => measured.moments[s.moment as usize].force_step_n / 12f64.sqrt(),
        _ => 0.0,
    };
    let each = samples.map(|(s, by)| (one(s, *by), of_rounding(s)));
    each.map(|((sigma, profile), least)| (sigma.max(least), profile))
        .unzip()
}
