//! Akaike weights of stated rungs: of pairs that count, and of effects that show nothing.

use crate::synthetic_rungs;

use synthetic_rungs::rungs_beside;
use thenar_contact::effects::Effect;
use thenar_inference::selection::model_weights::{names_90, probabilities};
use thenar_inference::selection::scored::{Rungs, Scored};

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
