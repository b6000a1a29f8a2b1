//! Presses in a row: warm starts, and Live while a part of the skin, all of it, or the product moves.

use nalgebra::Rotation3;
use thenar_contact::{Drag, ForceTarget, Model, Press, Start};
use thenar_surface::Vec3;

use crate::presses::{of, pressed};
use crate::scenes::{Bench, flat_skin, lattice, material, press_posed};
use crate::shapes::{bowl, dome, halves, named, plain, stiffening, switch_on};
use crate::{Bits, Case, case};

const FRAMES: usize = 8;

pub fn cases() -> Vec<Case> {
    vec![
        case("warm, tilting", |bits| {
            follow(bits, &mut skin(&[]), Start::Warm, tilted);
        }),
        case("live, a bump moves", |bits| {
            follow(bits, &mut skin(&[]), Start::Live, bumped);
        }),
        case("live, tilting", |bits| {
            follow(bits, &mut skin(&[]), Start::Live, tilted);
        }),
        case("live, stiff skin", |bits| {
            follow(bits, &mut skin(&["stiff_skin"]), Start::Live, tilted);
        }),
        case("live, adhesion", |bits| {
            let mut skin = plain(lattice(9.0, 1.2, 0.3), material(5.0));
            switch_on(&mut skin, vec![named("adhesion", 0.8)]);
            for frame in 0..FRAMES {
                let product = bowl(40.0, 0.3 + 0.1 * (frame as f64).sin(), 14.0);
                let request = Press {
                    start: Start::Live,
                    ..of(&product)
                };
                bits.contact(&pressed(&mut skin, &request));
            }
        }),
        case("live, paper", |bits| {
            let mut skin = flat_skin(16.0, 1.6, stiffening(), Model::Paper);
            let rest = lattice(16.0, 1.6, 0.3).positions().to_vec();
            let product = bowl(60.0, 1.5, 30.0);
            for frame in 0..FRAMES {
                let posed: Vec<Vec3> = rest.iter().map(|p| bumped(p, frame)).collect();
                let request = Press {
                    posed: Some(&posed),
                    start: Start::Live,
                    ..of(&product)
                };
                bits.contact(&pressed(&mut skin, &request));
            }
        }),
        case("live, the product moves", |bits| {
            let mut skin = skin(&[]);
            for frame in 0..FRAMES {
                let product = bowl(60.0, 1.5 + 0.1 * (frame as f64).sin(), 30.0);
                let request = Press {
                    start: Start::Live,
                    ..of(&product)
                };
                bits.contact(&pressed(&mut skin, &request));
            }
        }),
        case("live, force target and drag", |bits| {
            let mut skin = plain(dome(9.0, 1.2, 14.0), material(6.0));
            switch_on(&mut skin, vec![named("friction", 1.0)]);
            let product = bowl(40.0, 0.3, 14.0);
            for frame in 0..FRAMES {
                let travel = Vec3::new(0.03 * frame as f64, 0.0, 0.0);
                let request = Press {
                    force: Some(ForceTarget {
                        newton: 1.0 + 0.1 * frame as f64,
                        direction: Some(-Vec3::z()),
                    }),
                    drag: Some(Drag::Motion {
                        travel,
                        turn: Vec3::zeros(),
                    }),
                    start: Start::Live,
                    ..of(&product)
                };
                bits.contact(&pressed(&mut skin, &request));
            }
        }),
    ]
}

/// 18 mm of skin in two regions.
fn skin(effects: &[&str]) -> Bench {
    let mesh = lattice(18.0, 1.2, 0.3);
    let mut skin = halves(mesh, [material(5.0), stiffening()], Model::Layer);
    switch_on(
        &mut skin,
        effects.iter().map(|name| named(name, 0.8)).collect(),
    );
    skin
}

/// Follows a motion, then presses the last posture from nothing.
fn follow(bits: &mut Bits, skin: &mut Bench, start: Start, at: fn(&Vec3, usize) -> Vec3) {
    let rest = lattice(18.0, 1.2, 0.3).positions().to_vec();
    let product = bowl(90.0, 1.6, 32.0);
    let mut posed = rest.clone();
    for frame in 0..FRAMES {
        posed = rest.iter().map(|p| at(p, frame)).collect();
        let request = Press {
            posed: Some(&posed),
            start,
            ..of(&product)
        };
        bits.contact(&pressed(skin, &request));
    }
    bits.contact(&press_posed(skin, &product, &posed));
}

/// A bump of 8 mm about (9, 0) that rises and falls; the rest lies exactly where it was.
fn bumped(p: &Vec3, frame: usize) -> Vec3 {
    let off = (p - Vec3::new(9.0, 0.0, 0.0)).norm_squared() / 64.0;
    p + Vec3::z() * (1.1 * (0.3 * frame as f64).sin() * (1.0 - off).max(0.0).powi(2))
}

fn tilted(p: &Vec3, frame: usize) -> Vec3 {
    let angle = 0.01 * (frame as f64).sin();
    Rotation3::from_euler_angles(angle, 0.5 * angle, 0.0) * p + Vec3::z() * (0.02 * frame as f64)
}
