//! Where straight legs of a motion end: where their lines meet.

use crate::observe::motion::legs::{FEWEST, Leg};
use crate::observe::motion::line::{Line, Readings, is_straight};

/// Most rounds in which turning points are sought.
pub(crate) const ROUNDS: usize = 10;
/// Lead in BIC from which a smooth course shows that a leg is not straight: strong evidence (Kass and Raftery 1995, Journal of the American
/// Statistical Association 90:773). The course has the best of many strengths, so that on straight legs it often leads by less.
pub(crate) const CURVED: f64 = 6.0;

/// Legs that end where their lines meet, if both are straight then: readings beyond a turning point make a straight leg seem curved.
pub(crate) fn cut_where_straight(mut legs: Vec<Leg>, of: Readings<'_>) -> Vec<Leg> {
    for _ in 0..ROUNDS {
        let last = legs.clone();
        for k in 1..legs.len() {
            let (before, after) = (legs[k - 1], legs[k]);
            let Some(at) = meeting((before, after), of) else {
                continue;
            };
            let cut = [Leg { end: at, ..before }, Leg { start: at, ..after }];
            let is_line =
                |leg: &Leg| leg.end - leg.start < FEWEST || is_straight((*leg, CURVED), of);
            if cut.iter().all(is_line) {
                [legs[k - 1], legs[k]] = cut;
            }
        }
        if legs == last {
            break;
        }
    }
    legs
}

/// First reading after two legs' lines meet; None unless half of the fewest readings are left to each.
pub(crate) fn meeting((before, after): (Leg, Leg), of: Readings<'_>) -> Option<usize> {
    let (one, other) = (Line::through(before, of), Line::through(after, of));
    let meets = (one.height - other.height) / (other.speed - one.speed);
    let at = of.time.partition_point(|t| *t < meets);
    let is_within = before.start + FEWEST / 2 <= at && at + FEWEST / 2 <= after.end;
    (meets.is_finite() && is_within).then_some(at)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::observe::motion::legs::{EndStands, legs};
    use crate::random::Random;

    /// Readings at 10 Hz of a stand of 1 s, a ramp at 1 mm/s, a hold, a lift and a stand, with a jitter of 16 um: all legs are straight. Of 400
    /// legs few may seem curved by chance; where legs end at extremes of the readings, 28 do.
    #[test]
    fn noise_at_turning_points_curves_no_leg() {
        let path = |t: f64| (t - 1.1).clamp(-0.1, 0.9).min((0.5 * (7.3 - t)).max(-0.1));
        let time: Vec<f64> = (0..85).map(|k| 0.1 * f64::from(k)).collect();
        let (mut curved, mut all) = (0, 0);
        for seed in 1..81 {
            let mut random = Random::new(seed);
            let one = |t: &f64| path(*t) + 0.016 * random.normal();
            let depth: Vec<f64> = time.iter().map(one).collect();
            let legs = legs((&time, &depth), EndStands::Apart);
            let of = Readings::new((&time, &depth), (&legs, 0.0));
            let cut = cut_where_straight(legs, of);
            all += cut.len();
            curved += cut
                .iter()
                .filter(|leg| leg.end - leg.start >= FEWEST && !is_straight((**leg, CURVED), of))
                .count();
        }
        assert!(curved * 50 < all, "{curved} of {all}");
    }
}
