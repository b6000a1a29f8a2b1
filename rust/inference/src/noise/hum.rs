//! A hum in the difference between repeats: a sine of one frequency in all recordings that asks not whether the tool touches.
//!
//! It is the instrument's, or its mount's, as a pulse is the skin's ([`crate::noise::periodic_component`]): that one grows with the force. A hum is
//! a part of the noise ([`crate::noise::correlation`]), found by restricted likelihood.

use crate::noise::correlation::{Correlation, Hum};
use crate::noise::deviations::Deviations;
use crate::noise::periodic_component::{Freed, Grows, HZ, frequencies};
use crate::noise::restricted_likelihood::{likelihood, sampling_interval, within};

/// Fastest hum that is sought, Hz: up to some turns between the samples of a hold, which those of a ramp still follow.
const FASTEST_HZ: f64 = 12.0;
/// Turns of the slowest in the longest recording: slower ones are a zero that wanders.
const TURNS: f64 = 2.0;
/// Variances over that of the rest that are tried: from the first, by the second, so many.
const VARIANCES: (f64, f64, i32) = (0.05, 1.7, 16);
/// Memories of the rest that are tried, in intervals between samples.
const MEMORIES: [f64; 7] = [0.0, 0.3, 0.6, 1.2, 2.5, 5.0, 12.0];
/// How much likelier it must be than noise without a hum, nats, for its three numbers; the logarithm of how many frequencies are tried is added.
const CLEARLY: f64 = 8.0;
/// How much likelier it must be than a rhythm that grows with the force, or that is in contact alone.
const RATHER: f64 = 5.0;
/// Rounds of the search.
const ROUNDS: i32 = 3;

/// The correlation with a hum, if that is clearly likelier than this one; deviations are as they are weighted.
pub(crate) fn with_hum(all: &[Deviations], plain: Correlation) -> Option<Correlation> {
    let longest = all
        .iter()
        .filter_map(|d| Some(d.time.last()? - d.time.first()?));
    let longest = longest.fold(0.0, f64::max);
    let slowest = f64::max(HZ.0, TURNS / longest);
    let tried = frequencies((slowest, fastest_hz(all)), longest);
    if tried.len() < 3 {
        return None;
    }
    let kept: Vec<Vec<usize>> = all.iter().map(|d| within(d, None)).collect();
    let clearly = CLEARLY + libm::log(tried.len() as f64);
    let mut best = (likelihood(all, &kept, plain) + clearly, None);
    // Where a memory has taken up the hum, it is seen without one.
    for before in [plain, Correlation::NONE] {
        let groups: Vec<Freed> = all.iter().filter_map(|d| Freed::of(d, before)).collect();
        let nats = |hz: f64| -> f64 { groups.iter().map(|g| g.gained(hz, Grows::Not)).sum() };
        let nats: Vec<f64> = tried.iter().map(|hz| nats(*hz)).collect();
        let clearest =
            (1..nats.len().saturating_sub(1)).max_by(|a, b| nats[*a].total_cmp(&nats[*b]));
        let Some(at) = clearest.filter(|at| nats[*at] > nats[0].max(nats[nats.len() - 1])) else {
            continue;
        };
        let found = likeliest(all, &kept, (tried[at], tried[1] - tried[0]));
        if found.0 > best.0 {
            best = (found.0, Some(found.1));
        }
    }
    best.1.filter(|found| is_without_load(all, *found, longest))
}

/// Fastest hum, Hz, that the densest samples can tell from slower ones.
fn fastest_hz(all: &[Deviations]) -> f64 {
    let each = all
        .iter()
        .flat_map(|d| d.time.windows(2).map(|w| w[1] - w[0]));
    let mut steps: Vec<f64> = each.filter(|step| *step > 0.0).collect();
    steps.sort_by(f64::total_cmp);
    let dense = steps.get(steps.len() / 10).copied();
    dense.map_or(0.0, |step| FASTEST_HZ.min(0.5 / step))
}

/// Whether a hum explains deviations better than any rhythm that grows with the force.
fn is_without_load(all: &[Deviations], found: Correlation, longest_s: f64) -> bool {
    let rest = Correlation {
        hum: Hum::NONE,
        ..found
    };
    let groups: Vec<Freed> = all.iter().filter_map(|d| Freed::of(d, rest)).collect();
    let nats = |hz: f64, grows: Grows| -> f64 { groups.iter().map(|g| g.gained(hz, grows)).sum() };
    let rhythms = frequencies(HZ, longest_s).into_iter().chain([found.hum.hz]);
    let both = |hz: f64| {
        [Grows::WithForce, Grows::WithGain, Grows::InContact]
            .into_iter()
            .fold(0.0, |most, grows| f64::max(most, nats(hz, grows)))
    };
    let rhythm = rhythms.map(both).fold(0.0, f64::max);
    nats(found.hum.hz, Grows::Not) > rhythm + RATHER
}

/// The likeliest hum near a frequency, with a memory of the rest, and its likelihood: one number after the other.
fn likeliest(
    all: &[Deviations],
    kept: &[Vec<usize>],
    (hz, step): (f64, f64),
) -> (f64, Correlation) {
    let interval = sampling_interval(all);
    let of = |memory_s: f64, hum: Hum| Correlation {
        hum,
        ..Correlation::of_memory(memory_s)
    };
    let mut best = of(0.0, Hum { hz, variance: 1.0 });
    let mut most = likelihood(all, kept, best);
    for round in 0..ROUNDS {
        for number in 0..3 {
            let Correlation { memory_s, hum, .. } = best;
            let tried: Vec<Correlation> = match number {
                0 => (0..VARIANCES.2)
                    .map(|k| VARIANCES.0 * libm::pow(VARIANCES.1, f64::from(k)))
                    .map(|variance| of(memory_s, Hum { variance, ..hum }))
                    .collect(),
                1 => MEMORIES.map(|m| of(m * interval, hum)).to_vec(),
                _ => (-2..=2)
                    .map(|k| hum.hz + 0.5 * step * f64::from(k) * libm::pow(0.5, f64::from(round)))
                    .map(|hz| of(memory_s, Hum { hz, ..hum }))
                    .collect(),
            };
            for one in tried {
                let found = likelihood(all, kept, one);
                if found > most {
                    (most, best) = (found, one);
                }
            }
        }
    }
    (most, best)
}
