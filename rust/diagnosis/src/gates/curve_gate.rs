//! Gate for a misfit over depth: a free curve explains what no effect of the list does.

use crate::gates::pair_gates::is_pair;
use crate::wording::effect_in_words;
use thenar_inference::checks::depth_curve::largest_departure;
use thenar_inference::selection::scored::{Rungs, Scored};

/// Evidence of a free curve, nats, from which it is believed: where nothing is missing it reaches 6.7.
const BELIEVED: f64 = 10.0;
/// Part of it that a listed effect must reach to be what the curve shows: a true stiffening law reaches 0.79 and more, a stiff skin more than
/// all of it; a pocket that passes for one of these 0.64 at most, or all of a small one.
const REACHED: f64 = 0.7;
/// Part of it from which what comes nearest is suspected.
const NEAR: f64 = 0.5;
/// Smallest departure that is believed, as a logarithm: the model's own is 0.006 on flat skin.
const SMALLEST: f64 = 0.02;

/// That the stiffness follows a curve over depth which no listed effect gives, in words, and the names of what comes nearest where that reaches
/// half of it; None where an effect gives it, or there is none.
pub(crate) fn free_curve(rungs: &Rungs) -> Option<(String, Vec<&'static str>)> {
    let curve = rungs.depth_curve.as_ref()?;
    let size = largest_departure(curve);
    let all = rungs.singles.iter().chain(&rungs.pairs);
    let most = all.map(|s| s.qaic_gain).fold(0.0, f64::max);
    let is_believed = curve.qaic_gain > BELIEVED && most < REACHED * curve.qaic_gain;
    if !is_believed || size < SMALLEST {
        return None;
    }
    let pair = rungs.pairs.iter().find(|pair| is_pair(pair, rungs));
    let near = pair.or(rungs.singles.first());
    let near = near.filter(|near| near.qaic_gain > NEAR * curve.qaic_gain);
    let names = near.map(Scored::names).unwrap_or_default();
    let words: Vec<String> = names.iter().map(|name| effect_in_words(name)).collect();
    let nearest = match words.is_empty() {
        true => "nothing on the list has half of that".to_owned(),
        false => format!(
            "what comes nearest, {}, has {most:.0} at most",
            words.join(" and ")
        ),
    };
    let reason = format!(
        "recordings follow one curve over depth that no listed effect gives, by up to {:.0} % of the stiffness: its evidence is {:.0} nats, and \
         {nearest}",
        100.0 * libm::expm1(size),
        curve.qaic_gain,
    );
    Some((reason, names))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::synthetic_rungs::{rungs_beside, scored};
    use thenar_contact::effects::Effect::{Relaxation, StiffSkin};

    /// What is said of a curve of so much evidence that departs by so much, where a stiff skin has so much.
    fn said(nats: f64, departs: f64, skin: f64) -> Option<(String, Vec<&'static str>)> {
        let mut curve: Scored = scored(&[], nats);
        curve.refit.at = vec![0.3, 0.1, 0.0, 0.0, 0.0, -departs, 0.0, 0.0, 0.0];
        let rungs = Rungs {
            depth_curve: Some(curve),
            ..rungs_beside((StiffSkin, skin), Relaxation, 0.0)
        };
        free_curve(&rungs)
    }

    #[test]
    fn curve_that_an_effect_nearly_explains_is_left_to_it() {
        assert_eq!(said(100.0, 0.1, 71.0), None);
        let (words, suspected) = said(100.0, 0.1, 69.0).unwrap();
        assert!(
            words.contains("100 nats, and what comes nearest"),
            "{words}"
        );
        assert_eq!(suspected, ["stiff_skin"]);
        let (words, suspected) = said(100.0, 0.1, 20.0).unwrap();
        assert!(words.contains("nothing on the list has half"), "{words}");
        assert!(words.contains("by up to 9 % of the stiffness") && suspected.is_empty());
    }

    #[test]
    fn curve_within_noise_or_the_error_of_the_model_is_none() {
        assert_eq!(said(60.0, 0.01, 0.0), None);
        assert_eq!(said(9.0, 0.1, 0.0), None);
        assert!(said(11.0, 0.1, 0.0).is_some());
    }
}
