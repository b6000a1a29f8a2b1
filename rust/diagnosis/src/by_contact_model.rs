//! The last word on a finding: held-out recordings predicted by the contact model with what the finding switches on.

use thenar_contact::effects::Effect;
use thenar_contact::{ActiveEffect, Control};

use crate::effect_numbers::numbers_of_effect;
use crate::findings::{Diagnosis, Switched};
use crate::gates::size_gate::{Sized, unnamed};
use crate::wording::effect_in_words;
use thenar_inference::errors::InferenceError;
use thenar_inference::fit::fitting::Fitting;
use thenar_inference::forward::surrogate::mechanism::Law;
use thenar_inference::forward::surrogate::prepared_study::PreparedStudy;
use thenar_inference::parameters::surrogate_priors::is_form_known;
use thenar_inference::selection::contact_model_check::ByContactModel;
use thenar_inference::selection::cross_validation::{ContactModelCheck, Gain, Judged};
use thenar_inference::selection::scored::{Rungs, Scored};

/// Share of what the fit removes of held-out error that the contact model must remove as well; below, it is said.
const LEAST: f64 = 0.7;

/// Standard deviations of the noise by which its error must be larger too: where a finding is small against the noise, shares mean little.
const CLEARLY: f64 = 0.1;

/// What findings are judged by.
pub struct Judging<'a> {
    pub ready: &'a PreparedStudy,
    pub rungs: &'a Rungs,
    /// Of what is drawn.
    pub seed: u64,
}

/// Adds the check to the gain of what is named, which stays named unless the contact model refutes it. What the contact model cannot do is a note.
///
/// # Errors
/// `Cancelled` alone.
pub fn check<'a>(
    sized: &mut Sized<'a>,
    fitting: &mut Fitting,
    judging: &Judging<'a>,
    control: &Control<'_>,
) -> Result<Option<String>, InferenceError> {
    let (Some(named), Some(gain)) = (sized.decision.named, &mut sized.gain) else {
        return Ok(None);
    };
    let measured = fitting.measured().to_vec();
    let switched = |scored: &Scored| effects_of(judging.ready, scored);
    let quiet = Control {
        cancelled: control.cancelled,
        progress: &|_, _| {},
    };
    let mut asked = ByContactModel {
        judged: Judged {
            ready: judging.ready,
            measured: &measured,
            found: named,
            overdispersion: judging.rungs.overdispersion,
            seed: judging.seed,
        },
        replay: &mut fitting.replay,
        switched: &switched,
        control: &quiet,
        progress: &|share| (control.progress)("asking the contact model", share),
    };
    match asked.check(gain.held_out_by) {
        Ok(found) => {
            gain.contact_model = found;
            if let Some(check) = refuting(judging.ready, named, gain) {
                let reason = format!(
                    "suspected is {}, which explains more than noise would, but with it the contact model predicts held-out recordings worse than \
                     without: its error is {:.2} instead of {:.2} standard deviations of the noise",
                    effect_in_words(named.names()[0]),
                    check.after.rms,
                    check.before.rms
                );
                let nothing = unnamed(judging.ready, judging.rungs, &measured, &reason);
                *sized = Sized {
                    decision: nothing.suspecting(&named.names()),
                    gain: None,
                    profiled: Vec::new(),
                };
            }
            Ok(None)
        }
        Err(InferenceError::Cancelled) => Err(InferenceError::Cancelled),
        Err(error) => Ok(Some(format!(
            "the contact model could not follow the held-out recordings with what is named: {error}"
        ))),
    }
}

/// The check that speaks against a name: on skin whose form is known from measurements alone, the contact model predicts held-out recordings clearly
/// worse with it than without, be it with the numbers that were sought in it or, where none were found, with the fit's. Effects whose laws
/// differ between fit and contact model, and two effects together, are not judged by it.
fn refuting<'a>(
    ready: &PreparedStudy,
    named: &Scored,
    gain: &'a Gain,
) -> Option<&'a ContactModelCheck> {
    let is_judged = |effect| matches!(effect, Effect::Bone | Effect::Compressibility);
    if is_form_known(&ready.elastic)
        || !matches!(&named.mechanisms[..], [one] if is_judged(one.effect))
    {
        return None;
    }
    let check = gain.contact_model.as_ref()?;
    (check.after.rms > check.before.rms + CLEARLY).then_some(check)
}

/// Whether with what is named the contact model predicts held-out recordings worse than without: all of the interval of what it removes is below 0,
/// and its error is larger by at least a tenth of the noise.
pub fn is_worse_than_without(check: &ContactModelCheck) -> bool {
    check.interval.1 < 0.0 && check.after.rms > check.before.rms + CLEARLY
}

/// Gives what is switched on the numbers with which the contact model was checked, and says what that came to.
pub fn switch_on(found: &mut Diagnosis) {
    let Some((gain, check)) = found
        .gain
        .as_ref()
        .and_then(|g| Some((g, g.contact_model.as_ref()?)))
    else {
        return;
    };
    for (_, g0, g_lim) in &mut found.materials {
        *g0 *= check.moduli[0];
        *g_lim *= check.moduli[1];
    }
    let mut changed = Vec::new();
    for (switched, active) in found.effects.iter_mut().zip(&check.effects) {
        let of_fit = switched.clone();
        switched.amplitude = active.amplitude;
        for (name, value) in &mut switched.numbers {
            *value = active.number(name);
        }
        if differs(&of_fit, switched) {
            changed.push(effect_in_words(switched.name));
        }
    }
    let is_moved = check
        .moduli
        .iter()
        .any(|factor| (factor - 1.0).abs() > 0.05);
    let is_worse = is_worse_than_without(check);
    if !is_worse && (is_moved || !changed.is_empty()) {
        let what = match changed.is_empty() {
            true => "the tissue".to_owned(),
            false => changed.join(" and "),
        };
        found.notes.push(format!(
            "{what}: the contact model has a law of its own; what is switched on in it, and the moduli that belong to it, are the numbers \
             with which it answers as the fit does"
        ));
    }
    if is_worse {
        found.notes.push(format!(
            "with what is named the contact model predicts held-out recordings worse than without: its error is {:.2} instead of {:.2} standard \
             deviations of the noise; what was found holds, but simulations with it are wrong for these tools",
            check.after.rms, check.before.rms
        ));
    } else if is_behind(gain) {
        found.notes.push(match check.removed > 0.0 {
            true => format!(
                "the contact model with what is named removes {:.0} % of the error of held-out recordings beyond noise, the fit {:.0} %: \
                 simulations show less than was found",
                100.0 * check.removed,
                100.0 * check.by_fit.0
            ),
            false => "the contact model with what is named predicts held-out recordings no better than without: simulations do not show \
                      what was found"
                .to_owned(),
        });
    }
}

/// Whether the contact model predicts held-out recordings clearly worse than the fit: it removes less of the error, by more than noise decides.
pub fn is_behind(gain: &Gain) -> bool {
    gain.contact_model.as_ref().is_some_and(|check| {
        let (removed, rms) = check.by_fit;
        check.removed < LEAST * removed && check.after.rms > rms + CLEARLY
    })
}

/// Whether a number differs by more than a twentieth.
fn differs(a: &Switched, b: &Switched) -> bool {
    let is_other = |a: f64, b: f64| (a - b).abs() > 0.05 * a.abs();
    let mut both = a.numbers.iter().zip(&b.numbers);
    is_other(a.amplitude, b.amplitude) || both.any(|(a, b)| is_other(a.1, b.1))
}

/// What a finding switches on; None for a step of the gain, which is no effect of one recording.
fn effects_of(ready: &PreparedStudy, scored: &Scored) -> Option<Vec<ActiveEffect>> {
    let mut all = Vec::new();
    for (number, mechanism) in scored.mechanisms.iter().enumerate() {
        if matches!(mechanism.law, Law::GainStep { .. }) {
            return None;
        }
        let (_, switched) = numbers_of_effect(ready, (scored, &[]), number);
        all.push(active(&switched)?);
    }
    Some(all)
}

/// An effect as the contact model takes it; None if its catalogue has no such number or choice.
fn active(switched: &Switched) -> Option<ActiveEffect> {
    let mut effect = ActiveEffect::named(switched.name, switched.amplitude).ok()?;
    for (name, value) in &switched.numbers {
        effect = effect.with(name, *value).ok()?;
    }
    for (name, option) in &switched.choices {
        effect = effect.choose(name, option).ok()?;
    }
    Some(effect)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect_numbers::{choices, drift_rate};
    use thenar_contact::effects::Effect;
    use thenar_contact::instrument::{Signals, observe};
    use thenar_inference::forward::surrogate::mechanism::{Clock, Law, Mechanism};
    use thenar_inference::forward::surrogate::relaxation_spectrum::Spectrum;
    use thenar_inference::selection::cross_validation::Spread;

    #[test]
    fn switched_numbers_and_choices_reach_the_contact_model() {
        let switched = Switched {
            name: "stiffening_law",
            amplitude: 1.0,
            numbers: vec![("reference_depth_mm", 2.5)],
            choices: vec![("law", "power"), ("measure", "depth")],
        };
        let effect = active(&switched).unwrap();
        assert_eq!(effect.number("reference_depth_mm"), 2.5);
        let choices = effect.entry().choices.iter().zip(&effect.chosen);
        let chosen: Vec<&str> = choices.map(|(choice, k)| choice.options[*k]).collect();
        assert!(chosen.contains(&"power") && chosen.contains(&"depth"));
        let unknown = Switched {
            numbers: vec![("nothing", 1.0)],
            ..switched
        };
        assert!(active(&unknown).is_none());
    }

    /// An effect smaller than the noise is not refused for a hundredth, and none where noise decides what is removed.
    #[test]
    fn worse_than_without_is_more_than_noise_decides() {
        let of = |after: f64, interval: (f64, f64)| {
            let spread = |rms| Spread {
                rms,
                interval: (rms, rms),
            };
            is_worse_than_without(&ContactModelCheck {
                by_fit: (0.5, 1.0),
                before: spread(1.07),
                after: spread(after),
                removed: 0.5 * (interval.0 + interval.1),
                interval,
                moduli: [1.0; 2],
                effects: Vec::new(),
            })
        };
        assert!(of(2.87, (-136.0, -4.4)));
        assert!(!of(1.08, (-13.0, -0.1)) && !of(1.3, (-3.0, 0.5)) && !of(1.04, (0.1, 0.5)));
    }

    /// What the surrogate's skin does, which clings where it has touched, is what the contact model does.
    #[test]
    fn adhesion_is_switched_on_with_bonds_that_touch_made() {
        let found = choices(&Mechanism {
            effect: Effect::Adhesion,
            law: Law::Adhesion { lets_go: -0.2 },
        });
        let mut effect = ActiveEffect::named("adhesion", 1.0).unwrap();
        for (name, option) in found {
            effect = effect.choose(name, option).unwrap();
        }
        let bonds = effect.entry().choices[0];
        assert_eq!(
            (bonds.name, bonds.options[effect.chosen[0]]),
            ("bonds", "touched")
        );
    }

    /// And its layer drains as the contact model's does; what relaxes has no such choice.
    #[test]
    fn drainage_is_switched_on_as_that_of_a_layer() {
        let of = |effect: Effect| {
            choices(&Mechanism {
                effect,
                law: Law::Relaxation {
                    clock: Clock::Area { reference_mm: 3.0 },
                    spectrum: Spectrum::Smooth { widths: (0.1, 1.0) },
                },
            })
        };
        assert_eq!(of(Effect::Drainage), [("curve", "layer")]);
        assert_eq!(of(Effect::Relaxation), []);
        let effect = ActiveEffect::named("drainage", 1.0).unwrap();
        assert!(effect.choose("curve", "layer").is_ok());
    }

    /// The fit's drift is `x ln(1 + t / tau)` newtons; what is switched on reads as much, at every time.
    #[test]
    fn drift_is_switched_on_as_the_fit_has_it() {
        let (x, time_s) = (0.03, 6.0);
        let rate = drift_rate(x, time_s);
        let mechanism = Mechanism {
            effect: Effect::Drift,
            law: Law::Drift { time_s },
        };
        let mut effect = ActiveEffect::named("drift", 1.0).unwrap();
        for (name, value) in [("rate_n_per_min", rate), ("time_s", time_s)] {
            effect = effect.with(name, value).unwrap();
        }
        for (name, option) in choices(&mechanism) {
            effect = effect.choose(name, option).unwrap();
        }
        let times: Vec<f64> = (0..40).map(|k| 0.7 * f64::from(k)).collect();
        let signals = Signals {
            force_n: vec![2.0; times.len()],
            time_s: times.clone(),
            ..Signals::default()
        };
        let shown = observe(&signals, None, &[effect]).unwrap().force_n;
        for (force, time) in shown.iter().zip(&times) {
            let wanted = 2.0 + x * libm::log1p((time - times[0]) / time_s);
            assert!((force - wanted).abs() < 1e-12, "{time}: {force} {wanted}");
        }
    }
}
