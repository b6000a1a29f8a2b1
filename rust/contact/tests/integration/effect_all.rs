//! What holds for every effect: amplitude 0 is the base model bit for bit, pairs run together, no cycle gives energy.

use crate::scenes;

use scenes::{Bench, Dice, flat_skin, lattice, paraboloid, press};
use thenar_contact::effects::{CATALOGUE, Effect, Entry};
use thenar_contact::{
    ActiveEffect, Contact, Control, Course, Keep, Material, Model, Protocol, Run, Skin, SkinInput,
};
use thenar_surface::{Product, Vec3};

fn material() -> Material {
    Material {
        g0_mpa: 0.01,
        g_lim_mpa: 0.03,
        thickness_mm: 7.0,
        ..Material::default()
    }
}

/// The effects that a skin takes; instruments have their own tests.
fn tissue() -> impl DoubleEndedIterator<Item = &'static (Effect, &'static Entry)> {
    CATALOGUE.iter().filter(|(_, entry)| !entry.is_instrument())
}

fn two_regions() -> Bench {
    let mesh = lattice(9.0, 1.5, 0.3);
    let regions = mesh
        .positions()
        .iter()
        .map(|p| i32::from(p.x > 0.0))
        .collect();
    let input = SkinInput {
        mesh,
        regions,
        materials: vec![material(); 2],
        model: Model::Layer,
    };
    Bench::from(Skin::prepare(input, &Control::none()).unwrap())
}

fn follow(skin: &mut Bench, product: &Product, protocol: &Protocol) -> Course {
    let run = Run {
        product,
        posed: None,
        protocol,
        keep: Keep::Pressure,
    };
    skin.run(&run, &Control::none()).unwrap()
}

fn cycle() -> Protocol {
    let times: Vec<f64> = (0..40).map(|i| 0.05 * f64::from(i)).collect();
    let depths: Vec<f64> = times
        .iter()
        .map(|t| 1.2 * (2.5 * t).sin().abs() - 0.05)
        .collect();
    let mut protocol = Protocol::of_depth(&times, &depths);
    for row in &mut protocol.rows {
        row.slide = Vec3::new(0.2 * row.time_s, 0.0, 0.0);
    }
    protocol
}

fn set(skin: &mut Bench, effects: Vec<ActiveEffect>) {
    skin.set_effects(effects, &Control::none()).unwrap();
}

fn bits(contact: &Contact) -> Vec<u64> {
    let forces = contact.nodal_force.iter().copied();
    let moved = contact.displacement.iter().flat_map(|u| [u.x, u.y, u.z]);
    forces
        .chain(moved)
        .chain([contact.contact_area])
        .map(f64::to_bits)
        .collect()
}

#[test]
fn amplitude_zero_is_the_base_model_bit_for_bit() {
    let tool = paraboloid(8.0, 1.0, 8.0);
    let mut skin = two_regions();
    let base = press(&mut skin, &tool);
    let course = follow(&mut skin, &tool, &cycle());
    for &(effect, entry) in tissue() {
        let mut fresh = two_regions();
        set(&mut fresh, vec![ActiveEffect::new(effect, 0.0)]);
        assert_eq!(
            bits(&base),
            bits(&press(&mut fresh, &tool)),
            "{}",
            entry.name
        );
        let off = follow(&mut fresh, &tool, &cycle());
        assert_eq!(course.steps, off.steps, "{}", entry.name);
        assert_eq!(bits(&course.last), bits(&off.last), "{}", entry.name);
        // And after it was on.
        set(&mut skin, vec![ActiveEffect::new(effect, 0.5)]);
        press(&mut skin, &tool);
        set(&mut skin, vec![ActiveEffect::new(effect, 0.0)]);
        assert_eq!(
            bits(&base),
            bits(&press(&mut skin, &tool)),
            "{}",
            entry.name
        );
    }
}

#[test]
fn every_effect_changes_something() {
    let tool = paraboloid(8.0, 1.0, 8.0);
    let mut skin = two_regions();
    let base = follow(&mut skin, &tool, &cycle());
    for &(effect, entry) in tissue() {
        set(&mut skin, vec![ActiveEffect::new(effect, 0.9)]);
        let course = follow(&mut skin, &tool, &cycle());
        let steps = base.steps.iter().zip(&course.steps);
        let most = steps
            .map(|(a, b)| (a.total_force - b.total_force).norm())
            .fold(0.0, f64::max);
        assert!(most > 1e-3, "{}: {most}", entry.name);
    }
}

#[test]
fn every_pair_runs_together_and_in_one_order() {
    let tool = paraboloid(8.0, 1.0, 8.0);
    let mut skin = two_regions();
    for (i, (first, a)) in tissue().enumerate() {
        for (second, b) in tissue().take(i) {
            let pair = [
                ActiveEffect::new(*first, 0.4),
                ActiveEffect::new(*second, 0.4),
            ];
            set(&mut skin, pair.to_vec());
            let one = follow(&mut skin, &tool, &cycle());
            set(&mut skin, pair.iter().rev().cloned().collect());
            let other = follow(&mut skin, &tool, &cycle());
            let what = format!("{} and {}", a.name, b.name);
            assert_eq!(one.steps, other.steps, "{what}");
            assert!(
                one.steps
                    .iter()
                    .all(|s| s.has_converged && s.force.is_finite()),
                "{what}"
            );
            assert!(one.steps.iter().any(|s| s.force > 0.01), "{what}");
        }
    }
}

/// A random path of depths that ends where it began, off the skin. All depths lie on one grid, so that the sum for the work of
/// an elastic tissue is zero for any path, and what is left is the tissue's.
fn closed_path(dice: &mut Dice) -> Protocol {
    let (mut times, mut places) = (vec![0.0], vec![-2i32]);
    let mut goals: Vec<i32> = (0..4).map(|_| (17.0 * dice.roll()) as i32 - 2).collect();
    goals.push(-2);
    for goal in goals {
        let pace = 10f64.powf(-3.0 + 3.5 * dice.roll());
        loop {
            times.push(times[times.len() - 1] + pace);
            let here = places[places.len() - 1];
            places.push(here + (goal - here).signum());
            if here == goal {
                break;
            }
        }
    }
    let depths: Vec<f64> = places.iter().map(|place| 0.1 * f64::from(*place)).collect();
    Protocol::of_depth(&times, &depths)
}

/// Work that came out of the most generous of `runs` random closed paths, relative to what went in.
fn most_gained(
    skin: &mut Bench,
    runs: usize,
    (dice, draw): (&mut Dice, impl Fn(&mut Dice) -> Vec<ActiveEffect>),
) -> f64 {
    let tool = paraboloid(8.0, 0.0, 8.0);
    let mut worst = f64::NEG_INFINITY;
    for _ in 0..runs {
        set(skin, draw(dice));
        let course = follow(skin, &tool, &closed_path(dice));
        let works: Vec<f64> = course.steps.iter().map(|s| s.work).collect();
        let most = works.iter().fold(1e-6, |m: f64, w| m.max(*w));
        worst = worst.max(-works[works.len() - 1] / most);
    }
    worst
}

fn draw(dice: &mut Dice) -> Vec<ActiveEffect> {
    let memory = [
        "relaxation",
        "drainage",
        "cycle_softening",
        "rate_independent_loss",
    ];
    let mut drawn: Vec<ActiveEffect> = Vec::new();
    for name in memory {
        if dice.roll() < 0.5 {
            let effect = ActiveEffect::named(name, 0.9 * dice.roll()).unwrap();
            drawn.push(match name {
                "drainage" if dice.roll() < 0.6 => {
                    let layer = effect.choose("curve", "layer").unwrap();
                    layer.with("radius_mm", 0.5 + 3.0 * dice.roll()).unwrap()
                }
                _ => effect,
            });
        }
    }
    drawn
}

/// Work gained in `runs` random closed cycles of a material that stiffens, one that does not, and a thin layer of it.
fn check_passivity(runs: usize) {
    let thick = material().thickness_mm;
    for (g_lim_mpa, thickness_mm) in [(0.01, thick), (0.03, thick), (0.01, 2.0)] {
        let material = Material {
            g_lim_mpa,
            thickness_mm,
            ..material()
        };
        let mut skin = flat_skin(4.5, 1.5, material, Model::Layer);
        let worst = most_gained(&mut skin, runs, (&mut Dice(11), draw));
        println!("most energy gained in {runs} closed cycles, over the work done: {worst:.2e}");
        // The solver's tolerance: elastic cycles reach 1e-8.
        assert!(worst <= 1e-6, "{worst}");
    }
}

#[test]
fn closed_cycles_never_give_energy() {
    check_passivity(200);
}

#[test]
fn closed_cycles_of_a_skin_that_remembers_in_one_region_only_never_give_energy() {
    let in_one = |dice: &mut Dice| {
        let drawn = draw(dice).into_iter();
        drawn.map(|effect| effect.in_regions(&[0])).collect()
    };
    let worst = most_gained(&mut two_regions(), 100, (&mut Dice(5), in_one));
    println!("most energy gained with memory in one region of two: {worst:.2e}");
    assert!(worst <= 1e-6, "{worst}");
}

/// After a deep row and a row off the skin, a slow light press ends where a first contact does, and force never rises in the hold: the share
/// that drains is not the deep contact's.
#[test]
fn a_layer_that_was_left_at_once_drains_as_one_that_was_never_pressed() {
    let even = Material {
        g_lim_mpa: 0.01,
        thickness_mm: 4.0,
        ..material()
    };
    let mut skin = flat_skin(6.0, 1.0, even, Model::Layer);
    let drainage = ActiveEffect::named("drainage", 1.0).unwrap();
    let layer = drainage.choose("curve", "layer").unwrap();
    set(&mut skin, vec![layer.with("radius_mm", 1.0).unwrap()]);
    let tool = paraboloid(8.0, 0.0, 8.0);
    let mut forces = |rows: &[(f64, f64)]| -> Vec<f64> {
        let (times, depths): (Vec<f64>, Vec<f64>) = rows.iter().copied().unzip();
        let course = follow(&mut skin, &tool, &Protocol::of_depth(&times, &depths));
        course.steps.iter().map(|step| step.force).collect()
    };
    let light = [(1e5, 0.3), (2e5, 0.3), (3e5, 0.3)];
    let first = forces(&[&[(0.0, -0.1)][..], &light].concat());
    let again = forces(&[&[(0.0, -0.1), (1e-6, 1.2), (2e-6, -0.1)][..], &light].concat());
    assert!(again[1] > 3.0 * again[3] && again[2] == 0.0, "{again:?}");
    // Once both have drained; a first row has no radius to drain by.
    let (ends, wanted) = (again[5], first[3]);
    assert!((ends / wanted - 1.0).abs() < 0.01, "{ends} {wanted}");
    assert!(
        again[3..].is_sorted_by(|a, b| *b <= a * (1.0 + 1e-6)),
        "{again:?}"
    );
}

/// As many as `PASSIVITY_CYCLES` says, or ten thousand.
#[test]
#[ignore = "ten minutes: run it when memory or its effects change"]
fn ten_thousand_closed_cycles_never_give_energy() {
    let cycles = std::env::var("PASSIVITY_CYCLES");
    let cycles: usize = cycles.map_or(10_000, |count| count.parse().unwrap());
    check_passivity(cycles.div_ceil(3));
}
