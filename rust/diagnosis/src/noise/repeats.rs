//! What repeats of a protocol show: noise within a recording, and how recordings differ as a whole.

use nalgebra::Vector2;

use super::alike::{Told, aligned};
use super::together::Together;
use super::{Channel, POOLED_DEGREES};
use crate::observe::Measured;
use crate::observe::scatter::median;

/// Deviations beyond this many standard deviations are outliers, and not noise.
const OUTLIER: f64 = 3.5;
/// Variance that values within `OUTLIER` standard deviations of a normal law keep.
const KEPT_VARIANCE: f64 = 0.9935;
/// Fewest samples of a channel from which noise is told.
pub(super) const LEAST_SAMPLES: usize = 8;
/// Largest correlation of neighbors that a correction leads to.
const MOST_CARRY: f64 = 0.97;
/// Ratios of memory to sampling interval that are tried.
const MEMORIES: [f64; 16] = [
    0.0, 0.3, 0.5, 0.7, 0.9, 1.2, 1.5, 1.9, 2.4, 3.0, 3.8, 4.8, 6.0, 7.5, 9.5, 12.0,
];

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
        let told = |&k: &usize| Told {
            measured: &measured[k],
            simulated: &simulated[k],
            slopes: &slopes[k],
        };
        let aligned_all: Vec<(&Group, Together)> = self
            .groups
            .iter()
            .filter_map(|group| {
                let repeats: Vec<Told<'_>> = group.iter().map(told).collect();
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
        let memory_s = memory(&all);
        let shares: Vec<(f64, f64)> = all.iter().map(|d| d.share(memory_s)).collect();
        let degrees: f64 = shares.iter().map(|s| s.1).sum();
        let pooled = (shares.iter().map(|(s, n)| s * s * n).sum::<f64>() / degrees).sqrt();
        let shrunk = |(own, n): &(f64, f64)| {
            ((own * own * n + pooled * pooled * POOLED_DEGREES) / (n + POOLED_DEGREES)).sqrt()
        };
        let between = between(&all, &shares, memory_s);
        let (step, drawn_from) = pooled_steps(&all, memory_s);
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
        })
    }
}

impl Deviations {
    /// Standard deviation as a part of the largest value, and its degrees of freedom for noise with that memory.
    fn share(&self, memory_s: f64) -> (f64, f64) {
        let (m, n) = (self.rest.len() as f64, self.time.len() as f64);
        let scale = (m / (m - 1.0)).sqrt();
        let all = self.rest.iter().flatten().map(|u| u * scale);
        let sigma = spread(&all.collect::<Vec<f64>>());
        let sigma = sigma * (n / (n - 2.0)).sqrt();
        let carry = self.carry(memory_s);
        // Equivalent number of independent squares of an AR(1) series.
        let worth = (1.0 - carry * carry) / (1.0 + carry * carry);
        (sigma / self.most, ((m - 1.0) * (n - 2.0) * worth).max(1.0))
    }

    /// Deviations made independent, over the standard deviation of the noise, by repeat.
    fn whitened(&self, memory_s: f64) -> Vec<Vec<f64>> {
        let sigma = spread(&self.rest.concat());
        let steps: Vec<f64> = self.time.windows(2).map(|w| w[1] - w[0]).collect();
        let series = |rest: &Vec<f64>| -> Vec<f64> {
            (1..rest.len())
                .map(|k| {
                    let carry = carry(steps[k - 1], memory_s);
                    (rest[k] - carry * rest[k - 1]) / sigma / (1.0 - carry * carry).sqrt()
                })
                .collect()
        };
        match sigma > 0.0 {
            true => self.rest.iter().map(series).collect(),
            false => Vec::new(),
        }
    }

    /// A memory that was told from these deviations, without the part that taking out a course of two numbers hides: the
    /// correlation of neighbors is found too small by (2 + 4 rho) / n (Kendall 1954, for a line taken out).
    fn longer(&self, memory_s: f64) -> f64 {
        let n = self.time.len() as f64;
        let found = self.carry(memory_s);
        if found == 0.0 {
            return 0.0;
        }
        let carry = ((found + 2.0 / n) / (1.0 - 4.0 / n)).min(MOST_CARRY);
        memory_s * libm::log(found) / libm::log(carry)
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

    /// Correlation of neighboring samples.
    fn carry(&self, memory_s: f64) -> f64 {
        let mut steps: Vec<f64> = self.time.windows(2).map(|w| w[1] - w[0]).collect();
        carry(median(&mut steps), memory_s)
    }
}

/// Standard deviation of the whitened deviations of all groups, and those over it.
fn pooled_steps(all: &[Deviations], memory_s: f64) -> (f64, Vec<f64>) {
    let groups: Vec<Vec<Vec<f64>>> = all.iter().map(|d| d.whitened(memory_s)).collect();
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

/// The memory under which the deviations are likeliest, s.
fn memory(all: &[Deviations]) -> f64 {
    let mut steps: Vec<f64> = all
        .iter()
        .flat_map(|d| d.time.windows(2).map(|w| w[1] - w[0]))
        .collect();
    let step = median(&mut steps);
    let unlikeliness = |memory_s: f64| -> f64 {
        all.iter()
            .map(|d| {
                let sigma = spread(&d.rest.iter().flatten().copied().collect::<Vec<f64>>());
                d.rest
                    .iter()
                    .map(|series| minus_log_likelihood(series, d, (memory_s, sigma)))
                    .sum::<f64>()
            })
            .sum()
    };
    let mut best = (f64::INFINITY, 0.0);
    for ratio in MEMORIES {
        let memory_s = ratio * step;
        let found = unlikeliness(memory_s);
        if found < best.0 {
            best = (found, memory_s);
        }
    }
    let corrected = all.iter().map(|d| d.longer(best.1)).sum::<f64>();
    corrected / all.len() as f64
}

fn minus_log_likelihood(series: &[f64], of: &Deviations, (memory_s, sigma): (f64, f64)) -> f64 {
    if sigma == 0.0 {
        return 0.0;
    }
    let (mut sum, is_outlier) = (0.0, |v: f64| v.abs() > OUTLIER * sigma);
    for k in 1..series.len() {
        // An outlier is remembered by nothing.
        if is_outlier(series[k]) || is_outlier(series[k - 1]) {
            continue;
        }
        let carry = carry(of.time[k] - of.time[k - 1], memory_s);
        let left = 1.0 - carry * carry;
        let step = (series[k] - carry * series[k - 1]) / sigma;
        sum += 0.5 * (step * step / left + libm::log(left));
    }
    sum
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
