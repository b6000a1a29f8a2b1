//! Tests of the noise model on synthetic repeats with planted noise.

mod hum;
mod rounding;

use nalgebra::Vector3;

use crate::noise::channel::Channel;
use crate::noise::estimate::noise;
use crate::noise::repeat_alignment::{RepeatSeries, aligned};
use crate::observe::measured::{Censoring, Measured, Moment, Phase, Quantity, Sample};
use crate::random::Random;

const SAMPLES: usize = 90;
const STEP_S: f64 = 0.05;
const PEAK_N: f64 = 3.0;

fn force(depth: f64) -> f64 {
    PEAK_N * (depth.max(0.0) / 2.0).powf(1.5)
}

/// What is planted: share of the peak, memory (s), gain and zero (mm) between repeats, share of outliers.
struct Planted {
    noise: f64,
    memory_s: f64,
    gain: f64,
    zero_mm: f64,
    outliers: f64,
}

impl Planted {
    /// White noise alone.
    fn white(noise: f64) -> Planted {
        Planted {
            noise,
            memory_s: 0.0,
            gain: 0.0,
            zero_mm: 0.0,
            outliers: 0.0,
        }
    }
}

fn repeat(protocol: &str, planted: &Planted, random: &mut Random) -> Measured {
    let (gain, zero) = (
        (planted.gain * random.normal()).exp(),
        planted.zero_mm * random.normal(),
    );
    let (mut moments, mut samples, mut colored) = (Vec::new(), Vec::new(), random.normal());
    for k in 0..SAMPLES {
        let autocorrelation = if planted.memory_s > 0.0 {
            (-STEP_S / planted.memory_s).exp()
        } else {
            0.0
        };
        colored = autocorrelation * colored
            + (1.0 - autocorrelation * autocorrelation).sqrt() * random.normal();
        let jump = if random.uniform() < planted.outliers {
            10.0 * random.normal()
        } else {
            0.0
        };
        let depth = 2.0 * (k + 1) as f64 / SAMPLES as f64;
        moments.push(Moment {
            time_s: STEP_S * k as f64,
            depth_mm: depth,
            demand_n: f64::NAN,
            slide_mm: Vector3::zeros(),
            rate_mm_s: 0.4,
            phase: Phase::Load,
            cycle: 0,
            readings: 1,
            depth_spread_mm: 0.0,
            force_step_n: 0.0,
        });
        samples.push(Sample {
            moment: k as u32,
            quantity: Quantity::Force,
            value: gain * force(depth - zero) + planted.noise * PEAK_N * (colored + jump),
            censoring: Censoring::Seen,
        });
    }
    Measured {
        name: String::new(),
        protocol: protocol.into(),
        indenter: "plate".into(),
        site: "pad".into(),
        moments,
        samples,
        mat: None,
        scan: None,
        is_calibrated: true,
        depth_error_mm: 0.0,
        is_coarse: false,
        unknown: Vec::new(),
    }
}

/// A study of that many protocols and repeats with what the model says of it, here the truth without noise times a wrong modulus.
fn study(
    protocols: usize,
    repeats: usize,
    planted: &Planted,
) -> (Vec<Measured>, Vec<Vec<f64>>, Vec<Vec<f64>>) {
    let mut random = Random::new(8);
    let names = (0..protocols * repeats).map(|k| format!("{}", k / repeats));
    let measured: Vec<Measured> = names
        .map(|name| repeat(&name, planted, &mut random))
        .collect();
    let each = |f: &dyn Fn(f64) -> f64| -> Vec<Vec<f64>> {
        let of = |m: &Measured| m.moments.iter().map(|moment| f(moment.depth_mm)).collect();
        measured.iter().map(of).collect()
    };
    let wrong = 1.7;
    let simulated = each(&|d| wrong * force(d));
    let slopes = each(&|d| wrong * (force(d + 1e-4) - force(d)) / 1e-4);
    (measured, simulated, slopes)
}

#[test]
fn planted_noise_within_and_between_repeats_is_recovered() {
    let planted = Planted {
        noise: 0.01,
        memory_s: 0.15,
        gain: 0.04,
        zero_mm: 0.03,
        outliers: 0.01,
    };
    let (measured, simulated, slopes) = study(8, 4, &planted);
    let told = noise(&measured, (&simulated, &slopes), &[true; 32], None);
    let sigma = told.sigma.iter().map(|s| s[0]).sum::<f64>() / 32.0 / PEAK_N;
    assert!((sigma / planted.noise - 1.0).abs() < 0.15, "{sigma}");
    assert!(
        (told.correlation[0].memory_s / planted.memory_s - 1.0).abs() < 0.4,
        "{:?}",
        told.correlation
    );
    // 24 degrees of freedom tell a standard deviation to a seventh.
    assert!(
        (told.gain / planted.gain - 1.0).abs() < 0.35,
        "{}",
        told.gain
    );
    assert!(
        (told.zero_mm.unwrap() / planted.zero_mm - 1.0).abs() < 0.35,
        "{:?}",
        told.zero_mm
    );
}

#[test]
fn identical_repeats_have_no_between_repeat_variance() {
    let planted = Planted::white(0.01);
    let (measured, simulated, slopes) = study(8, 4, &planted);
    let told = noise(&measured, (&simulated, &slopes), &[true; 32], None);
    // Half of the error with which one recording's gain and zero can be told apart stays as doubt.
    assert!(
        told.gain < 0.005 && told.zero_mm.unwrap() < 0.005,
        "{} {:?}",
        told.gain,
        told.zero_mm
    );
    assert_eq!(told.correlation[0].memory_s, 0.0);
}

/// Recordings with a zero of the force of their own, in addition to gain and touch: how far the zeros lie apart is recovered and said, and their scatter is
/// taken neither for a memory nor for a gain.
#[test]
fn zeros_of_the_force_are_recovered_and_are_no_memory() {
    let planted = Planted {
        noise: 0.01,
        memory_s: 0.15,
        gain: 0.01,
        zero_mm: 0.01,
        outliers: 0.0,
    };
    let of = |zero_n: f64| {
        let (mut measured, simulated, slopes) = study(8, 4, &planted);
        let mut random = Random::new(21);
        for one in &mut measured {
            let zero = zero_n * random.normal();
            one.samples.iter_mut().for_each(|s| s.value += zero);
        }
        noise(&measured, (&simulated, &slopes), &[true; 32], None)
    };
    let (tared, off) = (of(0.0), of(0.1));
    assert!(!tared.has_clear_zeros && tared.zero_note().is_none());
    // Half of the error with which a zero is found stays as doubt.
    assert!(
        tared.force_zero_n.unwrap() < 0.03,
        "{:?}",
        tared.force_zero_n
    );
    // 24 degrees of freedom tell a standard deviation to a seventh.
    let zero_n = off.force_zero_n.unwrap();
    assert!((zero_n / 0.1 - 1.0).abs() < 0.35, "{zero_n}");
    assert!(
        off.has_clear_zeros
            && off
                .zero_note()
                .unwrap()
                .contains(" mN (standard deviation)")
    );
    assert!(
        (off.correlation[0].memory_s / planted.memory_s - 1.0).abs() < 0.4,
        "{:?}",
        off.correlation
    );
    // Taken for a gain, zeros of 3 % of the peak would make it several times as large.
    assert!((off.gain / planted.gain - 1.0).abs() < 0.6, "{}", off.gain);
}

/// Of recordings that hold one force, too: nobody can tell gain from zero there, and what others say of their zeros stays.
#[test]
fn a_hold_alone_says_nothing_of_zeros() {
    let planted = Planted::white(0.01);
    let (mut measured, mut simulated, mut slopes) = study(4, 4, &planted);
    let known = noise(&measured, (&simulated, &slopes), &[true; 16], None);
    for recording in 0..4 {
        for k in 0..SAMPLES {
            let creep = 1e-3 * k as f64 / SAMPLES as f64;
            let depth = &mut measured[recording].moments[k].depth_mm;
            let held = force(2.0) - force(*depth);
            *depth = 2.0;
            measured[recording].samples[k].value += held + creep;
            simulated[recording][k] = 1.7 * force(2.0) + creep;
            slopes[recording][k] = 1.7 * (force(2.0 + 1e-4) - force(2.0)) / 1e-4 + creep;
        }
    }
    let held = noise(&measured, (&simulated, &slopes), &[true; 16], None);
    let [known, held] = [known, held].map(|noise| noise.force_zero_n.unwrap());
    assert!((held / known - 1.0).abs() < 0.5, "{held} {known}");
}

/// An error of the depth shakes the force by its own slope, whatever the modulus that slopes were simulated with.
#[test]
fn error_of_the_depth_is_noise_through_the_slope_of_the_force() {
    let planted = Planted::white(0.001);
    let (mut measured, simulated, slopes) = study(3, 3, &planted);
    let found =
        |measured: &[Measured]| noise(measured, (&simulated, &slopes), &[true; 9], None).sigma;
    let known = found(&measured);
    measured[4].depth_error_mm = 0.02;
    let rounded = found(&measured);
    let mut largest = 0.0f64;
    for (k, moment) in measured[4].moments.iter().enumerate() {
        let slope = (force(moment.depth_mm + 1e-4) - force(moment.depth_mm)) / 1e-4;
        let added = (rounded[4][k].powi(2) - known[4][k].powi(2))
            .max(0.0)
            .sqrt();
        assert!(
            (added - 0.02 * slope).abs() < 0.01 * 0.02 * slope.max(1.0),
            "{k}: {added}"
        );
        largest = largest.max(added);
    }
    assert!(largest > 2.0 * known[4][0]);
    assert_eq!((&known[3], &known[5]), (&rounded[3], &rounded[5]));
}

#[test]
fn without_repeats_noise_comes_from_roughness_with_a_note() {
    let planted = Planted {
        noise: 0.01,
        memory_s: 0.0,
        gain: 0.04,
        zero_mm: 0.0,
        outliers: 0.0,
    };
    let (measured, simulated, slopes) = study(5, 1, &planted);
    let told = noise(&measured, (&simulated, &slopes), &[true; 5], None);
    assert_eq!((told.degrees, told.zero_mm), (None, None));
    assert!((told.sigma[0][0] / PEAK_N / 0.01 - 1.0).abs() < 0.3);
    assert!(told.notes[0].contains("no protocol was repeated"));
}

/// A press and its map share a protocol, but the map has no force: it must not hide what the presses repeat.
#[test]
fn repeats_are_grouped_by_channel() {
    let planted = Planted::white(0.01);
    let (mut measured, simulated, slopes) = study(3, 3, &planted);
    let alone = noise(
        &measured,
        (&simulated[..6], &slopes[..6]),
        &[true, true, true, true, true, true, false, false, false],
        None,
    );
    for other in &mut measured[6..] {
        other.protocol = "0".into();
        other
            .samples
            .iter_mut()
            .for_each(|s| s.quantity = Quantity::Area);
    }
    let mixed = noise(&measured, (&simulated, &slopes), &[true; 9], None);
    assert_eq!(mixed.sigma[0], alone.sigma[0]);
    assert!(
        mixed.degrees.unwrap() > alone.degrees.unwrap(),
        "the areas repeat each other, too"
    );
}

/// A repeat whose first loading seems to have begun a little earlier, as the rows about it fell otherwise, is the same; one that began
/// a tenth of its time earlier is another, and is joined by straight lines at the moments of the first.
#[test]
fn small_lag_is_ignored_and_large_lag_is_resampled() {
    let planted = Planted {
        noise: 0.0,
        memory_s: 0.0,
        gain: 0.0,
        zero_mm: 0.0,
        outliers: 0.0,
    };
    let mut random = Random::new(1);
    let first = repeat("one", &planted, &mut random);
    let nothing = vec![0.0; SAMPLES];
    fn told<'a>(measured: &'a Measured, nothing: &'a [f64]) -> RepeatSeries<'a> {
        RepeatSeries {
            measured,
            simulated: nothing,
            slopes: nothing,
            number: 0,
        }
    }
    for (rows, is_same) in [(3, true), (9, false)] {
        let mut other = first.clone();
        let starts = &mut other.moments[..rows];
        starts.iter_mut().for_each(|m| m.phase = Phase::Apart);
        let (times, both) = aligned(
            Channel::Force,
            &[told(&first, &nothing), told(&other, &nothing)],
        );
        assert_eq!(times.len() == SAMPLES, is_same, "{rows} rows late");
        let shift = f64::from(rows as u32) * STEP_S;
        for (k, time) in times.iter().enumerate() {
            let at = if is_same { *time } else { time + shift };
            let wanted = force(2.0 * (at / STEP_S + 1.0) / SAMPLES as f64);
            assert!((both[1].value[k] - wanted).abs() < 1e-6 * PEAK_N, "{time}");
        }
    }
}
