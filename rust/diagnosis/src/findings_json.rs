//! findings.json, schema 1: numbers with their units, null for what is not known.

use serde_json::{Map, Value, json};

use crate::by_contact_model::{is_behind, is_worse_than_without};
use crate::findings::{Diagnosis, Finding, Rival, Suggestion, Switched};
use crate::track_record::Confidence;
use crate::unlisted_finding::{Correction, Unlisted};
use thenar_inference::selection::cross_validation::{Gain, HeldOutBy, Spread};

/// The diagnosis as JSON, schema 1.
pub fn findings_json(found: &Diagnosis) -> String {
    let by_name = |(name, value, unit): &(&'static str, Option<f64>, &'static str)| {
        (
            (*name).to_owned(),
            json!({"value": value.and_then(rounded), "unit": unit}),
        )
    };
    let smallest: Map<String, Value> = found.smallest_seen.iter().map(by_name).collect();
    let material = |(region, g0, g_lim): &(String, f64, f64)| {
        (
            region.clone(),
            json!({"g0_mpa": rounded(*g0), "g_lim_mpa": rounded(*g_lim)}),
        )
    };
    let materials: Map<String, Value> = found.materials.iter().map(material).collect();
    let evidence: Map<String, Value> = found
        .evidence
        .iter()
        .map(|(name, value)| ((*name).to_owned(), json!(rounded(*value))))
        .collect();
    let value = json!({
        "schema": 1,
        "version": env!("CARGO_PKG_VERSION"),
        "verdict": found.verdict.word(),
        "sentence": found.sentence,
        "findings": found.findings.iter().map(finding).collect::<Vec<_>>(),
        "unlisted": found.unlisted.as_ref().map(unlisted),
        "names_90": found.names_90,
        "cannot_tell": found.cannot_tell,
        "suspected": found.suspected,
        "is_more_than_noise": found.is_more_than_noise,
        "fit": fit(found.gain.as_ref()),
        "smallest_seen": smallest,
        "record_next": found.record_next.iter().map(suggestion).collect::<Vec<_>>(),
        "model": {
            "materials": materials,
            "effects": found.effects.iter().map(switched).collect::<Vec<_>>(),
        },
        "rivals": found.rivals.iter().map(rival).collect::<Vec<_>>(),
        "evidence": evidence,
        "notes": found.notes,
    });
    serde_json::to_string_pretty(&value).unwrap_or_default() + "\n"
}

/// Of findings of the same kind on studies of known truth; counts are null where they are too few.
fn track_record(of: &Confidence) -> Value {
    json!({"kind": of.kind.word(), "right": of.record.map(|r| r.right), "stated": of.record.map(|r| r.stated)})
}

/// To seven digits, so that the file does not depend on the last bits; null if not finite.
fn rounded(value: f64) -> Option<f64> {
    if !value.is_finite() {
        return None;
    }
    format!("{value:.6e}").parse().ok()
}

fn finding(found: &Finding) -> Value {
    let number = |n: &crate::findings::Number| {
        let ends = n.interval;
        let value = json!({
            "value": rounded(n.value), "low": rounded(ends.0), "high": rounded(ends.1), "unit": n.unit,
        });
        (n.name.to_owned(), value)
    };
    let numbers: Map<String, Value> = found.numbers.iter().map(number).collect();
    let mut value = json!({
        "effect": found.effect,
        "kind": found.kind,
        "channel": found.channel,
        "confidence": found.confidence.frequency().and_then(rounded),
        "posterior": rounded(found.confidence.posterior),
        "track_record": track_record(&found.confidence),
        "parameters": numbers,
        "depends_on": found.depends_on,
        "consequences": found.consequences.iter()
            .map(|(sentence, holds)| json!({"sentence": sentence, "holds": holds})).collect::<Vec<_>>(),
    });
    if let Some(place) = &found.place {
        let mut at = Map::new();
        at.insert("site".into(), json!(place.site));
        if let Some(region) = &place.region {
            at.insert("region".into(), json!(region));
        }
        if let Some(center) = place.center_mm {
            at.insert("center_mm".into(), json!(center.map(rounded)));
        }
        if let Some(radius) = place.radius_mm {
            at.insert("radius_mm".into(), json!(rounded(radius)));
        }
        if let Some(area) = place.area_90_mm2 {
            at.insert("area_90_mm2".into(), json!(rounded(area)));
        }
        if !place.vertices.is_empty() {
            let list: Vec<String> = place.vertices.iter().map(u32::to_string).collect();
            at.insert("vertices_csv".into(), json!(list.join(",")));
        }
        value["where"] = Value::Object(at);
    }
    if let Some(when) = &found.when {
        value["when"] = json!({
            "recordings": when.recordings,
            "phase": when.phase,
            "time_s": when.time_s.map(rounded),
            "depth_mm": when.depth_mm.map(rounded),
            "cycles": when.cycles,
        });
    }
    value
}

fn unlisted(found: &Unlisted) -> Value {
    let depends =
        |(on, removed): &(&'static str, f64)| json!({"on": on, "removed": rounded(*removed)});
    let numbers = |of: &[f64]| of.iter().map(|v| rounded(*v)).collect::<Vec<_>>();
    let factors = |of: &[f64]| of.iter().map(|c| rounded(1.0 + c)).collect::<Vec<_>>();
    let correction = |of: &Correction| {
        json!({
            "kind": "empirical",
            "by": of.by().0,
            "unit": of.by().1,
            "at": numbers(&of.factors.knots),
            "factor_in": factors(&of.factors.change[0]),
            "factor_out": factors(&of.factors.change[1]),
            "removed": rounded(of.removed),
        })
    };
    json!({
        "depends_on": found.depends_on.iter().map(depends).collect::<Vec<_>>(),
        "where": found.place.as_ref().map(|(site, _)| json!({"site": site})),
        "when": found.place.as_ref().map(|(_, phase)| json!({"phase": phase})),
        "correction": found.correction.as_ref().map(correction),
        "rhythm": found.rhythm.map(|r| json!({"hz": rounded(r.hz), "per_minute": rounded(r.per_minute()), "chance": rounded(r.chance)})),
    })
}

fn spread(of: Spread) -> Value {
    json!({
        "rms": rounded(of.rms), "unit": "standard deviations of the noise",
        "low": rounded(of.interval.0), "high": rounded(of.interval.1),
    })
}

fn fit(gain: Option<&Gain>) -> Value {
    match gain {
        None => json!({"held_out": []}),
        Some(gain) => json!({
            "held_out": gain.held_out,
            "held_out_by": match gain.held_out_by { HeldOutBy::Protocol => "protocol", HeldOutBy::Repeat => "repeat" },
            "before": spread(gain.before),
            "after": spread(gain.after),
            "noise_floor": spread(gain.floor),
            "reducible_error_removed": {
                "value": rounded(gain.removed), "low": rounded(gain.interval.0), "high": rounded(gain.interval.1),
            },
            "log_score": {
                "value": rounded(gain.log_score), "unit": "nats", "placebo": rounded(gain.placebo), "of_evidence": rounded(gain.confirmed),
            },
            "by_contact_model": gain.contact_model.as_ref().map(|by| json!({
                "before": spread(by.before),
                "after": spread(by.after),
                "is_behind_the_fit": is_behind(gain),
                "is_worse_than_without": is_worse_than_without(by),
                "removed_by_the_fit": rounded(by.by_fit.0),
                "moduli_over_the_fits": by.moduli.map(rounded),
                "reducible_error_removed": {
                    "value": rounded(by.removed), "low": rounded(by.interval.0), "high": rounded(by.interval.1),
                },
            })),
            "evidence_confirmed_given_the_other": gain.members.iter()
                .map(|(name, share)| ((*name).to_owned(), json!(rounded(*share)))).collect::<Map<String, Value>>(),
        }),
    }
}

fn suggestion(of: &Suggestion) -> Value {
    json!({
        "text": of.text,
        "protocol": {
            "indenter": of.indenter,
            "radius_mm": of.radius_mm.and_then(rounded),
            "in_turn_with": of.in_turn_with,
            "site": of.site,
            "speed_mm_s": rounded(of.speed_mm_s),
            "hold_s": rounded(of.hold_s),
            "cycles": of.cycles,
            "depth_mm": rounded(of.depth_mm),
            "presses": of.presses,
        },
        "settles": of.settles,
        "probability": of.probability.and_then(rounded),
        "minutes": rounded(of.minutes),
    })
}

fn switched(effect: &Switched) -> Value {
    let mut value = json!({"name": effect.name, "amplitude": rounded(effect.amplitude)});
    for (name, number) in &effect.numbers {
        value[*name] = json!(rounded(*number));
    }
    for (name, choice) in &effect.choices {
        value[*name] = json!(choice);
    }
    value
}

fn rival(of: &Rival) -> Value {
    json!({
        "effects": of.effects,
        "evidence": rounded(of.evidence),
        "probability": rounded(of.probability),
        "left": rounded(of.left),
        "ledger": {
            "load": rounded(of.ledger[0]), "hold": rounded(of.ledger[1]),
            "unload": rounded(of.ledger[2]), "rest": rounded(of.ledger[3]),
        },
    })
}
