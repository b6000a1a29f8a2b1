//! Evidence of what was fitted where the form of the model may be off by as much as it was measured to be.

use crate::checks::lack_of_fit::blocks;
use crate::forward::surrogate::candidate_model::Model;
use crate::forward::surrogate::mechanism::Mechanism;
use crate::forward::surrogate::prepared_study::PreparedStudy;
use crate::forward::surrogate::surrogate_data::Surrogate;
use crate::least_squares::surrogate_fit::{Refit, refit};
use crate::observe::measured::Measured;
use crate::parameters::surrogate_priors::with_measured_form;
use crate::selection::candidate_fits::lack_of_fit;
use crate::selection::ladder::PENALTY;
use crate::selection::scored::{LackOfFit, Rungs, Scored};

/// The base of a study, fitted again with the form of the model free.
pub struct FormCheck<'a> {
    surrogate: Surrogate<'a>,
    /// Number of coordinates that fits of the ladder share.
    shared: usize,
    samples: f64,
    base: Refit,
    lack_of_fit: LackOfFit,
}

impl<'a> FormCheck<'a> {
    /// None on flat skin, whose form is known, and on a half space.
    pub fn new(
        ready: &'a PreparedStudy,
        measured: &[Measured],
        rungs: &Rungs,
    ) -> Option<FormCheck<'a>> {
        let surrogate = Surrogate {
            shared: with_measured_form(&ready.shared, &ready.elastic)?,
            ..ready.surrogate()
        };
        let model = Model::new(&surrogate, &[]);
        let fits = [&rungs.base.refit.at[..], &[]].map(|from| refit(&surrogate, &model, from));
        let base = fits.into_iter().reduce(lower)?;
        Some(FormCheck {
            lack_of_fit: lack_of_fit(&surrogate, &base.residual, &blocks(measured)),
            shared: ready.shared.len(),
            samples: rungs.samples.max(1) as f64,
            surrogate,
            base,
        })
    }

    /// Evidence of an explanation, nats, where it and the base may both be off by the form: what the form can feign, it does not count.
    pub fn evidence(&self, scored: &Scored) -> f64 {
        let model = Model::new(&self.surrogate, &scored.mechanisms);
        let (known, own) = scored.refit.at.split_at(self.shared);
        let free = vec![0.0; self.base.at.len() - known.len()];
        let starts = [
            [known, &free, own].concat(),
            [&self.base.at[..], own].concat(),
        ];
        let fits = starts.map(|from| refit(&self.surrogate, &model, &from));
        let [one, other] = fits.map(|fit| fit.deviance);
        let deviance = one.min(other);
        let overdispersion = (deviance / self.samples).max(1.0);
        let numbers: usize = scored
            .mechanisms
            .iter()
            .map(Mechanism::effective_parameters)
            .sum();
        0.5 * (self.base.deviance - deviance) / overdispersion - PENALTY * numbers as f64
    }

    /// The study's surrogate with the form free.
    pub(crate) fn surrogate(&self) -> &Surrogate<'a> {
        &self.surrogate
    }

    /// Coherent misfit per sample that parameters and form leave, without the largest part, in variances of the noise.
    pub fn left(&self) -> f64 {
        self.lack_of_fit.less_largest / self.samples
    }
}

/// The one that fits better.
fn lower(one: Refit, other: Refit) -> Refit {
    match other.deviance < one.deviance {
        true => other,
        false => one,
    }
}

#[cfg(test)]
mod tests {
    use thenar_contact::Control;
    use thenar_contact::effects::Effect;

    use super::*;
    use crate::forward::surrogate::synthetic::{Reading, ready, tool};
    use crate::observe::measured::Phase;
    use crate::parameters::surrogate_priors::of_place;
    use crate::selection::candidate_fits::Trial;
    use crate::selection::candidates::singles;

    /// Forces of two balls pressed to 1 mm and held: what is left of a load after so many seconds of the hold is up to the second argument, and
    /// the first is a factor over depth.
    fn evidence(form: &dyn Fn(f64) -> f64, left: &dyn Fn(f64) -> f64, effect: Effect) -> [f64; 2] {
        let ball = |radius: f64| move |d: f64| 5.0 * radius.sqrt() * d * d.sqrt();
        let readings = |radius: f64| -> Vec<Reading> {
            let read = |k: u32| {
                let time = f64::from(k) / 40.0;
                let depth = time.min(1.0);
                let force = ball(radius)(depth) * form(depth) * left((time - 1.0).max(0.0));
                (time, depth, Phase::Load, force)
            };
            (0..=120).map(read).collect()
        };
        let radii = [4.0, 9.0];
        let tools = radii.map(|r| tool(1.0, ball(r), move |d| (r * d).sqrt()));
        let recordings = [0, 1].map(|k| (k, readings(radii[k])));
        let (mut made, measured) = ready(tools.into(), &recordings, 0.02);
        made.elastic.is_flat = false;
        let touch = |k| of_place(k, (1e-3, 1.0), ([0.0; 7], false));
        made.shared.extend([0, 1].into_iter().flat_map(touch));
        let surrogate = made.surrogate();
        let trial = Trial {
            ready: &made,
            surrogate: &surrogate,
            blocks: blocks(&measured),
            from: Vec::new(),
            control: &Control::none(),
        };
        let base = trial.score(&[], &[]);
        let trial = Trial {
            from: base.refit.at.clone(),
            ..trial
        };
        let tried = singles(made.scales)
            .into_iter()
            .filter(|m| m.effect == effect);
        let mut best = tried
            .map(|m| trial.single(&m))
            .min_by(|a, b| a.refit.deviance.total_cmp(&b.refit.deviance))
            .expect("a candidate");
        best.qaic_gain = 0.5 * (base.refit.deviance - best.refit.deviance);
        let rungs = Rungs {
            base,
            singles: Vec::new(),
            pairs: Vec::new(),
            heteroscedasticity: None,
            short_waves: None,
            depth_curve: None,
            gain_step: None,
            samples: made.values.len(),
            overdispersion: 1.0,
        };
        let check = FormCheck::new(&made, &measured, &rungs).expect("round skin");
        [best.qaic_gain, check.evidence(&best)]
    }

    /// A narrow bone bends the curves of all tools as a stiffening law does.
    #[test]
    fn what_the_form_can_feign_is_no_evidence() {
        let bone = |d: f64| libm::exp(-0.1 * (2.0 * d - 1.0) + 0.06 * (6.0 * d * (d - 1.0) + 1.0));
        let [fitted, beyond] = evidence(&bone, &|_| 1.0, Effect::StiffeningLaw);
        assert!(fitted > 20.0 && beyond < 3.0, "{fitted} {beyond}");
    }

    /// What fades in a hold is seen at one depth, which no form explains.
    #[test]
    fn what_the_form_cannot_feign_keeps_its_evidence() {
        let fades = |time: f64| 1.0 - 0.2 * (1.0 - libm::exp(-time / 0.5));
        let [fitted, beyond] = evidence(&|_| 1.0, &fades, Effect::Relaxation);
        assert!(fitted > 20.0 && beyond > 0.7 * fitted, "{fitted} {beyond}");
    }
}
