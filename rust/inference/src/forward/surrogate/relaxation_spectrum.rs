//! Relaxation spectra: periods and shares of their branches.

use thenar_contact::effects::layer_drainage::NODES;

/// Branches of a load that fades, and what of them is free. Periods in s, or in s at the contact radius `reference_mm`, or in mm.
#[derive(Debug, Clone, PartialEq)]
pub enum Spectrum {
    /// Each share, of branches of these periods.
    Free(Vec<f64>),
    /// The same branches by the sum of their shares, and of each but the last the portion that it has of what those before it leave: the sum
    /// can be held while the others are fitted.
    Portions(Vec<f64>),
    /// The sum of the shares, the logarithm of the median period and the width: a normal law over the logarithm of the period.
    ///
    /// Free shares let one clock imitate another wherever the contact's size does not change much. Tissue loses its load by a
    /// smooth spectrum (Fung 1993, Biomechanics, 7.6), and so do layers that drain (Hu et al. 2010).
    Smooth {
        /// Smallest and largest width, in nats of the period.
        widths: (f64, f64),
    },
    /// The same spectrum by the logarithm of a period `at` so many widths from the median in place of the median's, so that this period can be
    /// held while the width is fitted.
    Beside {
        /// As of the smooth one.
        widths: (f64, f64),
        /// In widths.
        at: f64,
    },
}

impl Spectrum {
    /// Number of free numbers.
    pub fn count(&self) -> usize {
        match self {
            Spectrum::Free(periods) | Spectrum::Portions(periods) => periods.len(),
            Spectrum::Smooth { .. } | Spectrum::Beside { .. } => 3,
        }
    }

    /// Period and share of every branch for the free numbers.
    ///
    /// Branches of a smooth spectrum move with its median: on periods that stay, a narrow one would be now between two branches
    /// and now on one, and a fit would end between any two.
    pub(crate) fn branches(&self, numbers: &[f64]) -> Vec<(f64, f64)> {
        match (self, numbers) {
            (Spectrum::Free(periods), shares) => {
                let each = periods.iter().zip(shares);
                each.map(|(period, share)| (*period, *share)).collect()
            }
            (Spectrum::Portions(periods), [sum, portions @ ..]) => {
                let mut left = *sum;
                let mut one = |(k, period): (usize, &f64)| {
                    let share = left * portions.get(k).unwrap_or(&1.0);
                    left -= share;
                    (*period, share)
                };
                periods.iter().enumerate().map(&mut one).collect()
            }
            (Spectrum::Smooth { .. }, [sum, middle, width]) => {
                let all: f64 = NODES.iter().map(|(_, weight)| weight).sum();
                let branch =
                    |(z, weight): &(f64, f64)| (libm::exp(middle + width * z), sum * weight / all);
                NODES.iter().map(branch).collect()
            }
            (Spectrum::Beside { widths, at }, [sum, period, width]) => {
                let smooth = Spectrum::Smooth { widths: *widths };
                smooth.branches(&[*sum, period - width * at, *width])
            }
            (Spectrum::Smooth { .. } | Spectrum::Beside { .. } | Spectrum::Portions(_), _) => {
                Vec::new()
            }
        }
    }

    /// A smooth spectrum and its numbers by the period `at` so many widths from the median; None of another spectrum.
    pub(crate) fn beside(&self, at: f64, numbers: &[f64]) -> Option<(Spectrum, Vec<f64>)> {
        match (self, numbers) {
            (Spectrum::Smooth { widths }, [sum, middle, width]) => Some((
                Spectrum::Beside {
                    widths: *widths,
                    at,
                },
                vec![*sum, middle + width * at, *width],
            )),
            _ => None,
        }
    }

    /// Free shares as their sum and portions, with the numbers that are these shares; None of another spectrum.
    pub(crate) fn by_sum(&self, shares: &[f64]) -> Option<(Spectrum, Vec<f64>)> {
        let Spectrum::Free(periods) = self else {
            return None;
        };
        let mut left: f64 = shares.iter().sum();
        let mut numbers = vec![left];
        for share in &shares[..shares.len().saturating_sub(1)] {
            numbers.push(if left > 0.0 { share / left } else { 0.5 });
            left -= share;
        }
        Some((Spectrum::Portions(periods.clone()), numbers))
    }
}

/// Mean of the outer thirds of a normal law, in widths from its middle: the shortest and the longest of three time constants.
pub const OUTER: f64 = 1.090_8;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::forward::surrogate::mechanism::WIDTHS;

    fn smooth(numbers: [f64; 3]) -> Vec<(f64, f64)> {
        let widths = WIDTHS[0];
        Spectrum::Smooth { widths }.branches(&numbers)
    }

    #[test]
    fn log_normal_spectrum_has_its_moments() {
        let all = smooth([0.3, 0.7, 1.5]);
        let moment = |k: i32| -> f64 {
            let of = |(period, share): &(f64, f64)| share * (libm::log(*period) - 0.7).powi(k);
            all.iter().map(of).sum::<f64>() / 0.3
        };
        assert!((moment(0) - 1.0).abs() < 1e-12);
        assert!(moment(1).abs() < 1e-12);
        assert!((moment(2) / 1.5f64.powi(2) - 1.0).abs() < 1e-3);
        let free = Spectrum::Free(vec![2.0, 3.0]).branches(&[0.1, 0.2]);
        assert_eq!(free, [(2.0, 0.1), (3.0, 0.2)]);
    }

    #[test]
    fn smooth_spectrum_by_another_period_is_the_same() {
        let spectrum = Spectrum::Smooth { widths: WIDTHS[0] };
        for at in [-OUTER, OUTER] {
            let (beside, numbers) = spectrum.beside(at, &[0.3, 0.7, 1.5]).expect("smooth");
            assert!((numbers[1] - (0.7 + 1.5 * at)).abs() < 1e-15);
            for (one, other) in beside
                .branches(&numbers)
                .iter()
                .zip(smooth([0.3, 0.7, 1.5]))
            {
                assert!((one.0 / other.0 - 1.0).abs() < 1e-12 && one.1 == other.1);
            }
        }
    }

    #[test]
    fn sum_and_portions_are_the_same_branches() {
        let free = Spectrum::Free(vec![2.0, 3.0, 5.0]);
        for shares in [[0.1, 0.2, 0.05], [0.0, 0.0, 0.3], [0.4, 0.0, 0.0], [0.0; 3]] {
            let (by_sum, numbers) = free.by_sum(&shares).expect("free shares");
            assert!((numbers[0] - shares.iter().sum::<f64>()).abs() < 1e-15);
            let pairs = by_sum
                .branches(&numbers)
                .into_iter()
                .zip(free.branches(&shares));
            for ((period, share), (same, wanted)) in pairs {
                assert!(period == same && (share - wanted).abs() < 1e-15);
            }
        }
    }

    /// The load left of the widest spectrum is that of the normal law itself, integrated at steps forty times as fine.
    #[test]
    fn discrete_spectrum_approximates_the_log_normal_relaxation() {
        let (width, fine) = (WIDTHS[0].1, 2000);
        let all = smooth([1.0, 0.0, width]);
        for k in 0..=60 {
            let time = 1e-3 * libm::pow(1e6, f64::from(k) / 60.0);
            let ours: f64 = all.iter().map(|(t, s)| s * libm::exp(-time / t)).sum();
            let (mut law, mut whole) = (0.0, 0.0);
            for n in 0..=fine {
                let z = -6.0 + 12.0 * f64::from(n) / f64::from(fine);
                let weight = libm::exp(-0.5 * z * z);
                law += weight * libm::exp(-time / libm::exp(width * z));
                whole += weight;
            }
            assert!(
                (ours - law / whole).abs() < 0.03,
                "{time}: {ours} {}",
                law / whole
            );
        }
    }

    /// Hu, Zhao, Vlassak & Suo 2010: `g = 0.491 exp(-0.908 tau^0.5) + 0.509 exp(-1.679 tau)`.
    #[test]
    fn spectrum_contains_the_poroelastic_half_space() {
        let all = smooth([1.0, -0.367, WIDTHS[1].1]);
        for k in 0..=60 {
            let tau = 0.01 * libm::pow(3000.0, f64::from(k) / 60.0);
            let hu = 0.491 * libm::exp(-0.908 * tau.sqrt()) + 0.509 * libm::exp(-1.679 * tau);
            let ours: f64 = all.iter().map(|(t, s)| s * libm::exp(-tau / t)).sum();
            assert!((ours - hu).abs() < 0.026, "tau {tau}: {ours} {hu}");
        }
    }
}
