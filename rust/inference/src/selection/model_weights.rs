//! Akaike weights of all fitted models, and the names that hold 90 % of the weight.

use crate::selection::scored::{Rungs, Scored};

/// Probabilities of the base and of everything that was tried, by evidence.
pub fn probabilities(
    rungs: &Rungs,
    is_needed: impl Fn(&Scored) -> bool,
) -> Vec<(Vec<&'static str>, f64)> {
    let mut all: Vec<(Vec<&'static str>, f64)> = vec![(Vec::new(), BASE_SCORE)];
    // A pair one of which is not needed is that single effect over again.
    let pairs = rungs.pairs.iter().filter(|pair| is_needed(pair));
    for scored in rungs.singles.iter().chain(pairs) {
        let names = scored.names();
        match all.iter_mut().find(|(other, _)| *other == names) {
            Some((_, qaic_gain)) => *qaic_gain = qaic_gain.max(scored.qaic_gain),
            None => all.push((names, scored.qaic_gain)),
        }
    }
    let most = all
        .iter()
        .fold(f64::NEG_INFINITY, |most, (_, e)| most.max(*e));
    let weight = |e: f64| libm::exp(e - most);
    let sum: f64 = all.iter().map(|(_, e)| weight(*e)).sum();
    let mut all: Vec<(Vec<&'static str>, f64)> = all
        .into_iter()
        .map(|(names, e)| (names, weight(e) / sum))
        .collect();
    all.sort_by(|a, b| b.1.total_cmp(&a.1));
    all
}

/// Evidence that the base counts for without any: what nulls reach.
const BASE_SCORE: f64 = 4.0;

/// Names, most probable first, until they hold 90 %.
pub fn names_90(probabilities: &[(Vec<&'static str>, f64)]) -> Vec<Vec<&'static str>> {
    let (mut kept, mut sum) = (Vec::new(), 0.0);
    for (names, p) in probabilities {
        if sum >= 0.9 {
            break;
        }
        kept.push(names.clone());
        sum += p;
    }
    kept
}
