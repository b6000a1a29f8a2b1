//! The verdict in one sentence.

use crate::by_contact_model::is_worse_than_without;
use crate::findings::{Finding, Suggestion, Verdict};
use crate::wording::{effect_in_words, phase_in_words};
use thenar_inference::selection::cross_validation::Gain;

/// The verdict in one sentence.
pub fn sentence(
    (verdict, is_more_than_noise): (Verdict, bool),
    (findings, gain): (&[Finding], Option<&Gain>),
    (pairs, beside, next): (&[[&'static str; 2]], &[&'static str], &[Suggestion]),
    reason: &str,
) -> String {
    let names: Vec<String> = findings.iter().map(|f| effect_in_words(f.effect)).collect();
    let names = names.join(" and ");
    let sure = sureness(findings);
    match verdict {
        Verdict::NothingMissing if is_more_than_noise => {
            "No effect is named, though the recordings differ from the simulation by more than their noise: they do not settle why (see the notes)."
                .to_owned()
        }
        Verdict::Parameters if is_more_than_noise => {
            "No effect is named. The stiffness of the tissue was off, and with fitted moduli the recordings still differ from the simulation by \
             more than their noise: they do not settle why (see the notes)."
                .to_owned()
        }
        Verdict::NothingMissing => {
            "Nothing is missing: with the study's own parameters the simulation agrees with the recordings within their noise.".to_owned()
        }
        Verdict::Parameters => {
            "No effect is missing, but the stiffness of the tissue was off: with fitted moduli the simulation agrees with the recordings within \
             their noise."
                .to_owned()
        }
        Verdict::InsufficientData => format!(
            "Too little was recorded to say what is missing: {reason}. Record next: the same presses again, each at least twice, and one with a hold."
        ),
        Verdict::Unlisted => {
            format!("Something is missing that is not in the list of effects: {reason}.")
        }
        Verdict::CannotTell => {
            let told: Vec<String> = pairs
                .iter()
                .map(|[a, b]| format!("{} from {}", effect_in_words(a), effect_in_words(b)))
                .collect();
            let with: Vec<String> = beside.iter().map(|name| effect_in_words(name)).collect();
            let with = match with.is_empty() {
                true => String::new(),
                false => format!(", each of them together with {}", with.join(" and ")),
            };
            format!(
                "Something is missing, but these recordings cannot distinguish {}{with}.{}",
                told.join(", nor "),
                next.first().map_or(String::new(), advised)
            )
        }
        Verdict::Instrument if findings.is_empty() => {
            "The instrument is at fault, not the skin: the deviation in the pressure maps stays at the same sensels of the mat."
                .into()
        }
        Verdict::Instrument => format!("The instrument is at fault, not the skin: {names}.{sure}"),
        Verdict::MissingPhysics => {
            let when = findings.first().and_then(|f| f.when.as_ref());
            let when = when.map_or(String::new(), |w| {
                format!(" It shows most {}.", phase_in_words(w.phase))
            });
            let gained = gain.map_or(String::new(), predicted);
            let of = |kind: &str| {
                let all = findings.iter().filter(|f| f.kind == kind);
                let all: Vec<String> = all.map(|f| effect_in_words(f.effect)).collect();
                all.join(" and ")
            };
            let instrument = match of("instrument") {
                none if none.is_empty() => none,
                some => format!(" The instrument is at fault as well: {some}."),
            };
            format!(
                "The simulation lacks {}.{instrument}{when}{gained}{sure}",
                of("tissue")
            )
        }
    }
}

/// How often findings of the least sure kind are right; one that was not measured is less sure than any other.
fn sureness(findings: &[Finding]) -> String {
    let frequency = |f: &&Finding| f.confidence.frequency().unwrap_or(-1.0);
    let least = findings
        .iter()
        .min_by(|a, b| frequency(a).total_cmp(&frequency(b)));
    match least.map(|f| f.confidence.frequency()) {
        None => String::new(),
        Some(Some(share)) => format!(
            " At least {:.0} % of such findings were right in studies whose truth was known.",
            100.0 * share
        ),
        Some(None) => {
            " How often such a finding is right has not been measured: check it with one more recording."
                .to_owned()
        }
    }
}

/// Share of the reducible error from which it is stated, if all of its interval is above 0: otherwise noise decides how large it is.
const TELLING: f64 = 0.3;

/// How much better held-out recordings are predicted.
fn predicted(gain: &Gain) -> String {
    let is_worse = gain
        .contact_model
        .as_ref()
        .is_some_and(is_worse_than_without);
    if gain.removed < TELLING || gain.interval.0 < 0.0 {
        let mut text = " It is small against the noise, but recordings that were not used for the fit are predicted better with it."
            .to_owned();
        if is_worse {
            text += " Do not simulate with it: the contact model predicts them worse.";
        }
        return text;
    }
    if is_worse {
        return " With it, the fit predicts recordings that were not used for it better, but the contact model predicts them worse: do not simulate with it."
            .to_owned();
    }
    format!(
        " With it, the simulation predicts recordings that were not used for the fit: {:.0} % of its error beyond noise is gone.",
        100.0 * gain.removed
    )
}

/// How often a recording settles a matter from which it is advised without reserve.
const HOPEFUL: f64 = 0.2;

/// What to record next, or that little is to be hoped of it.
fn advised(next: &Suggestion) -> String {
    let (text, outlook) = (&next.text, next.outlook());
    match next.probability.is_none_or(|p| p >= HOPEFUL) {
        true => format!(" Record next: {text} ({outlook})."),
        false => format!(
            " No recording with these tools is likely to settle it; the best would be: {text} ({outlook})."
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_instrument_without_a_name_is_given_neither_a_name_nor_a_share() {
        let said = sentence(
            (Verdict::Instrument, false),
            (&[], None),
            (&[], &[], &[]),
            "",
        );
        assert!(said.contains("instrument") && !said.contains('%'), "{said}");
    }

    fn said(probability: Option<f64>) -> String {
        advised(&Suggestion {
            text: "Press".into(),
            indenter: None,
            radius_mm: None,
            in_turn_with: None,
            site: String::new(),
            speed_mm_s: 1.0,
            hold_s: 8.0,
            cycles: 1,
            depth_mm: 1.0,
            presses: 12,
            settles: Vec::new(),
            probability,
            minutes: 30.0,
        })
    }

    #[test]
    fn agreement_is_not_claimed_where_more_than_noise_is_left() {
        let of = |verdict, is_more| {
            let nothing: (&[Finding], Option<&Gain>) = (&[], None);
            sentence((verdict, is_more), nothing, (&[], &[], &[]), "")
        };
        for verdict in [Verdict::NothingMissing, Verdict::Parameters] {
            let said = of(verdict, true);
            assert!(said.starts_with("No effect is named") && !said.contains("agrees"));
            assert!(of(verdict, false).contains("agrees"));
        }
    }

    #[test]
    fn sentence_names_the_effects_common_to_all_rivals() {
        let pairs = [["bone", "fixture_compliance"]];
        let told = |beside: &[&'static str]| {
            sentence(
                (Verdict::CannotTell, false),
                (&[], None),
                (&pairs, beside, &[]),
                "unused",
            )
        };
        let apart = "Something is missing, but these recordings cannot distinguish a thicker or thinner tissue over the bone from compliance of the fixture";
        assert_eq!(told(&[]), format!("{apart}."));
        let with = ", each of them together with a zero error of the sensor.";
        assert_eq!(told(&["offset"]), format!("{apart}{with}"));
    }

    #[test]
    fn unlikely_next_recording_is_advised_with_reserve() {
        assert_eq!(
            said(Some(0.6)),
            " Record next: Press (settles it in 60 % of cases, takes about 30 minutes)."
        );
        assert!(said(None).starts_with(" Record next: Press (takes"));
        let poor = said(Some(0.01));
        assert!(
            poor.starts_with(" No recording with these tools") && poor.contains("1 % of cases")
        );
    }
}
