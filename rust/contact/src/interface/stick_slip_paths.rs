//! Tests of stick-slip over load paths: Mindlin and Deresiewicz's loop, passivity, limits.

use thenar_surface::Vec3;

use super::shear_kernel::LATTICE;
use super::shear_matrix::ShearMatrix;
use super::stick_slip::{SiteFriction, StickSlipProblem};
use crate::Control;

const SHEAR_MODULUS: f64 = 0.02;
const QUIET: &Control<'static> = &Control {
    cancelled: &|| false,
    progress: &|_, _| {},
};

/// A flat disc of points on a square lattice under Hertz's pressure, of radius 1 mm and total force 1 N.
struct Disc {
    points: Vec<Vec3>,
    normal_force: Vec<f64>,
    matrix: ShearMatrix<f32>,
}

fn disc(spacing: f64) -> Disc {
    let reach = (1.0 / spacing).ceil() as i32;
    let mut points = Vec::new();
    for i in -reach..=reach {
        for j in -reach..=reach {
            let p = Vec3::new(f64::from(i) + 0.31, f64::from(j) - 0.17, 0.0) * spacing;
            if p.norm() < 1.0 {
                points.push(p);
            }
        }
    }
    let pressure = |p: &Vec3| 1.5 / std::f64::consts::PI * (1.0 - p.norm_squared()).sqrt();
    let normal_force = points
        .iter()
        .map(|p| pressure(p) * spacing * spacing)
        .collect();
    let unit = 1.0 / (std::f64::consts::TAU * SHEAR_MODULUS);
    let own = vec![0.75 * LATTICE / spacing * unit; points.len()];
    let matrix = ShearMatrix::from_blocks(&own, |i, j| {
        let chord = points[j] - points[i];
        let r = chord.norm();
        let c = chord / r;
        let block = |a: f64, b: f64, same: f64| unit * (0.5 * same + 0.5 * a * b) / r;
        [
            block(c.x, c.x, 1.0),
            block(c.x, c.y, 0.0),
            block(c.y, c.x, 0.0),
            block(c.y, c.y, 1.0),
        ]
    });
    Disc {
        points,
        normal_force,
        matrix,
    }
}

/// Travel of a dragged Hertz contact over `3 (2 - nu) mu P / (16 G a)` (Mindlin 1949), `share` being Q / mu P.
fn mindlin(share: f64) -> f64 {
    1.0 - (1.0 - share).powf(2.0 / 3.0)
}

fn grip<'a>(
    disc: &'a Disc,
    planes: &'a [[Vec3; 2]],
    workspace: (&'a [f64], &'a [Option<SiteFriction>]),
) -> StickSlipProblem<'a> {
    StickSlipProblem {
        matrix: &disc.matrix,
        tangents: planes,
        limit: workspace.0,
        before: workspace.1,
    }
}

#[test]
fn a_loop_to_and_fro_is_the_one_of_mindlin_and_deresiewicz() {
    let disc = disc(1.0 / 9.0);
    let n = disc.points.len();
    let planes = vec![[Vec3::x(), Vec3::y()]; n];
    let limit: Vec<f64> = disc.normal_force.iter().map(|p| 0.4 * p).collect();
    let most: f64 = limit.iter().sum();
    let unit = 3.0 * 1.5 * most / (16.0 * SHEAR_MODULUS);
    let turn_at = 0.8;
    // Loading by Mindlin's curve, then twice the curve at half the change: Masing's rule, exact for Hertz.
    let back = |share: f64| mindlin(turn_at) - 2.0 * mindlin(0.5 * (turn_at - share));
    let mut before = vec![None; n];
    let (mut travel, mut force, mut lost, mut work) = (0.0, 0.0, 0.0, 0.0);
    let loading = (1..=4).map(|k| 0.2 * f64::from(k));
    let unloading = (1..=40).map(|k| 0.8 - 0.04 * f64::from(k));
    let again = (1..=40).map(|k| -0.8 + 0.04 * f64::from(k));
    for (step, share) in loading.chain(unloading).chain(again).enumerate() {
        let grip = grip(&disc, &planes, (&limit, &before));
        let here = vec![Vec3::x() * travel; n];
        let wanted = (&vec![Vec3::x(); n][..], Vec3::x(), share * most);
        let (moved, end) = grip
            .drag_to_force(&here, wanted, QUIET)
            .expect("less than all");
        if step >= 4 {
            lost += end.dissipated;
            work += 0.5 * (force + share * most) * moved;
        }
        (travel, force) = (travel + moved, share * most);
        if step < 4 {
            assert!((travel / (unit * mindlin(share)) - 1.0).abs() < 0.01);
        } else if step < 44 {
            assert!(
                (travel / unit - back(share)).abs() < 0.01,
                "{share}: {travel}"
            );
        }
        before = end.traces.into_iter().map(Some).collect();
    }
    assert!(
        (travel / unit - mindlin(turn_at)).abs() < 0.01,
        "the loop closes"
    );
    let area: f64 = (0..2000)
        .map(|k| -turn_at + 2.0 * turn_at * (f64::from(k) + 0.5) / 2000.0)
        .map(|share| (back(share) + back(-share)) * 2.0 * turn_at / 2000.0)
        .sum();
    assert!(
        (work / (area * unit * most) - 1.0).abs() < 0.02,
        "{work} {}",
        area * unit * most
    );
    assert!((lost / work - 1.0).abs() < 0.1, "{lost} {work}");
}

#[test]
fn no_closed_path_gives_energy() {
    let disc = disc(1.0 / 2.5);
    let n = disc.points.len();
    let planes = vec![[Vec3::x(), Vec3::y()]; n];
    let limit: Vec<f64> = disc.normal_force.iter().map(|p| 0.5 * p).collect();
    let mut seed = 7u64;
    let mut dice = move || {
        seed = seed
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (seed >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    };
    for path in 0..10_000 {
        let reach = 10f64.powf(2.0 * dice());
        let steps = 2 + path % 5;
        let mut before = vec![None; n];
        let (mut here, mut force) = (Vec3::zeros(), Vec3::zeros());
        let (mut work, mut lost) = (0.0, 0.0);
        for step in 0..=steps {
            // The path ends where it began.
            let there = if step == steps {
                Vec3::zeros()
            } else {
                Vec3::new(dice(), dice(), 0.0) * reach
            };
            let grip = grip(&disc, &planes, (&limit, &before));
            let end = grip.drag(&vec![here; n], &vec![there; n], QUIET);
            assert!(end.residual <= 1e-8, "{}", end.residual);
            let change = there - here;
            work += end.force().dot(&change);
            lost += end.dissipated;
            force = end.force();
            assert!(end.stored >= 0.0 && work >= end.stored + lost - 1e-9 * (1.0 + work.abs()));
            before = end.traces.into_iter().map(Some).collect();
            here = there;
        }
        assert!(
            work >= -1e-9,
            "path {path}: {work} N mm, last force {force}"
        );
    }
}

#[test]
fn friction_without_normal_force_is_none_and_all_slips_in_the_end() {
    let disc = disc(1.0 / 6.0);
    let n = disc.points.len();
    let planes = vec![[Vec3::x(), Vec3::y()]; n];
    let before = vec![None; n];
    let (zero, rest) = (vec![0.0; n], vec![Vec3::zeros(); n]);
    let far = vec![Vec3::new(30.0, 40.0, 0.0); n];
    let none = grip(&disc, &planes, (&zero, &before)).drag(&rest, &far, QUIET);
    assert_eq!(none.force(), Vec3::zeros());
    assert_eq!(none.dissipated, 0.0);
    let limit: Vec<f64> = disc.normal_force.iter().map(|p| 0.3 * p).collect();
    let most: f64 = limit.iter().sum();
    let all = grip(&disc, &planes, (&limit, &before)).drag(&rest, &far, QUIET);
    assert!(all.is_sticking.iter().all(|s| !s));
    assert!(
        (all.force().norm() / most - 1.0).abs() < 1e-3,
        "{}",
        all.force().norm() / most
    );
    let wanted = (&vec![Vec3::x(); n][..], Vec3::x(), 1.001 * most);
    assert!(
        grip(&disc, &planes, (&limit, &before))
            .drag_to_force(&rest, wanted, QUIET)
            .is_none()
    );
}
