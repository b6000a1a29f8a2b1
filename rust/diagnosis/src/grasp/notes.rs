//! What is said of grasps: sentence, notes, detection limits, and the next recording.

use thenar_inference::grasp::causes::Cause;
use thenar_inference::grasp::channels::{place, regions};
use thenar_inference::grasp::explain::Explained;
use thenar_inference::grasp::hold::Hold;
use thenar_inference::grasp::product_maps::SHIFTS_MM;
use thenar_inference::grasp::regional_fit::{Bound, RegionalFit};
use thenar_inference::number_format::{number, percent};
use thenar_recordings::Study;

use crate::findings::{Diagnosis, Finding, Suggestion, Verdict};
use crate::grasp::grasp_findings::region_force;

/// Standard deviations that the evidence for a name asks of its size: `z^2 / 2` is about the 4 nats with the prior's cost.
const SEEN: f64 = 3.6;
/// Regions whose posture is listed.
const MOST_POSTURES: usize = 3;

/// What the comparison says of itself.
pub(super) fn of_comparison() -> Vec<String> {
    vec![
        "Scale and posture of every region, and the hand's place along the mat, are fitted to the mean map of each hold: the error that is left is the \
         pattern within regions and what changes in time."
            .to_owned(),
    ]
}

/// The first sentence of the letter.
pub(super) fn sentence(explained: &Explained, found: &Diagnosis) -> String {
    let parts: Vec<String> = found
        .findings
        .iter()
        .map(|f| of_finding(explained, f))
        .collect();
    match found.verdict {
        Verdict::NothingMissing => format!(
            "Nothing is missing: what changes in {} is posture, and no region of the hand, no change over time and no part of the mat deviates by more than \
             the model itself may be off.",
            match explained.holds.len() {
                1 => "this hold".to_owned(),
                count => format!("these {count} holds"),
            }
        ),
        Verdict::CannotTell => {
            let pair = found.cannot_tell.first().map_or(["", ""], |pair| *pair);
            let [a, b] = pair.map(|name| name.replace('_', " "));
            format!("{} These recordings cannot distinguish {a} from {b}.", parts.join(" "))
        }
        Verdict::Unlisted => format!(
            "Something changes in these holds that no listed cause explains; most of it in {}.",
            most_unexplained(explained)
        ),
        Verdict::InsufficientData => {
            "Too little was recorded: hold the product for 30 s, two or three times, with a force trace next to the mat.".to_owned()
        }
        _ => parts.join(" "),
    }
}

fn of_finding(explained: &Explained, finding: &Finding) -> String {
    let value = |name: &str| {
        finding
            .numbers
            .iter()
            .find(|n| n.name == name)
            .map_or(f64::NAN, |n| n.value)
    };
    let region = finding
        .place
        .as_ref()
        .and_then(|place| place.region.clone())
        .unwrap_or_default()
        .replace('_', " ");
    let longest = explained
        .holds
        .iter()
        .map(|hold| hold.length_s())
        .fold(0.0, f64::max);
    match finding.effect {
        "relaxation" => format!(
            "Held skin relaxes: within {longest:.0} s its pressure falls by {} at unchanged contact, with a time constant of about {} s; posture does not explain it.",
            percent(value("amplitude") * (1.0 - (-longest / value("time_3_s")).exp())),
            number(value("time_3_s"))
        ),
        "cycle_softening" => format!(
            "Skin is softer from hold to hold, by {} each time.",
            percent(value("amplitude"))
        ),
        "region_stiffness" => {
            let factor = value("factor");
            let word = if factor > 1.0 { "stiffer" } else { "softer" };
            format!("The {region} is {word} than given, by a factor of {factor:.2}.")
        }
        "bone" => format!(
            "The bone under the {region} lies at another depth than given: the tissue acts as if {:.1} mm thick.",
            value("thickness_mm")
        ),
        "gain" if finding.channel == "map" => finding
            .consequences
            .first()
            .map_or(String::new(), |(sign, _)| {
                format!("A part of the mat reads by another factor: {sign}.")
            }),
        "gain" => format!(
            "The mat reads {} {} than the force trace says is there.",
            percent(value("error").abs()),
            if value("error") > 0.0 { "more" } else { "less" }
        ),
        "drift" => "The mat's readings drift against the force trace.".to_owned(),
        "saturation" => format!("The mat clips at {} kPa.", number(value("ceiling_kpa"))),
        "threshold" => format!(
            "The mat shows nothing below {} kPa.",
            number(value("floor_kpa"))
        ),
        "dead_cells" => finding
            .consequences
            .first()
            .map_or(String::new(), |(sign, _)| {
                format!("The mat has dead cells: {sign}.")
            }),
        other => format!("{}.", other.replace('_', " ")),
    }
}

/// Notes, the most useful first.
pub(super) fn notes(study: &Study, explained: &Explained) -> Vec<String> {
    let mut notes = study.warnings.clone();
    notes.extend(explained.product.notes().iter().cloned());
    notes.extend(postures(explained));
    notes.extend(unsettled(&explained.forces.unsettled_mm));
    notes.extend(at_bounds(explained));
    notes.push(by_region(explained));
    notes.push(
        "a region's scale is known no better than the model's own form: its force is 0.84 to 1.19 times that of a solid in seven grasps; one region is named stiffer, softer or \
         thinner only where it stands out of the others by more than that"
            .to_owned(),
    );
    if explained.holds.iter().all(|hold| hold.force_n.is_none()) {
        notes.push(
            "no force trace was recorded next to the mat: its gain was not tested, and skin that relaxes cannot be distinguished from a mat whose readings fall".to_owned(),
        );
    }
    if explained.holds.len() < 3 {
        notes.push("softening from hold to hold was not tested: it takes three holds".to_owned());
    }
    notes.push("friction was not tested: no hold slides".to_owned());
    notes
}

/// Presses of the model that did not converge.
fn unsettled(shifts_mm: &[f64]) -> Option<String> {
    let parts: Vec<String> = shifts_mm.iter().map(|s| format!("{s:+.1}")).collect();
    (!parts.is_empty()).then(|| {
        format!(
            "{} of {} presses of the model did not converge (regions shifted by {} mm): forces near that posture are approximate; check skin and product \
             for folds and intersections",
            parts.len(),
            SHIFTS_MM.len(),
            parts.join(" and ")
        )
    })
}

/// Regions whose fitted posture or scale ended at a bound, by hold.
fn at_bounds(explained: &Explained) -> Option<String> {
    let of = |hold: &Hold, fit: &RegionalFit| -> Vec<String> {
        let each = fit.active.iter().enumerate().filter_map(|(k, &region)| {
            let bound = fit.at_bound(k, explained.forces.range(region))?;
            let title = explained.product.regions()[region].replace('_', " ");
            Some(bound_in_words(&title, &hold.name, bound))
        });
        each.collect()
    };
    let both = explained.holds.iter().zip(&explained.fits);
    let parts: Vec<String> = both.flat_map(|(hold, fit)| of(hold, fit)).collect();
    (!parts.is_empty()).then(|| {
        format!(
            "fitted values at a bound, which are known no better than that: {}; pose the hand as it held the product",
            parts.join("; ")
        )
    })
}

fn bound_in_words(title: &str, hold: &str, bound: Bound) -> String {
    match bound {
        Bound::Shift(shift) => {
            format!("the {title} in '{hold}' lies {shift:+.1} mm toward the product or farther")
        }
        Bound::Scale(scale) => {
            let word = if scale > 1.0 { "more" } else { "less" };
            format!("the {title} in '{hold}' bears {scale:.1} times the model's pressure or {word}")
        }
    }
}

/// Force, scale over the model, and posture of every region, in the mean over holds.
fn by_region(explained: &Explained) -> String {
    let parts = regions(&explained.fits).into_iter().map(|region| {
        let mean = |of: &dyn Fn(&RegionalFit, usize) -> f64| {
            let own = explained
                .fits
                .iter()
                .filter_map(|fit| place(fit, region).map(|k| of(fit, k)));
            let own: Vec<f64> = own.collect();
            own.iter().sum::<f64>() / own.len().max(1) as f64
        };
        let scale = mean(&|fit, k| fit.log_scale[k]).exp();
        let shift = mean(&|fit, k| fit.shift_mm[k]);
        let title = explained.product.regions()[region].replace('_', " ");
        let force = region_force(explained, region);
        format!("{title} {force:.0} N, {scale:.2} of the model, {shift:+.1} mm")
    });
    format!(
        "by region, force, pressure over the model's, and shift toward the product: {}",
        parts.collect::<Vec<_>>().join("; ")
    )
}

/// How the posture differs from the study's, and how far regions moved.
fn postures(explained: &Explained) -> Vec<String> {
    let title = |region: usize| explained.product.regions()[region].replace('_', " ");
    let mean = |region: usize| {
        let own = explained
            .fits
            .iter()
            .filter_map(|fit| place(fit, region).map(|k| fit.shift_mm[k]));
        let own: Vec<f64> = own.collect();
        own.iter().sum::<f64>() / own.len().max(1) as f64
    };
    let mut shifts: Vec<(usize, f64)> = regions(&explained.fits)
        .into_iter()
        .map(|r| (r, mean(r)))
        .collect();
    shifts.sort_by(|a, b| b.1.abs().total_cmp(&a.1.abs()));
    let parts: Vec<String> = shifts
        .iter()
        .take(MOST_POSTURES)
        .map(|(region, shift)| {
            let word = if *shift > 0.0 { "deeper" } else { "less deep" };
            format!(
                "the {} lies {:.1} mm {word} ({:.0} N)",
                title(*region),
                shift.abs(),
                region_force(explained, *region)
            )
        })
        .collect();
    let moved = explained
        .courses
        .iter()
        .flat_map(|c| c.shift_mm.iter().flatten())
        .fold(0.0, |most: f64, s| most.max(s.abs()));
    let mut notes = Vec::new();
    if !parts.is_empty() {
        notes.push(format!(
            "posture, against the study's hand: {}",
            parts.join("; ")
        ));
    }
    notes.push(format!(
        "within a hold no region moved by more than {moved:.2} mm toward or from the product"
    ));
    notes
}

/// Moduli by region as the holds would have them.
pub(super) fn materials(explained: &Explained) -> Vec<(String, f64, f64)> {
    let named = &explained.chosen.named;
    let of = |region: usize| {
        let factor = named.iter().find_map(|each| match each.cause {
            Cause::Stiffness(r) if r == region => Some(each.sized.size.exp()),
            _ => None,
        });
        let (g0, g_lim) = explained.product.moduli_mpa(region);
        factor.map(|f| {
            (
                explained.product.regions()[region].clone(),
                g0 * f,
                g_lim * f,
            )
        })
    };
    regions(&explained.fits)
        .into_iter()
        .filter_map(of)
        .collect()
}

/// The smallest size of each cause that would have been named.
pub(super) fn smallest(explained: &Explained) -> Vec<(&'static str, Option<f64>, &'static str)> {
    let least = |is_it: fn(Cause) -> bool| {
        let own = explained.chosen.rivals.iter().filter(|r| is_it(r.cause));
        own.map(|r| SEEN * r.sized.deviation).reduce(f64::min)
    };
    vec![
        (
            "relaxation",
            least(|c| matches!(c, Cause::Relaxation(_))),
            "share of the pressure",
        ),
        (
            "cycle_softening",
            least(|c| c == Cause::Softening),
            "share of the pressure",
        ),
        ("gain", least(|c| c == Cause::Gain), "share of the reading"),
    ]
}

/// The hold in which most is left.
fn most_unexplained(explained: &Explained) -> String {
    let mut sums = vec![0.0; explained.holds.len()];
    if let Some(factored) = explained.channels.model.factored(|_| true) {
        for (row, value) in factored.whitened() {
            sums[explained.channels.rows[row].hold()] += value * value;
        }
    }
    let most = (0..sums.len()).max_by(|a, b| sums[*a].total_cmp(&sums[*b]));
    most.map_or(String::new(), |k| format!("'{}'", explained.holds[k].name))
}

/// What to record next.
pub(super) fn next(explained: &Explained, found: &Diagnosis) -> Vec<Suggestion> {
    let has_trace = explained.holds.iter().any(|hold| hold.force_n.is_some());
    let settles = |pair: &[&'static str; 2]| pair.to_vec();
    match found.cannot_tell.first() {
        Some(pair) if pair.contains(&"bone") => vec![suggestion(
            "Hold the product lightly and firmly, 10 s each, or press this region alone with a small and a large ball",
            (settles(pair), 2),
        )],
        Some(pair) if !has_trace => vec![suggestion(
            "Repeat the hold with a load cell in the product, and give its trace with the mat's frames",
            (settles(pair), 2),
        )],
        Some(pair) => vec![suggestion(
            "Repeat the hold twice, with the mat turned by a quarter",
            (settles(pair), 2),
        )],
        None if found.verdict == Verdict::InsufficientData => vec![suggestion(
            "Hold the product for 30 s, three times, with a force trace next to the mat",
            (Vec::new(), 3),
        )],
        None => Vec::new(),
    }
}

/// A suggestion of a grasp, which has neither tool nor speed.
fn suggestion(text: &str, (settles, presses): (Vec<&'static str>, u32)) -> Suggestion {
    Suggestion {
        text: text.to_owned(),
        indenter: None,
        radius_mm: None,
        in_turn_with: None,
        site: String::new(),
        speed_mm_s: 0.0,
        hold_s: 30.0,
        cycles: 1,
        depth_mm: 0.0,
        presses,
        settles,
        probability: None,
        minutes: 2.0 * f64::from(presses),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn presses_that_did_not_converge_are_listed_with_their_shift() {
        assert_eq!(unsettled(&[]), None);
        let said = unsettled(&[-1.0, 0.5]).unwrap();
        assert!(
            said.starts_with("2 of 5 presses") && said.contains("-1.0 and +0.5 mm"),
            "{said}"
        );
    }

    #[test]
    fn values_at_a_bound_say_on_which_side_they_may_lie() {
        let of = |bound| bound_in_words("thumb", "hold 1", bound);
        assert!(of(Bound::Shift(-1.0)).contains("-1.0 mm"));
        assert!(of(Bound::Scale(4.95)).ends_with("pressure or more"));
        assert!(of(Bound::Scale(0.2)).ends_with("pressure or less"));
    }
}
