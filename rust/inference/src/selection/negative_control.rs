//! Negative control of the cross-validated gain: the finding's change on wrong recordings at wrong moments.

use crate::random::Random;

/// Draws, and the part of them that a gain must exceed.
const DRAWS: (usize, f64) = (199, 0.99);

/// A held-out recording, whitened.
#[derive(Debug, Clone)]
pub struct HeldOut {
    /// Number of its protocol.
    pub protocol: usize,
    /// Residuals of what is predicted without the finding.
    pub error: Vec<f64>,
    /// What the finding adds to that prediction.
    pub patch: Vec<f64>,
}

/// Sum of squared errors that a placebo takes off, at its 99th percentile.
///
/// In every draw the patches of the recordings change places and each begins anywhere; how much of them is taken is fitted to the
/// other protocols. Errors count for `most` standard deviations at most, as in the gain.
pub(crate) fn negative_control(all: &[HeldOut], most: f64, seed: u64) -> f64 {
    let mut random = Random::new(seed);
    let square = |x: f64| x.clamp(-most, most).powi(2);
    let mut removed: Vec<f64> = (0..DRAWS.0)
        .map(|_| {
            let patches = moved(all, &mut random);
            let sums: Vec<(f64, f64)> = all.iter().zip(&patches).map(sums).collect();
            let one = |(held_out, patch): (&HeldOut, &Vec<f64>)| -> f64 {
                let others = all.iter().zip(&sums);
                let others = others.filter(|(other, _)| other.protocol != held_out.protocol);
                let (over, under) = others.fold((0.0, 0.0), |(o, u), (_, s)| (o + s.0, u + s.1));
                let size = if under > 0.0 { over / under } else { 0.0 };
                let both = held_out.error.iter().zip(patch);
                both.map(|(e, p)| square(*e) - square(e - size * p)).sum()
            };
            all.iter().zip(&patches).map(one).sum()
        })
        .collect();
    removed.sort_by(f64::total_cmp);
    let at = (DRAWS.1 * removed.len() as f64) as usize;
    removed[at.min(removed.len() - 1)]
}

/// Products of a recording's error with a patch, and of the patch with itself.
fn sums((held_out, patch): (&HeldOut, &Vec<f64>)) -> (f64, f64) {
    let over = held_out.error.iter().zip(patch).map(|(e, p)| e * p).sum();
    (over, patch.iter().map(|p| p * p).sum())
}

/// Every recording's patch on another one, stretched to its length, from any moment on.
fn moved(all: &[HeldOut], random: &mut Random) -> Vec<Vec<f64>> {
    let mut below = |n: usize| ((random.uniform() * n as f64) as usize).min(n.saturating_sub(1));
    let mut order: Vec<usize> = (0..all.len()).collect();
    for k in (1..order.len()).rev() {
        order.swap(k, below(k + 1));
    }
    let onto = |(held_out, from): (&HeldOut, usize)| {
        let (patch, count) = (&all[from].patch, held_out.error.len());
        let start = below(count);
        let at = |k: usize| (k + start) % count * patch.len() / count;
        (0..count).map(|k| patch[at(k)]).collect()
    };
    all.iter().zip(order).map(onto).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn held_out(size: f64) -> Vec<HeldOut> {
        let mut random = Random::new(3);
        let mut noise = || (0..12).map(|_| random.uniform() - 0.5).sum::<f64>();
        let one = |protocol: usize| {
            let patch: Vec<f64> = (0..40)
                .map(|k| 3.0 * (-f64::from(k) / (4.0 + protocol as f64)).exp())
                .collect();
            let error = patch.iter().map(|p| size * p + noise()).collect();
            HeldOut {
                protocol,
                error,
                patch,
            }
        };
        (0..6).map(one).collect()
    }

    fn gained(all: &[HeldOut]) -> f64 {
        let one = |h: &HeldOut| -> f64 {
            let both = h.error.iter().zip(&h.patch);
            both.map(|(e, p)| e * e - (e - p).powi(2)).sum()
        };
        all.iter().map(one).sum()
    }

    #[test]
    fn planted_effect_exceeds_its_negative_control_and_noise_does_not() {
        let (there, not) = (held_out(1.0), held_out(0.0));
        assert!(gained(&there) > 2.0 * negative_control(&there, 8.0, 1).max(1.0));
        assert!(gained(&not) < negative_control(&not, 8.0, 1));
    }

    #[test]
    fn negative_control_is_deterministic_and_zero_for_one_protocol() {
        let mut all = held_out(1.0);
        assert_eq!(
            negative_control(&all, 8.0, 5),
            negative_control(&all, 8.0, 5)
        );
        all.iter_mut().for_each(|h| h.protocol = 0);
        assert_eq!(negative_control(&all, 8.0, 5), 0.0);
    }
}
