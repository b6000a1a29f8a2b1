//! Mats of sensels against closed forms: force kept, even pressure, Hertz over a square, mats that bend, shift and turn.

use std::f64::consts::{PI, TAU};

use thenar_contact::instrument::{Mat, MatLayout, Placement, PointLoad};
use thenar_surface::Vec3;

/// A flat mat of `rows` x `columns` sensels around the origin, normals up, first direction x.
fn flat(rows: usize, columns: usize, pitch: [f64; 2]) -> MatLayout {
    let middle = |count: usize, k: usize| k as f64 - 0.5 * (count as f64 - 1.0);
    let mut layout = MatLayout {
        along: Some(Vec3::x()),
        ..MatLayout::default()
    };
    for row in 0..rows {
        for column in 0..columns {
            let (x, y) = (
                pitch[0] * middle(columns, column),
                pitch[1] * middle(rows, row),
            );
            layout.centers.push(Vec3::new(x, y, 0.0));
            layout.normals.push(Vec3::z());
            layout.areas.push(pitch[0] * pitch[1]);
        }
    }
    layout
}

/// The same wrapped around a cylinder of that radius about y: x becomes an arc, the middle lies on top.
fn wrapped(mut layout: MatLayout, radius: f64) -> MatLayout {
    for (center, normal) in layout.centers.iter_mut().zip(&mut layout.normals) {
        let angle = center.x / radius;
        *normal = Vec3::new(angle.sin(), 0.0, angle.cos());
        *center = *normal * radius + Vec3::new(0.0, center.y, 0.0);
    }
    layout
}

fn load(x: f64, y: f64, force_n: f64, area_mm2: f64) -> PointLoad {
    PointLoad {
        position: Vec3::new(x, y, 0.0),
        force_n,
        area_mm2,
    }
}

/// Hertz's pressure with a = 6 mm and a peak of 0.03 MPa on small squares, its center at (x, y).
fn hertz(x: f64, y: f64) -> Vec<PointLoad> {
    let (a, peak, step) = (6.0f64, 0.03, 0.1);
    let mut loads = Vec::new();
    for i in -60..60 {
        for j in -60..60 {
            let (u, v) = (step * (f64::from(i) + 0.5), step * (f64::from(j) + 0.5));
            let rest = 1.0 - (u * u + v * v) / (a * a);
            if rest > 0.0 {
                loads.push(load(
                    x + u,
                    y + v,
                    peak * rest.sqrt() * step * step,
                    step * step,
                ));
            }
        }
    }
    loads
}

/// Mean of that pressure over a square, kPa, by Gauss-Legendre's rule in one direction and the closed form in the other.
fn hertz_over(center: [f64; 2], side: f64) -> f64 {
    let (a, peak) = (6.0f64, 30.0);
    let primitive = |v: f64, half: f64| {
        let v = v.clamp(-half, half);
        0.5 * (v * (half * half - v * v).max(0.0).sqrt()
            + half * half * (v / half).clamp(-1.0, 1.0).asin())
    };
    let count = 20_000;
    let mut sum = 0.0;
    for i in 0..count {
        let u = center[0] + side * ((f64::from(i) + 0.5) / f64::from(count) - 0.5);
        let half = (a * a - u * u).max(0.0).sqrt();
        if half > 0.0 {
            let (low, high) = (center[1] - 0.5 * side, center[1] + 0.5 * side);
            sum += primitive(high, half) - primitive(low, half);
        }
    }
    peak / a * sum / (f64::from(count) * side)
}

#[test]
fn an_even_pressure_reads_even_and_its_force_is_kept() {
    let mat = Mat::new(flat(6, 8, [5.0, 4.0])).unwrap();
    // Squares of 0.7 mm do not fit the sensels: footprints straddle their sides.
    let mut loads = Vec::new();
    for i in -60..60 {
        for j in -60..60 {
            loads.push(load(
                0.7 * f64::from(i) + 0.21,
                0.7 * f64::from(j) - 0.13,
                0.02 * 0.49,
                0.49,
            ));
        }
    }
    let frame = mat.read(&loads);
    for reading in &frame {
        assert!((reading - 20.0).abs() < 1e-9, "{reading}");
    }
    assert!((mat.force_n(&frame) - 0.02 * 48.0 * 20.0).abs() < 1e-9);
    assert!((mat.area_mm2(&frame, 1.0) - 960.0).abs() < 1e-9);
}

#[test]
fn hertz_is_read_as_its_mean_over_each_square() {
    let mat = Mat::new(flat(5, 5, [5.0, 5.0])).unwrap();
    let loads = hertz(1.3, -0.7);
    let frame = mat.read(&loads);
    let force: f64 = loads.iter().map(|l| l.force_n).sum();
    assert!((mat.force_n(&frame) - force).abs() < 1e-12 * force);
    assert!((force / (2.0 / 3.0 * PI * 36.0 * 0.03) - 1.0).abs() < 1e-3);
    let peak = frame.iter().fold(0.0, |most: f64, p| most.max(*p));
    for (center, reading) in mat.centers().iter().zip(&frame) {
        let expected = hertz_over([center.x - 1.3, center.y + 0.7], 5.0);
        assert!(
            (reading - expected).abs() < 0.01 * peak,
            "{center}: {reading}, {expected}"
        );
        if expected > 0.1 * peak {
            assert!(
                (reading / expected - 1.0).abs() < 0.01,
                "{center}: {reading}, {expected}"
            );
        }
    }
}

#[test]
fn force_is_kept_on_a_cylinder_on_its_skin_side_too() {
    let radius = 24.0;
    let mat = Mat::new(wrapped(flat(6, 12, [5.0, 5.0]), radius)).unwrap();
    for lift in [-0.5, 0.0, 0.5, 1.0] {
        let mut loads = Vec::new();
        for i in 0..97 {
            for j in 0..53 {
                let (angle, y) = (
                    (-25.0 + 50.0 * f64::from(i) / 96.0) / radius,
                    -12.0 + 24.0 * f64::from(j) / 52.0,
                );
                let position = Vec3::new(angle.sin(), 0.0, angle.cos()) * (radius + lift)
                    + Vec3::new(0.0, y, 0.0);
                loads.push(PointLoad {
                    position,
                    force_n: 0.01,
                    area_mm2: 1.0,
                });
            }
        }
        let force = mat.force_n(&mat.read(&loads));
        assert!(
            (force / (0.01 * 97.0 * 53.0) - 1.0).abs() < 1e-9,
            "{lift}: {force}"
        );
    }
}

#[test]
fn force_is_kept_on_a_mat_around_a_whole_cylinder() {
    let columns = 30;
    let radius = 5.0 * f64::from(columns) / TAU;
    let mat = Mat::new(wrapped(flat(4, columns as usize, [5.0, 5.0]), radius)).unwrap();
    for degree in 0..360 {
        let angle = f64::from(degree).to_radians();
        let position = Vec3::new(angle.sin(), 0.0, angle.cos()) * radius + Vec3::new(0.0, 0.4, 0.0);
        let frame = mat.read(&[PointLoad {
            position,
            force_n: 1.0,
            area_mm2: 4.0,
        }]);
        assert!((mat.force_n(&frame) - 1.0).abs() < 1e-9, "{degree}");
        assert!(frame.iter().filter(|p| **p > 0.0).count() <= 4, "{degree}");
    }
}

#[test]
fn loads_off_the_mat_or_on_a_missing_cell_are_not_read() {
    let mut layout = flat(3, 3, [5.0, 5.0]);
    for list in [&mut layout.centers, &mut layout.normals] {
        list.remove(4);
    }
    layout.areas.remove(4);
    let mat = Mat::new(layout).unwrap();
    for (x, y, kept) in [
        (0.0, 0.0, 0.0),
        (9.0, 0.0, 0.0),
        (5.0, 0.0, 1.0),
        (7.5, 0.0, 0.5),
        (2.5, 0.0, 0.5),
    ] {
        let force = mat.force_n(&mat.read(&[load(x, y, 1.0, 1.0)]));
        assert!((force - kept).abs() < 1e-9, "{x} {y}: {force}");
    }
    // Nor is what is far off it.
    let far = PointLoad {
        position: Vec3::new(5.0, 5.0, 30.0),
        force_n: 1.0,
        area_mm2: 1.0,
    };
    assert_eq!(mat.force_n(&mat.read(&[far])), 0.0);
}

#[test]
fn the_mat_unrolls_without_stretching() {
    let layout = flat(4, 14, [5.0, 3.0]);
    let mat = Mat::new(wrapped(layout.clone(), 12.0)).unwrap();
    assert!((mat.pitch_mm()[0] - 5.0).abs() < 1e-9 && (mat.pitch_mm()[1] - 3.0).abs() < 1e-9);
    for (found, center) in mat.flat().iter().zip(&layout.centers) {
        assert!(
            (found[0] - center.x).abs() < 1e-9 && (found[1] - center.y).abs() < 1e-9,
            "{found:?} {center}"
        );
    }
}

#[test]
fn a_mat_without_normals_finds_them() {
    let mut layout = wrapped(flat(6, 6, [5.0, 5.0]), 30.0);
    let given = Mat::new(layout.clone()).unwrap();
    layout.normals.clear();
    let found = Mat::new(layout).unwrap();
    for (a, b) in given.normals().iter().zip(found.normals()) {
        assert!(a.dot(b).abs() > 0.97, "{a} {b}");
    }
}

#[test]
fn moving_the_mat_is_moving_the_load_the_other_way() {
    let mat = Mat::new(flat(7, 7, [5.0, 5.0])).unwrap();
    let placement = Placement {
        shift_mm: [2.0, -1.5],
        turn_rad: 0.0,
    };
    let (moved, there) = (
        mat.read_at(&hertz(0.0, 0.0), &placement),
        mat.read(&hertz(-2.0, 1.5)),
    );
    for (a, b) in moved.iter().zip(&there) {
        assert!((a - b).abs() < 1e-9, "{a} {b}");
    }
    // A quarter turn about the middle is seen as the contact turning back; then the shift.
    let placement = Placement {
        shift_mm: [1.0, 0.0],
        turn_rad: 0.5 * PI,
    };
    let (moved, there) = (
        mat.read_at(&hertz(4.0, 2.0), &placement),
        mat.read(&hertz(2.0, -3.0)),
    );
    for (a, b) in moved.iter().zip(&there) {
        assert!((a - b).abs() < 1e-6, "{a} {b}");
    }
}

#[test]
fn a_shift_around_a_cylinder_is_an_arc() {
    let radius = 20.0;
    let mat = Mat::new(wrapped(flat(5, 12, [5.0, 5.0]), radius)).unwrap();
    let at = |arc: f64| {
        let angle: f64 = arc / radius;
        let position = Vec3::new(angle.sin(), 0.0, angle.cos()) * radius;
        [PointLoad {
            position,
            force_n: 1.0,
            area_mm2: 9.0,
        }]
    };
    for shift in [0.7, 5.0, 13.0] {
        let placement = Placement {
            shift_mm: [shift, 0.0],
            turn_rad: 0.0,
        };
        let (moved, there) = (
            mat.read_at(&at(4.0), &placement),
            mat.read(&at(4.0 - shift)),
        );
        let most = moved
            .iter()
            .zip(&there)
            .map(|(a, b)| (a - b).abs())
            .fold(0.0, f64::max);
        let peak = there.iter().fold(0.0, |most: f64, p| most.max(*p));
        assert!(most < 0.005 * peak, "{shift}: {most} of {peak}");
    }
}

#[test]
fn readings_change_steadily_as_the_mat_moves() {
    let mat = Mat::new(flat(5, 5, [5.0, 5.0])).unwrap();
    let loads = hertz(0.4, 0.3);
    let read = |shift: f64| {
        mat.read_at(
            &loads,
            &Placement {
                shift_mm: [shift, 0.0],
                turn_rad: 0.0,
            },
        )
    };
    let (low, here, high) = (read(0.95), read(1.0), read(1.05));
    // The slope to the left is the slope to the right, and the mean over a square moves as the difference of its sides.
    for ((a, b), c) in low.iter().zip(&here).zip(&high) {
        assert!((2.0 * b - a - c).abs() < 0.01, "{a} {b} {c}");
    }
    let slope = (hertz_over([0.55, -0.3], 5.0) - hertz_over([0.65, -0.3], 5.0)) / -0.1;
    let middle = (high[12] - low[12]) / 0.1;
    assert!(
        (middle - slope).abs() < 0.02 * slope.abs().max(0.5),
        "{middle} {slope}"
    );
}

#[test]
fn bad_mats_are_refused_in_one_sentence() {
    let good = || flat(2, 2, [5.0, 5.0]);
    let refused = |layout: MatLayout| Mat::new(layout).unwrap_err().to_string();
    let mut bad = good();
    bad.areas[2] = -1.0;
    assert_eq!(
        refused(bad),
        "mat: sensel 2 has an area of -1 mm2; give one above 0"
    );
    let mut bad = good();
    bad.centers[1] = bad.centers[3];
    assert_eq!(
        refused(bad),
        "mat: sensels 1 and 3 lie on the same place; leave one out"
    );
    let mut bad = good();
    bad.normals[3] = Vec3::zeros();
    assert_eq!(
        refused(bad),
        "mat: the normal of sensel 3 has no direction; give the surface's there"
    );
    let mut bad = good();
    bad.centers[0].y = f64::NAN;
    assert_eq!(
        refused(bad),
        "mat: the center of sensel 0 is not finite; leave missing cells out"
    );
    let mut bad = good();
    bad.areas.pop();
    assert_eq!(
        refused(bad),
        "mat: 4 centers, 3 areas and 4 normals; give one of each per sensel, or no normals"
    );
    assert_eq!(
        refused(MatLayout::default()),
        "mat: it has 0 sensels; give 1 to 16384"
    );
}
