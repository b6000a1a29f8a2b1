//! Energy lost in closed cycles: none in elastic tissue, a Maxwell branch's in tissue that relaxes.

use crate::scenes;

use scenes::{Bench, flat_skin, material, paraboloid, revolve};
use thenar_contact::{ActiveEffect, Control, Course, Keep, Model, Protocol, Run};
use thenar_surface::{Product, Vec3};

fn follow(skin: &mut Bench, product: &Product, path: &[(f64, f64)]) -> Course {
    let (times, depths): (Vec<f64>, Vec<f64>) = path.iter().copied().unzip();
    let protocol = Protocol {
        direction: Some(-Vec3::z()),
        ..Protocol::of_depth(&times, &depths)
    };
    let run = Run {
        product,
        posed: None,
        protocol: &protocol,
        keep: Keep::Totals,
    };
    skin.run(&run, &Control::none()).unwrap()
}

/// Presses of a triangle wave: `peak` mm and a second each way, and a second of rest.
fn triangles(peak: f64, count: usize, step: f64) -> Vec<(f64, f64)> {
    let rows = (3.0 * count as f64 / step) as usize;
    let depth = |time: f64| {
        let phase = time % 3.0;
        peak * (1.0 - (phase - 1.0).abs()).max(-0.1)
    };
    (0..=rows)
        .map(|k| (k as f64 * step, depth(k as f64 * step) - 1e-9))
        .collect()
}

#[test]
fn elastic_cycles_lose_nothing() {
    let mut skin = flat_skin(6.0, 1.0, material(7.0), Model::Layer);
    let course = follow(
        &mut skin,
        &paraboloid(8.0, 0.0, 9.0),
        &triangles(0.8, 2, 0.02),
    );
    let cycles = course.cycles();
    assert_eq!(cycles.len(), 2);
    // What is left is the rows at both ends, which do not meet first touch.
    for cycle in &cycles {
        assert!(cycle.work > 0.01 && cycle.share().abs() < 2e-4, "{cycle:?}");
    }
    assert!(
        (cycles[1].start_s - 3.0).abs() < 0.1 && (cycles[1].end_s - 5.0).abs() < 0.1,
        "{cycles:?}"
    );
}

#[test]
fn a_flat_punch_on_tissue_that_relaxes_loses_what_a_maxwell_branch_does() {
    let (share, time, peak) = (0.5, 0.4, 0.2);
    let mut skin = flat_skin(6.0, 1.0, material(7.0), Model::Layer);
    let punch = revolve(|_| 0.0, 3.0, 60);
    let stiffness = follow(&mut skin, &punch, &[(0.0, peak)]).steps[0].force / peak;
    let relaxation = ActiveEffect::named("relaxation", share).unwrap();
    let relaxation = relaxation.with("time_1_s", time).unwrap();
    let relaxation = relaxation
        .with("weight_2", 0.0)
        .unwrap()
        .with("weight_3", 0.0)
        .unwrap();
    skin.set_effects(vec![relaxation], &Control::none())
        .unwrap();
    let course = follow(&mut skin, &punch, &triangles(peak, 1, 0.01));
    // One spring beside a Maxwell branch by small steps; the punch lets go where the force would pull.
    let (mut branch, mut before, mut work, mut most) = (0.0, 0.0, 0.0, 0.0f64);
    let (step, mut force) = (1e-5, 0.0);
    for k in 1..=200_000 {
        let at = f64::from(k) * step;
        let depth = peak * (1.0 - (at - 1.0).abs());
        branch = branch * (-step / time).exp() + share * stiffness * (depth - before);
        let next = f64::max((1.0 - share) * stiffness * depth + branch, 0.0);
        work += 0.5 * (force + next) * (depth - before);
        most = most.max(work);
        (before, force) = (depth, next);
        if next == 0.0 {
            break;
        }
    }
    let cycles = course.cycles();
    assert_eq!(cycles.len(), 1, "{cycles:?}");
    assert!(
        (cycles[0].work / most - 1.0).abs() < 0.01,
        "{cycles:?} {most}"
    );
    assert!(
        (cycles[0].loss / work - 1.0).abs() < 0.01,
        "{cycles:?} {work}"
    );
    assert!(cycles[0].share() > 0.2, "{cycles:?}");
}
