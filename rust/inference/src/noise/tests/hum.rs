//! A hum of the instrument, next to rhythms that grow with the force and noise that has none.

use std::f64::consts::TAU;

use super::{PEAK_N, Planted, SAMPLES, force, study};
use crate::noise::estimate::{Noise, noise};
use crate::noise::noise_shape::estimate;
use crate::noise::periodic_component::Rhythm;
use crate::noise::restricted_likelihood::tests::{deviations, deviations_of};
use crate::random::Random;

/// Where a sine of 1.2 Hz is.
#[derive(Clone, Copy, PartialEq)]
enum Where {
    Everywhere,
    InContact,
    /// Everywhere, but for forces beyond a ceiling.
    BelowACeiling,
}

/// Noise of two protocols of three repeats with 0.5 % of noise, of which the tool is apart for the first third, and a sine of another phase in each: of
/// so many newtons, and of so much of the force.
fn found(newtons: f64, part: f64, of: Where) -> Noise {
    let (mut measured, mut simulated, mut slopes) = study(2, 3, &Planted::white(0.005));
    for (recording, one) in measured.iter_mut().enumerate() {
        for (k, (sample, moment)) in one.samples.iter_mut().zip(&one.moments).enumerate() {
            let is_apart = k < SAMPLES / 3;
            if is_apart {
                sample.value -= force(moment.depth_mm);
                simulated[recording][k] = 0.0;
                slopes[recording][k] = 0.0;
            }
            let sine = libm::sin(TAU * (1.2 * moment.time_s + 0.37 * recording as f64));
            if of != Where::InContact || !is_apart {
                sample.value += (newtons + part * sample.value) * sine;
            }
            if of == Where::BelowACeiling {
                sample.value = sample.value.min(0.6 * PEAK_N);
            }
        }
    }
    noise(&measured, (&simulated, &slopes), &[true; 6], None)
}

#[test]
fn a_hum_is_the_instruments_and_a_pulse_is_not() {
    for newtons in [0.01, 0.03, 0.1] {
        let of = found(newtons, 0.0, Where::Everywhere);
        let (hz, amplitude_n) = of.hum.unwrap();
        assert!((hz - 1.2).abs() < 0.03, "{newtons}: {hz} Hz");
        // Six recordings of one size each.
        assert!(
            (0.6..1.7).contains(&(amplitude_n / newtons)),
            "{newtons}: {amplitude_n}"
        );
        assert!(
            !of.rhythm.is_some_and(|r| Rhythm::is_clear(&r)),
            "{newtons}"
        );
        assert!(of.hum_note().unwrap().contains("the force hums at 1."));
        let sizes: Vec<f64> = of.sigma.iter().map(|s| s[0]).collect();
        let wanted = (0.005 * PEAK_N).hypot(newtons / 2f64.sqrt());
        assert!(
            (sizes[0] / wanted - 1.0).abs() < 0.3,
            "{newtons}: {}",
            sizes[0]
        );
    }
    let clipped = found(0.1, 0.0, Where::BelowACeiling);
    assert!((clipped.hum.unwrap().0 - 1.2).abs() < 0.03);
    assert!(!clipped.rhythm.is_some_and(|r| Rhythm::is_clear(&r)));
    let pulse = found(0.0, 0.05, Where::Everywhere);
    assert!(pulse.hum.is_none() && pulse.hum_note().is_none());
    assert!(Rhythm::is_clear(&pulse.rhythm.unwrap()));
    assert!(found(0.0, 0.0, Where::Everywhere).hum.is_none());
    assert!(found(0.03, 0.0, Where::InContact).hum.is_none(), "a tremor");
}

/// Deviations of five protocols: white noise, memories, a zero that walks, and noise of 1 with a hum of that amplitude.
#[test]
fn noise_without_a_hum_has_none() {
    let mut random = Random::new(12);
    for memory_s in [0.0, 0.05, 0.15, 0.6, 3.0] {
        let often = (0..20).filter(|_| {
            let mut all: Vec<_> = (0..5).map(|_| deviations(memory_s, &mut random)).collect();
            estimate(&mut all).correlation.hum.variance > 0.0
        });
        assert_eq!(often.count(), 0, "{memory_s}");
    }
    let mut walk = |time: &[f64], hum: f64| -> Vec<f64> {
        let (mut zero, phase) = (0.0, random.uniform());
        let one = |k: usize| {
            let step = if k > 0 { time[k] - time[k - 1] } else { 0.0 };
            zero += 0.3 * step.sqrt() * random.normal();
            zero + hum * libm::sin(TAU * (0.7 * time[k] + phase)) + random.normal()
        };
        (0..time.len()).map(one).collect()
    };
    let mut of = |hum: f64| {
        let each = (0..5).map(|_| deviations_of(2, &mut |time| walk(time, hum)));
        let hum = estimate(&mut each.collect()).correlation.hum;
        (hum.variance > 0.0).then_some(hum.hz)
    };
    for _ in 0..10 {
        assert_eq!(of(0.0), None);
        let hz = of(3.0).unwrap();
        assert!((hz - 0.7).abs() < 0.05, "{hz}");
    }
}
