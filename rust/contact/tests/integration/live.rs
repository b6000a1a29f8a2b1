//! Live presses against full ones: a drag of part of the skin, of all of it, and of the product.

use crate::scenes;

use std::sync::atomic::{AtomicBool, Ordering};

use scenes::{Bench, lattice, material, paraboloid, press_posed};
use thenar_contact::{Contact, Control, Model, Press, Skin, SkinInput, Start, Unsolved};
use thenar_surface::{GapLimits, Mesh, Product, Vec3};

/// Largest difference of a nodal force from a full press, over the largest force.
const FORCE: f64 = 0.02;
/// The same of the sum of all forces.
const TOTAL: f64 = 0.005;
/// Largest difference of where skin in contact lies, along the product's normal, mm. Across it the written skin of a vertex
/// that just leaves or joins the contact leaps all the same.
const PLACE: f64 = 0.03;
/// Largest distance between the written surface and the product where they press, and largest penetration elsewhere, mm.
const FIT: f64 = 0.02;

fn skin(mesh: &Mesh) -> Bench {
    let input = SkinInput {
        mesh: mesh.clone(),
        regions: Vec::new(),
        materials: vec![material(5.0)],
        model: Model::Layer,
    };
    Bench::from(Skin::prepare(input, &Control::none()).unwrap())
}

fn follow(skin: &mut Bench, product: &Product, posed: &[Vec3], start: Start) -> Contact {
    let press = Press {
        product,
        posed: Some(posed),
        force: None,
        drag: None,
        start,
        unsolved: Unsolved::Refuse,
    };
    skin.press(&press, &Control::none()).unwrap()
}

/// The skin with a bump of 8 mm radius, `height` (mm), about (10, 0); the rest lies exactly where it was.
fn bumped(mesh: &Mesh, height: f64) -> Vec<Vec3> {
    let up = |p: &Vec3| {
        let off = (p - Vec3::new(10.0, 0.0, 0.0)).norm_squared() / 64.0;
        p + Vec3::z() * (height * (1.0 - off).max(0.0).powi(2))
    };
    mesh.positions().iter().map(up).collect()
}

fn assert_same(live: &Contact, full: &Contact, frame: usize) {
    assert!(live.convergence.has_converged, "{frame}");
    assert!(live.residual.complementarity <= 5e-3, "{frame}");
    assert!(
        live.residual.penetration_mm <= 0.02,
        "{frame}: {}",
        live.residual.penetration_mm
    );
    let largest = full.nodal_force.iter().fold(0.0, |m, f| f64::max(m, *f));
    let off = live.nodal_force.iter().zip(&full.nodal_force);
    let off = off.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(off < FORCE * largest, "{frame}: {off} N of {largest} N");
    let total: f64 = full.nodal_force.iter().sum();
    let off = (live.total_force - full.total_force).norm();
    assert!(off < TOTAL * total, "{frame}: {off} N of {total} N");
    let places = live.displacement.iter().zip(&full.displacement);
    let off = places
        .zip(&full.normal)
        .map(|((a, b), n)| (a - b).dot(n).abs());
    let off = off.fold(0.0, f64::max);
    assert!(off < PLACE, "{frame}: {off} mm");
}

/// The written surface, measured against the product anew.
fn assert_fits(live: &Contact, product: &Product, posed: &[Vec3], frame: usize) {
    let limits = GapLimits {
        cut_off_mm: 2.0,
        max_depth_mm: 2.0,
    };
    let written = posed.iter().zip(&live.displacement).zip(&live.nodal_force);
    for ((place, moved), force) in written {
        let Some(gap) = product.gap(place + moved, None, limits) else {
            continue;
        };
        let off = if *force > 0.0 {
            gap.distance.abs()
        } else {
            -gap.distance
        };
        assert!(off <= FIT, "{frame}: {off} mm under {force} N");
    }
}

#[test]
fn a_drag_of_part_of_the_skin_stays_with_full_presses_and_costs_fewer_steps() {
    let mesh = lattice(22.0, 1.2, 0.3);
    let product = paraboloid(90.0, 2.0, 40.0);
    let (mut live, mut warm) = (skin(&mesh), skin(&mesh));
    let (mut live_steps, mut warm_steps) = (0, 0);
    for frame in 0..30 {
        let posed = bumped(&mesh, 1.2 * (0.25 * frame as f64).sin());
        let shown = follow(&mut live, &product, &posed, Start::Live);
        let followed = follow(&mut warm, &product, &posed, Start::Warm);
        let full = press_posed(&mut skin(&mesh), &product, &posed);
        assert_same(&shown, &full, frame);
        assert_fits(&shown, &product, &posed, frame);
        if frame > 0 {
            live_steps += shown.convergence.cg_steps;
            warm_steps += followed.convergence.cg_steps;
        }
    }
    assert!(3 * live_steps < warm_steps, "{live_steps} {warm_steps}");
}

/// Skin slides over edges of 25 degrees: its distance there does not grow evenly with its way.
#[test]
fn the_written_surface_fits_a_product_with_edges() {
    let mesh = lattice(16.0, 1.2, 0.3);
    let product = paraboloid(12.0, 5.0, 30.0);
    let mut live = skin(&mesh);
    for frame in 0..20 {
        let along = Vec3::new(0.5, 0.3, 0.0) * (0.4 * f64::from(frame)).sin() * 4.0;
        let posed = bumped(&mesh, 0.6 * (0.3 * f64::from(frame)).sin());
        let posed: Vec<Vec3> = posed.iter().map(|p| p + along).collect();
        let shown = follow(&mut live, &product, &posed, Start::Live);
        assert!(shown.convergence.has_converged, "{frame}");
        assert_fits(&shown, &product, &posed, frame as usize);
    }
}

#[test]
fn nothing_drifts_where_all_moves_the_product_changes_or_nothing_moves() {
    let mesh = lattice(16.0, 1.3, 0.3);
    let products = [paraboloid(60.0, 1.5, 30.0), paraboloid(40.0, 1.8, 30.0)];
    let mut live = skin(&mesh);
    for frame in 0..24 {
        let product = &products[frame / 5 % 2];
        let up = Vec3::z() * (0.2 * (0.7 * frame as f64).sin());
        let mut posed: Vec<Vec3> = bumped(&mesh, 0.1 * (frame / 2 % 4) as f64);
        if frame > 8 {
            posed.iter_mut().for_each(|p| *p += up);
        }
        let shown = follow(&mut live, product, &posed, Start::Live);
        let full = press_posed(&mut skin(&mesh), product, &posed);
        assert_same(&shown, &full, frame);
        assert_fits(&shown, product, &posed, frame);
    }
}

#[test]
fn other_presses_of_that_skin_know_nothing_of_it() {
    let mesh = lattice(14.0, 1.3, 0.3);
    let product = paraboloid(60.0, 1.5, 30.0);
    let mut live = skin(&mesh);
    let bare = |contact: Contact| Contact {
        seconds: Vec::new(),
        ..contact
    };
    for frame in 0..4 {
        let posed = bumped(&mesh, 0.2 * f64::from(frame));
        follow(&mut live, &product, &posed, Start::Live);
    }
    let posed = bumped(&mesh, 0.3);
    let full = bare(press_posed(&mut skin(&mesh), &product, &posed));
    assert_eq!(bare(press_posed(&mut live, &product, &posed)), full);
    let off = Vec3::z() * -30.0;
    let away: Vec<Vec3> = posed.iter().map(|p| p + off).collect();
    let free = follow(&mut live, &product, &away, Start::Live);
    assert!(free.nodal_force.iter().all(|f| *f == 0.0));
    assert!(free.displacement.iter().all(|u| u.norm() < 1e-9));
    let back = follow(&mut live, &product, &posed, Start::Live);
    assert_same(&back, &full, 5);
}

/// A press that is broken off after its solve is no last press, but what it solved may be held: skin that holds it bears the forces
/// of that posture and not those of the press before.
#[test]
fn held_skin_keeps_the_forces_of_a_press_that_was_broken_off() {
    let mesh = lattice(14.0, 1.3, 0.3);
    let product = paraboloid(60.0, 1.5, 30.0);
    let (before, then) = (bumped(&mesh, 0.0), bumped(&mesh, 0.8));
    let mut live = skin(&mesh);
    follow(&mut live, &product, &before, Start::Live);
    let is_solved = AtomicBool::new(false);
    let control = Control {
        cancelled: &|| is_solved.load(Ordering::Relaxed),
        progress: &|stage, _| is_solved.store(stage == "fields", Ordering::Relaxed),
    };
    let press = Press {
        product: &product,
        posed: Some(&then),
        force: None,
        drag: None,
        start: Start::Live,
        unsolved: Unsolved::Refuse,
    };
    assert!(live.press(&press, &control).is_err());
    let shown = follow(&mut live, &product, &then, Start::Live);
    assert_eq!(
        shown.convergence.cg_steps, 0,
        "nothing moved since: all of it is held"
    );
    assert_same(&shown, &press_posed(&mut skin(&mesh), &product, &then), 1);
}
