//! Profile-likelihood intervals of an effect's own parameters (Venzon & Moolgavkar 1988), and which of them a study leaves open.
//!
//! A parameter whose interval reaches an end of its admissible range is practically non-identifiable (Raue et al. 2009): recordings bound it from
//! one side, or not at all.

use crate::forward::surrogate::candidate_model::Model;
use crate::forward::surrogate::mechanism::{Clock, Law, Mechanism, Scales};
use crate::forward::surrogate::prepared_study::PreparedStudy;
use crate::forward::surrogate::relaxation_spectrum::OUTER;
use crate::forward::surrogate::surrogate_data::Surrogate;
use crate::least_squares::surrogate_fit::{Refit, refit};
use crate::observe::measured::Measured;
use crate::selection::candidates::singles;
use crate::selection::form_check::FormCheck;
pub use crate::selection::profile_ends::Interval;
use crate::selection::profile_ends::{Profile, ROOT};
use crate::selection::scored::{Rungs, Scored};

/// What recordings say of one mechanism of an explanation.
#[derive(Debug, Clone, PartialEq)]
pub struct Profiled {
    /// By its own parameters, over all variants that are not excluded. Of free shares the first is their sum, since shares of neighboring
    /// branches stand for each other.
    pub numbers: Vec<Interval>,
    /// Variants of its law that are not excluded, in the order of the candidates; the fitted one is among them.
    pub variants: Vec<Mechanism>,
    /// Logarithms of the shortest and the longest time constant of a spectrum over time; empty of any other law.
    pub outer: Vec<Interval>,
}

impl Profiled {
    /// Whether the size of the mechanism excludes that it does nothing: its interval holds no value with which it does, and it is bounded on
    /// one side at least.
    pub fn excludes_absence(&self, mechanism: &Mechanism) -> bool {
        let size = self.numbers[0];
        let is_above = size.ends.0 > 0.0 && !size.is_open.0;
        match mechanism.law {
            Law::Saturation(_) => !size.is_open.1,
            Law::Floor(_) => !size.is_open.0,
            _ => is_above || (size.ends.1 < 0.0 && !size.is_open.1),
        }
    }
}

/// Profiles every mechanism of an explanation: on skin whose form was only measured with that form free, since a name is held against it there.
pub fn profiled(
    ready: &PreparedStudy,
    rungs: &Rungs,
    measured: &[Measured],
    of: &Scored,
) -> Vec<Profiled> {
    let check = FormCheck::new(ready, measured, rungs);
    let plain = ready.surrogate();
    let surrogate = check.as_ref().map_or(&plain, FormCheck::surrogate);
    let known = ready.shared.len();
    let free = vec![0.0; surrogate.shared.len() - known];
    let samples = rungs.samples.max(1) as f64;
    let one = |number: usize| {
        let (mechanisms, own) = by_sum(of, (number, known));
        let start = [&of.refit.at[..known], &free, &own].concat();
        let all = variants(&mechanisms, (number, ready.scales));
        let models: Vec<Model<'_>> = all.iter().map(|set| Model::new(surrogate, set)).collect();
        let fits: Vec<Refit> = models
            .iter()
            .map(|model| refit(surrogate, model, &start))
            .collect();
        let least = fits
            .iter()
            .map(|f| f.deviance)
            .fold(f64::INFINITY, f64::min);
        let overdispersion = match &check {
            Some(_) => (least / samples).max(1.0),
            None => rungs.overdispersion,
        };
        let mut found: Option<Profiled> = None;
        for ((set, model), best) in all.iter().zip(models).zip(fits) {
            let mut profile = Profile {
                surrogate,
                model,
                best,
                least,
                overdispersion,
            };
            if profile.root(profile.best.deviance) > ROOT {
                continue;
            }
            let numbers = profile.intervals(number);
            let variant = set[number].clone();
            match &mut found {
                None => {
                    found = Some(Profiled {
                        numbers,
                        variants: vec![variant],
                        outer: Vec::new(),
                    });
                }
                Some(known) => {
                    known.variants.push(variant);
                    let each = known.numbers.iter_mut().zip(numbers);
                    each.for_each(|(a, b)| *a = a.joined(b));
                }
            }
        }
        let mut found = found.unwrap_or(Profiled {
            numbers: Vec::new(),
            variants: Vec::new(),
            outer: Vec::new(),
        });
        found.outer = outer(surrogate, (&mechanisms, number), (&start, overdispersion));
        found
    };
    (0..of.mechanisms.len()).map(one).collect()
}

/// Intervals of the shortest and the longest time constant (logarithms) of one mechanism that fades over time.
fn outer(
    surrogate: &Surrogate<'_>,
    (mechanisms, number): (&[Mechanism], usize),
    (start, overdispersion): (&[f64], f64),
) -> Vec<Interval> {
    let before: usize = mechanisms[..number].iter().map(Mechanism::count).sum();
    let first = surrogate.shared.len() + before;
    let own = first..first + mechanisms[number].count();
    let one = |at: f64| {
        let (mut all, mut start) = (mechanisms.to_vec(), start.to_vec());
        let Law::Relaxation {
            clock: Clock::Time,
            spectrum,
        } = &mut all[number].law
        else {
            return None;
        };
        let (beside, numbers) = spectrum.beside(at, &start[own.clone()])?;
        *spectrum = beside;
        start[own.clone()].copy_from_slice(&numbers);
        let model = Model::new(surrogate, &all);
        let best = refit(surrogate, &model, &start);
        let mut profile = Profile {
            surrogate,
            model,
            least: best.deviance,
            best,
            overdispersion,
        };
        Some(profile.interval(first + 1))
    };
    [-OUTER, OUTER].into_iter().filter_map(one).collect()
}

/// The mechanisms of an explanation and their numbers, with free shares of one as their sum and portions.
fn by_sum(of: &Scored, (number, shared): (usize, usize)) -> (Vec<Mechanism>, Vec<f64>) {
    let (mut mechanisms, mut own) = (of.mechanisms.clone(), of.refit.at[shared..].to_vec());
    let before: usize = mechanisms[..number].iter().map(Mechanism::count).sum();
    let numbers = before..before + mechanisms[number].count();
    if let Law::Relaxation { spectrum, .. } = &mut mechanisms[number].law
        && let Some((summed, portions)) = spectrum.by_sum(&own[numbers.clone()])
    {
        *spectrum = summed;
        own[numbers].copy_from_slice(&portions);
    }
    (mechanisms, own)
}

/// The explanation with every variant of one of its laws that differs in a number which is tried and not fitted.
fn variants(of: &[Mechanism], (number, scales): (usize, Scales)) -> Vec<Vec<Mechanism>> {
    let own = &of[number];
    let is_variant = |other: &Mechanism| match (&own.law, &other.law) {
        (Law::Tabulated(_), Law::Tabulated(_)) => true,
        (Law::Softening { start: a, .. }, Law::Softening { start: b, .. }) => a == b,
        _ => false,
    };
    let all = singles(scales).into_iter();
    let mut found: Vec<Mechanism> = all
        .filter(|other| other.effect == own.effect && is_variant(other))
        .collect();
    if !found.contains(own) {
        found = vec![own.clone()];
    }
    let with = |variant: Mechanism| {
        let mut set = of.to_vec();
        set[number] = variant;
        set
    };
    found.into_iter().map(with).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::selection::profile_ends::NEAR;
    use crate::selection::scored::LackOfFit;
    use thenar_contact::effects::Effect;

    use crate::forward::surrogate::synthetic::{Reading, ready, tool};
    use crate::observe::measured::Phase;

    const SIGMA_N: f64 = 0.05;

    /// A flat punch of 10 N/mm pressed to 2 mm and read with an offset: the interval of one of its effect's numbers.
    fn of(effect: (Effect, Law), offset_n: f64, overdispersion: f64) -> (Interval, Refit) {
        let read = |k: u32| -> Reading {
            let depth = f64::from(k) / 40.0;
            (depth, depth, Phase::Load, 10.0 * depth + offset_n)
        };
        let punch = tool(2.0, |depth| 10.0 * depth, |_| 1.0);
        let readings = (0..=80).map(read).collect();
        let (ready, _) = ready(vec![punch], &[(0, readings)], SIGMA_N);
        let surrogate = ready.surrogate();
        let (effect, law) = effect;
        let all = [Mechanism { effect, law }];
        let model = Model::new(&surrogate, &all);
        let best = refit(&surrogate, &model, &[]);
        let mut profile = Profile {
            surrogate: &surrogate,
            least: best.deviance,
            model,
            best: best.clone(),
            overdispersion,
        };
        (profile.intervals(0)[0], best)
    }

    /// An offset adds to the force and to nothing else, so that its likelihood is normal: 1.645 standard errors either way.
    #[test]
    fn interval_of_a_linear_parameter_is_the_normal_one() {
        for overdispersion in [1.0f64, 4.0] {
            let (found, best) = of((Effect::Offset, Law::Offset), 0.3, overdispersion);
            let last = best.at.len() - 1;
            let error = best.covariance[(last, last)].sqrt() * overdispersion.sqrt();
            assert_eq!(found.is_open, (false, false));
            for (end, wanted) in [(found.ends.0, -ROOT), (found.ends.1, ROOT)] {
                let at = (end - best.at[last]) / error;
                assert!((at / wanted - 1.0).abs() < 2.0 * NEAR, "{at} {wanted}");
            }
        }
    }

    /// A flat punch of 10 N/mm pressed to 2 mm and let go, whose load is lost with travel in closed form (x' = d' - x |d'| / length): the
    /// interval of the whole share, and whether it excludes that nothing is lost.
    fn lost(share: f64, sigma_n: f64) -> (Interval, bool) {
        let (deepest, length) = (2.0f64, 0.8);
        let read = |k: u32| -> Reading {
            let way = f64::from(k) / 40.0;
            let up = (way - deepest).max(0.0);
            let depth = way - 2.0 * up;
            let last = length * (1.0 - libm::exp(-way.min(deepest) / length));
            let left = (last + length) * libm::exp(-up / length) - length;
            let (left, phase) = match up > 0.0 {
                true => (left, Phase::Unload),
                false => (last, Phase::Load),
            };
            let force = 10.0 * (depth - share * (depth - left)).max(0.0);
            (way, depth, phase, force)
        };
        let punch = tool(deepest, |depth| 10.0 * depth, |_| 1.0);
        let readings = (0..=160).map(read).collect();
        let (ready, measured) = ready(vec![punch], &[(0, readings)], sigma_n);
        let mut mechanisms = singles(ready.scales);
        mechanisms.retain(|m| m.effect == Effect::RateIndependentLoss);
        let known = alone((&ready, &measured), &mechanisms);
        (known.numbers[0], known.excludes_absence(&mechanisms[0]))
    }

    /// What recordings say of an explanation of one mechanism.
    fn alone(
        (ready, measured): (&PreparedStudy, &[Measured]),
        mechanisms: &[Mechanism],
    ) -> Profiled {
        let surrogate = ready.surrogate();
        let scored = |mechanisms: &[Mechanism]| Scored {
            mechanisms: mechanisms.to_vec(),
            refit: refit(&surrogate, &Model::new(&surrogate, mechanisms), &[]),
            qaic_gain: 0.0,
            lack_of_fit: LackOfFit::default(),
        };
        let rungs = Rungs {
            base: scored(&[]),
            singles: Vec::new(),
            pairs: Vec::new(),
            heteroscedasticity: None,
            short_waves: None,
            depth_curve: None,
            gain_step: None,
            samples: ready.values.len(),
            overdispersion: 1.0,
        };
        profiled(ready, &rungs, measured, &scored(mechanisms)).remove(0)
    }

    /// A flat punch of 10 N/mm stepped to 2 mm and held so long, s, whose load loses 0.3 by a log-normal spectrum about 1 s, integrated at fine
    /// steps: intervals of the logarithms of its outer time constants.
    fn faded(hold_s: f64, width: f64) -> Vec<Interval> {
        let lost = |time: f64| {
            let (mut law, mut whole) = (0.0, 0.0);
            for n in 0..=1000 {
                let z = -6.0 + 0.012 * f64::from(n);
                let weight = libm::exp(-0.5 * z * z);
                law += weight * libm::exp(-time / libm::exp(width * z));
                whole += weight;
            }
            0.3 * (1.0 - law / whole)
        };
        let read = |k: u32| -> Reading {
            let after = 1e-3 * libm::pow(1e3 * hold_s, f64::from(k) / 120.0);
            (1e-3 + after, 2.0, Phase::Hold, 20.0 * (1.0 - lost(after)))
        };
        let punch = tool(2.0, |depth| 10.0 * depth, |_| 1.0);
        let step = [(0.0, 0.0, Phase::Load, 0.0), (1e-3, 2.0, Phase::Load, 20.0)];
        let readings = step.into_iter().chain((0..=120).map(read)).collect();
        let (ready, measured) = ready(vec![punch], &[(0, readings)], 0.3);
        let mut mechanisms = singles(ready.scales);
        mechanisms.retain(|m| m.effect == Effect::Relaxation);
        alone((&ready, &measured), &mechanisms).outer
    }

    /// The planted ones lie in their intervals; a hold that ends before the longest leaves that open upwards.
    #[test]
    fn intervals_of_outer_time_constants_hold_what_was_planted() {
        let width = 1.2;
        let found = faded(300.0, width);
        for (interval, planted) in found.iter().zip([-OUTER * width, OUTER * width]) {
            assert_eq!(interval.is_open, (false, false), "{interval:?}");
            assert!(
                interval.ends.0 < planted && planted < interval.ends.1,
                "{interval:?}"
            );
        }
        let short = faded(1.0, width);
        assert_eq!((found.len(), short.len()), (2, 2));
        let length = |of: &Interval| of.ends.1 - of.ends.0;
        assert!(
            short[1].is_open.1 || length(&short[1]) > 3.0 * length(&found[1]),
            "{short:?}"
        );
    }

    /// Of many shares that stand for each other only the sum is asked: it holds what was planted, and none where nothing was.
    #[test]
    fn interval_of_shares_is_that_of_their_sum() {
        let (found, is_there) = lost(0.4, 0.3);
        assert!(
            is_there && found.ends.0 < 0.4 && 0.4 < found.ends.1,
            "{found:?}"
        );
        let (found, is_there) = lost(0.0, 0.3);
        assert!(!is_there && found.is_open.0, "{found:?}");
        // A loss of a twentieth of the noise.
        let (found, is_there) = lost(0.001, 0.3);
        assert!(!is_there, "{found:?}");
    }

    /// A creep whose own time is thirty years adds nothing in two seconds: its size is open on both sides.
    #[test]
    fn parameter_that_recordings_do_not_show_is_open() {
        let none = Law::Drift { time_s: 1e9 };
        let (found, _) = of((Effect::Drift, none), 0.0, 1.0);
        assert_eq!(found.is_open, (true, true), "{found:?}");
    }
}
