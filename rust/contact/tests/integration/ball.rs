//! A ball on a layer, with and without a stiff skin that stretches.

use thenar_contact::ball::{Ball, StiffSkin};

const DEPTHS: [f64; 6] = [0.05, 0.1, 0.2, 0.3, 0.5, 0.77];

fn forces((thickness, nu, radius): (f64, f64, f64), skin: Option<(f64, f64)>) -> Vec<f64> {
    let skin = skin.map(|(thickness_mm, ratio)| StiffSkin {
        thickness_mm,
        ratio,
    });
    Ball::new((thickness, nu), radius, DEPTHS[5])
        .forces(skin, &DEPTHS)
        .unwrap()
}

/// Sneddon 1965 for a sphere: d = a L / 2 and F = E* ((a^2 + R^2) L / 2 - a R), L = ln((R + a) / (R - a)), E* = 2 G / (1 - nu).
fn sneddon((nu, radius): (f64, f64), depth: f64) -> f64 {
    let log = |a: f64| ((radius + a) / (radius - a)).ln();
    let (mut low, mut high) = (0.0, radius);
    for _ in 0..60 {
        let a = 0.5 * (low + high);
        match 0.5 * a * log(a) < depth {
            true => low = a,
            false => high = a,
        }
    }
    2.0 / (1.0 - nu) * (0.5 * (low * low + radius * radius) * log(low) - low * radius)
}

#[test]
fn without_a_skin_a_half_space_answers_as_sneddon_has_it() {
    for nu in [0.5, 0.3] {
        for (force, depth) in forces((f64::INFINITY, nu, 3.0), None).iter().zip(DEPTHS) {
            let off = force / sneddon((nu, 3.0), depth) - 1.0;
            println!("nu {nu}, {depth} mm: {:+.2} %", 100.0 * off);
            assert!(off.abs() < 3e-3, "{nu} {depth}");
        }
    }
}

#[test]
fn a_skin_as_soft_as_the_layer_is_the_layer() {
    let layer = (5.5, 0.5, 5.0);
    let (with, without) = (forces(layer, Some((0.5, 1.0))), forces(layer, None));
    for (a, b) in with.iter().zip(&without) {
        assert!((a / b - 1.0).abs() < 1e-6, "{a} {b}");
    }
}

/// Lengths twice as large: areas, and so forces over G, four times.
#[test]
fn forces_go_as_the_square_of_all_lengths() {
    let skin = |scale: f64| StiffSkin {
        thickness_mm: 0.4 * scale,
        ratio: 20.0,
    };
    let at = |scale: f64| {
        let depths = DEPTHS.map(|d| d * scale);
        let ball = Ball::new((5.5 * scale, 0.5), 5.0 * scale, depths[5]);
        ball.forces(Some(skin(scale)), &depths).unwrap()
    };
    for (a, b) in at(2.0).iter().zip(at(1.0)) {
        assert!((a / b - 4.0).abs() < 1e-6, "{a} {b}");
    }
}
