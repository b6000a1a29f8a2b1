//! Fits of candidate models, each from all its starts.

use thenar_contact::Control;

use crate::errors::InferenceError;
use crate::forward::surrogate::candidate_model::Model;
use crate::forward::surrogate::mechanism::Mechanism;
use crate::forward::surrogate::prepared_study::PreparedStudy;
use crate::forward::surrogate::surrogate_data::Surrogate;
use crate::least_squares::surrogate_fit::refit;
use crate::selection::scored::{LackOfFit, Scored};

/// Tries hypotheses on one study.
pub struct Trial<'a> {
    /// The study.
    pub ready: &'a PreparedStudy,
    /// Its screen.
    pub surrogate: &'a Surrogate<'a>,
    /// Samples that repeats share, by number of their block.
    pub blocks: Vec<usize>,
    /// Optimum of the base, where fits begin.
    pub from: Vec<f64>,
    /// Who watches.
    pub control: &'a Control<'a>,
}

impl Trial<'_> {
    /// Tells how far the trial has come.
    ///
    /// # Errors
    /// `Cancelled`.
    pub fn step(&self, share: f64) -> Result<(), InferenceError> {
        let step = self.control.step("trying explanations", share);
        step.map_err(|_| InferenceError::Cancelled)
    }

    /// Fits from an optimum of fewer mechanisms, the first of these.
    pub fn score(&self, mechanisms: &[Mechanism], from: &[f64]) -> Scored {
        let model = Model::new(self.surrogate, mechanisms);
        let refit = refit(self.surrogate, &model, from);
        Scored {
            lack_of_fit: lack_of_fit(self.surrogate, &refit.residual, &self.blocks),
            mechanisms: mechanisms.to_vec(),
            refit,
            qaic_gain: 0.0,
        }
    }

    /// The best fit of one mechanism from all its starts, each from the base's optimum and from the study's own numbers: what is missing may
    /// have drawn the base into a hollow that the fit with it does not leave again (a stiff skin's did not).
    pub fn single(&self, mechanism: &Mechanism) -> Scored {
        let one = std::slice::from_ref(mechanism);
        let mut starts = mechanism.starts(self.ready.least_seen());
        starts.push(Vec::new());
        let own: Vec<f64> = self.surrogate.shared.iter().map(|c| c.start).collect();
        let beside = |shared: &[f64], start: &[f64]| self.score(one, &[shared, start].concat());
        let fits = starts
            .iter()
            .flat_map(|start| [&self.from, &own].map(|at| beside(at, start)));
        fits.reduce(lower).expect("two starts at least")
    }

    /// The best fit of two mechanisms from the optimum of the better one; the second begins where it is told to, and where it ended alone.
    /// Also from the optimum of the second, and where all that is worse than the better one by itself, where the second does nothing.
    pub fn pair(&self, (better, set): (&Scored, &[Mechanism; 2]), singles: &[Scored]) -> Scored {
        let from = |parts: &[&[f64]]| self.score(set, &parts.concat());
        let (shared, first) = better.refit.at.split_at(self.from.len());
        let mut best = from(&[shared, first]);
        if let Some(alone) = singles.iter().find(|s| s.mechanisms[0] == set[1]) {
            let (other, second) = alone.refit.at.split_at(self.from.len());
            for start in [
                &[shared, first, second][..],
                &[other, first, second],
                &[other],
            ] {
                best = lower(best, from(start));
            }
        }
        match set[1].nothing() {
            Some(nothing) if best.refit.deviance > better.refit.deviance => {
                lower(best, from(&[shared, first, &[nothing]]))
            }
            _ => best,
        }
    }
}

/// The one that fits better.
pub(crate) fn lower(one: Scored, other: Scored) -> Scored {
    match other.refit.deviance < one.refit.deviance {
        true => other,
        false => one,
    }
}

/// Sum over blocks of the squared sum of residuals over their number, less what residuals that know nothing of each other give; and the same
/// without the block that adds most.
pub(crate) fn lack_of_fit(
    surrogate: &Surrogate<'_>,
    residual: &[f64],
    blocks: &[usize],
) -> LackOfFit {
    let count = blocks.iter().fold(0, |most, b| most.max(b + 1));
    let mut sums = vec![(0.0, 0.0f64, 0.0); count];
    for (sample, _, _) in surrogate.phases() {
        let r = residual[sample].clamp(-6.0, 6.0);
        let sum = &mut sums[blocks[sample]];
        *sum = (sum.0 + r, sum.1 + 1.0, sum.2 + r * r);
    }
    let used: Vec<_> = sums.iter().filter(|s| s.1 > 1.0).collect();
    let own: f64 = used
        .iter()
        .map(|(sum, n, squares)| squares - sum * sum / n)
        .sum();
    let degrees: f64 = used.iter().map(|s| s.1 - 1.0).sum();
    let variance = if degrees > 0.0 { own / degrees } else { 1.0 };
    let each = || used.iter().map(|(sum, n, _)| sum * sum / n - variance);
    let (all, most) = (each().sum::<f64>(), each().fold(0.0, f64::max));
    LackOfFit {
        all: all.max(0.0),
        less_largest: (all - most).max(0.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::checks::lack_of_fit::blocks;
    use crate::forward::surrogate::mechanism::{Law, Stage};
    use crate::forward::surrogate::synthetic::{Reading, ready, tool};
    use crate::observe::measured::Phase;
    use crate::selection::candidates::singles;
    use thenar_contact::effects::Effect;

    /// Presses of flat punches at 1 mm/s and a hold, as an amplifier with an offset reads them up to a ceiling; a spike of the first
    /// stands above that by a factor e^spike, so that the study's largest force is no ceiling.
    struct Clipped {
        ceiling_n: f64,
        offset_n: f64,
        spike: f64,
        /// Part of the force that fades.
        fades: f64,
        /// Stiffness of the punches, N/mm.
        stiffness: &'static [f64],
    }

    impl Clipped {
        fn readings(&self, place: usize) -> Vec<Reading> {
            let read = |k: u32| {
                let time = f64::from(k) / 40.0;
                let depth = time.min(2.0);
                let left = 1.0 - self.fades * (1.0 - libm::exp(-(time - 1.0).max(0.0) / 0.3));
                let true_n = self.stiffness[place] * depth * left;
                let force = match (place, k) {
                    (0, 60) => self.ceiling_n * libm::exp(self.spike),
                    _ => (true_n + self.offset_n).min(self.ceiling_n),
                };
                (time, depth, Phase::Load, force)
            };
            (0..=100).map(read).collect()
        }

        fn on_trial<T>(&self, ask: impl Fn(&Trial<'_>) -> T) -> T {
            self.on_trial_of(&|force| force, ask)
        }

        /// The same where the readings are made of the forces so.
        fn on_trial_of<T>(&self, read: &dyn Fn(f64) -> f64, ask: impl Fn(&Trial<'_>) -> T) -> T {
            let punch = |k: &f64| tool(2.0, |depth| k * depth, |_| 1.0);
            let places = 0..self.stiffness.len();
            let readings = |k: usize| -> Vec<Reading> {
                let all = self.readings(k).into_iter();
                all.map(|(time, depth, phase, force)| (time, depth, phase, read(force)))
                    .collect()
            };
            let recordings: Vec<_> = places.map(|k| (k, readings(k))).collect();
            let tools = self.stiffness.iter().map(punch).collect();
            let (ready, measured) = ready(tools, &recordings, 0.05);
            let surrogate = ready.surrogate();
            let mut trial = Trial {
                ready: &ready,
                surrogate: &surrogate,
                blocks: blocks(&measured),
                from: Vec::new(),
                control: &Control::none(),
            };
            trial.from = trial.score(&[], &[]).refit.at;
            ask(&trial)
        }
    }

    const LOW: Clipped = Clipped {
        ceiling_n: 15.0,
        offset_n: 0.0,
        spike: 0.9,
        fades: 0.0,
        stiffness: &[10.0],
    };
    const CEILING: Mechanism = Mechanism {
        effect: Effect::Saturation,
        law: Law::Saturation(Stage::Last),
    };

    /// From any one start, a fit misses some of them.
    #[test]
    fn saturation_is_found_from_any_of_its_starts() {
        let middle = Clipped {
            ceiling_n: 13.0,
            offset_n: 0.6,
            spike: 0.5,
            ..LOW
        };
        let near = Clipped {
            ceiling_n: 10.0,
            offset_n: -1.5,
            spike: 0.05,
            fades: 0.3,
            stiffness: &[10.0, 2.0],
        };
        for study in [LOW, middle, near] {
            let found = study.on_trial(|trial| trial.single(&CEILING));
            let at = found.refit.at.last().expect("a ceiling");
            assert!((at + study.spike).abs() < 5e-3, "{at} {}", study.spike);
        }
    }

    /// An offset and a ceiling far below the largest force: from the offset alone only the ceiling that was found alone leads there.
    #[test]
    fn pair_fit_also_starts_at_the_single_optimum_of_its_second() {
        let study = Clipped {
            offset_n: 1.2,
            ..LOW
        };
        let offset = Mechanism {
            effect: Effect::Offset,
            law: Law::Offset,
        };
        let both = study.on_trial(|trial| {
            let singles = [&offset, &CEILING].map(|m| trial.single(m));
            let set = [offset.clone(), CEILING];
            trial.pair((&singles[0], &set), &singles).refit.at
        });
        let [.., offset, ceiling] = both[..] else {
            panic!("two numbers")
        };
        assert!((offset - study.offset_n).abs() < 0.02, "{offset}");
        assert!((ceiling + study.spike).abs() < 5e-3, "{ceiling}");
    }

    /// A base that was drawn to tissue that is none: nothing leads back from there.
    #[test]
    fn single_fit_also_starts_at_the_study_parameters() {
        LOW.on_trial(|trial| {
            let mut surrogate = trial.ready.surrogate();
            surrogate
                .shared
                .iter_mut()
                .for_each(|c| c.bounds.0 = -900.0);
            let drawn = Trial {
                surrogate: &surrogate,
                from: vec![-900.0; trial.from.len()],
                control: &Control::none(),
                blocks: trial.blocks.clone(),
                ready: trial.ready,
            };
            let stuck = drawn.score(std::slice::from_ref(&CEILING), &drawn.from);
            assert_eq!(stuck.refit.at[..2], drawn.from[..]);
            let found = drawn.single(&CEILING).refit.at;
            assert!((found[2] + LOW.spike).abs() < 5e-3, "{found:?}");
        });
    }

    /// A floor under readings of two punches, small and just below the peak of the softer: between the last reading that is not there and the
    /// first that is. Where some get through a fifth below it the least reading is no floor, and they draw it down, by less than a tenth.
    #[test]
    fn sensor_floor_is_found_over_its_range() {
        let study = Clipped {
            ceiling_n: 1e3,
            stiffness: &[10.0, 4.0],
            ..LOW
        };
        let all = [
            (1.0, false),
            (3.0, false),
            (6.0, false),
            (3.0, true),
            (6.0, true),
        ];
        for (floor_n, some_slip) in all {
            let slips = |f: f64| some_slip && (f / floor_n - 0.8).abs() < 0.02;
            let blind = |f: f64| if f < floor_n && !slips(f) { 0.0 } else { f };
            let found = study.on_trial_of(&blind, |trial| {
                let law = Law::Floor(Stage::Last);
                let effect = Effect::Threshold;
                trial.single(&Mechanism { effect, law }).refit.at
            });
            let at = found.last().expect("a floor") * 8.0;
            let least = if some_slip {
                0.9 * floor_n
            } else {
                floor_n - 0.25
            };
            assert!(at > least && at < floor_n + 0.05, "{at} {floor_n}");
        }
    }

    /// What a recording too noisy for the smallest peak shows is not asked for.
    #[test]
    fn least_detectable_reading_ignores_noisy_recordings() {
        let study = Clipped {
            stiffness: &[10.0, 4.0],
            ..LOW
        };
        let tools = [10.0, 4.0].map(|k: f64| tool(2.0, move |depth| k * depth, |_| 1.0));
        let recordings = [0, 1].map(|k| (k, study.readings(k)));
        let (mut made, _) = ready(tools.into(), &recordings, 0.05);
        let both = made.least_seen();
        let (first, count) = made.courses[0].samples;
        made.sigma[first..first + count].fill(3.0);
        // Of 10 N/mm and 4 N/mm every 0.025 mm: the third and the first reading that stand out of four times the noise.
        assert!((both * 8.0 - 0.3).abs() < 0.06, "{both}");
        assert!((made.least_seen() * 8.0 - 0.3).abs() < 1e-9);
    }

    /// Of six parts of a press, two misfit alike or one alone: readings that are astray at one moment of two repeats are no misfit over the press.
    #[test]
    fn misfit_of_one_part_is_the_largest_that_is_left_out() {
        let left = |misfits: &[usize]| {
            LOW.on_trial(|trial| {
                let parts: Vec<usize> = (0..trial.ready.values.len()).map(|k| k / 17).collect();
                let residual = |(k, part): (usize, &usize)| match misfits.contains(part) {
                    true => 2.0,
                    false => 1.0 - 2.0 * (k % 2) as f64,
                };
                let residual: Vec<f64> = parts.iter().enumerate().map(residual).collect();
                lack_of_fit(trial.surrogate, &residual, &parts)
            })
        };
        let (one, two) = (left(&[2]), left(&[2, 4]));
        assert!(one.all > 50.0 && one.less_largest < 2.0, "{one:?}");
        assert!(two.all > 100.0 && two.less_largest > 50.0, "{two:?}");
    }

    /// What begins with nothing answers as what it is added to, and so ends no worse.
    #[test]
    fn null_parameter_of_a_mechanism_leaves_predictions_unchanged() {
        LOW.on_trial(|trial| {
            let base = Model::new(trial.surrogate, &[]);
            let without = trial.surrogate.all_forces(&base, &trial.from);
            let mut all = singles(trial.ready.scales);
            all.retain(|m| !matches!(m.law, Law::Tabulated(_)));
            let found: Vec<Effect> = all
                .iter()
                .filter(|m| m.nothing().is_some())
                .map(|m| m.effect)
                .collect();
            assert!(
                found.contains(&Effect::Saturation) && found.contains(&Effect::FixtureCompliance),
                "{found:?}"
            );
            for mechanism in all {
                let Some(nothing) = mechanism.nothing() else {
                    continue;
                };
                let model = Model::new(trial.surrogate, std::slice::from_ref(&mechanism));
                let at = [&trial.from[..], &[nothing]].concat();
                let with = trial.surrogate.all_forces(&model, &at).concat();
                let most = with
                    .iter()
                    .zip(without.concat())
                    .map(|(a, b)| (a - b).abs());
                let most = most.fold(0.0, f64::max);
                assert!(most < 1e-9, "{}: {most} N", mechanism.effect.name());
            }
        });
    }
}
