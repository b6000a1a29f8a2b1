//! Stiffness along a press, from its own readings.

use crate::observe::measured::Phase;
use crate::observe::protocol_phases::Stretch;

/// Stiffness by sample, N/mm: of a leg its own; of a hold or a slide that at the end of the leg before; none apart.
pub(crate) fn slopes(
    (time, depth, force): (&[f64], &[f64], &[f64]),
    stretches: &[Stretch],
) -> Vec<f64> {
    let mut slope = vec![0.0; time.len()];
    let mut last = 0.0;
    for stretch in stretches {
        let own = stretch.start..stretch.end;
        let way = depth[stretch.end - 1] - depth[stretch.start];
        match stretch.phase {
            Phase::Load | Phase::Unload if own.len() > 4 && way != 0.0 => {
                // Over a fifth of the leg, so that what is left of the noise does not count.
                let reach = (own.len() / 10).max(1);
                for k in own {
                    let a = k.saturating_sub(reach).max(stretch.start);
                    let b = (k + reach).min(stretch.end - 1);
                    let moved = depth[b] - depth[a];
                    let is_leg = moved * way > 0.0;
                    slope[k] = if is_leg {
                        ((force[b] - force[a]) / moved).max(0.0)
                    } else {
                        0.0
                    };
                }
                if stretch.phase == Phase::Load {
                    last = slope[stretch.end - 1];
                }
            }
            Phase::Hold | Phase::Slide => slope[own].fill(last),
            _ => {}
        }
    }
    slope
}
