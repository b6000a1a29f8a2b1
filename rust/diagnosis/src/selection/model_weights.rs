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

#[cfg(test)]
mod tests {
    use thenar_contact::effects::Effect;

    use super::*;
    use crate::selection::synthetic_rungs::rungs_beside;

    /// Weights where a pair counts that leads by 6 nats.
    fn weights(rungs: &Rungs) -> Vec<(Vec<&'static str>, f64)> {
        let lead = |pair: &Scored| pair.qaic_gain - rungs.singles[0].qaic_gain;
        probabilities(rungs, |pair| lead(pair) > 6.0)
    }

    #[test]
    fn names_90_hold_nine_tenths_of_the_weight_without_needless_pairs() {
        let first = (Effect::Relaxation, 100.0);
        let needed = weights(&rungs_beside(first, Effect::Offset, 8.0));
        assert_eq!(needed[0].0, ["relaxation", "offset"]);
        assert!((needed.iter().map(|(_, p)| p).sum::<f64>() - 1.0).abs() < 1e-12);
        let odds = needed[0].1 / needed[1].1;
        assert!((odds / libm::exp(8.0) - 1.0).abs() < 1e-9, "{odds}");
        assert_eq!(names_90(&needed), [needed[0].0.clone()]);
        let needless = weights(&rungs_beside(first, Effect::Offset, 5.0));
        assert!(needless.iter().all(|(names, _)| names.len() < 2));
        let silent = weights(&rungs_beside(
            (Effect::Relaxation, 4.0),
            Effect::Offset,
            0.0,
        ));
        let kept = names_90(&silent).len();
        assert_eq!(
            kept, 2,
            "e^4 = 55, as much again, and 1 for nothing of either"
        );
        assert!(
            (silent[0].1 - silent[1].1).abs() < 1e-12,
            "nothing at all is as good as 4 nats"
        );
    }
}
