//! Rungs that tests state: candidates with a given score.

use nalgebra::DMatrix;
use thenar_contact::effects::Effect;

use thenar_inference::forward::surrogate::mechanism::{Mechanism, Scales};
use thenar_inference::least_squares::surrogate_fit::Refit;
use thenar_inference::selection::candidates::singles;
use thenar_inference::selection::scored::{LackOfFit, Rungs, Scored};

/// A candidate with these effects.
pub fn scored(effects: &[Effect], qaic_gain: f64) -> Scored {
    let tried = singles(Scales {
        deepest: 1.0,
        radius: 1.0,
        forces: (1.0, 1.0),
        has_bone: true,
        has_strain: true,
        carries_use: false,
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
        qaic_gain,
        lack_of_fit: LackOfFit::default(),
    }
}

/// One effect, another that shows nothing alone, and both with so much more evidence than the first.
pub fn rungs_beside(first: (Effect, f64), second: Effect, more: f64) -> Rungs {
    Rungs {
        base: scored(&[], 0.0),
        singles: vec![scored(&[first.0], first.1), scored(&[second], 0.0)],
        pairs: vec![scored(&[first.0, second], first.1 + more)],
        heteroscedasticity: None,
        short_waves: None,
        depth_curve: None,
        gain_step: None,
        samples: 100,
        overdispersion: 1.0,
    }
}
