//! What instruments make of a contact, and the solvers that stand by themselves: dense rows, stick and slip, a ball on a layer.

use thenar_contact::ball::{Ball, StiffSkin};
use thenar_contact::effects::{CATALOGUE, Effect};
use thenar_contact::instrument::{Mat, MatLayout, PointLoad, Signals, observe};
use thenar_contact::{ActiveEffect, solve_dense, solve_stick_slip};
use thenar_surface::Vec3;

use crate::scenes::Dice;
use crate::{Bits, Case, case};

const SIDE: usize = 6;

pub fn cases() -> Vec<Case> {
    let mut all: Vec<Case> = Vec::new();
    for (effect, entry) in CATALOGUE.iter().filter(|(_, e)| e.is_instrument()) {
        let name = format!("effect {}", entry.name);
        all.push(case(&name, move |bits| shown(bits, &[ready(*effect)])));
    }
    all.push(case("readings, all instruments", |bits| {
        let some = CATALOGUE.iter().filter(|(_, e)| e.is_instrument());
        let some: Vec<ActiveEffect> = some.map(|(effect, _)| ready(*effect)).collect();
        shown(bits, &some);
    }));
    all.push(case("ball on a layer", |bits| {
        let depths = [0.05, 0.1, 0.2, 0.3, 0.5];
        let ball = Ball::new((6.0, 0.45), 5.5, 0.5);
        let stiff = StiffSkin {
            thickness_mm: 0.4,
            ratio: 20.0,
        };
        for skin in [None, Some(stiff)] {
            bits.numbers(&ball.forces(skin, &depths).unwrap());
        }
    }));
    all.push(case("dense rows", |bits| {
        let (matrix, gap) = dense(120);
        let solution = solve_dense(matrix, &gap).unwrap();
        bits.numbers(&solution.force);
    }));
    all.push(case("dense rows, stick and slip", |bits| {
        let (matrix, _) = dense(60);
        let travel: Vec<f64> = (0..60).map(|k| 0.2 * f64::from(k % 7)).collect();
        let limit: Vec<f64> = (0..30).map(|k| 0.01 * f64::from(k)).collect();
        let solution = solve_stick_slip(&matrix, &travel, &limit).unwrap();
        bits.numbers(&solution.force);
        bits.numbers(&solution.slip);
    }));
    all
}

/// A compliance of points on a line with gaps of a blunt tool.
fn dense(n: usize) -> (Vec<f64>, Vec<f64>) {
    let mut dice = Dice(3);
    let at: Vec<f64> = (0..n).map(|k| k as f64 + 0.3 * dice.roll()).collect();
    let entry = |i: usize, j: usize| 1.0 / (1.0 + (at[i] - at[j]).powi(2));
    let matrix = (0..n * n).map(|k| entry(k / n, k % n)).collect();
    let gap = at.iter().map(|x| 0.01 * (x - 60.0).powi(2) - 2.0).collect();
    (matrix, gap)
}

fn ready(effect: Effect) -> ActiveEffect {
    let active = ActiveEffect::new(effect, 0.9);
    match effect {
        Effect::DeadCells => {
            let dead = |k: usize| f64::from(u8::from(k.is_multiple_of(5)));
            active.painted((0..SIDE * SIDE).map(dead).collect())
        }
        Effect::Saturation => active.with("ceiling_kpa", 3.0).unwrap(),
        Effect::Threshold => active.with("floor_kpa", 2.0).unwrap(),
        _ => active,
    }
}

fn shown(bits: &mut Bits, effects: &[ActiveEffect]) {
    let Signals {
        time_s,
        depth_mm,
        force_n,
        area_mm2,
        tangential_force_n,
        loads: _,
        frames,
    } = observe(&signals(), Some(&mat()), effects).unwrap();
    for channel in [
        time_s,
        depth_mm,
        force_n,
        area_mm2,
        tangential_force_n,
        frames.concat(),
    ] {
        bits.numbers(&channel);
    }
}

fn mat() -> Mat {
    let mut layout = MatLayout {
        along: Some(Vec3::x()),
        ..MatLayout::default()
    };
    for k in 0..SIDE * SIDE {
        let (row, column) = ((k / SIDE) as f64, (k % SIDE) as f64);
        let center = Vec3::new(5.0 * column - 12.5, 5.0 * row - 12.5, 0.0);
        layout.centers.push(center);
        layout.normals.push(Vec3::z());
        layout.areas.push(25.0);
    }
    Mat::new(layout).unwrap()
}

/// Loads on a spiral that grows with time, and channels to go with them.
fn signals() -> Signals {
    let mut signals = Signals::default();
    for k in 0..40 {
        let time = 0.05 * f64::from(k);
        let depth = (2.0 * time).sin().abs();
        let load = |j: i32| {
            let (angle, r) = (0.3 * f64::from(j), 4.0 * depth + 0.03 * f64::from(j));
            PointLoad {
                position: Vec3::new(r * angle.cos(), r * angle.sin(), 0.1),
                force_n: 0.01 * depth,
                area_mm2: 2.0,
            }
        };
        signals.time_s.push(time);
        signals.depth_mm.push(depth);
        signals.force_n.push(0.6 * depth);
        signals.area_mm2.push(50.0 * depth);
        signals.tangential_force_n.push(0.1 * depth);
        signals.loads.push((0..60).map(load).collect());
    }
    signals
}
