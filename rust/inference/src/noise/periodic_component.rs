//! Periodic component in the difference between repeats, such as a pulse (Lomb 1976).
//!
//! What is missing from the model is the same in every repeat of a protocol, and so cancels in their deviations; a pulse is not. It is
//! sought as a sine that grows with the gain or with the force, of one frequency in all recordings and of any phase and size in each, next to
//! what each repeat has of its own (gain, first touch, zero), in noise with memory.

use nalgebra::{DMatrix, DVector, Matrix2, Vector2};

use crate::noise::correlation::{Correlation, Filter};
use crate::noise::deviations::Deviations;
use crate::noise::restricted_likelihood::within;

/// Frequencies between which a rhythm is sought, Hz: a heart at rest or at work, a muscle that tenses for seconds. Samples of a press are
/// too far apart for faster ones.
pub(crate) const HZ: (f64, f64) = (0.3, 3.0);
/// How often noise alone may show a rhythm as clear as one that is told. False ones of the second trial's third and fourth draws show by a
/// chance of 0.0014 to 0.0046, of closed forms by 0.0002 to 0.004; pulses of closed forms and pads by 1.4e-5 at most, but a weak one of the
/// calibration by 0.0022.
const BY_CHANCE: f64 = 0.001;
/// By how much less clear a rhythm is next to a hum: means of many readings blur one by as many turns as each lasts, and so not all alike. Of a hum of 4 Hz
/// (closed forms, seed 10568) a rhythm of 2.7 Hz was left with a chance of 0.0002.
const NEXT_TO_A_HUM: f64 = 100.0;
/// Standard errors of a ratio of variances from which it is less than 1. Under 12 pulses of closed forms it is 1.4 at most, under a line of the mains 2.2.
const QUIETER: f64 = 2.0;
/// By how much likelier a rhythm next to a hum must be than an even sine of its frequency, nats.
const RATHER: f64 = 5.0;
/// With what a rhythm of the skin may go: the gain of its recording, free of what first touch does alike, or the force.
const SIZES: [Grows; 2] = [Grows::WithGain, Grows::WithForce];
/// Frequencies that are one, Hz, in recordings of some seconds.
const ALIKE_HZ: f64 = 0.2;
/// Turns by which the longest recording tells two frequencies that are tried apart.
const TURNS: f64 = 0.25;

/// The clearest rhythm of a study.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rhythm {
    /// Hz.
    pub hz: f64,
    /// By how much it makes the deviations likelier, nats.
    pub nats: f64,
    /// How often noise alone would show one as clear at any frequency; at most, since neighbors among these are alike.
    pub chance: f64,
}

impl Rhythm {
    /// True if noise alone would hardly show it.
    pub fn is_clear(&self) -> bool {
        self.chance < BY_CHANCE
    }

    /// The same where forces hum as well, at a frequency in Hz: a rhythm of that is the hum, which at a ceiling is not seen, and so not the same everywhere.
    pub(crate) fn next_to_a_hum(self, hum_hz: f64) -> Rhythm {
        let chance = match (self.hz - hum_hz).abs() < ALIKE_HZ {
            true => 1.0,
            false => (NEXT_TO_A_HUM * self.chance).min(1.0),
        };
        Rhythm { chance, ..self }
    }

    /// Times a minute.
    pub fn per_minute(&self) -> f64 {
        60.0 * self.hz
    }
}

/// The clearest rhythm in the deviations of all groups, in noise of that correlation; None where nothing differs. One that is
/// clearest at an end of the band is none: its chance is 1. So is one next to a hum that is as well even as growing with the force: its overtone.
/// Where nothing hums, so is one without which there is less noise under load than without load: a line of the mains is read as another rhythm where samples
/// lie farther apart, as in a hold.
pub fn rhythm(all: &[Deviations], correlation: Correlation) -> Option<Rhythm> {
    let groups: Vec<Freed> = all
        .iter()
        .filter_map(|d| Freed::of(d, correlation))
        .collect();
    let found = SIZES.map(|grows| clearest(&groups, grows));
    let best = match found[1].chance < found[0].chance {
        true => found[1],
        false => found[0],
    };
    let is_feigned = match correlation.hum.variance > 0.0 {
        true => {
            let even = groups.iter().map(|g| g.gained(best.hz, Grows::Not));
            best.nats < even.sum::<f64>() + RATHER
        }
        false => is_quieter_under_load(&groups, best.hz),
    };
    (!groups.is_empty()).then_some(Rhythm {
        chance: if is_feigned { 1.0 } else { best.chance },
        ..best
    })
}

/// Whether deviations less a rhythm are clearly smaller where the tool touches than where it does not (an F test).
fn is_quieter_under_load(groups: &[Freed], hz: f64) -> bool {
    let (mut loaded, mut light) = (Left::default(), Left::default());
    for group in groups {
        group.add_left(hz, &mut loaded, &mut light);
    }
    let of_few = 2.0 / loaded.count.max(1.0) + 2.0 / light.count.max(1.0);
    let quieter = libm::log(light.mean_square() / loaded.mean_square());
    loaded.count.min(light.count) >= LEAST as f64 && quieter > QUIETER * of_few.sqrt()
}

/// What a sine leaves of deviations: the sum of its squares, N², and how many samples it holds, less what the mean of repeats takes.
#[derive(Default)]
struct Left {
    squares: f64,
    count: f64,
}

impl Left {
    fn mean_square(&self) -> f64 {
        self.squares / self.count.max(1.0)
    }
}

/// The clearest rhythm of that kind.
fn clearest(groups: &[Freed], grows: Grows) -> Rhythm {
    let longest = groups
        .iter()
        .filter_map(|g| Some(g.time.last()? - g.time.first()?));
    let each = frequencies(HZ, longest.fold(0.0, f64::max));
    let steps = each.len() - 1;
    // A phase and a size for each repeat but one: twice as many numbers.
    let pairs: f64 = groups.iter().map(|group| group.repeats).sum();
    let tried = each.into_iter().map(|hz| {
        let nats = groups.iter().map(|group| group.gained(hz, grows)).sum();
        let of_one = exceeded(nats, pairs as usize);
        Rhythm {
            hz,
            nats,
            chance: ((SIZES.len() * steps) as f64 * of_one).min(1.0),
        }
    });
    let tried: Vec<Rhythm> = tried.collect();
    let clearer = |a: Rhythm, b: &Rhythm| if b.nats > a.nats { *b } else { a };
    // Clearest at an end of the band, something slower or faster than a rhythm differs between repeats.
    let ends = tried[0].nats.max(tried[steps].nats);
    let inner = tried[1..steps].iter().fold(tried[0], clearer);
    match inner.nats > ends {
        true => inner,
        false => Rhythm {
            chance: 1.0,
            ..tried[0]
        },
    }
}

/// Frequencies of a band that recordings tell apart of which the longest takes that time, s.
pub(crate) fn frequencies((slowest, fastest): (f64, f64), longest_s: f64) -> Vec<f64> {
    let step = TURNS / longest_s.max(1.0);
    let steps = ((fastest - slowest) / step).ceil().max(0.0) as usize;
    (0..=steps).map(|k| slowest + step * k as f64).collect()
}

/// What the size of a sine goes with.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Grows {
    /// What a sample adds to the gain of its recording.
    WithGain,
    /// The force, as a pulse of the skin.
    WithForce,
    /// Whether the tool touches, as a tremor.
    InContact,
    /// Nothing, as a hum of the instrument.
    Not,
}

/// How often half of a chi-square of `2 pairs` degrees exceeds a number: in closed form, as their count is even.
fn exceeded(half: f64, pairs: usize) -> f64 {
    let terms = (0..pairs).scan(1.0, |term, j| {
        let now = *term;
        *term *= half / (j + 1) as f64;
        Some(now)
    });
    libm::exp(-half) * terms.sum::<f64>()
}

/// One group's deviations, whitened and free of what each repeat has of its own.
pub(crate) struct Freed {
    /// s.
    time: Vec<f64>,
    /// What a sample adds to the gain, or where a zero is taken out the load.
    gain: Vec<f64>,
    /// Its load.
    load: Vec<f64>,
    /// What a newton adds to it where the tool touches.
    touches: Vec<f64>,
    /// What a newton adds to it.
    newton: Vec<f64>,
    /// Makes noise independent.
    filter: Filter,
    /// Orthonormal: what the numbers do that each repeat has of its own.
    along: DMatrix<f64>,
    series: Vec<DVector<f64>>,
    /// Squares of all series.
    sum: f64,
    /// Of one series less one, as the repeats' own mean takes one.
    repeats: f64,
}

impl Freed {
    pub(crate) fn of(of: &Deviations, correlation: Correlation) -> Option<Freed> {
        let kept = within(of, Some(correlation));
        if kept.len() < LEAST {
            return None;
        }
        let time: Vec<f64> = kept.iter().map(|k| of.time[*k]).collect();
        let filter = correlation.filter(kept.iter().map(|k| of.sample(*k)));
        let scale: Vec<f64> = kept.iter().map(|k| of.rescaled(*k, correlation)).collect();
        let white = |values: &dyn Fn(usize) -> f64| {
            DVector::from_vec(filter.whitened(|k| values(kept[k]) * scale[k]))
        };
        let column = |j: usize| white(&|k| of.along[k][j]);
        let columns: Vec<DVector<f64>> = (0..of.own() as usize).map(column).collect();
        let along = DMatrix::from_columns(&columns).qr().q();
        let free = |series: &Vec<f64>| {
            let flat = white(&|k| series[k]);
            &flat - &along * (along.transpose() * &flat)
        };
        let series: Vec<DVector<f64>> = of.rest.iter().map(free).collect();
        let sum: f64 = series.iter().map(|s| s.norm_squared()).sum();
        let each = |of: &dyn Fn(usize) -> f64| -> Vec<f64> {
            let samples = kept.iter().zip(&scale);
            samples.map(|(k, scale)| of(*k) * scale).collect()
        };
        (sum > 0.0).then(|| Freed {
            gain: each(&|k| of.grows(k)),
            load: each(&|k| of.load[k] / of.profile[k]),
            touches: each(&|k| match of.load[k] > TOUCHES {
                true => 1.0 / of.profile[k],
                false => 0.0,
            }),
            newton: each(&|k| 1.0 / of.profile[k]),
            repeats: series.len() as f64 - 1.0,
            time,
            filter,
            along,
            series,
            sum,
        })
    }

    /// Adds what a sine of that frequency that grows with the force leaves, where the tool touches and where it does not.
    fn add_left(&self, hz: f64, loaded: &mut Left, light: &mut Left) {
        let Some((waves, inverse)) = self.waves(hz, &self.load) else {
            return;
        };
        let each = self.repeats / self.series.len() as f64;
        for series in &self.series {
            let found = inverse * Vector2::new(waves[0].dot(series), waves[1].dot(series));
            let rest = series - &waves[0] * found.x - &waves[1] * found.y;
            for (k, off) in rest.iter().enumerate() {
                let off_n = off / self.newton[k];
                let left = match self.touches[k] > 0.0 {
                    true => &mut *loaded,
                    false => &mut *light,
                };
                left.squares += off_n * off_n;
                left.count += each;
            }
        }
    }

    /// Sine and cosine of that frequency and size, free of what each repeat has of its own, and the inverse of their products.
    fn waves(&self, hz: f64, size: &[f64]) -> Option<([DVector<f64>; 2], Matrix2<f64>)> {
        let turn = std::f64::consts::TAU * hz;
        let column = |wave: fn(f64) -> f64| {
            let of = |k: usize| size[k] * wave(turn * self.time[k]);
            let flat = DVector::from_vec(self.filter.whitened(of));
            &flat - &self.along * (self.along.transpose() * &flat)
        };
        let waves = [column(libm::sin), column(libm::cos)];
        let gram = Matrix2::from_fn(|i, j| waves[i].dot(&waves[j]));
        Some((waves, gram.try_inverse()?))
    }

    /// What a sine of that frequency gains here, nats: half of what the logarithm of the squares falls by for every degree of freedom.
    pub(crate) fn gained(&self, hz: f64, grows: Grows) -> f64 {
        let size = match grows {
            Grows::WithGain => &self.gain,
            Grows::WithForce => &self.load,
            Grows::InContact => &self.touches,
            Grows::Not => &self.newton,
        };
        let Some((waves, inverse)) = self.waves(hz, size) else {
            return 0.0;
        };
        let taken = self.series.iter().map(|series| {
            let pull = Vector2::new(waves[0].dot(series), waves[1].dot(series));
            pull.dot(&(inverse * pull))
        });
        let part = (taken.sum::<f64>() / self.sum).clamp(0.0, 1.0 - 1e-9);
        let degrees = self.repeats * (self.time.len() - self.along.ncols()) as f64;
        -0.5 * degrees * libm::log1p(-part)
    }
}

/// Part of the largest load from which the tool touches.
const TOUCHES: f64 = 0.05;

/// Fewest samples in which a rhythm is sought.
const LEAST: usize = 12;

#[cfg(test)]
mod tests;
