//! A free curve over depth, against which explanations are held: what it alone explains has no name on the list.

use thenar_contact::effects::Effect;

use crate::forward::surrogate::mechanism::{KNOTS, Law, Mechanism};
use crate::parameters::surrogate_priors::is_form_known;
use crate::selection::candidate_fits::Trial;
use crate::selection::scored::Scored;

/// The fit in which the stiffness in all recordings follows one free curve over depth, straight between its knots. None where the form of
/// the model itself is not known: there it may be the form that the curve shows.
pub(crate) fn depth_curve(trial: &Trial<'_>) -> Option<Scored> {
    let knots = (0..KNOTS).map(|knot| Mechanism {
        effect: Effect::StiffeningLaw,
        law: Law::DepthCurve { knot },
    });
    is_form_known(&trial.ready.elastic)
        .then(|| trial.score(&knots.collect::<Vec<_>>(), &trial.from))
}

/// By how much a curve that was fitted departs most from its mean, as the size of a logarithm of the stiffness.
pub fn largest_departure(curve: &Scored) -> f64 {
    let sizes = &curve.refit.at[curve.refit.at.len() - KNOTS..];
    let mean = sizes.iter().sum::<f64>() / KNOTS as f64;
    let each = sizes.iter().map(|size| (size - mean).abs());
    each.fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::checks::lack_of_fit::blocks;
    use crate::forward::surrogate::synthetic::{Reading, ready, tool};
    use crate::observe::measured::Phase;
    use crate::random::Random;
    use thenar_contact::Control;

    /// Fit of a curve to two presses by a flat punch, 10 N/mm to 2 mm, that is this much softer about 1.25 mm; noise of 20 mN.
    fn fitted(softer: f64) -> (f64, Scored) {
        let mut random = Random::new(5);
        let mut press = || -> (usize, Vec<Reading>) {
            let read = |k: u32| {
                let depth = f64::from(k) / 50.0;
                let hat = (1.0 - 4.0 * (depth - 1.25).abs()).max(0.0);
                let force = 10.0 * depth * libm::exp(-softer * hat) + 0.02 * random.normal();
                (depth, depth, Phase::Load, force)
            };
            (0, (1..=100).map(read).collect())
        };
        let recordings = [press(), press()];
        let (made, measured) = ready(vec![tool(2.0, |d| 10.0 * d, |_| 1.0)], &recordings, 0.02);
        let surrogate = made.surrogate();
        let mut trial = Trial {
            ready: &made,
            surrogate: &surrogate,
            blocks: blocks(&measured),
            from: Vec::new(),
            control: &Control::none(),
        };
        let base = trial.score(&[], &[]);
        trial.from.clone_from(&base.refit.at);
        let curve = depth_curve(&trial).expect("a known form");
        (0.5 * (base.refit.deviance - curve.refit.deviance), curve)
    }

    #[test]
    fn curve_departs_where_the_tissue_is_softer_and_nowhere_in_noise() {
        let (nats, curve) = fitted(0.05);
        let size = largest_departure(&curve);
        let sizes = &curve.refit.at[curve.refit.at.len() - KNOTS..];
        let softest = (0..KNOTS).min_by(|a, b| sizes[*a].total_cmp(&sizes[*b]));
        assert!(nats > 50.0 && softest == Some(4), "{nats} {sizes:?}");
        assert!((0.03..0.055).contains(&size), "{size}");
        let (nats, _) = fitted(0.0);
        assert!(nats < 10.0, "{nats}");
    }
}
