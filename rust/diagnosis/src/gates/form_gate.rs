//! Gate of form: what is named must explain more than the error of the model's own form can feign.
//!
//! On skin that is not flat, or over a bone of stated width, an explanation and its absence are both fitted again with the form as free as it was
//! measured to be against solids of pads (`priors::MEASURED_FORM`). Every threshold stays as it is.

use crate::findings::Verdict;
use crate::gates::decision::{
    self, Decision, UNLISTED, needed, opponents, silent, unsettled_misfit,
};
use crate::gates::held_out_gate::{self, predicted_by_protocols};
use crate::gates::waves_gate::shared_waves;
use crate::wording::effect_in_words;
use thenar_inference::checks::heteroscedasticity::unmodeled_repeat_noise;
use thenar_inference::forward::surrogate::mechanism::Mechanism;
use thenar_inference::forward::surrogate::prepared_study::PreparedStudy;
use thenar_inference::observe::measured::Measured;
use thenar_inference::selection::cross_validation::Gain;
use thenar_inference::selection::form_check::FormCheck;
use thenar_inference::selection::scored::{Rungs, Scored};

/// What the rungs decide and held-out recordings confirm, less what the model's form may feign; and the gain of what is named.
pub fn decide<'a>(
    ready: &PreparedStudy,
    rungs: &'a Rungs,
    measured: &[Measured],
    seed: u64,
) -> (Decision<'a>, Option<Gain>) {
    let (decision, gain) = held_out_gate::decide(ready, rungs, measured, seed);
    let is_said = !matches!(
        decision.verdict,
        Verdict::NothingMissing | Verdict::Parameters | Verdict::InsufficientData
    );
    let check = is_said.then(|| FormCheck::new(ready, measured, rungs));
    let Some(check) = check.flatten() else {
        return (decision, gain);
    };
    let of = |scored: &Scored| check.evidence(scored);
    let gate = Gate {
        ready,
        left: check.left(),
        beyond: BeyondForm { rungs, of: &of },
    };
    let alone = |single: &'a Scored, feigned: &[&'static str]| {
        let found = predicted_by_protocols((ready, rungs), measured, (single, seed));
        (gate.without(single, feigned), found)
    };
    match (decision.named, decision.verdict) {
        (Some(named), _) => match gate.beyond.of_name(named) {
            Beyond::All => (decision, gain),
            Beyond::One(single, feigned) => {
                let (decision, found) = alone(single, &[feigned]);
                (decision, found.map(|(gain, _)| gain))
            }
            Beyond::None => (gate.nothing(&named.names()), None),
        },
        (None, Verdict::CannotTell) => {
            let names: Vec<&'static str> = decision.cannot_tell.iter().flatten().copied().collect();
            let kept = gate.beyond.rivals(&decision.cannot_tell);
            if !kept.is_empty() {
                let decision = Decision {
                    cannot_tell: kept,
                    ..decision
                };
                return (decision, gain);
            }
            // What every explanation holds is named, if it stands for itself and predicts.
            let common = decision
                .beside
                .first()
                .and_then(|name| gate.beyond.single(name));
            match common.filter(|single| gate.beyond.holds(single)) {
                Some(single) => match alone(single, &names) {
                    (decision, Some((gain, true))) => (decision, Some(gain)),
                    _ => (gate.nothing(&names), None),
                },
                None => (gate.nothing(&names), None),
            }
        }
        _ => (gate.of_misfit(decision), gain),
    }
}

/// What of a name is beyond the error of form.
enum Beyond<'a> {
    All,
    /// One of two; and the one that is not.
    One(&'a Scored, &'static str),
    None,
}

/// What of the explanations is beyond the error of form.
struct BeyondForm<'a, 'b> {
    rungs: &'a Rungs,
    /// Evidence where the form is free.
    of: &'b dyn Fn(&Scored) -> f64,
}

impl<'a> BeyondForm<'a, '_> {
    fn single(&self, name: &str) -> Option<&'a Scored> {
        let is_it = |s: &&Scored| s.mechanisms[0].effect.name() == name;
        self.rungs.singles.iter().find(is_it)
    }

    fn holds(&self, single: &Scored) -> bool {
        (self.of)(single) >= needed(&single.mechanisms[0])
    }

    /// Of two, each must add to the other; else the one that adds more is asked by itself.
    fn of_name(&self, named: &Scored) -> Beyond<'a> {
        let [first, second] = &named.mechanisms[..] else {
            return match self.holds(named) {
                true => Beyond::All,
                false => Beyond::None,
            };
        };
        let both = (self.of)(named);
        let alone = [first, second].map(|m| {
            let single = self.single(m.effect.name());
            single.map(|single| (single, (self.of)(single)))
        });
        let added = |other: usize| both - alone[other].map_or(0.0, |(_, evidence)| evidence);
        let adds = [added(1), added(0)];
        if adds[0] >= needed(first) && adds[1] >= needed(second) {
            return Beyond::All;
        }
        let (kept, left): (usize, &Mechanism) = match adds[0] >= adds[1] {
            true => (0, second),
            false => (1, first),
        };
        match alone[kept] {
            Some((single, evidence)) if evidence >= needed(&single.mechanisms[0]) => {
                Beyond::One(single, left.effect.name())
            }
            _ => Beyond::None,
        }
    }

    /// Of these pairs of rivals, those of which both are beyond the error of form.
    fn rivals(&self, pairs: &[[&'static str; 2]]) -> Vec<[&'static str; 2]> {
        let is_kept = |pair: &&[&'static str; 2]| {
            let Some(both) = opponents(self.rungs, **pair) else {
                return false;
            };
            both.iter()
                .zip(pair.iter())
                .all(|(scored, name)| self.adds(scored, name))
        };
        pairs.iter().filter(is_kept).copied().collect()
    }

    /// Whether an effect of an explanation is beyond the error of form, and adds to the other one.
    fn adds(&self, scored: &Scored, name: &str) -> bool {
        let is_it = |m: &&Mechanism| m.effect.name() == name;
        let other = scored.mechanisms.iter().find(|m| !is_it(m));
        let other = other.and_then(|m| self.single(m.effect.name()));
        let known = other.map_or(0.0, |single| (self.of)(single));
        let least = scored.mechanisms.iter().find(is_it).map_or(0.0, needed);
        (self.of)(scored) - known >= least
    }
}

/// The study, and what its misfit is.
struct Gate<'a, 'b> {
    ready: &'b PreparedStudy,
    /// Coherent misfit per sample that parameters and form leave, in variances of the noise.
    left: f64,
    beyond: BeyondForm<'a, 'b>,
}

impl<'a> Gate<'a, '_> {
    fn without(&self, single: &'a Scored, feigned: &[&'static str]) -> Decision<'a> {
        let reason = format!(
            "{} would explain more, but no more than {}",
            in_words(feigned),
            self.form()
        );
        decision::named(single, &reason).suspecting(feigned)
    }

    fn nothing(&self, feigned: &[&'static str]) -> Decision<'a> {
        let reason = format!(
            "suspected is {}, which explains more than noise would, but no more than {}",
            in_words(feigned),
            self.form()
        );
        if let Some(waves) = shared_waves(self.beyond.rungs) {
            return silent(Verdict::Unlisted, &format!("{waves}; {reason}")).suspecting(feigned);
        }
        if self.left > UNLISTED {
            return silent(
                Verdict::Unlisted,
                &format!("repeats agree on a misfit that no listed effect takes up; {reason}"),
            )
            .suspecting(feigned);
        }
        unsettled_misfit(decision::nothing(self.ready, self.beyond.rungs), &reason)
            .suspecting(feigned)
    }

    /// A misfit without a name may be one of form; what differs between repeats is none, and no form makes short waves.
    fn of_misfit(&self, decision: Decision<'a>) -> Decision<'a> {
        let of_repeats =
            unmodeled_repeat_noise(&self.ready.noise, self.beyond.rungs.heteroscedasticity);
        let is_of_repeats = of_repeats.is_some_and(|reason| reason == decision.reason);
        let is_beyond =
            is_of_repeats || self.left > UNLISTED || shared_waves(self.beyond.rungs).is_some();
        if decision.verdict != Verdict::Unlisted || is_beyond {
            return decision;
        }
        let reason = format!(
            "repeats agree on a misfit that no listed effect explains, but it is no more than {}",
            self.form()
        );
        unsettled_misfit(decision::nothing(self.ready, self.beyond.rungs), &reason)
    }

    fn form(&self) -> &'static str {
        match self.ready.elastic.is_bone_stated {
            true => {
                "the form of the model may be off by on such skin; tools of other sizes and shapes at the same site would settle it"
            }
            false => {
                "the form of the model may be off by on such skin; state how wide the bone is (bone_half_width_mm in [skin.materials]), or press with \
                 tools of other sizes and shapes at the same site, to settle it"
            }
        }
    }
}

fn in_words(names: &[&'static str]) -> String {
    let mut all: Vec<String> = names.iter().map(|name| effect_in_words(name)).collect();
    all.sort();
    all.dedup();
    all.join(" and ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::synthetic_rungs::rungs_beside;
    use thenar_contact::effects::Effect::{self, Bone, Relaxation, StiffSkin};

    /// Evidence beyond form by names, nats.
    fn with<T>(evidence: &[(&[Effect], f64)], ask: impl Fn(BeyondForm<'_, '_>, &Rungs) -> T) -> T {
        let rungs = rungs_beside((Relaxation, 100.0), StiffSkin, 50.0);
        let of = |scored: &Scored| {
            let all: Vec<Effect> = scored.mechanisms.iter().map(|m| m.effect).collect();
            let is_it = |known: &&(&[Effect], f64)| known.0 == all;
            evidence.iter().find(is_it).map_or(0.0, |known| known.1)
        };
        ask(
            BeyondForm {
                rungs: &rungs,
                of: &of,
            },
            &rungs,
        )
    }

    #[test]
    fn one_of_two_that_the_form_can_feign_is_left_out() {
        let of_pair = |evidence: &[(&[Effect], f64)]| {
            with(evidence, |beyond, rungs| {
                match beyond.of_name(&rungs.pairs[0]) {
                    Beyond::All => "both",
                    Beyond::One(single, left) => {
                        assert_ne!(single.mechanisms[0].effect.name(), left);
                        single.mechanisms[0].effect.name()
                    }
                    Beyond::None => "none",
                }
            })
        };
        let both: &[Effect] = &[Relaxation, StiffSkin];
        let of = |relaxation: f64, skin: f64, pair: f64| {
            of_pair(&[
                (&[Relaxation], relaxation),
                (&[StiffSkin], skin),
                (both, pair),
            ])
        };
        assert_eq!(of(90.0, 20.0, 120.0), "both");
        assert_eq!(of(90.0, 20.0, 92.0), "relaxation");
        assert_eq!(of(3.0, 40.0, 42.0), "stiff_skin");
        assert_eq!(of(1.0, 2.0, 4.0), "none");
    }

    #[test]
    fn rivals_are_kept_where_both_are_beyond_the_form() {
        let pair = ["relaxation", "stiff_skin"];
        let kept = |skin: f64| {
            let evidence: [(&[Effect], f64); 2] = [(&[Relaxation], 30.0), (&[StiffSkin], skin)];
            with(&evidence, |beyond, _| {
                let unlike = BeyondForm {
                    rungs: &Rungs {
                        pairs: Vec::new(),
                        ..rungs_beside((Relaxation, 100.0), StiffSkin, 0.0)
                    },
                    of: beyond.of,
                };
                unlike.rivals(&[pair]).len()
            })
        };
        assert_eq!((kept(20.0), kept(2.0)), (1, 0));
    }

    #[test]
    fn names_are_joined_in_one_order() {
        let [bone, skin] = [Bone, StiffSkin].map(Effect::name);
        assert_eq!(in_words(&[skin, bone]), in_words(&[bone, skin, bone]));
    }
}
