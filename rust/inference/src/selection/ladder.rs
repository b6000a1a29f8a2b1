//! The ladder of models: base, single effects, pairs; stops at the first rung that suffices.

use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;
use thenar_contact::Control;
use thenar_contact::effects::Effect;

use crate::checks::depth_curve::depth_curve;
use crate::checks::gain_step::{GainStep, gain_step};
use crate::checks::heteroscedasticity::{heteroscedasticity, pulls};
use crate::checks::lack_of_fit::blocks;
use crate::checks::short_waves::{ShortWaves, short_waves};
use crate::errors::InferenceError;
use crate::forward::surrogate::force_recording::{changes_speed, goes_on};
use crate::forward::surrogate::mechanism::{Law, Mechanism};
use crate::forward::surrogate::prepared_study::PreparedStudy;
use crate::observe::measured::{Measured, Phase};
use crate::parameters::surrogate_parameter::{Kind, by_recording};
use crate::selection::candidate_fits::{Trial, lower};
use crate::selection::candidates::singles;
use crate::selection::scored::{Rungs, Scored};

/// Price of one free number in nats.
pub(crate) const PENALTY: f64 = 1.0;
/// Names among which all pairs are tried.
const PAIRED: usize = 6;
/// Names that are tried beside the leader.
const LED: usize = 12;
/// Fall of the base's deviance from which its first fit ended early.
const LEFT_EARLY: f64 = 2.0;
/// Evidence of the best single mechanism from which a second beside it is looked for.
const WORTH_A_PAIR: f64 = 7.0;

/// Climbs the ladder.
///
/// # Errors
/// `Cancelled`.
pub fn climb(
    ready: &PreparedStudy,
    measured: &[Measured],
    control: &Control<'_>,
) -> Result<Rungs, InferenceError> {
    let surrogate = ready.surrogate();
    let mut trial = Trial {
        ready,
        surrogate: &surrogate,
        blocks: blocks(measured),
        from: Vec::new(),
        control,
    };
    let mut base = trial.score(&[], &[]);
    trial.from.clone_from(&base.refit.at);
    let gain_step = gain_step(&ready.courses, &log_gains(ready, &base));
    let clear_step = gain_step.filter(|found| found.t > STEP);
    let mut singles = trial.singles(clear_step)?;
    let early = base.refit.deviance;
    base = trial.as_low_as(base, &singles);
    trial.from.clone_from(&base.refit.at);
    if early - base.refit.deviance > LEFT_EARLY {
        // Where the base ended early, so may those that began there.
        singles = trial.singles(clear_step)?;
        base = trial.as_low_as(base, &singles);
        trial.from.clone_from(&base.refit.at);
    }
    let rows = ready.courses.iter().flat_map(|c| &c.rows);
    let samples = rows.filter(|r| r.sample.is_some()).count();
    let deviances = singles.iter().map(|s| s.refit.deviance);
    let least = deviances.fold(base.refit.deviance, f64::min);
    let scale = Scale {
        base: base.refit.deviance,
        overdispersion: (least / samples.max(1) as f64).max(1.0),
    };
    scale.judge(&mut base);
    singles.iter_mut().for_each(|s| scale.judge(s));
    for scored in singles
        .iter_mut()
        .filter(|s| s.mechanisms[0].effect == Effect::Gain)
    {
        // The scatter of gains was judged with the step in it: what the step explains is told by the repeats' gains alone.
        scored.qaic_gain = scored.qaic_gain.max(clear_step.map_or(0.0, |f| f.evidence));
    }
    let mut curve = depth_curve(&trial);
    curve.iter_mut().for_each(|curve| scale.judge(curve));
    let singles = best_of_each(ready, singles);
    let pairs = trial.pairs(&singles, &scale)?;
    let sizes = (&base.refit.simulated[..], &ready.sigma[..]);
    Ok(Rungs {
        heteroscedasticity: heteroscedasticity(
            &surrogate,
            sizes,
            ready.noise.correlation[0].goes_on_s(),
        ),
        depth_curve: curve,
        short_waves: short_waves_left(ready, &base),
        base,
        singles,
        pairs,
        gain_step,
        samples,
        overdispersion: scale.overdispersion,
    })
}

/// Short waves that recordings share in what an explanation leaves.
pub fn short_waves_left(ready: &PreparedStudy, explained: &Scored) -> Option<ShortWaves> {
    let hum_hz = ready.noise.hum.map(|(hz, _)| hz);
    let simulated = &explained.refit.simulated[..];
    short_waves(&ready.courses, &ready.elastic.site_of, (simulated, hum_hz))
}

/// What evidence is measured with.
struct Scale {
    /// Deviance of the base.
    base: f64,
    /// Overdispersion, by which deviances are divided.
    overdispersion: f64,
}

impl Scale {
    fn judge(&self, scored: &mut Scored) {
        let numbers: usize = scored
            .mechanisms
            .iter()
            .map(Mechanism::effective_parameters)
            .sum();
        let fall = self.base - scored.refit.deviance;
        scored.qaic_gain = 0.5 * fall / self.overdispersion - PENALTY * numbers as f64;
    }
}

impl Trial<'_> {
    /// Every variant of every single mechanism, and a step of the gain if repeats show one.
    fn singles(&self, step: Option<GainStep>) -> Result<Vec<Scored>, InferenceError> {
        let mut tried = singles(self.ready.scales);
        let courses = &self.ready.courses;
        if !goes_on(courses) && !changes_speed(courses) {
            tried.retain(Mechanism::shows_in_loading);
        }
        tried.extend(step.map(|found| Mechanism {
            effect: Effect::Gain,
            law: Law::GainStep { from: found.from },
        }));
        self.each(&tried, (0.0, 0.6), |mechanism| self.single(mechanism))
    }

    /// The base, fitted again from where the best single mechanism ended: what that fit gained by going on is none of the mechanism's evidence.
    fn as_low_as(&self, base: Scored, singles: &[Scored]) -> Scored {
        let by_fit = |a: &&Scored, b: &&Scored| a.refit.deviance.total_cmp(&b.refit.deviance);
        match singles.iter().min_by(by_fit) {
            Some(best) => {
                let known = base.refit.at.len();
                lower(base, self.score(&[], &best.refit.at[..known]))
            }
            None => base,
        }
    }

    /// Pairs of single mechanisms, best first; none where no single one is worth it.
    fn pairs(&self, singles: &[Scored], scale: &Scale) -> Result<Vec<Scored>, InferenceError> {
        if singles.first().is_none_or(|b| b.qaic_gain <= WORTH_A_PAIR) {
            return Ok(Vec::new());
        }
        let fit = |(better, set): &(&Scored, _)| self.pair((better, set), singles);
        let mut pairs = self.each(&sets_of_two(singles), (0.6, 0.9), fit)?;
        pairs.iter_mut().for_each(|s| scale.judge(s));
        pairs.retain(|s| shows_its_signs(self.ready, s));
        pairs.sort_by(|a, b| b.qaic_gain.total_cmp(&a.qaic_gain));
        Ok(pairs)
    }

    /// Fits each on whatever threads there are, and tells how far it has come; what is found stands in their order.
    fn each<T: Sync>(
        &self,
        tried: &[T],
        (from, to): (f64, f64),
        fit: impl Fn(&T) -> Scored + Sync,
    ) -> Result<Vec<Scored>, InferenceError> {
        let done = AtomicUsize::new(0);
        let one = |one: &T| {
            let share = done.fetch_add(1, Ordering::Relaxed) as f64 / tried.len() as f64;
            self.step(from + (to - from) * share)?;
            Ok(fit(one))
        };
        tried.par_iter().map(one).collect()
    }
}

/// The best variant of every name whose necessary signs show, best first.
fn best_of_each(ready: &PreparedStudy, mut all: Vec<Scored>) -> Vec<Scored> {
    all.retain(|s| shows_its_signs(ready, s));
    all.sort_by(|a, b| b.qaic_gain.total_cmp(&a.qaic_gain));
    let mut best: Vec<Scored> = Vec::new();
    for scored in all {
        let is_same = |b: &Scored| b.mechanisms[0].effect == scored.mechanisms[0].effect;
        if !best.iter().any(is_same) {
            best.push(scored);
        }
    }
    best
}

/// The leader with each other name, and all pairs among the best few; with each the one of the two that does better alone, which
/// comes first.
fn sets_of_two(singles: &[Scored]) -> Vec<(&Scored, [Mechanism; 2])> {
    let others = &singles[..singles.len().min(LED)];
    let among = others
        .iter()
        .filter(|s| s.qaic_gain > 1.0)
        .count()
        .min(PAIRED);
    let mut sets = Vec::new();
    for (i, a) in others.iter().enumerate() {
        for (j, b) in others.iter().enumerate().skip(i + 1) {
            if (i == 0 && among > 0) || j < among {
                let both = [a, b].map(|s| s.mechanisms[0].clone());
                sets.push((a, both));
            }
        }
    }
    sets
}

/// False for a hypothesis whose necessary signs do not show in what was measured.
fn shows_its_signs(ready: &PreparedStudy, scored: &Scored) -> bool {
    let clings = scored
        .mechanisms
        .iter()
        .any(|m| m.effect == Effect::Adhesion);
    let zeros = by_recording(
        (&ready.shared, &scored.refit.at),
        ready.courses.len(),
        Kind::ForceZero,
    );
    let of = (&scored.refit.simulated[..], &ready.sigma[..]);
    !clings || pulls(&ready.courses, &zeros, of)
}

/// Standard errors from which a step of the gain is looked into.
const STEP: f64 = 3.0;

/// Logarithm of each recording's gain: what the fit with its prior gave, and what it left.
fn log_gains(ready: &PreparedStudy, base: &Scored) -> Vec<f64> {
    ready
        .courses
        .iter()
        .map(|course| {
            let (mut over, mut under) = (0.0, 0.0);
            for row in course.rows.iter().filter(|r| r.phase != Phase::Apart) {
                if let Some(sample) = row.sample {
                    let simulated = base.refit.simulated[sample];
                    over += (row.force_n - simulated) * simulated;
                    under += simulated * simulated;
                }
            }
            over / f64::max(under, 1e-30)
        })
        .zip(gains(ready, base))
        .map(|(rest, gain)| gain + libm::log1p(rest.max(-0.9)))
        .collect()
}

fn gains(ready: &PreparedStudy, base: &Scored) -> Vec<f64> {
    by_recording(
        (&ready.shared, &base.refit.at),
        ready.courses.len(),
        Kind::Gain,
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::forward::surrogate::synthetic::{Reading, ready, tool};

    /// A base that a fit left too early, by 17 nats, of which no effect explains any.
    #[test]
    fn a_base_that_was_left_too_early_is_no_evidence_of_an_effect() {
        let reading = |k: u32| -> Reading {
            let depth = 0.025 * f64::from(k);
            (f64::from(k), depth, Phase::Load, 3.0 * depth)
        };
        let readings: Vec<Reading> = (0..=40).map(reading).collect();
        let (ready, measured) = ready(
            vec![tool(1.0, |d| 3.0 * d, |_| 1.0)],
            &[(0, readings)],
            0.05,
        );
        let surrogate = ready.surrogate();
        let mut trial = Trial {
            ready: &ready,
            surrogate: &surrogate,
            blocks: blocks(&measured),
            from: Vec::new(),
            control: &Control::none(),
        };
        let settled = trial.score(&[], &[]);
        let mut early = settled.clone();
        early.refit.deviance += 34.0;
        trial.from.clone_from(&early.refit.at);
        let all = singles(ready.scales);
        let one = |m: &&Mechanism| m.effect == Effect::Offset;
        let single = trial.single(all.iter().find(one).expect("an offset"));
        let gained = early.refit.deviance - single.refit.deviance;
        assert!(gained > 30.0, "{gained}");
        let base = trial.as_low_as(early, &[single]);
        assert!(base.refit.deviance < settled.refit.deviance + 0.1);
        let kept = trial.as_low_as(settled.clone(), &[]);
        assert_eq!(kept.refit.at, settled.refit.at);
    }
}
