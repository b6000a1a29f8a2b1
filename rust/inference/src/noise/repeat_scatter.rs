//! Scatter of a channel over its repeats: within recordings (pooled), and between them.

use nalgebra::{Vector2, Vector3};

use crate::distributions::chi_square_exceeded;
use crate::noise::channel::Channel;
use crate::noise::correlation::Correlation;
use crate::noise::deviations::{Deviations, FLOOR, Group, OUTLIER, robust_deviation};
use crate::noise::noise_shape::{self, NoiseEstimate};
use crate::noise::periodic_component::rhythm;
use crate::noise::repeat_alignment::{RepeatSeries, aligned};
use crate::noise::repeat_deviations::AlignedGroup;
use crate::noise::scatter::Scatter;
use crate::observe::measured::Measured;

/// Degrees of freedom that the pooled noise counts for beside a protocol's own.
const POOLED_DEGREES: f64 = 10.0;

/// How rarely noise alone may make the zeros of repeats differ as much, so that noise is judged without them.
const ZERO_BY_CHANCE: f64 = 0.001;

/// Variance with which a zero is found, over the least of all groups, up to which it is seen.
const SEEN: f64 = 10.0;

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
            number: k,
        };
        let aligned_all: Vec<(&Group, AlignedGroup)> = self
            .groups
            .iter()
            .filter_map(|group| {
                let repeats: Vec<RepeatSeries<'_>> = group.iter().map(beside).collect();
                Some((group, AlignedGroup::new(aligned(self.channel, &repeats))?))
            })
            .collect();
        let is_force = self.channel == Channel::Force;
        let clear = match is_force {
            true => with_clear_zeros(&aligned_all),
            false => None,
        };
        let has_clear_zeros = clear.is_some();
        let (all, noise) = match clear {
            Some(found) => found,
            None => {
                let mut all = deviations(&aligned_all, false);
                if all.is_empty() {
                    return None;
                }
                let noise = noise_shape::estimate(&mut all);
                (all, noise)
            }
        };
        let correlation = noise.correlation;
        let shares = shares(&all, &noise);
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
            zero_mm: is_force.then_some(between.y),
            force_zero_n: match is_force {
                true => zero_sd(&aligned_all, &noise, (&all, &shares)),
                false => None,
            },
            has_clear_zeros,
            step,
            drawn_from,
            // Steps that a force goes through at a steady pace are a rhythm of their own.
            rhythm: {
                let is_judged = |d: &Deviations| !d.group.iter().any(|k| measured[*k].is_coarse);
                let judged: Vec<Deviations> = all.into_iter().filter(is_judged).collect();
                rhythm(&judged, correlation).map(|found| match correlation.hum.variance > 0.0 {
                    true => found.next_to_a_hum(correlation.hum.hz),
                    false => found,
                })
            },
        })
    }
}

fn deviations(aligned_all: &[(&Group, AlignedGroup)], has_own_zero: bool) -> Vec<Deviations> {
    let each = aligned_all.iter();
    each.filter_map(|(group, together)| together.deviations(group, has_own_zero))
        .collect()
}

/// By group: standard deviation of the noise over the largest mean value, and its degrees of freedom.
fn shares(all: &[Deviations], noise: &NoiseEstimate) -> Vec<(f64, f64)> {
    let of_most = |(d, (sigma, degrees)): (&Deviations, &(f64, f64))| (sigma / d.most, *degrees);
    all.iter().zip(&noise.sizes).map(of_most).collect()
}

/// Deviations with a zero of the force for each repeat taken out, and their noise; None unless these zeros clearly differ by more than noise makes
/// them.
fn with_clear_zeros(
    aligned_all: &[(&Group, AlignedGroup)],
) -> Option<(Vec<Deviations>, NoiseEstimate)> {
    let mut all = deviations(aligned_all, true);
    // With a memory noise makes zeros differ more than where it forgets itself at once.
    let size = |d: &Deviations| robust_deviation(&d.rest.concat()) / d.most;
    // The repeats' own mean takes part of each.
    let whole = |d: &Deviations| (d.rest.len() as f64 / (d.rest.len() as f64 - 1.0)).sqrt();
    let sizes: Vec<f64> = all.iter().map(|d| size(d) * whole(d)).collect();
    let white: Vec<(&Deviations, f64)> = all.iter().zip(sizes).collect();
    if zeros(&white, Correlation::NONE).chance >= ZERO_BY_CHANCE {
        return None;
    }
    let noise = noise_shape::estimate(&mut all);
    let sized = shares(&all, &noise).into_iter().map(|share| share.0);
    let of: Vec<(&Deviations, f64)> = all.iter().zip(sized).collect();
    let found = zeros(&of, noise.correlation);
    (found.chance < ZERO_BY_CHANCE).then_some((all, noise))
}

/// Standard deviation between repeats of the force's zero, N, in a noise that is known; by group its part of the largest value.
fn zero_sd(
    aligned_all: &[(&Group, AlignedGroup)],
    noise: &NoiseEstimate,
    (groups, shares): (&[Deviations], &[(f64, f64)]),
) -> Option<f64> {
    let with_share = |d: &Deviations| {
        let known = groups.iter().position(|other| other.group == d.group)?;
        Some((d.weighted(noise.shape), shares[known].0))
    };
    let freed = deviations(aligned_all, true);
    let freed: Vec<(Deviations, f64)> = freed.iter().filter_map(with_share).collect();
    let of: Vec<(&Deviations, f64)> = freed.iter().map(|(d, share)| (d, *share)).collect();
    let sd = zeros(&of, noise.correlation).sd_n;
    (sd > 0.0).then_some(sd)
}

/// Standard deviation of the whitened deviations of all groups, and those over it.
fn pooled_steps(all: &[Deviations], noise: &NoiseEstimate) -> (f64, Vec<f64>) {
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

/// Standard deviations between repeats of gain and first touch: what exceeds the error of finding them, with `(nu + 2) / nu` for few repeats.
///
/// Where a zero is taken out, a hold alone shows neither, and groups in which one is hardly seen say nothing of it.
fn between(all: &[Deviations], shares: &[(f64, f64)], correlation: Correlation) -> Vector2<f64> {
    let of = |(d, (share, _)): (&Deviations, &(f64, f64))| {
        let nu = d.whole.len() as f64 - 1.0;
        let mean = d.whole.iter().sum::<Vector3<f64>>() / (nu + 1.0);
        let squares: Vector3<f64> = d.whole.iter().map(|w| (w - mean).map(|x| x * x)).sum();
        let error = d.unit_variance(correlation) * (share * d.most).powi(2);
        (squares, error, nu)
    };
    let each: Vec<(Vector3<f64>, Vector3<f64>, f64)> = all.iter().zip(shares).map(of).collect();
    let most = |k: usize| match all.iter().any(|d| d.has_own_zero) {
        true => {
            SEEN * each
                .iter()
                .fold(f64::INFINITY, |least, e| least.min(e.1[k]))
        }
        false => f64::INFINITY,
    };
    Vector2::from_fn(|k, _| {
        let most = most(k);
        let seen = || each.iter().filter(|e| e.1[k] <= most);
        let degrees: f64 = seen().map(|e| e.2).sum();
        let sum: f64 = seen().map(|e| e.0[k]).sum();
        let own: f64 = seen().map(|e| e.1[k] * e.2).sum();
        let variance = (sum - own) / degrees;
        let least = own / degrees * 0.25;
        (variance.max(least) * (degrees + 2.0) / degrees).sqrt()
    })
}

/// How the force's zeros of repeats differ.
struct Zeros {
    /// Standard deviation, N: what exceeds the error of finding them, with `(nu + 2) / nu` for few repeats.
    sd_n: f64,
    /// How often noise alone makes them differ as much.
    chance: f64,
}

/// Of deviations with a zero taken out, each group's with its part of the largest value that is noise. Groups in which a zero is hardly seen, such as
/// those of a hold alone, say nothing of how zeros differ.
fn zeros(of: &[(&Deviations, f64)], correlation: Correlation) -> Zeros {
    let each: Vec<[f64; 3]> = of
        .iter()
        .map(|(d, share)| {
            let nu = d.whole.len() as f64 - 1.0;
            let mean = d.whole.iter().map(|w| w.z).sum::<f64>() / (nu + 1.0);
            let squares = d.whole.iter().map(|w| (w.z - mean).powi(2)).sum();
            let error = d.unit_variance(correlation).z * (share.max(FLOOR) * d.most).powi(2);
            [squares, error, nu]
        })
        .collect();
    let least = each.iter().fold(f64::INFINITY, |least, e| least.min(e[1]));
    let seen = || each.iter().filter(|e| e[1] <= SEEN * least);
    let sum_of = |what: fn(&[f64; 3]) -> f64| seen().map(what).sum::<f64>();
    let degrees = sum_of(|e| e[2]);
    let own = sum_of(|e| e[1] * e[2]) / degrees;
    let variance = sum_of(|e| e[0]) / degrees - own;
    let chi_square = sum_of(|e| e[0] / e[1].max(f64::MIN_POSITIVE));
    Zeros {
        sd_n: (variance.max(0.25 * own) * (degrees + 2.0) / degrees).sqrt(),
        chance: chi_square_exceeded(chi_square, degrees),
    }
}
