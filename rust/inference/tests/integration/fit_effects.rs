//! Fits of models with effects: what is left out shows, what is there foretells, and numbers of effects are found.

use crate::scenes;

use scenes::curve_of;
use scenes::laboratory::{USUAL, clean, measured, planned};
use thenar_contact::{ActiveEffect, Control};
use thenar_inference::{Fit, Fitting, Free, Options};

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
