//! Parameters fitted to indentation curves: closed forms, planted numbers, repeats, censored numbers, and the same bits.
#![allow(clippy::unwrap_used)]

mod scenes;

use scenes::{Dice, add, curve, curve_of, material, pad, press_hold_release, study};
use thenar_contact::{ActiveEffect, Control};
use thenar_diagnosis::{Fit, Fitting, Free, Options, Target, fit_study};
use thenar_recordings::Study;
use thenar_recordings::study::Shape;

fn value(fit: &Fit, name: &str) -> f64 {
    estimate(fit, name).0
}

/// Value and interval of a material's number.
fn estimate(fit: &Fit, name: &str) -> (f64, f64, f64) {
    let is_it =
        |e: &&thenar_diagnosis::Estimate| e.name == name && matches!(e.target, Target::Region(_));
    let found = fit.estimates.iter().find(is_it).unwrap();
    (found.value, found.low, found.high)
}

/// Force (N) and depth (mm) of a rigid sphere on an elastic half space, nu = 1/2, by its contact radius: exact for the sphere's arc
/// (Sneddon 1965, Int. J. Eng. Sci. 3:47, section 6), of which Hertz's law is the limit for small a / R.
fn sphere_on_half_space(g: f64, radius: f64, a: f64) -> (f64, f64) {
    let log = ((radius + a) / (radius - a)).ln();
    (
        4.0 * g * (0.5 * (a * a + radius * radius) * log - a * radius),
        0.5 * a * log,
    )
}

#[test]
fn a_sphere_on_a_half_space_gives_its_modulus_back() {
    let (g, radius) = (0.012, 10.0f64);
    let mut study = study(
        pad(f64::INFINITY, 9.0, 0.5),
        material(0.005, 0.005, f64::INFINITY),
        vec![("ball", Shape::Sphere { radius_mm: radius })],
    );
    for speed in [0.5, 2.0] {
        let (times, depths) = press_hold_release((1.0, speed, 1.0), 80);
        let force = |d: &f64| {
            let (mut low, mut high) = (0.0, 0.9 * radius);
            for _ in 0..100 {
                let a = 0.5 * (low + high);
                match sphere_on_half_space(g, radius, a).1 < *d {
                    true => low = a,
                    false => high = a,
                }
            }
            sphere_on_half_space(g, radius, low).0
        };
        let forces: Vec<f64> = depths.iter().map(force).collect();
        let name = format!("{speed} mm/s");
        let curve = curve(&[
            ("time_s", &times),
            ("depth_mm", &depths),
            ("force_n", &forces),
        ]);
        add(&mut study, (&name, &name, "ball"), curve);
    }
    // A body without stiffening: the law's limit lies far beyond the depths.
    study.skin.materials[0].d_lim_mm = Some(1e3);
    study.skin.materials[0].fit = vec!["g0_mpa".into()];
    let fit = fit_study(&study, &Options::default(), &Control::none()).unwrap();
    let found = value(&fit, "g0_mpa");
    println!("G = {found:.6} MPa for {g}; {:?}", fit.estimates);
    // 0.3 % is the kernel's own error on a mesh with a / h = 6; the tool's facets and the table add as much.
    assert!((found / g - 1.0).abs() < 0.01, "{found}");
    assert_eq!(fit.lack_of_fit_p, None);
    assert!(
        fit.notes
            .iter()
            .any(|note| note.contains("no protocol was repeated"))
    );
}

const TRUE_G0: f64 = 0.0085;
const TRUE_GLIM: f64 = 0.02;

/// Noise as in laboratories: white and coloured by 0.15 s, gain and first touch that differ from repeat to repeat, a few outliers.
struct Laboratory {
    noise: f64,
    memory_s: f64,
    gain: f64,
    /// Of each repeat, mm.
    zero_mm: f64,
    /// Of all recordings with one tool: the operator's habit, mm.
    habit_mm: f64,
    outliers: f64,
}

const USUAL: Laboratory = Laboratory {
    noise: 0.01,
    memory_s: 0.15,
    gain: 0.04,
    zero_mm: 0.02,
    habit_mm: 0.05,
    outliers: 0.01,
};

/// Plate and ball, two speeds, three repeats each, on a pad of about 250 vertices; forces are still those of nothing.
fn planned() -> Study {
    let mut study = study(
        pad(8.0, 7.0, 0.9),
        material(TRUE_G0, TRUE_GLIM, 7.0),
        vec![
            ("plate", Shape::Plane),
            ("ball", Shape::Sphere { radius_mm: 5.0 }),
        ],
    );
    for (indenter, deepest) in [("plate", 2.0), ("ball", 1.5)] {
        for speed in [0.5, 5.0] {
            let (times, depths) = press_hold_release((deepest, speed, 2.0), 90);
            for repeat in 1..=3 {
                let protocol = format!("{indenter} {speed}");
                let name = format!("{protocol}, {repeat}");
                let empty = vec![0.0; times.len()];
                let channels = [
                    ("time_s", &times[..]),
                    ("depth_mm", &depths),
                    ("force_n", &empty),
                ];
                add(&mut study, (&name, &protocol, indenter), curve(&channels));
            }
        }
    }
    study
}

/// What the model itself says of the planned study.
fn clean() -> (Study, Vec<Vec<f64>>) {
    let study = planned();
    let forces = Fitting::new(&study, &Control::none())
        .unwrap()
        .simulate(&[], &Control::none())
        .unwrap();
    (study, forces)
}

/// The model's own forces as a laboratory would have measured them: this tests intervals, not the model.
fn measured((study, forces): &(Study, Vec<Vec<f64>>), laboratory: &Laboratory, seed: u64) -> Study {
    let (mut study, mut dice) = (study.clone(), Dice(seed.wrapping_mul(7919) + 17));
    for _ in 0..20 {
        dice.roll();
    }
    let habits = [0, 1].map(|_| laboratory.habit_mm * dice.normal());
    for (recording, clean) in forces.iter().enumerate() {
        let most = clean.iter().fold(0.0f64, |most, f| most.max(*f));
        let gain = (laboratory.gain * dice.normal()).exp();
        let habit = habits[usize::from(study.recordings[recording].indenter == "ball")];
        let zero = habit + laboratory.zero_mm * dice.normal();
        let curve = curve_of(&mut study, recording);
        let times = curve.channels[0].values.clone();
        let mut colored = dice.normal();
        for k in 0..clean.len() {
            let step = if k > 0 { times[k] - times[k - 1] } else { 0.0 };
            let carry = (-step / laboratory.memory_s).exp();
            colored = carry * colored + (1.0 - carry * carry).sqrt() * dice.normal();
            let jump = if dice.roll() < laboratory.outliers {
                8.0 * dice.normal()
            } else {
                0.0
            };
            curve.channels[2].values[k] =
                gain * clean[k] + laboratory.noise * most * (colored + jump);
            curve.channels[1].values[k] += zero;
        }
    }
    for material in &mut study.skin.materials {
        (material.g0_mpa, material.g_lim_mpa) = (Some(0.005), Some(0.05));
    }
    study
}

/// How often intervals hold the truth in `sets` data sets, and how often the test for lack of fit calls a right model wrong.
fn coverage(sets: u64) -> (f64, f64, f64) {
    let clean = clean();
    let (mut g0, mut g_lim, mut accused) = (0, 0, 0);
    let (mut gain, mut share, mut p) = (0.0, 0.0, 0.0);
    for seed in 0..sets {
        let study = measured(&clean, &USUAL, seed);
        let options = Options {
            draws: 199,
            seed,
            ..Options::default()
        };
        let fit = fit_study(&study, &options, &Control::none()).unwrap();
        let holds = |name: &str, truth: f64| {
            let (_, low, high) = estimate(&fit, name);
            usize::from(low <= truth && truth <= high)
        };
        g0 += holds("g0_mpa", TRUE_G0);
        g_lim += holds("g_lim_mpa", TRUE_GLIM);
        p += fit.lack_of_fit_p.unwrap();
        accused += usize::from(fit.lack_of_fit_p.unwrap() < 0.01);
        let most = fit.measured[0]
            .samples
            .iter()
            .fold(0.0f64, |most, s| most.max(s.value));
        share += fit.sigma[0][0] / most;
        let (_, low, high) = estimate(&fit, "g0_mpa");
        gain += (high / low).ln() / 2.0;
    }
    let part = |count: usize| count as f64 / sets as f64;
    let n = sets as f64;
    println!(
        "{sets} data sets: 90 % intervals hold G0 in {:.1} %, Glim in {:.1} %",
        100.0 * part(g0),
        100.0 * part(g_lim)
    );
    println!(
        "mean noise {:.4} of the peak, half width of log G0 {:.4}, mean p {:.2}, accused {:.3}",
        share / n,
        gain / n,
        p / n,
        part(accused)
    );
    (part(g0), part(g_lim), part(accused))
}

#[test]
fn intervals_hold_planted_parameters() {
    let (g0, g_lim, accused) = coverage(40);
    // Three standard errors of 40 draws about 90 %.
    assert!(g0 >= 0.76 && g_lim >= 0.76, "{g0} {g_lim}");
    assert!(accused <= 0.075, "{accused}");
}

/// `cargo test --release -p thenar-diagnosis --test fit_curves -- --ignored --nocapture`
#[test]
#[ignore = "200 fits"]
fn intervals_hold_planted_parameters_in_85_to_95_of_100() {
    let (g0, g_lim, accused) = coverage(200);
    assert!(
        (0.85..=0.95).contains(&g0) && (0.85..=0.95).contains(&g_lim),
        "{g0} {g_lim}"
    );
    assert!(accused <= 0.03, "{accused}");
}

#[test]
fn the_same_seed_gives_the_same_bits() {
    let study = measured(&clean(), &USUAL, 3);
    let fit = || fit_study(&study, &Options::default(), &Control::none()).unwrap();
    let (a, b) = (fit(), fit());
    assert_eq!(a.estimates, b.estimates);
    assert_eq!(
        (a.projected, a.lack_of_fit_p),
        (b.projected, b.lack_of_fit_p)
    );
}

#[test]
fn thirteen_recordings_of_ninety_samples_take_seconds() {
    let started = std::time::Instant::now();
    let study = measured(&clean(), &USUAL, 3);
    let built = started.elapsed().as_secs_f64();
    let started = std::time::Instant::now();
    let fit = fit_study(&study, &Options::default(), &Control::none()).unwrap();
    println!(
        "{} recordings fitted in {:.2} s ({built:.2} s to make them)",
        fit.measured.len(),
        started.elapsed().as_secs_f64()
    );
    for e in &fit.estimates {
        println!("{e:?}");
    }
    println!("p {:?} {:?}", fit.lack_of_fit_p, fit.notes);
    assert!(started.elapsed().as_secs_f64() < 30.0);
}

/// Data with an effect in them: the base model is called wrong, the right one is not, and foretells a speed that it did not see.
#[test]
fn an_effect_that_is_left_out_shows_and_one_that_is_there_foretells() {
    let effect = ActiveEffect::named("relaxation", 0.5).unwrap();
    let study = planned();
    let mut fitting = Fitting::new(&study, &Control::none()).unwrap();
    let forces = fitting
        .simulate(std::slice::from_ref(&effect), &Control::none())
        .unwrap();
    let mut study = measured(&(study, forces), &USUAL, 11);
    study.recordings.truncate(6);
    let mut fitting = Fitting::new(&study, &Control::none()).unwrap();
    let fast: Vec<String> = study.recordings[3..]
        .iter()
        .map(|r| r.name.clone())
        .collect();
    let rms = |fit: &Fit| {
        let squares = (3..6).flat_map(|r| fit.measured[r].samples.iter().zip(&fit.simulated[r]));
        let each: Vec<f64> = squares.map(|(s, f)| (s.value - f).powi(2)).collect();
        (each.iter().sum::<f64>() / each.len() as f64).sqrt()
    };
    let base = Options {
        held_out: fast,
        draws: 199,
        ..Options::default()
    };
    let without = fitting.fit(&base, &Control::none()).unwrap();
    let started = std::time::Instant::now();
    let with = fitting
        .fit(
            &Options {
                effects: vec![effect],
                ..base
            },
            &Control::none(),
        )
        .unwrap();
    println!(
        "refit with relaxation, 3 recordings: {:.2} s",
        started.elapsed().as_secs_f64()
    );
    println!(
        "p {:?} and {:?}; held out rms {:.4} and {:.4} N",
        without.lack_of_fit_p,
        with.lack_of_fit_p,
        rms(&without),
        rms(&with)
    );
    assert!(without.lack_of_fit_p.unwrap() < 0.01);
    assert!(with.lack_of_fit_p.unwrap() > 0.01);
    assert!(rms(&with) < 0.5 * rms(&without));
    assert!(
        with.projected[3..].iter().flatten().all(|r| *r == 0.0),
        "held out recordings are not fitted"
    );
}

/// An amplitude and a time that were planted are found together with the moduli.
#[test]
fn numbers_of_an_effect_are_fitted_with_the_moduli() {
    let truth = ActiveEffect::named("relaxation", 0.5).unwrap();
    let study = planned();
    let forces = Fitting::new(&study, &Control::none())
        .unwrap()
        .simulate(std::slice::from_ref(&truth), &Control::none())
        .unwrap();
    let mut study = measured(&(study, forces), &USUAL, 11);
    study.recordings.truncate(6);
    let mut fitting = Fitting::new(&study, &Control::none()).unwrap();
    let base = Options {
        draws: 99,
        ..Options::default()
    };
    let without = fitting.fit_effects(&base, &[], &Control::none()).unwrap();
    let begin = ActiveEffect::named("relaxation", 0.2).unwrap();
    let free = [Free {
        effect: 0,
        number: None,
        bounds: (0.0, 0.9),
    }];
    let started = std::time::Instant::now();
    let with = Options {
        effects: vec![begin],
        ..base
    };
    let with = fitting.fit_effects(&with, &free, &Control::none()).unwrap();
    println!(
        "6 recordings with a free amplitude: {:.2} s",
        started.elapsed().as_secs_f64()
    );
    println!(
        "{:?}; deviance {:.0} and {:.0}",
        with.found, without.deviance, with.deviance
    );
    let found = with.found[0];
    assert!(
        found.low <= truth.amplitude && truth.amplitude <= found.high,
        "{found:?}"
    );
    assert!((found.value - truth.amplitude).abs() < 0.1);
    assert_eq!(with.effects[0].amplitude, found.value);
    assert!(with.deviance < without.deviance - 25.0);
}

/// Forces that are off by a smooth share of depth, alike in all repeats: lack of fit unless the form may be off by as much.
#[test]
fn a_form_that_is_off_is_taken_up_where_it_may_be() {
    let (study, mut forces) = clean();
    for (recording, force) in forces.iter_mut().enumerate() {
        let depths = curve_of(&mut study.clone(), recording).channels[1]
            .values
            .clone();
        let bump = |d: f64| 1.0 + 0.1 * (2.5 * d).sin();
        force
            .iter_mut()
            .zip(&depths)
            .for_each(|(f, d)| *f *= bump(*d));
    }
    let study = measured(&(study, forces), &USUAL, 5);
    let mut fitting = Fitting::new(&study, &Control::none()).unwrap();
    let mut p = |form_error: f64| {
        let options = Options {
            form_error,
            draws: 199,
            ..Options::default()
        };
        fitting
            .fit(&options, &Control::none())
            .unwrap()
            .lack_of_fit_p
            .unwrap()
    };
    let (strict, lenient) = (p(0.0), p(0.05));
    println!("p {strict} and {lenient}");
    assert!(strict < 0.01 && lenient > 0.01);
}
