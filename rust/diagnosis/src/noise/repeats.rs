//! What repeats of a protocol show: noise within a recording, and how recordings differ as a whole.

use nalgebra::Vector2;

use super::alike::{Told, aligned};
use super::restricted;
use super::rhythm::{Rhythm, rhythm};
use super::together::Together;
use super::{Channel, POOLED_DEGREES};
use crate::observe::Measured;
use crate::observe::scatter::median;

/// Deviations beyond this many standard deviations are outliers, and not noise.
pub(super) const OUTLIER: f64 = 3.5;
/// Variance that values within `OUTLIER` standard deviations of a normal law keep.
const KEPT_VARIANCE: f64 = 0.9935;
/// Least part of a sample's variance that the one before does not tell.
pub(super) const LEAST_FRESH: f64 = 1e-6;
/// Fewest samples of a channel from which noise is told.
pub(super) const LEAST_SAMPLES: usize = 8;
/// Recordings of one protocol with one tool at one place, by number; two or more.
pub type Group = Vec<usize>;

/// Recordings that repeat each other.
pub fn groups(measured: &[Measured], is_used: &[bool]) -> Vec<Group> {
    let mut groups: Vec<Group> = Vec::new();
    let used = (0..measured.len()).filter(|&k| is_used[k] && !measured[k].samples.is_empty());
    for recording in used {
        let one = &measured[recording];
        let key = |m: &Measured| (m.protocol.clone(), m.indenter.clone(), m.site.clone());
        match groups.iter_mut().find(|g| key(&measured[g[0]]) == key(one)) {
            Some(group) => group.push(recording),
            None => groups.push(vec![recording]),
        }
    }
    groups.retain(|group| group.len() > 1);
    groups
}

/// What the repeats of a channel show.
#[derive(Debug, Clone, PartialEq)]
pub struct Scatter {
    /// Recording, and its standard deviation as a part of its largest value.
    shares: Vec<(usize, f64)>,
    /// The same of all.
    pooled: f64,
    /// Part of the standard deviation that grows with the value (mats).
    pub proportional: f64,
    /// Degrees of freedom.
    pub degrees: f64,
    /// Time over which noise forgets itself, s.
    pub memory_s: f64,
    /// Standard deviation between repeats of the logarithm of the gain.
    pub gain: f64,
    /// Standard deviation between repeats of first touch, mm.
    pub zero_mm: Option<f64>,
    /// Standard deviation of whitened deviations: 1 if noise forgets itself as that memory says.
    pub step: f64,
    /// Whitened deviations over it, outliers among them.
    pub drawn_from: Vec<f64>,
    /// The clearest rhythm in them.
    pub rhythm: Option<Rhythm>,
}

impl Scatter {
    /// Of maps: shares of the peak that are constant and that grow with the reading.
    pub fn of_map(members: &[usize], parts: (f64, f64), degrees: f64, gain: f64) -> Scatter {
        Scatter {
            shares: members.iter().map(|k| (*k, parts.0)).collect(),
            pooled: parts.0,
            proportional: parts.1,
            degrees,
            memory_s: 0.0,
            gain,
            zero_mm: None,
            step: 1.0,
            drawn_from: Vec::new(),
            rhythm: None,
        }
    }

    /// Standard deviation of a recording's channel as a part of its largest value.
    pub fn share_of(&self, recording: usize) -> f64 {
        let own = self.shares.iter().find(|(k, _)| *k == recording);
        own.map_or(self.pooled, |(_, share)| *share)
    }
}

/// The repeats of one channel.
pub struct Repeats {
    channel: Channel,
    groups: Vec<Group>,
}

/// Deviations within one group.
pub(super) struct Deviations {
    pub(super) group: Group,
    /// s.
    pub(super) time: Vec<f64>,
    /// Largest mean value.
    pub(super) most: f64,
    /// Deviation by repeat and sample, with what differs as a whole taken out.
    pub(super) rest: Vec<Vec<f64>>,
    /// What differs as a whole, by repeat: logarithm of gain, and zero in mm; and what each sample adds to them.
    pub(super) whole: Vec<Vector2<f64>>,
    pub(super) along: Vec<Vector2<f64>>,
}

impl Repeats {
    /// Of a channel: a press's force and its map share a protocol, but each repeats its own kind.
    pub fn new(channel: Channel, groups: &[Group], measured: &[Measured]) -> Repeats {
        let has = |k: &usize| {
            let mut samples = measured[*k].samples.iter();
            samples.any(|s| Channel::of(s.quantity) == channel)
        };
        let own = |group: &Group| -> Group { group.iter().copied().filter(has).collect() };
        let groups = groups
            .iter()
            .map(own)
            .filter(|group| group.len() > 1)
            .collect();
        Repeats { channel, groups }
    }

    /// What they show; None without repeats of that channel.
    pub fn scatter(
        &self,
        measured: &[Measured],
        (simulated, slopes): (&[Vec<f64>], &[Vec<f64>]),
    ) -> Option<Scatter> {
        match self.channel {
            Channel::Pressure => return super::frames::scatter(&self.groups, measured),
            Channel::Scan => return super::scans::scatter(&self.groups, measured),
            _ => {}
        }
        let beside = |&k: &usize| Told {
            measured: &measured[k],
            simulated: &simulated[k],
            slopes: &slopes[k],
        };
        let aligned_all: Vec<(&Group, Together)> = self
            .groups
            .iter()
            .filter_map(|group| {
                let repeats: Vec<Told<'_>> = group.iter().map(beside).collect();
                Some((group, Together::new(aligned(self.channel, &repeats))?))
            })
            .collect();
        let each = aligned_all.iter();
        let all: Vec<Deviations> = each
            .filter_map(|(group, together)| together.deviations(group))
            .collect();
        if all.is_empty() {
            return None;
        }
        let told = restricted::told(&all);
        let memory_s = told.memory_s;
        let of_most =
            |(d, (sigma, degrees)): (&Deviations, &(f64, f64))| (sigma / d.most, *degrees);
        let shares: Vec<(f64, f64)> = all.iter().zip(&told.sizes).map(of_most).collect();
        let degrees: f64 = shares.iter().map(|s| s.1).sum();
        let pooled = (shares.iter().map(|(s, n)| s * s * n).sum::<f64>() / degrees).sqrt();
        let shrunk = |(own, n): &(f64, f64)| {
            ((own * own * n + pooled * pooled * POOLED_DEGREES) / (n + POOLED_DEGREES)).sqrt()
        };
        let between = between(&all, &shares, memory_s);
        let (step, drawn_from) = pooled_steps(&all, &told);
        let of_group = all.iter().zip(&shares);
        let each = of_group.flat_map(|(d, s)| d.group.iter().map(move |k| (*k, shrunk(s))));
        Some(Scatter {
            shares: each.collect(),
            pooled,
            proportional: 0.0,
            degrees,
            memory_s,
            gain: between.x,
            zero_mm: (self.channel == Channel::Force).then_some(between.y),
            step,
            drawn_from,
            rhythm: rhythm(&all, memory_s),
        })
    }
}

impl Deviations {
    /// Deviations made independent, over the standard deviation of the noise, by repeat.
    fn whitened(&self, (sigma, memory_s): (f64, f64)) -> Vec<Vec<f64>> {
        let m = self.rest.len() as f64;
        // The repeats' own mean takes part of each.
        let sigma = sigma * ((m - 1.0) / m).sqrt();
        let steps: Vec<f64> = self.time.windows(2).map(|w| w[1] - w[0]).collect();
        let series = |rest: &Vec<f64>| -> Vec<f64> {
            (1..rest.len())
                .map(|k| {
                    let carried = carry(steps[k - 1], memory_s);
                    fresh(rest[k], rest[k - 1], carried) / sigma
                })
                .collect()
        };
        match sigma > 0.0 {
            true => self.rest.iter().map(series).collect(),
            false => Vec::new(),
        }
    }

    /// Variance of what differs as a whole, for noise of variance 1 with that memory.
    fn unit_variance(&self, memory_s: f64) -> Vector2<f64> {
        let mut sum = Vector2::zeros();
        for (k, a) in self.along.iter().enumerate() {
            sum += a.component_mul(a);
            // Noise remembers little of what lies many memories back.
            for j in (0..k).rev() {
                let shared = carry(self.time[k] - self.time[j], memory_s);
                if shared < 1e-3 {
                    break;
                }
                sum += a.component_mul(&self.along[j]) * (2.0 * shared);
            }
        }
        sum
    }
}

/// Standard deviation of the whitened deviations of all groups, and those over it.
fn pooled_steps(all: &[Deviations], told: &restricted::Told) -> (f64, Vec<f64>) {
    let of_group = all.iter().zip(&told.sizes);
    let groups: Vec<Vec<Vec<f64>>> = of_group
        .map(|(d, (sigma, _))| d.whitened((*sigma, told.memory_s)))
        .collect();
    let size = spread(&groups.concat().concat());
    if size.is_nan() || size == 0.0 {
        return (1.0, Vec::new());
    }
    let mut kept = Vec::new();
    for group in groups.iter().filter(|group| !group.is_empty()) {
        for k in 0..group[0].len() {
            // An outlier moves the mean, and so shows in every repeat: it is counted where it is largest.
            let here = group.iter().map(|series| series[k] / size);
            let most = here
                .clone()
                .fold(0.0, |most: f64, w| match w.abs() > most.abs() {
                    true => w,
                    false => most,
                });
            match most.abs() > OUTLIER {
                true => kept.push(most),
                false => kept.extend(here),
            }
        }
    }
    (size, kept)
}

/// Correlation of noise over `step`, s, if it forgets itself in `memory_s`.
pub fn carry(step: f64, memory_s: f64) -> f64 {
    match memory_s > 0.0 {
        true => libm::exp(-step.max(0.0) / memory_s),
        false => 0.0,
    }
}

/// What is new in a value, of which `carried` of the one before is left, in units of all that it could be.
pub(super) fn fresh(now: f64, before: f64, carried: f64) -> f64 {
    (now - carried * before) / (1.0 - carried * carried).max(LEAST_FRESH).sqrt()
}

/// Standard deviation without outliers.
pub fn spread(values: &[f64]) -> f64 {
    let mut sizes: Vec<f64> = values.iter().map(|v| v.abs()).collect();
    let rough = 1.4826 * median(&mut sizes);
    let kept = values.iter().filter(|v| v.abs() <= OUTLIER * rough);
    let (sum, count) = kept.fold((0.0, 0.0), |(sum, n), v| (sum + v * v, n + 1.0));
    if count == 0.0 || rough == 0.0 {
        return rough;
    }
    (sum / count / KEPT_VARIANCE).sqrt()
}

/// Standard deviations between repeats of gain and zero: what exceeds the error of finding them, with `(nu + 2) / nu` for few repeats.
fn between(all: &[Deviations], shares: &[(f64, f64)], memory_s: f64) -> Vector2<f64> {
    let (mut sum, mut own, mut degrees) = (Vector2::zeros(), Vector2::zeros(), 0.0);
    for (d, (share, _)) in all.iter().zip(shares) {
        let nu = d.whole.len() as f64 - 1.0;
        let mean = d.whole.iter().sum::<Vector2<f64>>() / (nu + 1.0);
        let squares: Vector2<f64> = d.whole.iter().map(|w| (w - mean).map(|x| x * x)).sum();
        let noise = (share * d.most).powi(2);
        sum += squares;
        own += d.unit_variance(memory_s) * (noise * nu);
        degrees += nu;
    }
    let variance = (sum - own) / degrees;
    let least = own / degrees * 0.25;
    variance.zip_map(&least, |v, least| {
        (v.max(least) * (degrees + 2.0) / degrees).sqrt()
    })
}
