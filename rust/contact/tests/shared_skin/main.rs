//! One skin pressed by several threads at once, workspaces that serve several skins, and skins made from others.
#![allow(clippy::unwrap_used)]

#[path = "../scenes/mod.rs"]
mod scenes;

use std::sync::Barrier;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;

use nalgebra::Rotation3;
use scenes::{lattice, material, paraboloid};
use thenar_contact::{
    ActiveEffect, Contact, Control, Drag, Material, Model, Press, Skin, SkinInput, Start, Unsolved,
    Workspace,
};
use thenar_surface::{Product, Vec3};

const FRAMES: usize = 4;

/// What a press only reads may be read by every thread; what it writes moves with it.
const _: () = {
    const fn is_shared_by_threads<T: Send + Sync>() {}
    is_shared_by_threads::<Skin>();
    is_shared_by_threads::<Workspace>();
};

fn skin() -> Skin {
    let mesh = lattice(12.0, 1.1, 0.3);
    let input = SkinInput {
        regions: mesh
            .positions()
            .iter()
            .map(|p| i32::from(p.x > 0.0))
            .collect(),
        mesh,
        materials: vec![
            material(6.0),
            Material {
                thickness_mm: 9.0,
                ..Material::finger_layer()
            },
        ],
        model: Model::Layer,
    };
    let bare = Skin::prepare(input, &Control::none()).unwrap();
    with(&bare, &["friction", "stiff_skin"])
}

fn with(skin: &Skin, effects: &[&str]) -> Skin {
    let effect = |name: &&str| ActiveEffect::named(name, 0.8).unwrap();
    let effects = effects.iter().map(effect).collect();
    skin.with_effects(effects, &Control::none()).unwrap()
}

/// Tilted a little more from frame to frame.
fn posed(frame: usize) -> Vec<Vec3> {
    let tilt = Rotation3::from_euler_angles(0.01 * (frame as f64).sin(), 0.005, 0.0);
    let up = Vec3::z() * (0.05 * frame as f64);
    let mesh = lattice(12.0, 1.1, 0.3);
    mesh.positions().iter().map(|p| tilt * p + up).collect()
}

fn press(
    (skin, workspace): (&Skin, &mut Workspace),
    product: &Product,
    (frame, start): (usize, Start),
    control: &Control,
) -> Contact {
    let press = Press {
        product,
        posed: Some(&posed(frame)),
        force: None,
        drag: Some(Drag::Motion {
            travel: Vec3::new(0.1 * frame as f64, 0.05, 0.0),
            turn: Vec3::zeros(),
        }),
        start,
        unsolved: Unsolved::Refuse,
    };
    let contact = workspace.on(skin).press(&press, control).unwrap();
    Contact {
        seconds: Vec::new(),
        ..contact
    }
}

/// Presses of one workspace in a row. `meet` is called once in each, when it has begun.
fn frames(skin: &Skin, start: Start, depth: f64, meet: &(dyn Fn() + Sync)) -> Vec<Contact> {
    let (product, mut workspace) = (paraboloid(12.0, depth, 14.0), Workspace::default());
    let one = |frame| {
        let has_begun = AtomicBool::new(false);
        let control = Control {
            progress: &|stage: &str, _: f64| {
                if stage == "distances" && !has_begun.swap(true, Ordering::Relaxed) {
                    meet();
                }
            },
            ..Control::none()
        };
        press((skin, &mut workspace), &product, (frame, start), &control)
    };
    (0..FRAMES).map(one).collect()
}

/// Every number as text that tells it from all others; what is not a number equals itself.
fn bits(contacts: &[Contact]) -> String {
    format!("{contacts:?}")
}

#[test]
fn threads_that_press_one_skin_at_once_get_what_each_gets_alone() {
    let ways = [(Start::Fresh, 0.9), (Start::Warm, 0.6), (Start::Live, 1.1)];
    let alone = ways.map(|(start, depth)| frames(&skin(), start, depth, &|| ()));
    let shared = skin();
    let barrier = Barrier::new(ways.len());
    let meet = || {
        barrier.wait();
    };
    let at_once = thread::scope(|scope| {
        let of = |(start, depth)| {
            let (shared, meet) = (&shared, &meet);
            scope.spawn(move || frames(shared, start, depth, meet))
        };
        ways.map(of).map(|thread| thread.join().unwrap())
    });
    for ((ours, wanted), (start, _)) in at_once.iter().zip(&alone).zip(ways) {
        assert!(wanted.iter().all(|contact| contact.contact_area > 0.0));
        assert!(bits(ours) == bits(wanted), "{start:?}");
    }
}

#[test]
fn a_workspace_of_another_response_is_an_empty_one() {
    let (bare, product) = (skin(), paraboloid(12.0, 0.9, 14.0));
    let quiet = Control::none();
    for effects in [&["bone"][..], &["region_coupling"]] {
        let (other, mut used) = (with(&bare, effects), Workspace::default());
        for start in [Start::Warm, Start::Live] {
            press((&bare, &mut used), &product, (0, start), &quiet);
            assert!(used.is_of(&bare) && !used.is_of(&other));
            let ours = press((&other, &mut used), &product, (1, start), &quiet);
            let empty = (&other, &mut Workspace::default());
            assert!(ours == press(empty, &product, (1, start), &quiet));
        }
    }
}

#[test]
fn a_skin_of_the_same_response_goes_on_in_the_workspace() {
    let (bare, product) = (with(&skin(), &["friction"]), paraboloid(12.0, 0.9, 14.0));
    let (other, mut used, quiet) = (with(&bare, &[]), Workspace::default(), Control::none());
    let first = press((&bare, &mut used), &product, (0, Start::Warm), &quiet);
    assert!(used.is_of(&other) && first.shear.is_some());
    let before = bare.effects().len();
    let ours = press((&other, &mut used), &product, (0, Start::Warm), &quiet);
    // The same posture once more, begun at its own solution.
    assert!(ours.shear.is_none() && ours.convergence.pivots < first.convergence.pivots);
    assert_eq!(bare.effects().len(), before);
}

#[test]
fn a_warm_start_is_taken_to_another_workspace() {
    let (skin, product, quiet) = (skin(), paraboloid(12.0, 0.9, 14.0), Control::none());
    let (mut one, mut two) = (Workspace::default(), Workspace::default());
    let first = press((&skin, &mut one), &product, (0, Start::Fresh), &quiet);
    press((&skin, &mut two), &product, (3, Start::Fresh), &quiet);
    two.start_from(one.warm_start());
    let warm = press((&skin, &mut two), &product, (0, Start::Warm), &quiet);
    assert!(warm.convergence.pivots < first.convergence.pivots);
    assert!((warm.total_force.norm() / first.total_force.norm() - 1.0).abs() < 1e-3);
}
