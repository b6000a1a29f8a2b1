//! Parameters of effects that a mesh fit may change, and the estimates of them.

use thenar_contact::ActiveEffect;

use crate::fit::result::Fit;
use crate::parameters::parameter::{Kind, Parameter, Scale};

/// Step of a finite difference: of a logarithm, and of the bounds' distance.
const STEP: (f64, f64) = (0.05, 0.02);

/// A number of an effect that a fit may change, from where [`Options::effects`](crate::Options::effects) has it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Free {
    /// Number of the effect in the options.
    pub effect: usize,
    /// Number of its shape number; None: its amplitude.
    pub number: Option<usize>,
    /// Smallest and largest value. Above 0, steps are those of the logarithm.
    pub bounds: (f64, f64),
}

/// What a fit found for a free number.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Found {
    /// The estimate.
    pub value: f64,
    /// Lower end of the 90 % interval.
    pub low: f64,
    /// Upper end of it.
    pub high: f64,
    /// True if the estimate lies on a bound.
    pub is_at_bound: bool,
}

/// A fit with the effects as it left them.
#[derive(Debug, Clone)]
pub struct EffectFit {
    /// The fit.
    pub fit: Fit,
    /// The effects at the estimates.
    pub effects: Vec<ActiveEffect>,
    /// One for each free number.
    pub found: Vec<Found>,
    /// Sum of Huber's function (threshold 3) over whitened residuals and priors: minus twice the logarithm of the posterior density, but
    /// for a constant that is the same for all effects of one study and choice of recordings.
    pub deviance: f64,
}

/// The parameters of free numbers.
pub(crate) fn free_parameters(free: &[Free], effects: &[ActiveEffect]) -> Vec<Parameter> {
    free.iter()
        .map(|free| parameter(free, &effects[free.effect]))
        .collect()
}

fn parameter(free: &Free, effect: &ActiveEffect) -> Parameter {
    let (low, high) = free.bounds;
    let start = match free.number {
        None => effect.amplitude,
        Some(number) => effect.shape[number],
    };
    let start = start.clamp(low, high);
    let (scale, move_by): (Scale, fn(f64) -> f64) = match low > 0.0 {
        true => (Scale::Logarithm, libm::log),
        false => (Scale::Plain, |x| x),
    };
    Parameter {
        kind: Kind::Effect(free.effect, free.number, scale),
        start: move_by(start),
        bounds: (move_by(low), move_by(high)),
        prior: None,
        step: match scale {
            Scale::Logarithm => STEP.0,
            Scale::Plain => STEP.1 * (high - low),
        },
    }
}

/// The effects with their free numbers at a place.
pub(crate) fn effects_at(
    effects: &[ActiveEffect],
    (parameters, at): (&[Parameter], &[f64]),
) -> Vec<ActiveEffect> {
    let mut effects = effects.to_vec();
    for (parameter, at) in parameters.iter().zip(at) {
        if let Kind::Effect(effect, number, _) = parameter.kind {
            let value = parameter.value(*at);
            match number {
                None => effects[effect].amplitude = value,
                Some(number) => effects[effect].shape[number] = value,
            }
        }
    }
    effects
}
