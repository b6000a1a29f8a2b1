//! Scatter of a channel over its repeats: within recordings (pooled), and between them.

use nalgebra::Vector2;

use crate::noise::channel::Channel;
use crate::noise::correlation::Correlation;
use crate::noise::deviations::{Deviations, Group, OUTLIER, robust_deviation};
use crate::noise::noise_shape;
use crate::noise::periodic_component::rhythm;
use crate::noise::repeat_alignment::{RepeatSeries, aligned};
use crate::noise::repeat_deviations::AlignedGroup;
use crate::noise::scatter::Scatter;
use crate::observe::measured::Measured;

/// Degrees of freedom that the pooled noise counts for beside a protocol's own.
const POOLED_DEGREES: f64 = 10.0;
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

/// The repeats of one channel.
pub struct Repeats {
    channel: Channel,
    groups: Vec<Group>,
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
            Channel::Pressure => {
                return crate::noise::maps::mat_noise::scatter(&self.groups, measured);
            }
            Channel::Scan => {
                return crate::noise::maps::scan_noise::scatter(&self.groups, measured);
            }
            _ => {}
        }
        let beside = |&k: &usize| RepeatSeries {
            measured: &measured[k],
            simulated: &simulated[k],
            slopes: &slopes[k],
        };
        let aligned_all: Vec<(&Group, AlignedGroup)> = self
            .groups
            .iter()
            .filter_map(|group| {
                let repeats: Vec<RepeatSeries<'_>> = group.iter().map(beside).collect();
                Some((group, AlignedGroup::new(aligned(self.channel, &repeats))?))
            })
            .collect();
        let each = aligned_all.iter();
        let mut all: Vec<Deviations> = each
            .filter_map(|(group, together)| together.deviations(group))
            .collect();
        if all.is_empty() {
            return None;
        }
        let noise = noise_shape::estimate(&mut all);
        let correlation = noise.correlation;
        let of_most =
            |(d, (sigma, degrees)): (&Deviations, &(f64, f64))| (sigma / d.most, *degrees);
        let shares: Vec<(f64, f64)> = all.iter().zip(&noise.sizes).map(of_most).collect();
        let degrees: f64 = shares.iter().map(|s| s.1).sum();
        let pooled = (shares.iter().map(|(s, n)| s * s * n).sum::<f64>() / degrees).sqrt();
        let shrunk = |(own, n): &(f64, f64)| {
            ((own * own * n + pooled * pooled * POOLED_DEGREES) / (n + POOLED_DEGREES)).sqrt()
        };
        let between = between(&all, &shares, correlation);
        let (step, drawn_from) = pooled_steps(&all, &noise);
        let of_group = all.iter().zip(&shares);
        let each = of_group.flat_map(|(d, s)| d.group.iter().map(move |k| (*k, shrunk(s))));
        Some(Scatter {
            shares: each.collect(),
            pooled,
            proportional: 0.0,
            shape: noise.shape,
            degrees,
            correlation,
            gain: between.x,
            zero_mm: (self.channel == Channel::Force).then_some(between.y),
            step,
            drawn_from,
            rhythm: rhythm(&all, correlation),
        })
    }
}

/// Standard deviation of the whitened deviations of all groups, and those over it.
fn pooled_steps(all: &[Deviations], noise: &noise_shape::NoiseEstimate) -> (f64, Vec<f64>) {
    let of_group = all.iter().zip(&noise.sizes);
    let groups: Vec<Vec<Vec<f64>>> = of_group
        .map(|(d, (sigma, _))| d.whitened((*sigma, noise.correlation)))
        .collect();
    let size = robust_deviation(&groups.concat().concat());
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

/// Standard deviations between repeats of gain and zero: what exceeds the error of finding them, with `(nu + 2) / nu` for few repeats.
fn between(all: &[Deviations], shares: &[(f64, f64)], correlation: Correlation) -> Vector2<f64> {
    let (mut sum, mut own, mut degrees) = (Vector2::zeros(), Vector2::zeros(), 0.0);
    for (d, (share, _)) in all.iter().zip(shares) {
        let nu = d.whole.len() as f64 - 1.0;
        let mean = d.whole.iter().sum::<Vector2<f64>>() / (nu + 1.0);
        let squares: Vector2<f64> = d.whole.iter().map(|w| (w - mean).map(|x| x * x)).sum();
        let noise = (share * d.most).powi(2);
        sum += squares;
        own += d.unit_variance(correlation) * (noise * nu);
        degrees += nu;
    }
    let variance = (sum - own) / degrees;
    let least = own / degrees * 0.25;
    variance.zip_map(&least, |v, least| {
        (v.max(least) * (degrees + 2.0) / degrees).sqrt()
    })
}
