//! Fitted candidates with their QAIC scores, and the rungs of the model ladder.

use thenar_contact::effects::Effect;

use crate::checks::gain_step::GainStep;
use crate::checks::heteroscedasticity::Heteroscedasticity;
use crate::checks::short_waves::ShortWaves;
use crate::forward::surrogate::mechanism::Mechanism;
use crate::least_squares::surrogate_fit::Refit;

/// A hypothesis that was fitted.
#[derive(Debug, Clone)]
pub struct Scored {
    /// What it adds to the base; nothing for the base itself.
    pub mechanisms: Vec<Mechanism>,
    /// Its fit.
    pub refit: Refit,
    /// Minus half the QAIC difference to the base, nats: half the fall of the deviance over the overdispersion, less 1 per parameter.
    pub qaic_gain: f64,
    /// Lack of fit.
    pub lack_of_fit: LackOfFit,
}

/// Sum of squares common to repeats, beyond pure error, in variances of the noise.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct LackOfFit {
    /// Over all parts of all phases.
    pub all: f64,
    /// Without the part that adds most: readings that are astray in two repeats may meet in one.
    pub less_largest: f64,
}

impl Scored {
    /// Names, in the catalogue's order, each once.
    pub fn names(&self) -> Vec<&'static str> {
        let mut effects: Vec<Effect> = self.mechanisms.iter().map(|m| m.effect).collect();
        effects.sort_unstable();
        effects.dedup();
        effects.into_iter().map(Effect::name).collect()
    }
}

/// What every rung found.
pub struct Rungs {
    /// The base.
    pub base: Scored,
    /// One mechanism each, the best variant of every name, best first.
    pub singles: Vec<Scored>,
    /// Two mechanisms, best first; empty where one suffices.
    pub pairs: Vec<Scored>,
    /// How repeats deviate under load and without.
    pub heteroscedasticity: Option<Heteroscedasticity>,
    /// Short waves that repeats share; None where too little was recorded twice.
    pub short_waves: Option<ShortWaves>,
    /// What one free curve over depth explains; None where the form of the model is not known.
    pub depth_curve: Option<Scored>,
    /// The clearest step of the session's gain.
    pub gain_step: Option<GainStep>,
    /// Number of screened samples.
    pub samples: usize,
    /// Overdispersion (c-hat): deviance per sample of the best model, 1 at least; deviances are divided by it.
    pub overdispersion: f64,
}
