//! Laws of tissue effects in the surrogate: relaxation and drainage, adhesion, softening by use.

use thenar_contact::effects::layer_drainage::{NARROWS, growth};

use crate::forward::surrogate::candidate_model::{Model, Setting};
use crate::forward::surrogate::force_recording::ForceRecording;
use crate::forward::surrogate::mechanism::{Clock, Law};
use crate::forward::surrogate::relaxation_spectrum::Spectrum;
use crate::forward::surrogate::relaxing_springs::branch_decay;
use crate::forward::surrogate::surrogate_data::Surrogate;
use crate::forward::tables::elastic_table::radius;

/// Way over which skin lets go, over the largest depth.
const RELEASE: f64 = 0.08;

impl Surrogate<'_> {
    /// Every branch of every mechanism that fades: its decay over each row's step, and its share.
    ///
    /// What drains leaves tissue that gives up volume, and that matters the more, the larger the contact is against the thickness: the
    /// share of drainage is in proportion to what compressibility takes from the tool's force. How its times go with the contact's size is
    /// the contact model's own law (`layer_drainage`); against finite elements of pads that the trial does not use the whole leaves 0.04 to
    /// 0.11 % of the load, a power of 1.5 at every share 0.07 to 0.32 %, and a clock that does not ask for the contact's size 0.28 to 0.72 %
    /// (`python -m trial.finite_elements.against_drainage`).
    pub(crate) fn relaxation_branches(
        &self,
        model: &Model<'_>,
        set: &Setting,
        (one, depths): (&ForceRecording, &[f64]),
    ) -> (Vec<Vec<(f64, f64)>>, Vec<f64>) {
        let (mut relaxation_branches, mut shares) = (Vec::new(), Vec::new());
        for (number, mechanism) in model.mechanisms.iter().enumerate() {
            let Law::Relaxation { clock, spectrum } = &mechanism.law else {
                continue;
            };
            let factor = match clock {
                Clock::Area { .. } => self.elastic.drained[one.place],
                _ => 1.0,
            };
            let numbers = self.at_place((*clock, spectrum), (one, &set.of[number]));
            let steps = self.clocked((*clock, &numbers), (one, depths));
            for (period, share) in spectrum.branches(&numbers) {
                let over: Vec<f64> = steps.iter().map(|s| s / period).collect();
                relaxation_branches.push(branch_decay(&over));
                shares.push((share * factor).min(0.95));
            }
        }
        (relaxation_branches, shares)
    }

    /// A spectrum's free numbers as they are under a recording's tool: what drains has a width of its own at every size of contact.
    fn at_place(
        &self,
        (clock, spectrum): (Clock, &Spectrum),
        (one, numbers): (&ForceRecording, &[f64]),
    ) -> Vec<f64> {
        let mut numbers = numbers.to_vec();
        if let (Clock::Area { reference_mm }, Spectrum::Smooth { widths }) = (clock, spectrum) {
            let size = radius(&self.elastic.places[one.place], self.most.1) / reference_mm;
            numbers[2] = narrowed(numbers[2], size).max(widths.0);
        }
        numbers
    }

    /// By how much a clock goes on over each row's step; none over the first.
    fn clocked(
        &self,
        (clock, numbers): (Clock, &[f64]),
        (one, depths): (&ForceRecording, &[f64]),
    ) -> Vec<f64> {
        let table = &self.elastic.places[one.place];
        let step = |n: usize| {
            let seconds = one.rows[n].time_s - one.rows[n - 1].time_s;
            match clock {
                Clock::Time => seconds,
                Clock::Travel => (depths[n].max(0.0) - depths[n - 1].max(0.0)).abs(),
                Clock::Area { reference_mm } => {
                    let middle = 0.5 * (depths[n].max(0.0) + depths[n - 1].max(0.0));
                    let (least, grows) = (0.1 * reference_mm, growth(numbers[0]));
                    seconds * (reference_mm / radius(table, middle).max(least)).powf(grows)
                }
            }
        };
        (0..depths.len())
            .map(|n| if n == 0 { 0.0 } else { step(n) })
            .collect()
    }

    /// What skin that clings takes off.
    ///
    /// A grip that does not change the contact's shape pulls by what its traction adds up to over the gap about the contact
    /// (Derjaguin, Muller & Toporov 1975), and that does not ask how deep the tool still is. It is only where the skin has touched:
    /// the pull builds up as the gap at the rim of the largest contact opens, by the work done as far as that (`spanned`), and ends
    /// where the skin lets go. Larger tools lift the skin further: by the third root of their radius (Johnson 1985, 5.5).
    pub(crate) fn adhere(
        &self,
        model: &Model<'_>,
        set: &Setting,
        ((one, depths), forces): ((&ForceRecording, &[f64]), &mut [f64]),
    ) {
        let area = |place: usize| radius(&self.elastic.places[place], self.most.1).powi(2);
        let most = (0..self.elastic.studied)
            .map(area)
            .fold(f64::MIN_POSITIVE, f64::max);
        for (number, mechanism) in model.mechanisms.iter().enumerate() {
            let Law::Adhesion { lets_go } = mechanism.law else {
                continue;
            };
            let size = area(one.place) / most;
            let pull = set.of[number][0] * self.most.0 * size;
            let range = libm::exp(set.of[number][1]) * self.most.1;
            let lets_go = if lets_go < 0.0 {
                lets_go * libm::cbrt(size)
            } else {
                lets_go
            };
            let mut touched = 0.0;
            for (depth, force) in depths.iter().zip(forces.iter_mut()) {
                let over = ((depth / self.most.1 - lets_go) / RELEASE).clamp(0.0, 1.0);
                touched = match over > 0.0 {
                    true => f64::max(touched, *depth),
                    false => 0.0,
                };
                *force -= pull * over * spanned(gap(touched, *depth) / range);
            }
        }
    }

    /// Stiffness that use took away.
    pub(crate) fn soften_by_use(
        &self,
        model: &Model<'_>,
        set: &Setting,
        ((one, depths), forces): ((&ForceRecording, &[f64]), &mut [f64]),
    ) {
        for (number, mechanism) in model.mechanisms.iter().enumerate() {
            let Law::Softening {
                travel_mm,
                recovery_s,
                start,
            } = mechanism.law
            else {
                continue;
            };
            let share = set.of[number][0];
            let before = 1.0 - libm::exp(-one.travel_before(start) / travel_mm);
            let (mut used, mut last, mut time) = (before, 0.0, one.rows[0].time_s);
            for (n, force) in forces.iter_mut().enumerate() {
                let depth = depths[n].max(0.0);
                if depth <= 0.0 {
                    used *= libm::exp(-(one.rows[n].time_s - time) / recovery_s);
                }
                used = 1.0 - (1.0 - used) * libm::exp(-(depth - last).max(0.0) / travel_mm);
                (last, time) = (depth, one.rows[n].time_s);
                *force *= 1.0 - share * used;
            }
        }
    }
}

/// Width of drainage's spectrum under a contact, from that under one smaller by the factor `size`.
fn narrowed(width: f64, size: f64) -> f64 {
    width - NARROWS * libm::log(size.max(1e-3))
}

/// Gap at the rim of the contact that a round tool had at the depth `most`, now that it is at `depth`, mm (Johnson 1985, Eq. 3.42a, for
/// a sphere on a half space); none where it did not touch.
fn gap(most: f64, depth: f64) -> f64 {
    if most <= 0.0 || depth >= most {
        return 0.0;
    }
    let t = (depth / most).max(0.0);
    let open = (t * (1.0 - t)).sqrt() + (1.0 - 2.0 * t) * libm::acos(t.sqrt());
    most / std::f64::consts::PI * open + (-depth).max(0.0)
}

/// Part of a grip's work that is done when a gap has opened by this part of its range: its traction rises evenly up to [`PEAK`] and
/// falls evenly to none at the range (Geubelle & Baylor 1998); rough skin does not pull all at once.
fn spanned(gap: f64) -> f64 {
    match gap < PEAK {
        true => gap * gap / PEAK,
        false => 1.0 - (1.0 - gap.min(1.0)).powi(2) / (1.0 - PEAK),
    }
}

/// Part of a grip's range at which its traction is largest.
const PEAK: f64 = 0.25;
/// Range of the effect `adhesion`, whose traction only falls, over that of a grip with the same work at the same mean gap: of two
/// triangles over the gap, a third of the sum of their corners.
pub const RAMP: f64 = 1.0 + PEAK;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::forward::surrogate::mechanism::Mechanism;
    use crate::forward::surrogate::synthetic::{Reading, ready, tool};
    use crate::observe::measured::Phase;
    use thenar_contact::effects::Effect;

    /// Against the gap itself: Hertz's displacement outside the contact (Johnson 1985, Eq. 3.42a) beside a sphere, with numbers.
    #[test]
    fn rim_gap_equals_hertz_displacement() {
        let (radius, most) = (9.0f64, 0.8f64);
        let rim = (radius * most).sqrt();
        for depth in [0.79f64, 0.6, 0.3, 0.05] {
            let a = (radius * depth).sqrt();
            let turned = libm::asin(a / rim);
            let sunk = ((2.0 * a * a - rim * rim) * turned
                + rim * a * (1.0 - (a / rim).powi(2)).sqrt())
                / (std::f64::consts::PI * radius);
            let wanted = rim * rim / (2.0 * radius) - depth + sunk;
            let found = gap(most, depth);
            assert!(
                (found - wanted).abs() < 1e-9 * most,
                "{depth}: {found} {wanted}"
            );
        }
        assert!((gap(most, 0.0) - 0.5 * most).abs() < 1e-12);
        assert!((gap(most, -0.1) - 0.5 * most - 0.1).abs() < 1e-12);
        assert_eq!([gap(most, most), gap(0.0, -0.1)], [0.0, 0.0]);
    }

    /// Finite elements of the calibration's forefinger under spheres whose contacts are 1.48 and 2.37 times as wide as the smallest
    /// (`tests/trial/finite_elements/against_drainage.py`, amplitude 0.25): times go from 2.9 to 5.2 and 10.7 s, widths from 1.51 to 1.31 and 1.18.
    #[test]
    fn drainage_time_and_width_follow_contact_radius() {
        for (size, time_s, width) in [(1.48f64, 5.2, 1.31), (2.37, 10.7, 1.18)] {
            assert!((2.9 * size.powf(growth(0.14)) / time_s - 1.0).abs() < 0.1);
            assert!((narrowed(1.51, size) - width).abs() < 0.1);
        }
    }

    /// Its work is the area under a triangle, summed.
    #[test]
    fn adhesion_work_is_the_integral_of_traction() {
        let traction = |s: f64| match s < PEAK {
            true => 2.0 * s / PEAK,
            false => 2.0 * (1.0 - s) / (1.0 - PEAK),
        };
        let (mut work, mut moment, steps) = (0.0, 0.0, 100_000);
        for k in 0..steps {
            let s = (f64::from(k) + 0.5) / f64::from(steps);
            assert!((spanned(f64::from(k) / f64::from(steps)) - work).abs() < 1e-6);
            work += traction(s) / f64::from(steps);
            moment += s * traction(s) / f64::from(steps);
        }
        // A ramp's mean gap is a third of its range.
        assert!((moment - RAMP / 3.0).abs() < 1e-6);
        assert_eq!(spanned(1.0), 1.0);
        assert_eq!(spanned(7.0), 1.0);
    }

    /// Spheres of 1 and 8 mm lift the skin until it lets go by heights as 1 to 2.
    #[test]
    fn release_height_scales_with_cube_root_of_radius() {
        let (most, sigma, lets_go) = (2.0, 0.1, -0.3);
        let depths: Vec<f64> = (0..=4000).map(|k| 2.0 - 1e-3 * f64::from(k)).collect();
        let reading = |d: &f64| (most - d, *d, Phase::Unload, 1.0);
        let way: Vec<Reading> = depths.iter().map(reading).collect();
        let sphere = |radius: f64| tool(most, |d| d, move |d| (radius * d).sqrt());
        let tools = vec![sphere(8.0), sphere(1.0)];
        let (ready, _) = ready(tools, &[(0, way.clone()), (1, way)], sigma);
        let surrogate = ready.surrogate();
        let clings = [Mechanism {
            effect: Effect::Adhesion,
            law: Law::Adhesion { lets_go },
        }];
        let model = Model::new(&surrogate, &clings);
        let set = model.setting(&surrogate, &[0.0, 0.0, 0.2, libm::log(0.1)]);
        let highest = |course: &ForceRecording| {
            let mut forces = vec![0.0; depths.len()];
            surrogate.adhere(&model, &set, ((course, &depths), &mut forces));
            let pulled = depths.iter().zip(&forces).filter(|(_, f)| **f < 0.0);
            pulled.map(|(d, _)| -d).fold(0.0, f64::max)
        };
        let heights: Vec<f64> = surrogate.courses.iter().map(highest).collect();
        for (height, root) in heights.iter().zip([1.0, 0.5]) {
            assert!((height + lets_go * most * root).abs() < 2e-3, "{heights:?}");
        }
    }
}
