//! Gate for a misfit over depth: a free curve explains what no effect of the list does.

use thenar_inference::checks::depth_curve::largest_departure;
use thenar_inference::selection::scored::Rungs;

/// Evidence of a free curve, nats, from which it is believed: where nothing is missing it reaches 6.7.
const BELIEVED: f64 = 10.0;
/// Part of it that a listed effect must reach to be what the curve shows: a true stiffening law reaches 0.79 and more, a stiff skin more than
/// all of it; a pocket that passes for one of these 0.64 at most, or all of a small one.
const REACHED: f64 = 0.7;
/// Smallest departure that is believed, as a logarithm: the model's own is 0.006 on flat skin.
const SMALLEST: f64 = 0.02;

/// That the stiffness follows a curve over depth which no listed effect gives, in words; None where one does, or there is none. `deepest_mm`
/// is the study's largest depth.
pub(crate) fn free_curve(rungs: &Rungs, deepest_mm: f64) -> Option<String> {
    let curve = rungs.depth_curve.as_ref()?;
    let (share, size) = largest_departure(curve);
    let all = rungs.singles.iter().chain(&rungs.pairs);
    let best = all.map(|s| s.qaic_gain).fold(0.0, f64::max);
    let is_believed = curve.qaic_gain > BELIEVED && best < REACHED * curve.qaic_gain;
    (is_believed && size.abs() > SMALLEST).then(|| {
        format!(
            "all recordings follow one curve over depth, {:.0} % {} than elsewhere at {:.2} mm, which explains far more than any listed effect \
             ({:.0} nats, {:.0} at most)",
            100.0 * libm::expm1(size).abs(),
            if size < 0.0 { "softer" } else { "stiffer" },
            share * deepest_mm,
            curve.qaic_gain,
            best
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::synthetic_rungs::{rungs_beside, scored};
    use thenar_contact::effects::Effect::{Relaxation, StiffSkin};
    use thenar_inference::selection::scored::Scored;

    /// What is said of a curve of so much evidence that is softer by this at half of 2 mm, where the best effect has 20 nats.
    fn said(nats: f64, softer: f64) -> Option<String> {
        let mut curve: Scored = scored(&[], nats);
        curve.refit.at = vec![0.3, 0.1, 0.0, 0.0, 0.0, -softer, 0.0, 0.0, 0.0];
        let rungs = Rungs {
            depth_curve: Some(curve),
            ..rungs_beside((StiffSkin, 20.0), Relaxation, 0.0)
        };
        free_curve(&rungs, 2.0)
    }

    #[test]
    fn curve_that_an_effect_nearly_explains_is_left_to_it() {
        assert_eq!(said(27.0, 0.1), None);
        let words = said(60.0, 0.1).unwrap();
        assert!(
            words.contains("8 % softer than elsewhere at 1.00 mm"),
            "{words}"
        );
        assert!(words.contains("60 nats, 20 at most"), "{words}");
    }

    #[test]
    fn curve_within_the_error_of_the_model_is_none() {
        assert_eq!(said(60.0, 0.01), None);
    }
}
