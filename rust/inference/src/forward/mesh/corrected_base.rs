//! Forces of the contact model with effects, about a base force that is known: the effects are simulated, the form of the base is not.

use thenar_contact::{Control, Material};

use crate::errors::InferenceError;
use crate::forward::mesh::nuisance::Nuisance;
use crate::forward::mesh::replay::Replay;

/// Part of a recording's largest base force below which a moment gives no factor.
const LEAST_LOAD: f64 = 0.03;

/// A recording as the contact model is to follow it.
#[derive(Clone, Copy)]
pub(crate) struct Case<'a> {
    pub recording: usize,
    pub materials: &'a [Material],
    pub nuisance: &'a Nuisance,
}

impl Replay {
    /// What a recording's base is corrected by, by moment: a known force (N at the skin; NaN where none is) over the contact model's own
    /// without effects. Where either is small, the factor of the nearest moment at which it is not.
    ///
    /// # Errors
    /// What the contact model says of a press, or `Cancelled`.
    pub(crate) fn base_factors(
        &mut self,
        case: Case<'_>,
        known: &[f64],
        control: &Control<'_>,
    ) -> Result<Vec<f64>, InferenceError> {
        let at = (case.materials, case.nuisance);
        let base = self.look_up(case.recording, at, control)?;
        Ok(factors(known, &base.force))
    }

    /// Predictions for every sample of a recording with the effects that are switched on, of which the base was corrected.
    ///
    /// # Errors
    /// What the contact model says of a press or an effect, or `Cancelled`.
    pub(crate) fn predict_corrected(
        &mut self,
        case: Case<'_>,
        factors: &[f64],
        control: &Control<'_>,
    ) -> Result<Vec<f64>, InferenceError> {
        let at = (case.materials, case.nuisance);
        let mut at_skin = match self.remembers() {
            true => self.follow(case.recording, at, control)?,
            false => self.look_up(case.recording, at, control)?,
        };
        for (force, factor) in at_skin.force.iter_mut().zip(factors) {
            *force *= factor;
        }
        let bare = Nuisance {
            form: Nuisance::none().form,
            ..*case.nuisance
        };
        self.shown(case.recording, &bare, at_skin)
    }

    /// Index of the moment that each sample of a recording belongs to.
    pub(crate) fn moments_of_samples(&self, recording: usize) -> Vec<usize> {
        let samples = self.observed.measured[recording].samples.iter();
        samples.map(|s| s.moment as usize).collect()
    }

    /// Number of moments of a recording.
    pub(crate) fn moments(&self, recording: usize) -> usize {
        self.observed.measured[recording].moments.len()
    }
}

fn factors(known: &[f64], base: &[f64]) -> Vec<f64> {
    let most = base.iter().fold(0.0, |most, f| f64::max(most, f.abs()));
    let factor = |(known, base): (&f64, &f64)| {
        let is_loaded = *base > LEAST_LOAD * most && known.is_finite() && *known > 0.0;
        is_loaded.then(|| known / base)
    };
    let own: Vec<Option<f64>> = known.iter().zip(base).map(factor).collect();
    let near = |k: usize| {
        let before = (0..=k).rev().find_map(|j| own[j].map(|f| (k - j, f)));
        let after = (k..own.len()).find_map(|j| own[j].map(|f| (j - k, f)));
        match (before, after) {
            (Some(b), Some(a)) => match b.0 <= a.0 {
                true => b.1,
                false => a.1,
            },
            (one, other) => one.or(other).map_or(1.0, |(_, f)| f),
        }
    };
    (0..own.len()).map(near).collect()
}

#[cfg(test)]
mod tests {
    use super::factors;

    #[test]
    fn moments_without_load_take_the_factor_of_the_nearest_with_load() {
        let found = factors(
            &[f64::NAN, 0.0, 2.2, 3.6, f64::NAN, 0.0],
            &[0.0, 0.0, 2.0, 3.0, 3.0, 0.0],
        );
        let wanted = [1.1, 1.1, 1.1, 1.2, 1.2, 1.2];
        assert!(found.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 1e-12));
        assert_eq!(factors(&[f64::NAN], &[0.0]), [1.0]);
    }
}
