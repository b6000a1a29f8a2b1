//! The ladder: parameters, instrument and tissue one by one, pairs, and what no listed name explains; it stops at the first
//! rung that suffices.

use thenar_contact::effects::Effect;

use super::checks::{GainStep, Unsteady, gain_step, pulls, unsteady};
use super::course::{changes_speed, goes_on};
use super::mechanism::{Acts, Mechanism, singles};
use super::model::{Kind, Model};
use super::prepare::Prepared;
use super::refit::{Refit, refit};
use super::screen::Screen;
use crate::fit::blocks;
use crate::{DiagnosisError, Measured, Phase};
use thenar_contact::Control;

/// A hypothesis that was fitted.
#[derive(Debug, Clone)]
pub struct Scored {
    /// What it adds to the base; nothing for the base itself.
    pub mechanisms: Vec<Mechanism>,
    /// Its fit.
    pub refit: Refit,
    /// Logarithm of the evidence over that of the base: half of what the deviance falls by, tempered, less the price of its numbers.
    pub evidence: f64,
    /// Misfit that is the same in every repeat, beyond what noise adds up to.
    pub coherent: f64,
}

impl Scored {
    /// Names, in the catalogue's order, each once.
    pub fn names(&self) -> Vec<&'static str> {
        let mut effects: Vec<Effect> = self.mechanisms.iter().map(|m| m.effect).collect();
        effects.sort_unstable();
        effects.dedup();
        effects.into_iter().map(Effect::name).collect()
    }
}

/// What every rung found.
pub struct Rungs {
    /// The base.
    pub base: Scored,
    /// One mechanism each, the best variant of every name, best first.
    pub singles: Vec<Scored>,
    /// Two mechanisms, best first; empty where one suffices.
    pub pairs: Vec<Scored>,
    /// How repeats deviate under load and without.
    pub unsteady: Option<Unsteady>,
    /// The clearest step of the session's gain.
    pub gain_step: Option<GainStep>,
    /// Number of screened samples.
    pub samples: usize,
    /// What deviances are divided by: how much more than the noise the best model leaves.
    pub temper: f64,
}

/// Price of one free number in nats.
const PRICE: f64 = 1.0;
/// Names among which all pairs are tried.
const PAIRED: usize = 6;
/// Names that are tried beside the leader.
const LED: usize = 12;
/// Evidence of the best single mechanism from which a second beside it is looked for.
const WORTH_A_PAIR: f64 = 7.0;

/// Climbs the ladder.
///
/// # Errors
/// `Cancelled`.
pub fn climb(
    ready: &Prepared,
    measured: &[Measured],
    control: &Control<'_>,
) -> Result<Rungs, DiagnosisError> {
    let screen = ready.screen();
    let mut trial = Trial {
        ready,
        screen: &screen,
        blocks: blocks(measured),
        from: Vec::new(),
        control,
    };
    let mut base = trial.score(&[], &[]);
    trial.from.clone_from(&base.refit.at);
    let gain_step = gain_step(&ready.courses, &log_gains(ready, &base));
    let clear_step = gain_step.filter(|found| found.t > STEP);
    let mut singles = trial.singles(clear_step)?;
    let rows = ready.courses.iter().flat_map(|c| &c.rows);
    let samples = rows.filter(|r| r.sample.is_some()).count();
    let deviances = singles.iter().map(|s| s.refit.deviance);
    let least = deviances.fold(base.refit.deviance, f64::min);
    let scale = Scale {
        base: base.refit.deviance,
        temper: (least / samples.max(1) as f64).max(1.0),
    };
    scale.judge(&mut base);
    singles.iter_mut().for_each(|s| scale.judge(s));
    for scored in singles
        .iter_mut()
        .filter(|s| s.mechanisms[0].effect == Effect::Gain)
    {
        // The scatter of gains was judged with the step in it: what the step explains is told by the repeats' gains alone.
        scored.evidence = scored.evidence.max(clear_step.map_or(0.0, |f| f.evidence));
    }
    let singles = best_of_each(ready, singles);
    let pairs = trial.pairs(&singles, &scale)?;
    let sizes = (&base.refit.simulated[..], &ready.sigma[..]);
    Ok(Rungs {
        unsteady: unsteady(&screen, sizes, ready.noise.memory_s[0]),
        base,
        singles,
        pairs,
        gain_step,
        samples,
        temper: scale.temper,
    })
}

/// What evidence is measured with.
struct Scale {
    /// Deviance of the base.
    base: f64,
    /// What deviances are divided by.
    temper: f64,
}

impl Scale {
    fn judge(&self, scored: &mut Scored) {
        let numbers: usize = scored.mechanisms.iter().map(Mechanism::price).sum();
        let fall = self.base - scored.refit.deviance;
        scored.evidence = 0.5 * fall / self.temper - PRICE * numbers as f64;
    }
}

/// Tries hypotheses on one study.
struct Trial<'a> {
    ready: &'a Prepared,
    screen: &'a Screen<'a>,
    /// Samples that repeats share, by number of their block.
    blocks: Vec<usize>,
    /// Optimum of the base, where fits begin.
    from: Vec<f64>,
    control: &'a Control<'a>,
}

impl Trial<'_> {
    fn step(&self, share: f64) -> Result<(), DiagnosisError> {
        let step = self.control.step("trying explanations", share);
        step.map_err(|_| DiagnosisError::Cancelled)
    }

    /// Fits from an optimum of fewer mechanisms, the first of these.
    fn score(&self, mechanisms: &[Mechanism], from: &[f64]) -> Scored {
        let model = Model::new(self.screen, mechanisms);
        let refit = refit(self.screen, &model, from);
        Scored {
            coherent: coherent(self.screen, &refit.residual, &self.blocks),
            mechanisms: mechanisms.to_vec(),
            refit,
            evidence: 0.0,
        }
    }

    /// The best fit of one mechanism from all its starts.
    fn single(&self, mechanism: &Mechanism) -> Scored {
        let one = std::slice::from_ref(mechanism);
        let mut best = self.score(one, &self.from);
        for start in mechanism.starts() {
            let other = self.score(one, &[&self.from[..], start].concat());
            if other.refit.deviance < best.refit.deviance {
                best = other;
            }
        }
        best
    }

    /// The best fit of two mechanisms from the optimum of the better one; the second begins where it is told to, and, where it has
    /// other starts, also where it ended alone.
    fn pair(&self, (better, set): (&Scored, &[Mechanism; 2]), singles: &[Scored]) -> Scored {
        let plain = self.score(set, &better.refit.at);
        let alone = singles.iter().find(|s| s.mechanisms[0] == set[1]);
        let Some(alone) = alone.filter(|_| !set[1].starts().is_empty()) else {
            return plain;
        };
        let own = &alone.refit.at[self.from.len()..];
        let other = self.score(set, &[&better.refit.at[..], own].concat());
        match other.refit.deviance < plain.refit.deviance {
            true => other,
            false => plain,
        }
    }

    /// Every variant of every single mechanism, and a step of the gain if repeats show one.
    fn singles(&self, step: Option<GainStep>) -> Result<Vec<Scored>, DiagnosisError> {
        let mut tried = singles(self.ready.scales);
        let courses = &self.ready.courses;
        if !goes_on(courses) && !changes_speed(courses) {
            tried.retain(Mechanism::shows_in_loading);
        }
        tried.extend(step.map(|found| Mechanism {
            effect: Effect::Gain,
            acts: Acts::GainStep { from: found.from },
        }));
        let mut all = Vec::new();
        for (k, mechanism) in tried.iter().enumerate() {
            self.step(0.6 * k as f64 / tried.len() as f64)?;
            all.push(self.single(mechanism));
        }
        Ok(all)
    }

    /// Pairs of single mechanisms, best first; none where no single one is worth it.
    fn pairs(&self, singles: &[Scored], scale: &Scale) -> Result<Vec<Scored>, DiagnosisError> {
        let mut pairs = Vec::new();
        if singles.first().is_none_or(|b| b.evidence <= WORTH_A_PAIR) {
            return Ok(pairs);
        }
        let sets = sets_of_two(singles);
        for (k, (better, set)) in sets.iter().enumerate() {
            self.step(0.6 + 0.3 * k as f64 / sets.len() as f64)?;
            pairs.push(self.pair((better, set), singles));
        }
        pairs.iter_mut().for_each(|s| scale.judge(s));
        pairs.retain(|s| shows_its_signs(self.ready, s));
        pairs.sort_by(|a, b| b.evidence.total_cmp(&a.evidence));
        Ok(pairs)
    }
}

/// The best variant of every name whose necessary signs show, best first.
fn best_of_each(ready: &Prepared, mut all: Vec<Scored>) -> Vec<Scored> {
    all.retain(|s| shows_its_signs(ready, s));
    all.sort_by(|a, b| b.evidence.total_cmp(&a.evidence));
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
        .filter(|s| s.evidence > 1.0)
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
fn shows_its_signs(ready: &Prepared, scored: &Scored) -> bool {
    let clings = scored
        .mechanisms
        .iter()
        .any(|m| m.effect == Effect::Adhesion);
    !clings || pulls(&ready.courses, (&scored.refit.simulated, &ready.sigma))
}

/// Standard errors from which a step of the gain is looked into.
const STEP: f64 = 3.0;

/// Logarithm of each recording's gain: what the fit with its prior gave, and what it left.
fn log_gains(ready: &Prepared, base: &Scored) -> Vec<f64> {
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

fn gains(ready: &Prepared, base: &Scored) -> Vec<f64> {
    let of = |course: usize| {
        let place = ready
            .shared
            .iter()
            .position(|c| c.kind == Kind::Gain(course));
        place.map_or(0.0, |k| base.refit.at[k])
    };
    (0..ready.courses.len()).map(of).collect()
}

/// Sum over blocks of the squared sum of residuals over their number, less what residuals that know nothing of each other give.
fn coherent(screen: &Screen<'_>, residual: &[f64], blocks: &[usize]) -> f64 {
    let count = blocks.iter().fold(0, |most, b| most.max(b + 1));
    let mut sums = vec![(0.0, 0.0f64, 0.0); count];
    for (sample, _, _) in screen.phases() {
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
    let between: f64 = used.iter().map(|(sum, n, _)| sum * sum / n).sum();
    (between - variance * used.len() as f64).max(0.0)
}
