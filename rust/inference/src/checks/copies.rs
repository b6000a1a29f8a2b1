//! Copies of a recording that are given as its repeats: they show no noise, so that everything would be more than noise.

use std::collections::BTreeSet;

use crate::observe::measured::{Measured, Quantity};

/// Fewest different forces that chance does not make the same: a coarse load cell reads few.
const LEAST: usize = 12;
/// Most copies that are listed.
const LISTED: usize = 3;

/// Recordings that hold depths and forces of an earlier one of their protocol, tool and site, by number, and that one's number.
pub(crate) fn copies(measured: &[Measured]) -> Vec<(usize, usize)> {
    let mut found: Vec<(usize, usize)> = Vec::new();
    for one in 0..measured.len() {
        let is_original = |of: &usize| !found.iter().any(|(copy, _)| copy == of);
        let of = (0..one).filter(is_original);
        let same = of
            .into_iter()
            .find(|of| is_copy(&measured[one], &measured[*of]));
        found.extend(same.map(|of| (one, of)));
    }
    found
}

/// What is said of copies that are left out; None if there are none.
pub(crate) fn copies_note(measured: &[Measured]) -> Option<String> {
    let found = copies(measured);
    let name = |k: usize| &measured[k].name;
    if found.is_empty() {
        return None;
    }
    let listed = found.iter().take(LISTED);
    let mut listed: Vec<String> = listed
        .map(|(copy, of)| format!("'{}' ('{}')", name(*copy), name(*of)))
        .collect();
    if found.len() > LISTED {
        listed.push("\u{2026}".to_owned());
    }
    Some(format!(
        "a copy is no repeat: left out is what holds depths and forces of another recording, reading by reading: {}. Give the files of the repeats",
        listed.join(", ")
    ))
}

fn is_copy(one: &Measured, of: &Measured) -> bool {
    let readings = |of: &Measured| -> Vec<[u64; 2]> {
        let forces = of.samples.iter().filter(|s| s.quantity == Quantity::Force);
        forces
            .map(|s| {
                let depth_mm = of.moments[s.moment as usize].depth_mm;
                [s.value.to_bits(), depth_mm.to_bits()]
            })
            .collect()
    };
    let is_other = one.indenter != of.indenter || one.site != of.site;
    if is_other || one.protocol != of.protocol || one.samples.len() != of.samples.len() {
        return false;
    }
    let (a, b) = (readings(one), readings(of));
    let forces: BTreeSet<u64> = a.iter().map(|of| of[0]).collect();
    a == b && forces.len() >= LEAST
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::forward::surrogate::synthetic::ready;
    use crate::observe::measured::Phase;

    /// Presses of 40 readings, by tool: depths off by so much, and forces in such steps.
    fn presses(of: &[(&str, f64, f64)]) -> Vec<Measured> {
        let press = |(_, off, step): &(&str, f64, f64)| {
            let times = (0..40).map(|k| 0.1 * f64::from(k));
            let of = times.map(|t| (t, t + off, Phase::Load, step * (t / step).floor()));
            (0, of.collect())
        };
        let all: Vec<_> = of.iter().map(press).collect();
        let mut measured = ready(Vec::new(), &all, 0.1).1;
        for (k, one) in measured.iter_mut().enumerate() {
            one.name = format!("press {k}");
            one.indenter = of[k].0.to_owned();
        }
        measured
    }

    #[test]
    fn the_same_readings_count_once() {
        let (ball, plate) = (("ball", 0.0, 0.01), ("plate", 0.0, 0.01));
        let other = [("ball", 1e-9, 0.01), ("ball", 0.0, 0.03)];
        let made = presses(&[ball, plate, ball, other[0], other[1], ball]);
        assert_eq!(copies(&made), [(2, 0), (5, 0)]);
        let said = copies_note(&made).unwrap();
        assert!(
            said.contains(": 'press 2' ('press 0'), 'press 5' ('press 0'). Give"),
            "{said}"
        );
        assert_eq!(copies_note(&made[..2]), None);
    }

    #[test]
    fn repeats_of_a_coarse_load_cell_are_no_copies() {
        assert_eq!(copies(&presses(&[("ball", 0.0, 0.5); 2])), []);
    }

    #[test]
    fn only_some_of_many_copies_are_listed() {
        let said = copies_note(&presses(&[("ball", 0.0, 0.01); 6])).unwrap();
        assert!(
            said.contains(", \u{2026}. Give") && !said.contains("press 4"),
            "{said}"
        );
    }
}
