//! Profile likelihood of a candidate's own parameters: values that the recordings so far leave open.

use crate::forward::surrogate::candidate_model::Model;
use crate::forward::surrogate::surrogate_data::Surrogate;
use crate::least_squares::surrogate_fit::refit;
use crate::selection::scored::Scored;

/// Standard errors at which a number is held.
const FIXED_AT: [f64; 4] = [-2.0, -1.0, 1.0, 2.0];

/// Coordinates that an explanation may have.
pub struct ProfilePoint {
    /// Of the model that has nothing but the explanation's mechanisms.
    pub at: Vec<f64>,
    /// How probable they are beside the others; all add up to 1.
    pub share: f64,
}

/// The optimum of an explanation first, and its fits with one of its mechanisms' numbers held beside it; `overdispersion`: what deviances are divided
/// by. Standard errors are of the optimum's neighborhood, so that a number of which little is known is held at its bounds; how probable
/// it is there says the fit.
pub fn profile(surrogate: &Surrogate<'_>, of: &Scored, overdispersion: f64) -> Vec<ProfilePoint> {
    let mut model = Model::new(surrogate, &of.mechanisms);
    let best = &of.refit;
    let mut found = vec![(best.at.clone(), 0.0)];
    for number in surrogate.shared.len()..model.coordinates.len() {
        let bounds = model.coordinates[number].bounds;
        let error = best.covariance[(number, number)].max(0.0).sqrt();
        let fixed = FIXED_AT.map(|step| (best.at[number] + step * error).clamp(bounds.0, bounds.1));
        let mut fixed: Vec<f64> = fixed
            .into_iter()
            .filter(|x| *x != best.at[number])
            .collect();
        fixed.dedup();
        for value in fixed {
            model.coordinates[number].bounds = (value, value);
            let other = refit(surrogate, &model, &best.at);
            found.push((other.at, (other.deviance - best.deviance) / overdispersion));
        }
        model.coordinates[number].bounds = bounds;
    }
    let weigh = |more: f64| libm::exp(-0.5 * more.max(0.0));
    let sum: f64 = found.iter().map(|(_, more)| weigh(*more)).sum();
    let one = |(at, more): (Vec<f64>, f64)| ProfilePoint {
        at,
        share: weigh(more) / sum,
    };
    found.into_iter().map(one).collect()
}

#[cfg(test)]
mod tests {
    use crate::selection::scored::LackOfFit;
    use thenar_contact::effects::Effect;

    use super::*;
    use crate::forward::surrogate::mechanism::{Law, Mechanism};
    use crate::forward::surrogate::synthetic::{Reading, ready, tool};
    use crate::observe::measured::Phase;

    const SIGMA_N: f64 = 0.05;

    /// A flat punch of 10 N/mm, read with an offset.
    fn offset(offset_n: f64) -> Vec<Reading> {
        let read = |k: u32| {
            let depth = f64::from(k) / 40.0;
            (depth, depth, Phase::Load, 10.0 * depth + offset_n)
        };
        (0..=80).map(read).collect()
    }

    fn asked(reading: Vec<Reading>, overdispersion: f64) -> (Scored, Vec<ProfilePoint>) {
        let punch = tool(2.0, |depth| 10.0 * depth, |_| 1.0);
        let (ready, _) = ready(vec![punch], &[(0, reading)], SIGMA_N);
        let surrogate = ready.surrogate();
        let mechanisms = vec![Mechanism {
            effect: Effect::Offset,
            law: Law::Offset,
        }];
        let of = Scored {
            refit: refit(&surrogate, &Model::new(&surrogate, &mechanisms), &[]),
            mechanisms,
            qaic_gain: 0.0,
            lack_of_fit: LackOfFit::default(),
        };
        let all = profile(&surrogate, &of, overdispersion);
        (of, all)
    }

    /// An offset adds to the force and to nothing else, so that its law is a normal one: exp(-1/2) at one standard error, exp(-2) at two.
    #[test]
    fn profile_weights_of_a_linear_parameter_are_gaussian() {
        for overdispersion in [1.0, 4.0] {
            let (of, all) = asked(offset(0.3), overdispersion);
            let last = of.refit.at.len() - 1;
            let error = of.refit.covariance[(last, last)].sqrt();
            assert!((all.iter().map(|one| one.share).sum::<f64>() - 1.0).abs() < 1e-12);
            for (one, step) in all[1..].iter().zip(FIXED_AT) {
                assert!((one.at[last] - of.refit.at[last] - step * error).abs() < 1e-12);
                let over = libm::log(one.share / all[0].share) * overdispersion;
                assert!((over + 0.5 * step * step).abs() < 0.05, "{step}: {over}");
                // The moduli make up for it as far as they can.
                assert!((one.at[0] - of.refit.at[0]).signum() == -step.signum());
            }
        }
    }

    /// The largest offset that is tried is 0.3 of the largest force: beyond it none is.
    #[test]
    fn profile_points_stay_within_bounds() {
        let (of, all) = asked(offset(50.0), 1.0);
        let last = of.refit.at.len() - 1;
        assert!(all.len() < FIXED_AT.len() + 1, "{}", all.len());
        assert!(all.iter().all(|one| one.at[last] <= 0.3 * 70.0));
    }
}
