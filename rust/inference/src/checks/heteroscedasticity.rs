//! Heteroscedasticity between repeats (more scatter under load than without), and the periodic component of their difference.

use nalgebra::{Matrix2, Vector2};

use crate::forward::surrogate::force_recording::{ForceRecording, Row};
use crate::forward::surrogate::surrogate_data::Surrogate;
use crate::noise::estimate::Noise;
use crate::noise::periodic_component::Rhythm;
use crate::observe::measured::Phase;
use crate::observe::robust_scale::trimmed_deviation;
use crate::random::Random;

/// Fewest deviations with and without contact from which they are compared.
const LEAST: (usize, usize) = (40, 24);
/// Deviations beyond this many of their median size are outliers.
const OUTLIER: f64 = 5.0;

/// How repeats deviate from one another under load and without.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Heteroscedasticity {
    /// Standard deviation under load over that without, of what differs between repeats beyond gain and first touch.
    pub ratio: f64,
    /// Ratio that noise of the same size everywhere exceeds once in some hundred studies.
    pub least: f64,
}

/// Standard deviations of the ratio's logarithm that noise alone does not exceed.
const SURE: f64 = 3.0;
/// Part of a recording's largest force from which a row counts as under load.
const LOADED: f64 = 0.3;

/// One recording's deviations from its repeat, over the noise.
#[derive(Default)]
struct Deviations {
    under: Vec<f64>,
    without: Vec<f64>,
    /// What gain and first touch do, under load.
    along: Vec<[f64; 2]>,
    /// Seconds spent under load and without.
    seconds: [f64; 2],
}

/// Noise under load over that without, from which the skin itself is unsteady.
const HETEROSCEDASTIC: f64 = 2.0;

/// What in the repeats themselves no effect on the list does, in words; None where noise suffices.
pub fn unmodeled_repeat_noise(
    noise: &Noise,
    heteroscedasticity: Option<Heteroscedasticity>,
) -> Option<String> {
    if let Some(rhythm) = noise.rhythm.filter(Rhythm::is_clear) {
        return Some(format!(
            "under load repeats of one protocol differ by a rhythm of {:.2} Hz ({:.0} a minute), in step with nothing that was done",
            rhythm.hz,
            rhythm.per_minute()
        ));
    }
    let is_unsteady = heteroscedasticity.is_some_and(|u| u.ratio > u.least.max(HETEROSCEDASTIC));
    is_unsteady.then(|| {
        "repeats of one protocol differ more under load than without, by more than gain and first touch".to_owned()
    })
}

/// True if the force pulls where a fit with adhesion says so: a necessary sign, looked for in what was measured.
///
/// `simulated` are the predictions of that fit, and `zeros` (N) the zero of each recording's force in it: a cell that was not tared pulls all along.
/// Neighbors share their noise, so that so many count as one.
pub fn pulls(
    courses: &[ForceRecording],
    zeros: &[f64],
    (simulated, sigma): (&[f64], &[f64]),
) -> bool {
    let (mut sum, mut count) = (0.0, 0.0);
    let all = courses.iter().zip(zeros);
    for (row, zero) in all.flat_map(|(c, zero)| c.rows.iter().map(move |row| (row, *zero))) {
        let Some(sample) = row.sample else {
            continue;
        };
        if simulated[sample] - zero < -0.5 * sigma[sample] {
            sum += ((row.force_n - zero) / sigma[sample]).clamp(-6.0, 6.0);
            count += 1.0;
        }
    }
    count > 0.0 && sum / f64::sqrt(SHARED * count) < -PULLS
}

/// Neighboring samples that count as one where nothing is known of their noise's memory.
pub(crate) const SHARED: f64 = 3.0;
/// Standard errors below none that a pull must reach.
const PULLS: f64 = 2.5;

/// Compares what differs between repeats under load and without; None without repeats or rest, or where forces are rounded to steps that are larger
/// than their noise: without load they are all the same.
///
/// Noise of an instrument does not ask whether the tool touches; what the skin does by itself needs contact to be seen. `memory_s` is
/// the time over which deviations go on: so many count as one.
pub fn heteroscedasticity(
    surrogate: &Surrogate<'_>,
    (simulated, sigma): (&[f64], &[f64]),
    memory_s: f64,
) -> Option<Heteroscedasticity> {
    let (mut under, mut without, mut worth) = (Vec::new(), Vec::new(), [0.0, 0.0]);
    for (c, one) in surrogate.courses.iter().enumerate() {
        for other in &surrogate.courses[c + 1..] {
            let repeats = one.protocol == other.protocol && one.place == other.place;
            let is_coarse = one.is_coarse || other.is_coarse;
            if !repeats || is_coarse || one.rows.len() != other.rows.len() {
                continue;
            }
            let found = deviations((one, other), (simulated, sigma));
            let counts = [found.under.len() as f64, found.without.len() as f64];
            for (k, worth) in worth.iter_mut().enumerate() {
                *worth += counts[k].min(found.seconds[k] / (2.0 * memory_s).max(1e-6));
            }
            under.extend(freed(&found));
            without.extend(found.without);
        }
    }
    if under.len() < LEAST.0 || without.len() < LEAST.1 {
        return None;
    }
    let spread = (0.5 / worth[0].max(1.0) + 0.5 / worth[1].max(1.0)).sqrt();
    Some(Heteroscedasticity {
        ratio: trimmed_deviation(&under, OUTLIER) / trimmed_deviation(&without, OUTLIER).max(1e-9),
        least: libm::exp(SURE * spread),
    })
}

fn deviations(
    (one, other): (&ForceRecording, &ForceRecording),
    (simulated, sigma): (&[f64], &[f64]),
) -> Deviations {
    let mut found = Deviations::default();
    // Rounded forces that are the same seem to have no noise: where in its step each was, nobody knows.
    let mut random = Random::new(one.recording as u64);
    let mut within = |row: &Row| row.force_step_n * (random.uniform() - 0.5);
    let mut over = |row: &Row, k: usize| (row.force_n + within(row) - simulated[k]) / sigma[k];
    for (n, (a, b)) in one.rows.iter().zip(&other.rows).enumerate() {
        let (Some(i), Some(j)) = (a.sample, b.sample) else {
            continue;
        };
        let off = (over(a, i) - over(b, j)) / 2f64.sqrt();
        let step = if n > 0 {
            a.time_s - one.rows[n - 1].time_s
        } else {
            0.0
        };
        if a.phase == Phase::Apart && b.phase == Phase::Apart {
            found.without.push(off);
            found.seconds[1] += step;
        } else if a.force_n > LOADED * one.most() {
            let share = simulated[i].max(0.0) / one.most();
            found.under.push(off);
            // Force grows about as depth^1.5, and so its slope as the force's third root.
            found.along.push([share, libm::cbrt(share)]);
            found.seconds[0] += step;
        }
    }
    found
}

/// Deviations under load with what gain and first touch do taken out.
fn freed(found: &Deviations) -> Vec<f64> {
    let (mut gram, mut side) = (Matrix2::zeros(), Vector2::zeros());
    for (off, along) in found.under.iter().zip(&found.along) {
        let along = Vector2::from(*along);
        gram += along * along.transpose();
        side += along * *off;
    }
    let by = gram
        .try_inverse()
        .map_or(Vector2::zeros(), |inverse| inverse * side);
    let each = found.under.iter().zip(&found.along);
    each.map(|(off, along)| off - Vector2::from(*along).dot(&by))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn periodic_component_is_reported_before_heteroscedasticity() {
        let of = |chance: f64, ratio: f64| {
            let (mut made, _) = crate::forward::surrogate::synthetic::ready(Vec::new(), &[], 0.1);
            made.noise.rhythm = Some(Rhythm {
                hz: 1.2,
                nats: 20.0,
                chance,
            });
            unmodeled_repeat_noise(&made.noise, Some(Heteroscedasticity { ratio, least: 1.6 }))
        };
        let told = |chance, ratio| of(chance, ratio).unwrap();
        assert!(told(1e-4, 3.0).contains("1.20 Hz (72 a minute)"));
        assert!(told(0.1, 2.1).contains("more under load than without"));
        assert!(of(0.1, 1.9).is_none());
    }

    /// Without load most readings are 0, under load as many are a step off as not. Where steps are larger than the noise, repeats are not compared.
    #[test]
    fn rounding_hides_noise_without_load() {
        let step = 0.1;
        let found = |is_coarse: bool, step_n: f64| {
            let mut random = crate::random::Random::new(1);
            let mut recording = || -> Vec<(f64, f64, Phase, f64)> {
                let reading = |k: u32| {
                    let depth = f64::from(k.max(60) - 60) / 60.0;
                    let phase = if k < 60 { Phase::Apart } else { Phase::Load };
                    let noise = 0.4 * step * random.normal();
                    let read = ((10.0 * depth + noise) / step).round() * step;
                    (0.1 * f64::from(k), depth, phase, read)
                };
                (0..120).map(reading).collect()
            };
            let all = [(0, recording()), (0, recording())];
            let tool = crate::forward::surrogate::synthetic::tool(1.0, |d| 10.0 * d, |_| 1.0);
            let (mut made, _) = crate::forward::surrogate::synthetic::ready(vec![tool], &all, step);
            for course in &mut made.courses {
                course.is_coarse = is_coarse;
                let rows = course.rows.iter_mut();
                rows.for_each(|row| row.force_step_n = step_n);
            }
            let depths = made.courses.iter().flat_map(|course| &course.rows);
            let simulated: Vec<f64> = depths.map(|row| 10.0 * row.depth_mm.max(0.0)).collect();
            heteroscedasticity(&made.surrogate(), (&simulated, &made.sigma), 0.1)
        };
        assert!(found(false, 0.0).unwrap().ratio > 10.0, "as if not rounded");
        assert!(found(false, step).unwrap().ratio < HETEROSCEDASTIC);
        assert!(found(true, step).is_none());
    }

    /// A tool that leaves with 20 mN of pull, and a cell whose zero is 20 mN below none in all of a recording: the latter pulls nothing where the fit
    /// has that zero.
    #[test]
    fn a_zero_below_none_is_no_pull() {
        let pulled = |zero: f64, pull: f64| {
            let readings = (0..60).map(|k| {
                let force = if k >= 40 { -pull } else { 0.0 };
                (0.1 * f64::from(k), -0.1, Phase::Apart, force + zero)
            });
            let press = [(0, readings.collect())];
            let (made, _) = crate::forward::surrogate::synthetic::ready(Vec::new(), &press, 0.005);
            pulls(&made.courses, &[zero], (&made.values, &made.sigma))
        };
        assert!(pulled(0.0, 0.02) && pulled(-0.02, 0.02));
        assert!(
            !pulled(-0.02, 0.0) && !pulled(0.02, 0.0),
            "no more than a zero"
        );
        assert!(pulled(0.03, 0.02), "a pull that the cell reads above none");
    }
}
