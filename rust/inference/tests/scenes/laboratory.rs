//! A made-up laboratory: plate and ball, two speeds, three repeats, and noise as instruments and operators make it.

use thenar_contact::Control;
use thenar_inference::Fitting;
use thenar_recordings::Study;
use thenar_recordings::meshes::MeshFile;
use thenar_recordings::study::Shape;

use super::{Dice, add, curve, curve_of, material, pad, press_hold_release, study};

pub const TRUE_G0: f64 = 0.0085;
pub const TRUE_GLIM: f64 = 0.02;

/// Noise as in laboratories: white and coloured by 0.15 s, gain and first touch that differ from repeat to repeat, a few outliers.
pub struct Laboratory {
    pub noise: f64,
    pub memory_s: f64,
    pub gain: f64,
    /// Of each repeat, mm.
    pub zero_mm: f64,
    /// Of all recordings with one tool: the operator's habit, mm.
    pub habit_mm: f64,
    pub outliers: f64,
}

pub const USUAL: Laboratory = Laboratory {
    noise: 0.01,
    memory_s: 0.15,
    gain: 0.04,
    zero_mm: 0.02,
    habit_mm: 0.05,
    outliers: 0.01,
};

/// Plate and ball, two speeds, three repeats each, on a pad of about 250 vertices; forces are still those of nothing.
pub fn planned() -> Study {
    planned_on(pad(8.0, 7.0, 0.9))
}

/// The same on other skin.
pub fn planned_on(skin: MeshFile) -> Study {
    let mut study = study(
        skin,
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
pub fn clean() -> (Study, Vec<Vec<f64>>) {
    clean_of(planned())
}

/// The same of another study.
pub fn clean_of(study: Study) -> (Study, Vec<Vec<f64>>) {
    let forces = Fitting::new(&study, &Control::none())
        .unwrap()
        .simulate(&[], &Control::none())
        .unwrap();
    (study, forces)
}

/// The model's own forces as a laboratory would have measured them: this tests intervals, not the model.
pub fn measured(
    (study, forces): &(Study, Vec<Vec<f64>>),
    laboratory: &Laboratory,
    seed: u64,
) -> Study {
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
