//! How probable every explanation is, by its evidence, and which names hold nine tenths.

use super::gates::is_pair;
use super::ladder::Rungs;

/// Probabilities of the base and of everything that was tried, by evidence.
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
const SILENT: f64 = 4.0;

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
    use nalgebra::DMatrix;
    use thenar_contact::effects::Effect;

    use super::super::gates::needed;
    use super::super::ladder::Scored;
    use super::super::mechanism::{Mechanism, Scales, singles};
    use super::super::refit::Refit;
    use super::*;

    fn of(effects: &[Effect], evidence: f64) -> Scored {
        let tried = singles(Scales {
            deepest: 1.0,
            radius: 1.0,
            forces: (1.0, 1.0),
            has_bone: true,
            has_strain: true,
        });
        let one = |effect: &Effect| -> Mechanism {
            tried.iter().find(|m| m.effect == *effect).unwrap().clone()
        };
        Scored {
            mechanisms: effects.iter().map(one).collect(),
            refit: Refit {
                at: Vec::new(),
                deviance: 0.0,
                residual: Vec::new(),
                simulated: Vec::new(),
                covariance: DMatrix::zeros(0, 0),
            },
            evidence,
            coherent: 0.0,
        }
    }

    /// One effect, another that shows nothing alone, and both with so much more evidence than the first.
    fn beside(first: (Effect, f64), second: Effect, more: f64) -> Rungs {
        Rungs {
            base: of(&[], 0.0),
            singles: vec![of(&[first.0], first.1), of(&[second], 0.0)],
            pairs: vec![of(&[first.0, second], first.1 + more)],
            unsteady: None,
            gain_step: None,
            samples: 100,
            temper: 1.0,
        }
    }

    fn needs_both(first: (Effect, f64), second: Effect, more: f64) -> bool {
        let rungs = beside(first, second, more);
        is_pair(&rungs.pairs[0], &rungs)
    }

    /// What the calibration's nulls reach, nats (`cargo xtask prove -- --split calibration`).
    #[test]
    fn what_nulls_reach_is_no_detection() {
        let reached = [
            (Effect::Relaxation, 2.4),
            (Effect::StiffSkin, 2.4),
            (Effect::Offset, 4.3),
        ];
        for (effect, most) in reached {
            let least = needed(&of(&[effect], 0.0).mechanisms[0]);
            assert!(least > 1.3 * most, "{}: {least}", effect.name());
        }
    }

    #[test]
    fn a_second_effect_must_add_more_than_the_first_ones_form_leaves() {
        use Effect::{Adhesion, Bone, CycleSoftening, Offset};
        use Effect::{RateIndependentLoss, Relaxation, Saturation, StiffeningLaw};
        assert!(
            needs_both((Relaxation, 100.0), Bone, 4.5),
            "its form is known"
        );
        assert!(!needs_both((Relaxation, 100.0), Bone, 3.5));
        assert!(
            !needs_both((CycleSoftening, 100.0), Bone, 5.0),
            "not so well"
        );
        assert!(
            !needs_both((Relaxation, 1000.0), Bone, 5.5),
            "0.6 % of 1000"
        );
        assert!(needs_both((Relaxation, 1000.0), Bone, 6.5));
        assert!(!needs_both((Adhesion, 1000.0), Bone, 9.0), "1 % of 1000");
        assert!(needs_both((Adhesion, 1000.0), Bone, 11.0));
        let apart = |more| needs_both((Adhesion, 60.0), Bone, more);
        assert!(!apart(7.2) && apart(8.5), "it acts apart");
        assert!(
            !needs_both((Saturation, 60.0), Bone, 8.0),
            "its form is not known"
        );
        assert!(needs_both((Saturation, 60.0), Bone, 11.0));
        assert!(needs_both((Adhesion, 60.0), Offset, 6.0));
        assert!(!needs_both((Adhesion, 600.0), Offset, 11.0), "9 % of 600");
        assert!(!needs_both((Relaxation, 400.0), Offset, 6.0), "2 % of 400");
        for law in [StiffeningLaw, CycleSoftening] {
            assert!(!needs_both((law, 100.0), Relaxation, 12.0), "13 % of 100");
            assert!(needs_both((law, 100.0), Relaxation, 14.0));
        }
        assert!(
            !needs_both((StiffeningLaw, 11.0), Bone, 12.0),
            "both elastic"
        );
        assert!(needs_both((StiffeningLaw, 11.0), Bone, 15.0));
        let softer = |more| needs_both((StiffeningLaw, 100.0), Bone, more);
        assert!(!softer(24.0) && softer(26.0), "25 % of 100");
        let friction = |more| needs_both((RateIndependentLoss, 300.0), CycleSoftening, more);
        assert!(!friction(11.0) && friction(13.0), "4 % of 300");
        let beside = |more| needs_both((RateIndependentLoss, 700.0), Bone, more);
        assert!(!beside(13.0) && beside(15.0), "2 % of 700");
    }

    #[test]
    fn names_are_kept_until_they_hold_nine_tenths_and_a_needless_pair_is_none() {
        let first = (Effect::Relaxation, 100.0);
        let needed = probabilities(&beside(first, Effect::Offset, 8.0));
        assert_eq!(needed[0].0, ["relaxation", "offset"]);
        assert!((needed.iter().map(|(_, p)| p).sum::<f64>() - 1.0).abs() < 1e-12);
        let odds = needed[0].1 / needed[1].1;
        assert!((odds / libm::exp(8.0) - 1.0).abs() < 1e-9, "{odds}");
        assert_eq!(names_90(&needed), [needed[0].0.clone()]);
        let needless = probabilities(&beside(first, Effect::Offset, 5.0));
        assert!(needless.iter().all(|(names, _)| names.len() < 2));
        let silent = probabilities(&beside((Effect::Relaxation, 4.0), Effect::Offset, 0.0));
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
