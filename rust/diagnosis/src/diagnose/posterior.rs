//! How probable every explanation is, by its evidence, and which names hold nine tenths.

use super::gates::is_pair;
use super::ladder::Rungs;

/// Probabilities of the base and of everything that was tried, by evidence over [`TEMPERATURE`].
pub fn probabilities(rungs: &Rungs) -> Vec<(Vec<&'static str>, f64)> {
    let mut all: Vec<(Vec<&'static str>, f64)> = vec![(Vec::new(), SILENT)];
    // A pair one of which is not needed is that single effect over again.
    let pairs = rungs.pairs.iter().filter(|pair| is_pair(pair, rungs));
    for scored in rungs.singles.iter().chain(pairs) {
        let names = scored.names();
        match all.iter_mut().find(|(other, _)| *other == names) {
            Some((_, evidence)) => *evidence = evidence.max(scored.evidence),
            None => all.push((names, scored.evidence)),
        }
    }
    let most = all
        .iter()
        .fold(f64::NEG_INFINITY, |most, (_, e)| most.max(*e));
    let weight = |e: f64| libm::exp((e - most) / TEMPERATURE);
    let sum: f64 = all.iter().map(|(_, e)| weight(*e)).sum();
    let mut all: Vec<(Vec<&'static str>, f64)> = all
        .into_iter()
        .map(|(names, e)| (names, weight(e) / sum))
        .collect();
    all.sort_by(|a, b| b.1.total_cmp(&a.1));
    all
}

/// Evidence that the base counts for without any: what nulls reach.
const SILENT: f64 = 4.0;

/// What evidence is divided by before it becomes a probability: models are not true.
pub const TEMPERATURE: f64 = 2.0;

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
