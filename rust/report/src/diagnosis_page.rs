//! The page of a diagnosis: the sentence, rivals, ledger by phase, curves before and after, and what to record next; then the comparison.

use std::fmt::Write;

use crate::comparison_page::page;
use crate::plots::before_after_plot::plot;
use crate::svg::escaped;
use thenar_diagnosis::{Correction, Unlisted};
use thenar_diagnosis::{Diagnosis, Number, Rival, Verdict};
use thenar_diagnosis::{is_worse_than_without, variable_in_words};
use thenar_inference::number_format::{self, capital};
use thenar_inference::selection::cross_validation::{ContactModelCheck, Gain, HeldOutBy};

/// Recordings that are drawn.
const MOST_CURVES: usize = 6;

/// A self-contained page, UTF-8: the diagnosis first, then the comparison that it started from.
pub fn diagnosis_html(found: &Diagnosis) -> String {
    let mut html = "<section class='diagnosis'>\n".to_owned();
    html += &findings(found);
    if let Some(unlisted) = &found.unlisted {
        html += &nameless(unlisted);
    }
    if let Some(gain) = &found.gain {
        html += &gained(gain);
    }
    html += &next(found);
    html += &rivals(&found.rivals);
    html += &curves(found);
    html += &smallest(found);
    let notes: String = found
        .notes
        .iter()
        .map(|note| format!("<li>{}</li>", escaped(note)))
        .collect();
    let _ = writeln!(
        html,
        "<h3>Notes</h3><ul>{notes}</ul></section>\n<section><h2>With parameters alone</h2><p class='sentence'>{}</p>{}</section>",
        escaped(&found.comparison.sentence),
        match found.verdict {
            Verdict::NothingMissing | Verdict::Parameters => "",
            _ =>
                "<p class='meta'>This test weighs all residuals at once. The findings above were tested cause by cause, which detects smaller effects.</p>",
        }
    );
    page(&found.comparison, (&found.sentence, &html))
}

fn findings(found: &Diagnosis) -> String {
    let mut html = String::new();
    for finding in &found.findings {
        let _ = write!(
            html,
            "<h3>{} ({})</h3><table><tr><th class='left'>number</th><th>value</th><th>90 % interval</th><th class='left'>unit</th></tr>",
            escaped(&capital(&finding.effect.replace('_', " "))),
            finding.confidence.in_words()
        );
        html.extend(finding.numbers.iter().map(number));
        html.extend(found.choices(finding.effect).iter().map(choice));
        html += "</table>\n";
        html += &signs(&finding.consequences);
    }
    html
}

/// What is known of what has no name.
fn nameless(of: &Unlisted) -> String {
    let mut html = "<h3>What it depends on</h3>".to_owned();
    if let Some(rhythm) = of.rhythm {
        let _ = write!(
            html,
            "<p>Repeats differ by a rhythm of {:.2} Hz ({:.0} a minute) that grows with the force; noise alone would show one as clear in {}.</p>",
            rhythm.hz,
            rhythm.per_minute(),
            share(rhythm.chance)
        );
    }
    let told = of
        .depends_on
        .iter()
        .filter(|(_, removed)| removed.is_finite());
    let rows: String = told
        .map(|(on, removed)| {
            format!(
                "<tr><td class='left'>{}</td><td>{:.0} %</td></tr>",
                variable_in_words(on),
                100.0 * removed
            )
        })
        .collect();
    if rows.is_empty() {
        return html + "<p>No correction can be given.</p>\n";
    }
    let _ = write!(
        html,
        "<table><tr><th class='left'>goes with</th><th>removed on protocols not used</th></tr>{rows}</table>"
    );
    html + &of.correction.as_ref().map_or(String::new(), corrected)
}

fn corrected(of: &Correction) -> String {
    let percent = |change: &f64| format!("<td>{:+.1}</td>", 100.0 * change);
    let cells = |side: &[f64]| side.iter().map(percent).collect::<String>();
    let at: String = of
        .factors
        .knots
        .iter()
        .map(|at| format!("<th>{}</th>", number_format::number(*at)))
        .collect();
    let [going_in, going_out] = [0, 1].map(|side| cells(&of.factors.change[side]));
    let out = match going_in == going_out {
        true => String::new(),
        false => format!("<tr><td class='left'>going out, %</td>{going_out}</tr>"),
    };
    let first = if out.is_empty() {
        "force, %"
    } else {
        "going in, %"
    };
    format!(
        "<table><tr><th class='left'>{}, {}</th>{at}</tr><tr><td class='left'>{first}</td>{going_in}</tr>{out}</table><p class='meta'>An \
empirical correction of the force with parameters alone: what the recordings ask for, not why. It holds for nothing that was not recorded.</p>\n",
        variable_in_words(of.by().0),
        of.by().1
    )
}

/// Small shares as one in so many.
fn share(of: f64) -> String {
    match of < 1e-3 {
        true => "fewer than one study in a thousand".to_owned(),
        false => format!("at most {:.1} % of studies", 100.0 * of),
    }
}

fn number(of: &Number) -> String {
    let (value, between, unit) = of.in_words();
    format!(
        "<tr><td class='left'>{}</td><td>{value}</td><td>{between}</td><td class='left'>{unit}</td></tr>",
        spoken(of.name, if of.unit == "1" { "" } else { of.unit }),
    )
}

/// A number's name without the unit that stands beside it: the work of `work_j_per_m2` in J/m2.
fn spoken(name: &str, unit: &str) -> String {
    let ending = format!("_{}", unit.to_lowercase().replace('/', "_per_"));
    name.strip_suffix(&ending).unwrap_or(name).replace('_', " ")
}

fn choice((name, option): &(&'static str, &'static str)) -> String {
    format!("<tr><td class='left'>{name}</td><td>{option}</td><td></td><td></td></tr>")
}

/// What must show in the recordings if the effect is there, and whether it does.
fn signs(consequences: &[(String, bool)]) -> String {
    if consequences.is_empty() {
        return String::new();
    }
    let row = |(sentence, holds): &(String, bool)| {
        let word = if *holds { "seen" } else { "not seen" };
        format!(
            "<tr><td class='left'>{}</td><td class='left'>{word}</td></tr>",
            escaped(sentence)
        )
    };
    let rows: String = consequences.iter().map(row).collect();
    format!(
        "<table><tr><th class='left'>expected sign of the effect</th><th class='left'>in these recordings</th></tr>{rows}</table>\n"
    )
}

fn gained(gain: &Gain) -> String {
    let share = match gain.interval.0 < 0.0 {
        true => "The share of the reducible error that is removed cannot be given: noise is larger than the effect.".to_owned(),
        false => format!(
            "Share of the reducible error removed: {:.0} % ({:.0} to {:.0} %).",
            100.0 * gain.removed,
            100.0 * gain.interval.0,
            100.0 * gain.interval.1
        ),
    };
    let held_out = match gain.held_out_by {
        HeldOutBy::Protocol => "protocol by protocol",
        HeldOutBy::Repeat => "repeat by repeat, since one protocol alone shows it",
    };
    format!(
        "<p>Predictions of recordings that were held out, {held_out}: {:.2} standard deviations of the noise before, {:.2} \
after; repeats predict one another to {:.2}. {share} \
Their log predictive density rises by {:.1} (plug-in estimate of the elpd difference); by the same change on the wrong recordings at the wrong \
moments it rises by {:.1} at most (99 of 100 draws).</p>\n",
        gain.before.rms, gain.after.rms, gain.floor.rms, gain.log_score, gain.placebo
    ) + &gain
        .contact_model
        .as_ref()
        .map_or_else(String::new, by_contact_model)
}

/// What the contact model itself makes of them.
fn by_contact_model(check: &ContactModelCheck) -> String {
    let share = match check.interval {
        _ if is_worse_than_without(check) => {
            "worse than without, so that simulations with them are wrong for these tools".to_owned()
        }
        (_, high) if high <= 0.0 => "no better than without".to_owned(),
        (low, _) if low < 0.0 => {
            "noise decides how much of the reducible error that removes".to_owned()
        }
        (low, high) => format!(
            "that removes {:.0} % of the reducible error ({:.0} to {:.0} %), the fit {:.0} % of the same",
            100.0 * check.removed,
            100.0 * low,
            100.0 * high,
            100.0 * check.by_fit.0
        ),
    };
    format!(
        "<p>The contact model on the study's mesh, with the effects that are named, predicts them to {:.2} standard deviations \
({:.2} before): {share}. Of repeats the first was followed; first touch, gain and the error of the base's form are the fit's.</p>\n",
        check.after.rms, check.before.rms
    )
}

fn next(found: &Diagnosis) -> String {
    if found.record_next.is_empty() {
        return String::new();
    }
    let one = |next: &thenar_diagnosis::Suggestion| {
        format!("<li>{} ({})</li>", escaped(&next.text), next.outlook())
    };
    let list: String = found.record_next.iter().map(one).collect();
    format!("<h3>Record next</h3><ol>{list}</ol>\n")
}

fn rivals(all: &[Rival]) -> String {
    if all.is_empty() {
        return String::new();
    }
    let mut html = "<h3>What was tried</h3><table><tr><th class='left'>explanation</th><th>log evidence</th><th>probability</th>\
<th>shared misfit left</th><th>load</th><th>hold</th><th>unload</th><th>rest</th></tr>"
        .to_owned();
    for rival in all.iter().take(12) {
        let names = rival.effects.join(" + ").replace('_', " ");
        let _ = write!(
            html,
            "<tr><td class='left'>{}</td><td>{}</td><td>{:.0} %</td><td>{}</td>",
            escaped(&names),
            nats(rival.evidence),
            100.0 * rival.probability,
            part_of(rival.left)
        );
        for part in rival.ledger {
            let _ = write!(html, "<td>{}</td>", nats(part));
        }
        html += "</tr>";
    }
    html + "</table><p class='meta'>Log evidence (minus half the QAIC difference) over parameters alone; the last four columns say in which phase it accrued. A pair one of which is not needed \
counts as the other alone, and has no probability of its own.</p>\n"
}

/// A share in percent; a dash where it is not known, as of grasps.
fn part_of(share: f64) -> String {
    match share.is_finite() {
        true => format!("{:.0} %", 100.0 * share),
        false => "\u{2013}".to_owned(),
    }
}

/// Evidence with one decimal; what rounds to nothing has no sign, what is not known is a dash.
fn nats(evidence: f64) -> String {
    if !evidence.is_finite() {
        return "\u{2013}".to_owned();
    }
    format!("{:.1}", (10.0 * evidence).round() / 10.0 + 0.0)
}

fn smallest(found: &Diagnosis) -> String {
    if found.smallest_seen.is_empty() {
        return String::new();
    }
    let row = |(name, value, unit): &(&'static str, Option<f64>, &'static str)| {
        let size = value.map_or_else(|| "at no size".to_owned(), number_format::number);
        format!(
            "<tr><td class='left'>{}</td><td>{size}</td><td class='left'>{}</td></tr>",
            escaped(&name.replace('_', " ")),
            value.map_or_else(String::new, |_| escaped(unit))
        )
    };
    let rows: String = found.smallest_seen.iter().map(row).collect();
    format!(
        "<h3>Smallest effect that would have been seen</h3><table><tr><th class='left'>effect</th><th>size</th><th class='left'>unit</th></tr>{rows}</table>\n"
    )
}

fn curves(found: &Diagnosis) -> String {
    let is_corrected = (found.unlisted.as_ref()).is_some_and(|u| u.correction.is_some());
    if (found.findings.is_empty() && !is_corrected) || found.curves.is_empty() {
        return String::new();
    }
    let what = match is_corrected {
        true => "the empirical correction",
        false => "what was found",
    };
    let plots: String = found.curves.iter().take(MOST_CURVES).map(plot).collect();
    format!(
        "<h3>Before and after</h3><div class='pair'>{plots}</div><p class='meta'>Above, force over time: dots measured, dashes with parameters \
alone, blue with {what}. Below, the same less what parameters alone give: dots what they leave, blue what is added by {what}.</p>\n"
    )
}

#[cfg(test)]
mod tests {
    use super::{nats, spoken};

    #[test]
    fn a_number_is_called_without_its_unit() {
        let told = [
            ("work_j_per_m2", "J/m2"),
            ("offset_n", "N"),
            ("loss", ""),
            ("poisson_ratio", "1"),
        ];
        let names = told.map(|(name, unit)| spoken(name, unit));
        assert_eq!(names, ["work", "offset", "loss", "poisson ratio"]);
    }

    #[test]
    fn rounded_zero_has_no_sign() {
        assert_eq!(
            [-0.04, 0.04, -0.06, 12.34].map(nats),
            ["0.0", "0.0", "-0.1", "12.3"]
        );
    }
}
