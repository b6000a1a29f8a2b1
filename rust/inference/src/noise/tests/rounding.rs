//! Repeats whose forces are rounded to steps.

use super::{PEAK_N, Planted, study};
use crate::noise::estimate::noise;
use crate::noise::periodic_component::Rhythm;
use crate::noise::whitening::Whitening;
use crate::observe::measured::Measured;

/// Repeats whose forces are rounded alike to steps larger than their noise seem to have none.
#[test]
fn noise_of_rounded_forces_is_no_less_than_rounding() {
    let step_n = 0.1 * PEAK_N;
    for planted in [0.0, 0.01, 0.03, 0.05] {
        let (mut measured, simulated, slopes) = study(2, 3, &Planted::white(planted));
        for one in &mut measured {
            for (sample, moment) in one.samples.iter_mut().zip(&mut one.moments) {
                sample.value = (sample.value / step_n).round() * step_n;
                moment.force_step_n = step_n;
            }
        }
        let found = noise(&measured, (&simulated, &slopes), &[true; 6], None);
        // As noise can be drawn from them, repeats do not all seem to be the same.
        assert!(!found.drawn_from[0].is_empty(), "{planted}");
        let wanted = (planted * PEAK_N).hypot(step_n / 12f64.sqrt());
        for sigma in found.sigma.iter().flatten() {
            assert!(
                (0.8..1.6).contains(&(sigma / wanted)),
                "{planted}: {sigma} of {wanted}"
            );
        }
        let alone = noise(&measured[..1], (&simulated, &slopes), &[true], None);
        let least = alone.sigma[0].iter().copied().fold(f64::INFINITY, f64::min);
        assert!(least >= step_n / 12f64.sqrt(), "{planted}: {least} alone");
    }
}

/// Forces with a rhythm of 1.2 Hz, of another phase in each repeat. Steps larger than the noise have rhythms of their own.
#[test]
fn rhythms_of_coarse_recordings_are_not_judged() {
    let (mut measured, simulated, slopes) = study(2, 3, &Planted::white(0.005));
    for (recording, one) in measured.iter_mut().enumerate() {
        for (sample, moment) in one.samples.iter_mut().zip(&one.moments) {
            let turns = 1.2 * moment.time_s + 0.37 * recording as f64;
            sample.value *= 1.0 + 0.05 * libm::sin(std::f64::consts::TAU * turns);
        }
    }
    let rhythm = |measured: &[Measured]| {
        let found = noise(measured, (&simulated, &slopes), &[true; 6], None);
        found.rhythm.filter(Rhythm::is_clear)
    };
    assert!((rhythm(&measured).unwrap().hz - 1.2).abs() < 0.25);
    // In the first protocol only: the second shows it by itself.
    measured[0].is_coarse = true;
    assert!((rhythm(&measured).unwrap().hz - 1.2).abs() < 0.25);
    measured[3].is_coarse = true;
    assert_eq!(rhythm(&measured), None);
}

/// Within half a step of its reading nothing is off, and farther off only what lies beyond.
#[test]
fn a_rounded_force_is_off_by_what_lies_beyond_half_a_step() {
    let (mut measured, simulated, slopes) = study(1, 1, &Planted::white(0.05));
    for moment in &mut measured[0].moments {
        moment.force_step_n = 0.2;
    }
    let values: Vec<f64> = measured[0].samples.iter().map(|s| s.value).collect();
    let off = |is_coarse: bool, off_n: f64| {
        let mut measured = measured.clone();
        measured[0].is_coarse = is_coarse;
        let noise = noise(&measured, (&simulated, &slopes), &[true], None);
        let whitening = Whitening::new(&measured, &noise, &[true]);
        let moved: Vec<f64> = values.iter().map(|v| v - off_n).collect();
        let residual = whitening.residuals(&moved).residual;
        residual[0] * noise.sigma[0][0]
    };
    for (off_n, wanted) in [
        (0.0, 0.0),
        (0.09, 0.0),
        (-0.09, 0.0),
        (0.15, 0.05),
        (-0.3, -0.2),
    ] {
        assert!((off(true, off_n) - wanted).abs() < 1e-9, "{off_n}");
        assert!((off(false, off_n) - off_n).abs() < 1e-9, "{off_n}");
    }
}
