//! Gate of size: an effect whose size the recordings leave open, so that it may as well be absent, is no finding.
//!
//! The rule is practical identifiability by the profile likelihood (`thenar_inference::selection::profile_interval`). What is there, and of
//! which the size is bounded from one side alone, is named with that bound; what would bound it is advised.

use crate::findings::{Finding, Number, Verdict};
use crate::gates::decision::{self, Decision, UNLISTED, needed, silent, unsettled_misfit};
use crate::gates::form_gate;
use crate::gates::held_out_gate::predicted_by_protocols;
use crate::gates::waves_gate::shared_waves;
use crate::wording::effect_in_words;
use thenar_contact::effects::Effect;
use thenar_inference::forward::surrogate::prepared_study::PreparedStudy;
use thenar_inference::observe::measured::Measured;
use thenar_inference::selection::cross_validation::Gain;
use thenar_inference::selection::form_check::FormCheck;
use thenar_inference::selection::profile_interval::{Profiled, profiled};
use thenar_inference::selection::scored::{Rungs, Scored};

/// What is named, what it gains on held-out recordings, and what is known of its numbers.
pub struct Sized<'a> {
    /// The decision.
    pub decision: Decision<'a>,
    /// The gain of what is named.
    pub gain: Option<Gain>,
    /// By mechanism of what is named.
    pub profiled: Vec<Profiled>,
}

/// What the gates before this one decide, without the effects of which nothing is determined.
pub fn decide<'a>(
    ready: &PreparedStudy,
    rungs: &'a Rungs,
    measured: &[Measured],
    seed: u64,
) -> Sized<'a> {
    let (decision, gain) = form_gate::decide(ready, rungs, measured, seed);
    let of = |scored: &Scored| profiled(ready, rungs, measured, scored);
    let known = decision.named.map(of).unwrap_or_default();
    let kept = decision
        .named
        .map(|named| determined(named, &known))
        .unwrap_or_default();
    let Some(named) = decision
        .named
        .filter(|named| kept.len() < named.mechanisms.len())
    else {
        return Sized {
            decision,
            gain,
            profiled: known,
        };
    };
    let narrowed = Narrowed {
        named,
        reason: open(named, &kept),
        suspected: Vec::new(),
        kept,
    };
    narrowed.decide((ready, rungs), measured, seed)
}

/// An explanation of which not all effects are named.
pub(crate) struct Narrowed<'a> {
    /// All.
    pub(crate) named: &'a Scored,
    /// Those that may be named.
    pub(crate) kept: Vec<Effect>,
    /// Why others are not.
    pub(crate) reason: String,
    /// What is suspected already.
    pub(crate) suspected: Vec<&'static str>,
}

impl<'a> Narrowed<'a> {
    /// The first of those that are kept is named, if it stands for itself and predicts, and else nothing; the others are suspected.
    pub(crate) fn decide(
        &self,
        (ready, rungs): (&PreparedStudy, &'a Rungs),
        measured: &[Measured],
        seed: u64,
    ) -> Sized<'a> {
        let others = [left(self.named, &self.kept), self.suspected.clone()].concat();
        let single = self.kept.first().and_then(|effect| {
            let is_it = |s: &&Scored| s.mechanisms[0].effect == *effect;
            let single = rungs.singles.iter().find(is_it);
            single.filter(|single| single.qaic_gain >= needed(&single.mechanisms[0]))
        });
        let found = single.and_then(|single| {
            let found = predicted_by_protocols((ready, rungs), measured, (single, seed));
            let (gain, predicts) = found?;
            let known = profiled(ready, rungs, measured, single);
            let is_kept = predicts && determined(single, &known).len() == 1;
            is_kept.then_some((single, gain, known))
        });
        match found {
            Some((single, gain, profiled)) => Sized {
                decision: decision::named(single, &self.reason).suspecting(&others),
                gain: Some(gain),
                profiled,
            },
            None => Sized {
                decision: unnamed(ready, rungs, measured, &self.reason).suspecting(&others),
                gain: None,
                profiled: Vec::new(),
            },
        }
    }
}

/// Nothing is named: what is left over may still be more than any listed effect takes up.
pub(crate) fn unnamed<'a>(
    ready: &PreparedStudy,
    rungs: &'a Rungs,
    measured: &[Measured],
    reason: &str,
) -> Decision<'a> {
    let without_form = || rungs.base.lack_of_fit.less_largest / rungs.samples.max(1) as f64;
    let left = FormCheck::new(ready, measured, rungs).map_or_else(without_form, |it| it.left());
    if let Some(waves) = shared_waves(rungs) {
        return silent(Verdict::Unlisted, &format!("{waves}; {reason}"));
    }
    match left > UNLISTED {
        true => silent(
            Verdict::Unlisted,
            &format!("repeats agree on a misfit that no listed effect takes up; {reason}"),
        ),
        false => unsettled_misfit(decision::nothing(ready, rungs), reason),
    }
}

/// Effects of an explanation whose size excludes that they are absent.
fn determined(named: &Scored, known: &[Profiled]) -> Vec<Effect> {
    let both = named.mechanisms.iter().zip(known);
    let there = both.filter(|(mechanism, of)| of.excludes_absence(mechanism));
    there.map(|(mechanism, _)| mechanism.effect).collect()
}

/// Names of an explanation that are not kept.
fn left(named: &Scored, kept: &[Effect]) -> Vec<&'static str> {
    let effects = named.mechanisms.iter().map(|m| m.effect);
    let left = effects.filter(|effect| !kept.contains(effect));
    left.map(Effect::name).collect()
}

fn open(named: &Scored, kept: &[Effect]) -> String {
    let left = left(named, kept);
    let names: Vec<String> = left.iter().map(|name| effect_in_words(name)).collect();
    let advice: Vec<&str> = left.iter().map(|name| bounding(name)).collect();
    format!(
        "suspected is {}, of which these recordings determine no size, so that it may be absent; to determine it, {}",
        names.join(" and "),
        advice.join(", and ")
    )
}

/// What is said of a finding's numbers that recordings do not bound on both sides, and what would bound them; None where all are bounded.
pub fn open_note(finding: &Finding) -> Option<String> {
    // The spread of a layer's times ends at the half space's, whatever is recorded.
    let is_open = |n: &&Number| !n.is_bounded() && n.name != "spread";
    let open: Vec<String> = finding
        .numbers
        .iter()
        .filter(is_open)
        .map(|n| {
            let (_, between, unit) = n.in_words();
            format!(
                "its {} is {between} {unit}",
                number_in_words(n.name, n.unit)
            )
            .trim_end()
            .to_owned()
        })
        .collect();
    if open.is_empty() {
        return None;
    }
    Some(format!(
        "{}: its presence is determined, its size not fully: {} (90 %); to determine it, {}",
        effect_in_words(finding.effect),
        open.join(", "),
        bounding(finding.effect)
    ))
}

/// A number's name without its unit.
fn number_in_words(name: &str, unit: &str) -> String {
    match name {
        "time_1_s" => "shortest time constant".to_owned(),
        "time_2_s" => "middle time constant".to_owned(),
        "time_3_s" => "longest time constant".to_owned(),
        _ => {
            let ending = format!("_{}", unit.to_lowercase().replace('/', "_per_"));
            name.strip_suffix(&ending).unwrap_or(name).replace('_', " ")
        }
    }
}

/// The recording that bounds an effect's numbers.
fn bounding(effect: &str) -> &'static str {
    match effect {
        "stiff_skin" => {
            "press a ball or a flat punch of 1 to 3 mm radius at the same site: a small tool shows the skin, a large one the pulp under it"
        }
        "relaxation" | "drainage" => {
            "press as fast as the machine can, read in finer steps of time, and hold for ten times as long"
        }
        "rate_independent_loss" => "press to three depths and let go from each, several times",
        "cycle_softening" => "press ten times in a row to one depth, and again to half of it",
        "adhesion" => "let go slowly, with finer steps as the tool leaves the skin",
        "bone" | "stiffening_law" | "compressibility" => {
            "press deeper, with a second tool of another size at the same site"
        }
        "saturation" => "press harder, so that more readings lie at the ceiling",
        "threshold" => {
            "press more slowly about first touch, so that more readings lie near the floor"
        }
        _ => "repeat each protocol more often",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::synthetic_rungs::scored;
    use thenar_contact::effects::Effect::{Offset, StiffSkin};
    use thenar_inference::selection::profile_interval::Interval;

    fn of(ends: (f64, f64), is_open: (bool, bool)) -> Profiled {
        let value = 0.5 * (ends.0 + ends.1);
        Profiled {
            numbers: vec![Interval {
                value,
                ends,
                is_open,
            }],
            variants: Vec::new(),
            outer: Vec::new(),
        }
    }

    /// Open toward more is a bound; what may be none, in either sign, determines nothing.
    #[test]
    fn an_effect_that_may_be_absent_is_not_determined() {
        let kept = |effect, profile: Profiled| determined(&scored(&[effect], 9.0), &[profile]);
        assert_eq!(kept(StiffSkin, of((0.4, 5.0), (false, true))), [StiffSkin]);
        assert!(kept(StiffSkin, of((0.0, 3.0), (true, false))).is_empty());
        assert!(kept(StiffSkin, of((0.0, 5.0), (true, true))).is_empty());
        assert_eq!(kept(Offset, of((-0.4, -0.1), (false, false))), [Offset]);
        assert!(kept(Offset, of((-0.4, 0.1), (false, false))).is_empty());
    }
}
