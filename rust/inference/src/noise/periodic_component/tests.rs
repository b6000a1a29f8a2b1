//! Pulses and hums that are planted, and noise in which there is none.

use super::*;
use crate::noise::correlation::Hum;
use crate::noise::restricted_likelihood::tests::deviations;
use crate::random::Random;

/// Any table of chi-square: 5.991 at 2 degrees, 18.307 at 10 and 31.410 at 20 leave 5 %.
#[test]
fn chances_agree_with_published_tables() {
    for (chi_square, pairs) in [(5.991, 1), (18.307, 5), (31.410, 10)] {
        let p = exceeded(0.5 * chi_square, pairs);
        assert!((p / 0.05 - 1.0).abs() < 1e-3, "{pairs}: {p}");
    }
}

/// Five protocols of two repeats each with noise of 1; a pulse of that size at full load, its phase by protocol.
fn study(pulse: f64, random: &mut Random) -> Vec<Deviations> {
    let one = |phase: usize| {
        let mut of = deviations(0.15, random);
        for k in 0..of.time.len() {
            let turn = std::f64::consts::TAU * 1.2 * of.time[k] + phase as f64;
            let beat = pulse * of.along[k].x * libm::sin(turn);
            of.rest[0][k] += beat;
            of.rest[1][k] -= beat;
        }
        of
    };
    (0..5).map(one).collect()
}

#[test]
fn planted_pulse_is_found_at_its_frequency() {
    let mut random = Random::new(11);
    for _ in 0..20 {
        let found = rhythm(&study(1.0, &mut random), Correlation::of_memory(0.15)).unwrap();
        assert!(
            (found.hz - 1.2).abs() < 0.04 && found.chance < 1e-3,
            "{found:?}"
        );
        assert!((found.per_minute() - 60.0 * found.hz).abs() < 1e-9);
    }
}

/// Three protocols of two repeats each, a third of their time without load, a third pressed and a third held: what is added to one repeat and taken off the other,
/// by time (s), load and phase of the protocol; and noise of 1.
fn held(added: impl Fn(f64, f64, f64) -> f64, random: &mut Random) -> Vec<Deviations> {
    let one = |phase: usize| {
        let mut of = deviations(0.15, random);
        let n = of.time.len();
        for k in 0..n {
            let load = (3.0 * k as f64 / n as f64 - 1.0).clamp(0.0, 1.0);
            of.load[k] = load;
            // Free of what first touch does, the gain shows in the part that is pressed alone.
            of.along[k].x = if load < 1.0 {
                load * (1.5 - 2.0 * load)
            } else {
                0.05
            };
            let off = added(of.time[k], load, phase as f64);
            of.rest[0][k] += off;
            of.rest[1][k] -= off;
        }
        of
    };
    (0..3).map(one).collect()
}

fn sine(hz: f64, time_s: f64, phase: f64) -> f64 {
    libm::sin(std::f64::consts::TAU * hz * time_s + phase)
}

#[test]
fn pulse_of_a_hold_is_found_by_the_force_where_the_gain_hardly_shows() {
    let mut random = Random::new(21);
    for _ in 0..10 {
        let all = held(
            |time, load, phase| 1.5 * load * sine(1.2, time, phase),
            &mut random,
        );
        let found = rhythm(&all, Correlation::of_memory(0.15)).unwrap();
        assert!(
            (found.hz - 1.2).abs() < 0.04 && found.is_clear(),
            "{found:?}"
        );
        let freed = all
            .iter()
            .filter_map(|d| Freed::of(d, Correlation::of_memory(0.15)));
        let freed: Vec<Freed> = freed.collect();
        assert!(!clearest(&freed, Grows::WithGain).is_clear());
    }
}

/// A line of 7.3 Hz that is read as one of 1.2 Hz in a hold, where samples lie farther apart: without load it is as large.
#[test]
fn line_that_is_read_as_a_rhythm_under_load_is_none() {
    let mut random = Random::new(23);
    let correlation = Correlation::of_memory(0.15);
    let with = |light: f64, random: &mut Random| {
        let off = |time: f64, load: f64, phase: f64| match load > 0.0 {
            true => 2.0 * sine(1.2, time, phase),
            false => light * sine(7.3, time, phase),
        };
        rhythm(&held(off, random), correlation).unwrap()
    };
    for _ in 0..10 {
        let alias = with(3.0, &mut random);
        assert!(!alias.is_clear(), "{alias:?}");
        let pulse = with(0.0, &mut random);
        assert!(pulse.is_clear(), "{pulse:?}");
    }
}

/// The overtone of a hum is as large without load; a pulse next to a hum is not.
#[test]
fn rhythm_next_to_a_hum_is_one_if_it_grows_with_the_force() {
    let mut random = Random::new(22);
    let hum = Hum {
        hz: 0.6,
        variance: 2.0,
    };
    let correlation = Correlation {
        hum,
        ..Correlation::of_memory(0.15)
    };
    let with = |size: fn(f64) -> f64, random: &mut Random| {
        let off = |time: f64, load: f64, phase: f64| {
            2.0 * sine(0.6, time, phase) + size(load) * sine(1.2, time, 3.0 * phase)
        };
        rhythm(&held(off, random), correlation).unwrap()
    };
    for _ in 0..10 {
        let overtone = with(|_| 1.2, &mut random);
        assert!(!overtone.is_clear(), "{overtone:?}");
        let pulse = with(|load| 2.0 * load * load, &mut random);
        assert!(pulse.is_clear(), "{pulse:?}");
    }
}

/// What wanders over many seconds is clearest at the slow end of the band, and is no rhythm.
#[test]
fn slow_wander_is_no_rhythm() {
    let mut random = Random::new(12);
    let often = (0..20).filter(|_| {
        let all: Vec<Deviations> = study(0.0, &mut random)
            .into_iter()
            .map(|mut of| {
                let slow = deviations(6.0, &mut random);
                for k in 0..of.time.len() {
                    for r in 0..2 {
                        of.rest[r][k] += 4.0 * of.along[k].x * slow.rest[r][k];
                    }
                }
                of
            })
            .collect();
        rhythm(&all, Correlation::of_memory(0.15))
            .unwrap()
            .is_clear()
    });
    let often = often.count();
    assert!(often <= 6, "{often}");
}

/// The same part of the squares is twice as clear where there are twice as many degrees of freedom.
#[test]
fn periodic_component_power_grows_with_repeats() {
    let of = &study(1.0, &mut Random::new(6))[0];
    let mut freed = Freed::of(of, Correlation::of_memory(0.15)).unwrap();
    let two = freed.gained(1.2, Grows::WithGain);
    freed.repeats = 2.0;
    assert!(two > 1.0 && (freed.gained(1.2, Grows::WithGain) / two - 2.0).abs() < 1e-12);
}

/// The chance that is given is none too small: noise shows 5 % in no more than 5 of 100, of which 3 standard errors are 6.5.
#[test]
fn white_noise_has_no_periodic_component() {
    let mut random = Random::new(4);
    let shown = (0..100).filter(|_| {
        let found = rhythm(&study(0.0, &mut random), Correlation::of_memory(0.15)).unwrap();
        found.chance < 0.05
    });
    let often = shown.count();
    assert!(often <= 11, "{often}");
    assert!(rhythm(&[], Correlation::NONE).is_none());
}
