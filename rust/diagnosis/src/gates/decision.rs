//! Gates of the verdict: detection, adequacy, lead over rivals, and what the recordings could test at all.

use thenar_contact::effects::Effect;

use crate::findings::Verdict;
use crate::gates::curve_gate::free_curve;
use crate::gates::pair_gates::{CLOCKS, are_apart, is_adequate, is_pair, is_static};
use crate::gates::waves_gate::shared_waves;
use crate::wording::effect_in_words;
use thenar_inference::checks::heteroscedasticity::unmodeled_repeat_noise;
use thenar_inference::forward::surrogate::mechanism::Mechanism;
use thenar_inference::forward::surrogate::prepared_study::PreparedStudy;
use thenar_inference::forward::tables::elastic_table::radius;
use thenar_inference::selection::scored::{Rungs, Scored};

/// Evidence, nats, from which something is said to be missing, and from which the instrument is said to be at fault: an offset reaches 4.3
/// where nothing is, what the tissue remembers 2.4 (`cargo xtask prove -- --split calibration`).
const DETECTED: (f64, f64) = (5.0, 6.0);
/// The same of what changes the elastic answer of the skin alone, which reaches 2.4 where nothing is missing and 4.7 on the larger draw
/// (`--split larger`: gains that scatter alike in both repeats are as a size effect), and of a fixture that yields: the model's own form
/// may be off by as much, and looks like the latter.
const DETECTED_STATIC: (f64, f64) = (5.0, 6.0);
/// The same of a step in the gain, which reaches 3.6 there, and of adhesion, which has more variants than others.
const DETECTED_ELSE: (f64, f64) = (5.5, 7.5);
/// Lead in evidence, nats, over every rival that bears another name; and over one that belongs to the instrument where the other
/// belongs to the skin. The largest lead of a wrong name is 1.7, of a wrong clock 1.3 (printed likewise).
const LEAD: (f64, f64) = (3.0, 4.4);
/// Coherent misfit per sample that no name explains, without its largest part, from which something unlisted is there: where nothing is missing
/// it reaches 0.06 (calibration) and 0.11 (closed forms), under a blister at least 0.18.
pub(crate) const UNLISTED: f64 = 0.13;
/// Evidence of a listed effect from which unsteady skin does not keep it from being named.
const BEYOND_HETEROSCEDASTIC: f64 = 60.0;

/// Ratio of contact radii from which two sizes are two: a clock that grows as the area is then twice as slow.
const SIZES: f64 = 1.4;

/// Evidence from which an effect is suspected where the noise is only judged by roughness, and the part of the largest that others need
/// to be suspected with it.
const SUSPECTED: (f64, f64) = (12.0, 0.9);

/// What may be said.
#[derive(Debug, Clone)]
pub struct Decision<'a> {
    /// The verdict.
    pub verdict: Verdict,
    /// What is named; None: nothing.
    pub named: Option<&'a Scored>,
    /// Pairs of names within reach of one another.
    pub cannot_tell: Vec<[&'static str; 2]>,
    /// What every explanation holds that is within reach, if they are of two effects each.
    pub beside: Vec<&'static str>,
    /// Whether recordings differ by more than their noise although nothing is named.
    pub is_more_than_noise: bool,
    /// Effects that are suspected and not named: they explain more than noise would, and a gate refused them; where the noise is not known,
    /// what one would look at first.
    pub suspected: Vec<&'static str>,
    /// Why, for the notes.
    pub reason: String,
}

/// Decides from what the rungs found: the gates in their order, the first that is shut speaks.
pub fn decide<'a>(ready: &PreparedStudy, rungs: &'a Rungs) -> Decision<'a> {
    if ready.noise.degrees.is_none() {
        let suspected = suspected(rungs);
        let reason = format!(
            "no protocol was repeated, so that noise and a missing effect look alike; {}",
            suspicion(&suspected)
        );
        return Decision {
            suspected,
            ..silent(Verdict::InsufficientData, &reason)
        };
    }
    let best = rungs.singles.first();
    let is_clear = best.is_some_and(|b| b.qaic_gain > BEYOND_HETEROSCEDASTIC);
    if let Some(reason) =
        unmodeled_repeat_noise(&ready.noise, rungs.heteroscedasticity).filter(|_| !is_clear)
    {
        return silent(Verdict::Unlisted, &reason);
    }
    if let Some((reason, nearest)) = free_curve(rungs) {
        return silent(Verdict::Unlisted, &reason).suspecting(&nearest);
    }
    match best.filter(|b| b.qaic_gain >= needed(&b.mechanisms[0])) {
        None => undetected(ready, rungs),
        Some(best) => paired(rungs).unwrap_or_else(|| alone(ready, rungs, best)),
    }
}

pub(crate) fn silent<'a>(verdict: Verdict, reason: &str) -> Decision<'a> {
    Decision {
        verdict,
        named: None,
        cannot_tell: Vec::new(),
        beside: Vec::new(),
        is_more_than_noise: verdict == Verdict::Unlisted,
        suspected: Vec::new(),
        reason: reason.to_owned(),
    }
}

/// Nothing is named, though the recordings differ by more than their noise: it is suspected only, or may be of the form.
pub(crate) fn unsettled_misfit<'a>(verdict: Verdict, reason: &str) -> Decision<'a> {
    Decision {
        is_more_than_noise: true,
        ..silent(verdict, reason)
    }
}

impl Decision<'_> {
    /// The same with effects that are suspected only.
    pub(crate) fn suspecting(self, suspected: &[&'static str]) -> Self {
        let mut all: Vec<&'static str> = Vec::new();
        for name in suspected {
            if !all.contains(name) {
                all.push(name);
            }
        }
        Decision {
            suspected: all,
            ..self
        }
    }
}

impl Decision<'_> {
    /// These names, and what is suspected already.
    pub(crate) fn with_suspected(&self, names: &[&'static str]) -> Vec<&'static str> {
        [names, &self.suspected].concat()
    }

    /// A reason, and the one that there is where something is suspected already.
    pub(crate) fn with_reason(&self, reason: String) -> String {
        match self.suspected.is_empty() {
            true => reason,
            false => format!("{reason}; {}", self.reason),
        }
    }
}

/// What one would look at first, where the noise is not known.
fn suspected(rungs: &Rungs) -> Vec<&'static str> {
    let most = rungs.singles.first().map_or(0.0, |s| s.qaic_gain);
    let near = rungs
        .singles
        .iter()
        .filter(|s| most >= SUSPECTED.0 && s.qaic_gain > SUSPECTED.1 * most);
    near.map(|s| s.mechanisms[0].effect.name()).collect()
}

/// That in words.
fn suspicion(suspected: &[&'static str]) -> String {
    let mut names: Vec<String> = suspected.iter().map(|name| effect_in_words(name)).collect();
    // No order is known of what is not told apart.
    names.sort();
    match &names[..] {
        [] => "beyond the parameters nothing is suspected".to_owned(),
        [one] => format!("{one} is suspected"),
        _ => format!("suspected, and not distinguished, are {}", names.join(", ")),
    }
}

/// Nothing listed is there: nothing at all, or something unlisted.
pub fn undetected<'a>(ready: &PreparedStudy, rungs: &'a Rungs) -> Decision<'a> {
    let left = rungs.base.lack_of_fit.less_largest / rungs.samples as f64;
    if left > UNLISTED {
        return silent(
            Verdict::Unlisted,
            "repeats agree on a misfit that parameters leave and no listed effect takes up",
        );
    }
    if let Some(reason) = shared_waves(rungs) {
        return silent(Verdict::Unlisted, &reason);
    }
    silent(
        nothing(ready, rungs),
        "no listed effect explains more than noise would",
    )
}

/// Two effects; None where one suffices.
fn paired(rungs: &Rungs) -> Option<Decision<'_>> {
    let pair = rungs.pairs.iter().find(|pair| is_pair(pair, rungs))?;
    let names = pair.names();
    let within_reach = |r: &&Scored| within(pair, r) && is_pair(r, rungs);
    let alike: Vec<Vec<&'static str>> = rungs
        .pairs
        .iter()
        .filter(within_reach)
        .map(Scored::names)
        .collect();
    let rivals: Vec<[&'static str; 2]> = alike
        .iter()
        .flat_map(|rival| differing(&names, rival))
        .map(|(a, b)| [a, b])
        .collect();
    if rivals.is_empty() {
        return Some(named(pair, "two effects together, each of which is needed"));
    }
    let is_in_all = |name: &&'static str| alike.iter().all(|rival| rival.contains(name));
    Some(Decision {
        beside: names.iter().copied().filter(is_in_all).collect(),
        ..unsettled(
            rivals,
            "several pairs of effects explain the recordings alike",
        )
    })
}

/// One effect that was detected: named, or one of several, or not enough.
fn alone<'a>(ready: &PreparedStudy, rungs: &'a Rungs, best: &'a Scored) -> Decision<'a> {
    if !is_adequate(best, rungs) {
        return silent(
            Verdict::Unlisted,
            "the best listed effect leaves too much of what repeats agree on",
        );
    }
    let rivals: Vec<&'static str> = rungs.singles[1..]
        .iter()
        .filter(|r| (within(best, r) || is_alias(ready, best, r)) && is_adequate_beside(r, best))
        .map(|r| r.mechanisms[0].effect.name())
        .collect();
    if rivals.is_empty() {
        return named(
            best,
            "one effect explains what parameters cannot, and no other does",
        );
    }
    let first = best.mechanisms[0].effect.name();
    let mut pairs: Vec<[&'static str; 2]> = rivals.iter().map(|r| [first, *r]).collect();
    // Where the instrument explains best, effects of the skin are not held against each other: it may be none of them.
    if !best.mechanisms[0].is_instrument() {
        for (i, a) in rivals.iter().enumerate() {
            pairs.extend(rivals[i + 1..].iter().map(|b| [*a, *b]));
        }
    }
    unsettled(pairs, "several effects explain the recordings alike")
}

/// Nothing is missing, with the study's own parameters or with others.
pub(crate) fn nothing(ready: &PreparedStudy, rungs: &Rungs) -> Verdict {
    let at = &rungs.base.refit.at;
    let moved = (0..2).any(|k| {
        let start = ready.shared[k].start;
        let error = rungs.base.refit.covariance[(k, k)].max(0.0).sqrt();
        (at[k] - start).abs() > 3.0 * error.max(0.02)
    });
    if moved {
        Verdict::Parameters
    } else {
        Verdict::NothingMissing
    }
}

/// True if a rival's evidence is within reach.
fn within(best: &Scored, rival: &Scored) -> bool {
    lead(best, rival).is_some_and(|lead| best.qaic_gain - rival.qaic_gain < lead)
}

/// Lead in evidence from which one explanation stands before a rival; None if they are the same.
pub fn lead(best: &Scored, rival: &Scored) -> Option<f64> {
    let of = |s: &Scored| {
        let own = |m: &&Mechanism| !best.mechanisms.contains(m) || !rival.mechanisms.contains(m);
        s.mechanisms.iter().find(own).map(Mechanism::is_instrument)
    };
    let (a, b) = (of(best)?, of(rival)?);
    let is_alone = best.mechanisms.len() == 1;
    Some(match is_alone && a != b {
        true => LEAD.1,
        false => LEAD.0,
    })
}

/// The best explanations that hold one name of a pair without the other: two effects each where two were needed, else one.
pub fn opponents<'a>(rungs: &'a Rungs, pair: [&str; 2]) -> Option<[&'a Scored; 2]> {
    let needs_two = rungs.pairs.iter().any(|p| is_pair(p, rungs));
    let all = match needs_two {
        true => &rungs.pairs,
        false => &rungs.singles,
    };
    let best = |with: &str, without: &str| {
        all.iter().find(|s| {
            let names = s.names();
            names.contains(&with) && !names.contains(&without)
        })
    };
    Some([best(pair[0], pair[1])?, best(pair[1], pair[0])?])
}

/// True if only a second contact size could tell two names apart, and there is none: a clock that is fixed, and one that grows as
/// the contact's area. Within one size they differ little, unless what was recorded says otherwise (`are_apart`).
fn is_alias(ready: &PreparedStudy, best: &Scored, rival: &Scored) -> bool {
    let radii = ready
        .elastic
        .places
        .iter()
        .map(|p| radius(p, ready.scales.deepest));
    are_clocks([best, rival]) && !have_sizes(radii) && !are_apart(best, rival)
}

/// True of the two clocks that differ by the contact's size.
pub fn are_clocks(two: [&Scored; 2]) -> bool {
    let both = two.map(|s| s.mechanisms[0].effect);
    CLOCKS.iter().all(|c| both.contains(c))
}

/// True if contact radii differ enough to tell such clocks apart.
pub fn have_sizes(radii: impl Iterator<Item = f64>) -> bool {
    let (low, high) = radii.fold((f64::INFINITY, 0.0), |(l, h): (f64, f64), a| {
        (l.min(a), h.max(a))
    });
    high >= SIZES * low
}

fn is_adequate_beside(rival: &Scored, best: &Scored) -> bool {
    rival.qaic_gain > 0.5 * best.qaic_gain
}

/// Evidence from which a mechanism is said to be there, nats.
pub fn needed(mechanism: &Mechanism) -> f64 {
    match mechanism.effect {
        Effect::FixtureCompliance => DETECTED_STATIC.1,
        Effect::Gain => DETECTED_ELSE.0,
        Effect::Adhesion => DETECTED_ELSE.1,
        _ if is_static(mechanism) => DETECTED_STATIC.0,
        _ if mechanism.is_instrument() => DETECTED.1,
        _ => DETECTED.0,
    }
}

fn differing(names: &[&'static str], others: &[&'static str]) -> Vec<(&'static str, &'static str)> {
    let only = |a: &[&'static str], b: &[&'static str]| -> Vec<&'static str> {
        a.iter().copied().filter(|n| !b.contains(n)).collect()
    };
    let (ours, theirs) = (only(names, others), only(others, names));
    ours.iter()
        .flat_map(|a| theirs.iter().map(move |b| (*a, *b)))
        .collect()
}

pub fn named<'a>(scored: &'a Scored, reason: &str) -> Decision<'a> {
    let is_tissue = scored.mechanisms.iter().any(|m| !m.is_instrument());
    Decision {
        verdict: if is_tissue {
            Verdict::MissingPhysics
        } else {
            Verdict::Instrument
        },
        named: Some(scored),
        cannot_tell: Vec::new(),
        beside: Vec::new(),
        is_more_than_noise: false,
        suspected: Vec::new(),
        reason: reason.to_owned(),
    }
}

fn unsettled<'a>(mut pairs: Vec<[&'static str; 2]>, reason: &str) -> Decision<'a> {
    let mut seen: Vec<[&'static str; 2]> = Vec::new();
    for pair in &mut pairs {
        pair.sort_by_key(|name| Effect::named(name));
        if !seen.contains(pair) {
            seen.push(*pair);
        }
    }
    Decision {
        verdict: Verdict::CannotTell,
        named: None,
        cannot_tell: seen,
        beside: Vec::new(),
        is_more_than_noise: true,
        suspected: Vec::new(),
        reason: reason.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Both verdicts say that something is missing, and give it no name.
    #[test]
    fn what_is_missing_without_a_name_is_more_than_noise() {
        assert!(silent(Verdict::Unlisted, "").is_more_than_noise);
        assert!(unsettled(vec![["offset", "drift"]], "").is_more_than_noise);
        for verdict in [Verdict::NothingMissing, Verdict::InsufficientData] {
            assert!(!silent(verdict, "").is_more_than_noise);
        }
    }

    #[test]
    fn each_suspicion_is_listed_once() {
        let decision = silent(Verdict::Parameters, "").suspecting(&["bone", "drift", "bone"]);
        assert_eq!(decision.suspected, ["bone", "drift"]);
    }
}
