//! Parameters and pose fitted to pressure maps: planted, clipped, uncalibrated, and a long export compared by means of its frames.

use crate::scenes;

use scenes::{Dice, add_map, map_of, material, pad, press_hold_release, study};
use thenar_contact::{ActiveEffect, Control};
use thenar_inference::{Censoring, Fit, Fitting, Options, Quantity, fit_study};
use thenar_recordings::study::Shape;
use thenar_recordings::{PressureUnit, Study};

const TRUE_G0: f64 = 0.0085;
const TRUE_GLIM: f64 = 0.02;
const FRAMES: usize = 20;

fn value(fit: &Fit, name: &str) -> (f64, f64, f64) {
    let found = fit.estimates.iter().find(|e| e.name == name).unwrap();
    (found.value, found.low, found.high)
}

fn planned(size: usize, pitch: f64, frames: usize) -> Study {
    let mut study = study(
        pad(8.0, 7.0, 0.9),
        material(TRUE_G0, TRUE_GLIM, 7.0),
        vec![("plate", Shape::Plane)],
    );
    let (times, depths) = press_hold_release((2.0, 0.5, 2.0), frames);
    for name in ["1", "2"] {
        add_map(&mut study, (name, "mat"), (size, pitch), (&times, &depths));
    }
    study
}

/// The model's own maps of a mat that lies `shift` mm off, with noise of a part of the peak and of the reading.
fn measured(shift: [f64; 2], noise: (f64, f64), seed: u64) -> Study {
    let mut study = planned(12, 1.5, FRAMES);
    let misplaced = ActiveEffect::named("misregistration", 1.0)
        .and_then(|e| e.with("shift_1_mm", shift[0]))
        .and_then(|e| e.with("shift_2_mm", shift[1]))
        .unwrap();
    let mut fitting = Fitting::new(&study, &Control::none()).unwrap();
    let clean = fitting.simulate(&[misplaced], &Control::none()).unwrap();
    let samples: Vec<_> = fitting
        .measured()
        .iter()
        .map(|m| m.samples.clone())
        .collect();
    let mut dice = Dice(seed * 31 + 5);
    for recording in 0..2 {
        let map = map_of(&mut study, recording);
        let (peak, sensels) = (
            clean[recording].iter().fold(0.0f64, |a, b| a.max(*b)),
            map.sensels.len(),
        );
        for (sample, p) in samples[recording].iter().zip(&clean[recording]) {
            let Quantity::Pressure(sensel) = sample.quantity else {
                panic!()
            };
            let off = if *p > 0.0 {
                noise.0 * peak * dice.normal() + noise.1 * p * dice.normal()
            } else {
                0.0
            };
            map.values[sample.moment as usize * sensels + sensel as usize] = (p + off).max(0.0);
        }
    }
    for material in &mut study.skin.materials {
        (material.g0_mpa, material.g_lim_mpa) = (Some(0.005), Some(0.05));
    }
    study
}

#[test]
fn pose_and_moduli_of_a_mat_are_found() {
    let shift = [0.8, -0.5];
    let fit = fit_study(
        &measured(shift, (0.003, 0.01), 1),
        &Options::default(),
        &Control::none(),
    )
    .unwrap();
    for e in fit.estimates.iter().take(8) {
        println!(
            "{} {:?}: {:.5} ({:.5} to {:.5})",
            e.name, e.target, e.value, e.low, e.high
        );
    }
    println!("p {:?}", fit.lack_of_fit_p);
    let (x, y) = (value(&fit, "pose_x_mm").0, value(&fit, "pose_y_mm").0);
    // A tenth of a sensel.
    assert!(
        (x - shift[0]).abs() < 0.15 && (y - shift[1]).abs() < 0.15,
        "{x} {y}"
    );
    let (g0, low, high) = value(&fit, "g0_mpa");
    assert!(
        low <= TRUE_G0 && TRUE_G0 <= high && (g0 / TRUE_G0 - 1.0).abs() < 0.1,
        "{g0}"
    );
    assert!(fit.lack_of_fit_p.unwrap() > 0.01);
}

#[test]
fn clipped_and_hidden_readings_do_not_move_the_estimate() {
    let (mut sum, mut square, mut naive) = (0.0, 0.0, 0.0);
    let seeds = 8;
    for seed in 0..seeds {
        let mut study = measured([0.0; 2], (0.003, 0.02), seed);
        let peak = map_of(&mut study, 0)
            .values
            .iter()
            .fold(0.0f64, |a, b| a.max(*b));
        for recording in 0..2 {
            let map = map_of(&mut study, recording);
            let (top, bottom) = (0.6 * peak, 0.1 * peak);
            map.values
                .iter_mut()
                .for_each(|v| *v = if *v <= bottom { 0.0 } else { v.min(top) });
        }
        let blind = fit_study(&study, &Options::default(), &Control::none()).unwrap();
        naive += value(&blind, "g_lim_mpa").0.ln();
        study.instrument = Some(thenar_recordings::study::Instrument {
            saturation_kpa: Some(0.6 * peak),
            threshold_kpa: Some(0.1 * peak),
            ..Default::default()
        });
        let fit = fit_study(&study, &Options::default(), &Control::none()).unwrap();
        let kinds = |kind: Censoring| {
            fit.measured[0]
                .samples
                .iter()
                .filter(|s| s.censoring == kind)
                .count()
        };
        assert!(kinds(Censoring::AtLeast) > 50 && kinds(Censoring::AtMost) > 50);
        let off = (value(&fit, "g_lim_mpa").0 / TRUE_GLIM).ln();
        (sum, square) = (sum + off, square + off * off);
    }
    let n = seeds as f64;
    let (mean, error) = (sum / n, (square / n / n).sqrt());
    println!(
        "log Glim off by {mean:.4} +- {error:.4}; with clipping not known {:.4}",
        naive / n - TRUE_GLIM.ln()
    );
    assert!(mean.abs() < 3.0 * error.max(0.005), "{mean} {error}");
    assert!((naive / n - TRUE_GLIM.ln()).abs() > 3.0 * mean.abs());
}

#[test]
fn counts_give_shape_and_pose_without_a_size() {
    let shift = [0.8, -0.5];
    let mut study = measured(shift, (0.003, 0.01), 2);
    for recording in 0..2 {
        let map = map_of(&mut study, recording);
        map.unit = PressureUnit::RawCounts;
        map.values.iter_mut().for_each(|v| *v *= 7.5);
    }
    let fit = fit_study(&study, &Options::default(), &Control::none()).unwrap();
    let (x, y) = (value(&fit, "pose_x_mm").0, value(&fit, "pose_y_mm").0);
    assert!(
        (x - shift[0]).abs() < 0.15 && (y - shift[1]).abs() < 0.15,
        "{x} {y}"
    );
    let (_, low, high) = value(&fit, "g0_mpa");
    assert!(
        high / low > 10.0,
        "counts alone must not tell a modulus: {low} to {high}"
    );
}

/// Frames in counts without a depth: on a skin of known moduli the shape tells the force, and so how many counts a kPa is.
#[test]
fn counts_without_a_depth_are_compared_by_the_shape_of_their_force() {
    let mut study = measured([0.0, 0.0], (0.003, 0.01), 3);
    for recording in 0..2 {
        let map = map_of(&mut study, recording);
        map.unit = PressureUnit::RawCounts;
        map.values.iter_mut().for_each(|v| *v *= 7.5);
        map.channels
            .retain(|channel| !["depth_mm", "force_n"].contains(&channel.name.as_str()));
    }
    for material in &mut study.skin.materials {
        (material.g0_mpa, material.g_lim_mpa) = (Some(TRUE_G0), Some(TRUE_GLIM));
        material.fit.clear();
    }
    let fit = fit_study(&study, &Options::default(), &Control::none()).unwrap();
    let counts: Vec<_> = (fit.estimates.iter())
        .filter(|e| e.name == "counts_per_kpa")
        .collect();
    assert_eq!(counts.len(), 2);
    for one in counts {
        println!("{} ({} to {})", one.value, one.low, one.high);
        assert!((one.value / 7.5 - 1.0).abs() < 0.15 && !one.is_at_bound);
    }
    let told = fit.measured[0].unknown.join(" ");
    assert!(
        told.contains("at the counts per kPa that fit its shapes best"),
        "{told}"
    );
}

#[test]
fn a_long_export_is_compared_by_means_of_its_frames() {
    let mut study = planned(28, 1.0, 309);
    study.recordings.truncate(1);
    let mut fitting = Fitting::new(&study, &Control::none()).unwrap();
    let clean = fitting.simulate(&[], &Control::none()).unwrap();
    let (_, depths) = press_hold_release((2.0, 0.5, 2.0), 309);
    // Frames between the means that were simulated: the time does not depend on what they hold.
    let means = fitting.measured()[0].moments.clone();
    let mut dice = Dice(3);
    let map = map_of(&mut study, 0);
    for (frame, depth) in depths.iter().enumerate() {
        let off = |k: &usize| (means[*k].depth_mm - depth).abs();
        let near = (0..means.len())
            .min_by(|a, b| off(a).total_cmp(&off(b)))
            .unwrap();
        for cell in 0..784 {
            let p = clean[0][near * 784 + cell];
            map.values[frame * 784 + cell] = if p > 0.0 {
                (p * (1.0 + 0.02 * dice.normal())).max(0.0)
            } else {
                0.0
            };
        }
    }
    let started = std::time::Instant::now();
    let fit = fit_study(&study, &Options::default(), &Control::none()).unwrap();
    let seconds = started.elapsed().as_secs_f64();
    println!(
        "309 frames of 28 x 28: {} samples fitted and compared in {seconds:.2} s",
        fit.simulated[0].len()
    );
    assert!(fit.simulated[0].len() < 309 * 784 / 5);
    let (g0, _, _) = value(&fit, "g0_mpa");
    assert!((g0 / TRUE_G0 - 1.0).abs() < 0.05, "{g0}");
}
