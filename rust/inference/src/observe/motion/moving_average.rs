//! Forces whose readings are running means, as displays and load cells' amplifiers show them, and a motion that is read alike.
//!
//! A running mean rounds the corners of a press: at the deepest the force falls short, and before first touch it rises. Where the depth is averaged over
//! the same readings, both are off alike, but for the force's own curvature within them.

use crate::observe::protocol_phases::range;
use crate::observe::robust_scale::median_deviation;

/// Most readings of a mean that is sought.
const MOST: usize = 10;
/// Correlation at the lag of the mean: two neighbors share all readings but one each, so that their difference has the new one and the one that
/// left, which is -0.5 where readings were independent; and the largest at other lags.
const AT_LAG: (f64, f64) = (-0.62, -0.38);
const ELSEWHERE: f64 = 0.08;
/// Standard errors that are added to it, and fewest pairs.
const SURE: f64 = 2.5;
const FEWEST: usize = 100;
/// Differences before and after one that tell what the course does, and deviations beyond which one is a corner or an outlier.
const NEAR: usize = 12;
const FARTHEST: f64 = 3.0;

/// Part of neighboring readings, between the least and the most, that are the same, from which they are held or rounded, and no means.
const HELD: f64 = 0.2;

/// Readings before and after one of which that is the mean.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Window {
    /// Readings before.
    pub(crate) before: usize,
    /// Readings after.
    pub(crate) after: usize,
}

impl Window {
    /// One reading as it is.
    pub(crate) const ONE: Window = Window {
        before: 0,
        after: 0,
    };

    /// Readings of which each is the mean.
    pub(crate) fn readings(self) -> usize {
        self.before + 1 + self.after
    }
}

/// Depths and forces of a press, by reading.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Press<'a> {
    /// mm.
    pub(crate) depth: &'a [f64],
    /// N.
    pub(crate) force: &'a [f64],
}

/// Differences that repeats show; [`window`] needs some hundred.
pub(crate) fn differences(pairs: &[[Press<'_>; 2]]) -> usize {
    let alike = pairs.iter().filter(|pair| is_alike(pair));
    alike.map(|[one, _]| one.force.len() - 1).sum()
}

fn is_alike([one, other]: &[Press<'_>; 2]) -> bool {
    one.force.len() == other.force.len() && one.force.len() > NEAR
}

/// Over which readings each force is averaged; [`Window::ONE`] where they are not, or repeats do not show it. Repeats of one length are compared: what they
/// share is no noise. A mean is of readings before and after one, or of the last, as it comes where the force bends with the depth.
pub(crate) fn window(pairs: &[[Press<'_>; 2]]) -> Window {
    let pairs: Vec<[Press; 2]> = pairs.iter().copied().filter(is_alike).collect();
    let readings = averaged_over(&pairs);
    let of_last = Window {
        before: readings - 1,
        after: 0,
    };
    let about = [(readings - 1) / 2, readings / 2].map(|before| Window {
        before,
        after: readings - 1 - before,
    });
    let windows = [about[0], about[1], of_last];
    let bent = windows.map(|window| {
        pairs
            .iter()
            .flatten()
            .map(|one| bent(*one, window))
            .sum::<f64>()
    });
    let best = (0..3).max_by(|a, b| bent[*a].total_cmp(&bent[*b]).then(b.cmp(a)));
    best.map_or(Window::ONE, |best| windows[best])
}

/// How much the force bends where a mean over that window has it bend with the depth.
fn bent(of: Press<'_>, window: Window) -> f64 {
    let bend = |series: &[f64], k: usize| series[k - 1] - 2.0 * series[k] + series[k + 1];
    let count = of.force.len().min(of.depth.len());
    let here = |k: usize| -> f64 {
        // A reading is the mean of those from `before` before it: this one is in those up to so much later.
        let from = k.saturating_sub(window.after).max(1);
        let to = (k + window.before).min(count - 2);
        (from..=to).map(|later| bend(of.force, later)).sum()
    };
    (1..count.saturating_sub(1))
        .map(|k| bend(of.depth, k) * here(k))
        .sum()
}

/// Over how many readings.
fn averaged_over(pairs: &[[Press<'_>; 2]]) -> usize {
    if pairs.iter().flatten().any(|one| is_held(one.force)) {
        return 1;
    }
    let all: Vec<Vec<f64>> = pairs
        .iter()
        .map(|pair| fresh(pair.map(|one| one.force)))
        .collect();
    let variance: f64 = all.iter().flatten().map(|d| d * d).sum();
    let count: usize = all.iter().map(Vec::len).sum();
    if count < FEWEST || variance <= 0.0 {
        return 1;
    }
    let correlation = |lag: usize| -> f64 {
        let products = all.iter().map(|d| -> f64 {
            let pairs = d.iter().zip(d.iter().skip(lag));
            pairs.map(|(a, b)| a * b).sum()
        });
        products.sum::<f64>() / variance
    };
    let all: Vec<f64> = (1..=2 * MOST + 1).map(correlation).collect();
    let least = (1..=MOST).min_by(|a, b| all[a - 1].total_cmp(&all[b - 1]));
    let most = ELSEWHERE + SURE / (count as f64).sqrt();
    let is_mean = |n: &usize| {
        let others = (1..=2 * n + 1).filter(|lag| lag != n);
        let at = all[n - 1];
        *n > 1
            && at > AT_LAG.0
            && at < AT_LAG.1
            && others.map(|lag| all[lag - 1].abs()).all(|r| r < most)
    };
    least.filter(is_mean).unwrap_or(1)
}

/// Whether an instrument repeats its readings, or rounds them to steps larger than their noise.
fn is_held(force: &[f64]) -> bool {
    let (low, high) = range(force);
    let inner = force.windows(2).filter(|two| two[0] > low && two[0] < high);
    let same = inner.clone().filter(|two| two[0] == two[1]).count();
    same as f64 > HELD * inner.count() as f64
}

/// By how much more one repeat's force changes from reading to reading than the other's, less the mean nearby, cut at what noise does,
/// over what is cut.
fn fresh([one, other]: [&[f64]; 2]) -> Vec<f64> {
    let apart: Vec<f64> = one.iter().zip(other).map(|(a, b)| a - b).collect();
    let steps: Vec<f64> = apart.windows(2).map(|two| two[1] - two[0]).collect();
    let less_mean = |k: usize| {
        let near = &steps[k.saturating_sub(NEAR)..(k + NEAR + 1).min(steps.len())];
        steps[k] - near.iter().sum::<f64>() / near.len() as f64
    };
    let mut fresh: Vec<f64> = (0..steps.len()).map(less_mean).collect();
    let most =
        FARTHEST * median_deviation(&mut fresh.iter().map(|d| d.abs()).collect::<Vec<f64>>());
    let size = most.max(f64::MIN_POSITIVE);
    fresh
        .iter_mut()
        .for_each(|d| *d = (*d / size).clamp(-1.0, 1.0));
    fresh
}

/// Means over a window of readings; at an end its reading counts for those that are not there.
pub(crate) fn moving_average(series: &[f64], window: Window) -> Vec<f64> {
    let at = |k: isize| series[k.clamp(0, series.len() as isize - 1) as usize];
    let (before, after) = (window.before as isize, window.after as isize);
    let mean = |k: isize| {
        let own = (k - before..=k + after).map(at);
        own.sum::<f64>() / window.readings() as f64
    };
    (0..series.len() as isize).map(mean).collect()
}

/// Variance of a series over the readings of which [`moving_average`] is each mean; 0 of one reading.
pub(crate) fn variance_within(series: &[f64], window: Window) -> Vec<f64> {
    if window == Window::ONE {
        return vec![0.0; series.len()];
    }
    let squares: Vec<f64> = series.iter().map(|x| x * x).collect();
    let means = moving_average(series, window).into_iter();
    let pairs = means.zip(moving_average(&squares, window));
    pairs
        .map(|(mean, square)| (square - mean * mean).max(0.0))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    const ABOUT: fn(usize) -> Window = |n| Window {
        before: (n - 1) / 2,
        after: n / 2,
    };
    const OF_LAST: fn(usize) -> Window = |n| Window {
        before: n - 1,
        after: 0,
    };

    /// Sums written out.
    fn averaged(series: &[f64], window: Window) -> Vec<f64> {
        let n = window.before + window.after + 1;
        let mut padded = vec![series[0]; window.before];
        padded.extend(series);
        padded.extend(vec![series[series.len() - 1]; window.after]);
        let means = padded
            .windows(n)
            .map(|own| own.iter().sum::<f64>() / n as f64);
        means.collect()
    }

    fn motion() -> Vec<f64> {
        let depth = |k: i32| f64::from(k.min(57 - k).clamp(-4, 25)) / 25.0;
        (0..75).map(depth).collect()
    }

    /// Forces of eight presses of a ball with noise of so much that forgets itself in so many readings, averaged.
    fn presses(
        (noise_n, memory): (f64, f64),
        window: Window,
        random: &mut Random,
    ) -> Vec<Vec<f64>> {
        let kept = if memory > 0.0 {
            libm::exp(-1.0 / memory)
        } else {
            0.0
        };
        let mut one = |_| {
            let gain = 1.0 + 0.02 * random.normal();
            let mut noise = random.normal();
            let each = motion().into_iter().map(|depth| {
                noise = kept * noise + (1.0 - kept * kept).sqrt() * random.normal();
                gain * 0.15 * depth.max(0.0).powf(1.5) + noise_n * noise
            });
            averaged(&each.collect::<Vec<f64>>(), window)
        };
        (0..8).map(&mut one).collect()
    }

    fn found(forces: &[Vec<f64>]) -> Window {
        let depth = motion();
        let of = |force| Press {
            depth: &depth,
            force,
        };
        let pairs: Vec<[Press; 2]> = forces
            .chunks(2)
            .map(|two| [of(&two[0]), of(&two[1])])
            .collect();
        window(&pairs)
    }

    #[test]
    fn readings_of_a_running_mean_are_counted() {
        let mut random = Random::new(5);
        for readings in [1, 3, 4, 5, 8] {
            for of in [ABOUT, OF_LAST] {
                let wanted = of(readings);
                let right = (0..20)
                    .filter(|_| found(&presses((0.003, 0.0), wanted, &mut random)) == wanted);
                let right = right.count();
                assert!(right >= 18, "{wanted:?}: {right} of 20");
            }
        }
        for memory in [0.5, 1.0, 2.0, 5.0, 20.0] {
            for _ in 0..20 {
                let all = presses((0.003, memory), Window::ONE, &mut random);
                assert_eq!(found(&all), Window::ONE, "{memory}");
            }
        }
    }

    /// A cell that is read half as often as the depth repeats each reading; and a noisy instrument that averages says nothing of a quiet one that does
    /// not.
    #[test]
    fn readings_that_are_held_or_of_two_kinds_are_no_means() {
        let mut random = Random::new(6);
        for _ in 0..20 {
            let mut held = presses((0.003, 0.0), Window::ONE, &mut random);
            for force in &mut held {
                for k in (1..force.len()).step_by(2) {
                    force[k] = force[k - 1];
                }
            }
            assert_eq!(found(&held), Window::ONE);
            let mut both = presses((0.001, 0.0), Window::ONE, &mut random);
            both.extend(presses((0.01, 0.0), ABOUT(5), &mut random));
            assert_eq!(found(&both), Window::ONE);
        }
    }

    /// Of 3 to 8 mN, at so many turns from reading to reading of a slow part, and a tenth of that elsewhere.
    #[test]
    fn a_hum_is_no_mean() {
        let mut random = Random::new(7);
        for _ in 0..200 {
            let (step, amplitude) = (
                0.1 + 0.4 * random.uniform(),
                0.003 + 0.005 * random.uniform(),
            );
            let slow = 50 - (20.0 * random.uniform()) as usize;
            let mut forces = presses((0.003, 0.0), Window::ONE, &mut random);
            for force in &mut forces {
                let mut turns = random.uniform();
                for (k, force) in force.iter_mut().enumerate() {
                    turns += if k > slow { step } else { 0.1 * step };
                    *force += amplitude * libm::sin(std::f64::consts::TAU * turns);
                }
            }
            assert_eq!(found(&forces), Window::ONE, "{step} {amplitude} {slow}");
        }
    }

    /// A motion averaged as the force is explains the force at the deepest and at first touch, where a motion that is not is off by several times as much.
    #[test]
    fn a_motion_averaged_alike_explains_the_force() {
        let depth = motion();
        let law = |d: &f64| 0.15 * d.max(0.0).powf(1.5);
        let forces = depth.iter().map(law).collect::<Vec<f64>>();
        for window in [ABOUT(5), ABOUT(4), OF_LAST(5)] {
            let read = averaged(&forces, window);
            let off = |depth: &[f64]| -> f64 {
                let each = depth.iter().zip(&read).map(|(d, f)| (law(d) - f).abs());
                each.fold(0.0, f64::max)
            };
            assert!(5.0 * off(&moving_average(&depth, window)) < off(&depth));
        }
        assert_eq!(moving_average(&depth, Window::ONE), depth);
        // Of five even steps; at an end its reading counts three times.
        let even = variance_within(&[0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6], ABOUT(5));
        assert!((even[3] - 0.02).abs() < 1e-12);
        assert!((even[0] - (0.05 / 5.0 - 0.06 * 0.06)).abs() < 1e-12);
        assert!(
            variance_within(&depth, Window::ONE)
                .iter()
                .all(|v| *v == 0.0)
        );
    }
}
