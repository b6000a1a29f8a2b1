//! Adhesion against JKR, DMT and the path: pull-off, area at no load, hysteresis, and the base model without it.

use crate::scenes;

use scenes::{Bench, lattice, paraboloid, press};
use thenar_contact::{
    ActiveEffect, Control, Course, Demand, Keep, Material, Model, Protocol, Row, Run, Skin,
    SkinInput, Step,
};
use thenar_surface::{Product, Vec3};

const SHEAR_MODULUS: f64 = 0.01;
/// E* = 4 G at nu = 1/2, MPa.
const CONTACT_MODULUS: f64 = 4.0 * SHEAR_MODULUS;
const RADIUS: f64 = 10.0;
/// Radius of JKR's contact at no load, mm: a0^3 = 9 pi w R^2 / (2 E*).
const ZERO_LOAD_RADIUS: f64 = 1.0;

/// Work of adhesion that goes with that radius, N/mm.
fn work() -> f64 {
    2.0 * CONTACT_MODULUS * ZERO_LOAD_RADIUS.powi(3)
        / (9.0 * std::f64::consts::PI * RADIUS * RADIUS)
}

fn skin(spacing: f64, extent: f64, effects: Vec<ActiveEffect>) -> Bench {
    let material = Material {
        g0_mpa: SHEAR_MODULUS,
        g_lim_mpa: SHEAR_MODULUS,
        thickness_mm: f64::INFINITY,
        ..Material::finger()
    };
    let input = SkinInput {
        mesh: lattice(extent, spacing, 0.3),
        regions: Vec::new(),
        materials: vec![material],
        model: Model::Layer,
    };
    let mut skin = Bench::from(Skin::prepare(input, &Control::none()).unwrap());
    skin.set_effects(effects, &Control::none()).unwrap();
    skin
}

fn adhesion(work: f64, range_mm: f64) -> ActiveEffect {
    let effect = ActiveEffect::named("adhesion", 1.0).unwrap();
    let effect = effect.with("work_j_per_m2", 1e3 * work).unwrap();
    effect.with("range_mm", range_mm).unwrap()
}

fn follow(skin: &mut Bench, product: &Product, depths: impl Iterator<Item = f64>) -> Course {
    let row = |(k, depth): (usize, f64)| Row {
        time_s: k as f64,
        demand: Demand::Offset(depth),
        slide: Vec3::zeros(),
    };
    let protocol = Protocol {
        rows: depths.enumerate().map(row).collect(),
        direction: Some(-Vec3::z()),
    };
    let run = Run {
        product,
        posed: None,
        protocol: &protocol,
        keep: Keep::Totals,
    };
    skin.run(&run, &Control::none()).unwrap()
}

/// Force over pi w R and contact radius (mm) by depth.
fn path(skin: &mut Bench, work: f64, depths: impl Iterator<Item = f64>) -> Vec<(f64, f64)> {
    let course = follow(skin, &paraboloid(RADIUS, 0.0, 3.0), depths);
    let unit = std::f64::consts::PI * work * RADIUS;
    let one = |step: &Step| (step.force / unit, (step.area / std::f64::consts::PI).sqrt());
    course.steps.iter().map(one).collect()
}

/// Depth that goes with the radius of JKR's contact at no load, of which it needs a third, mm.
const SCALE: f64 = ZERO_LOAD_RADIUS * ZERO_LOAD_RADIUS / RADIUS;

#[test]
fn a_short_range_gives_the_pull_off_and_the_zero_load_contact_of_jkr() {
    let mut skin = skin(1.0 / 8.0, 1.7, vec![adhesion(work(), 1e-5)]);
    let deep = [0.5, 0.4, 0.34, 0.3].into_iter();
    let off = (0..5).map(|k| 0.0 - 0.05 * f64::from(k));
    let path = path(&mut skin, work(), deep.chain(off).map(|d| d * SCALE));
    let pull = path.iter().map(|p| -p.0).fold(0.0, f64::max);
    println!("short range: pull-off {pull:.3} pi w R, JKR's is 1.5");
    assert!((pull / 1.5 - 1.0).abs() < 0.03);
    let after = path.iter().position(|p| p.0 < 0.0).unwrap();
    let ((f1, a1), (f0, a0)) = (path[after - 1], path[after]);
    let radius = a1 + (a0 - a1) * f1 / (f1 - f0);
    assert!(
        (radius / ZERO_LOAD_RADIUS - 1.0).abs() < 0.03,
        "{radius} mm"
    );
}

#[test]
fn a_wide_range_gives_the_pull_off_of_dmt() {
    // Maugis' parameter is 0.01: the attraction hardly moves the skin.
    let work = 0.01 * work();
    let mut skin = skin(0.2, 2.3, vec![adhesion(work, 0.15)]);
    let path = path(
        &mut skin,
        work,
        (0..8).map(|k| 0.002 - 0.0005 * f64::from(k)),
    );
    let pull = path.iter().map(|p| -p.0).fold(0.0, f64::max);
    println!("wide range: pull-off {pull:.3} pi w R, DMT's is 2");
    assert!((pull / 2.0 - 1.0).abs() < 0.03);
}

/// Of skin that hardly moves: traction `2 w / range (1 - gap / range)` over the disc that Hertz's contact covered, `a^2 = R d`, at the
/// gaps `r^2 / 2 R + h` of a paraboloid at the height h.
#[test]
fn bonds_on_touch_pull_the_skin_that_touched_and_no_other() {
    let (work, range, depth, height) = (0.01 * work(), 0.3, 0.225, 0.05);
    let offsets = [-height, depth, -height, -0.4, -height];
    let forces = |effects: Vec<ActiveEffect>| -> Vec<f64> {
        let mut skin = skin(0.15, 2.4, effects);
        let course = follow(
            &mut skin,
            &paraboloid(RADIUS, 0.0, 3.0),
            offsets.into_iter(),
        );
        course.steps.iter().map(|step| step.force).collect()
    };
    let on_touch = adhesion(work, range).choose("bonds", "touched").unwrap();
    let (found, base) = (forces(vec![on_touch]), forces(Vec::new()));
    let reversible = forces(vec![adhesion(work, range)]);
    assert!(reversible[0] < 0.0 && (reversible[4] / reversible[0] - 1.0).abs() < 0.01);
    assert_eq!((found[0], found[3], found[4]), (0.0, 0.0, 0.0), "{found:?}");
    let touched = RADIUS * depth;
    let open = 1.0 - height / range - touched / (4.0 * RADIUS * range);
    let wanted = -2.0 * work / range * std::f64::consts::PI * touched * open;
    println!(
        "pull of what touched {} N, {wanted} by the formula",
        found[2]
    );
    assert!((found[2] / wanted - 1.0).abs() < 0.05, "{found:?} {wanted}");
    assert!(
        (found[1] - base[1]).abs() < 0.1 * wanted.abs(),
        "{found:?} {base:?}"
    );
}

#[test]
fn skin_lets_go_later_than_it_came_and_the_loop_costs_energy() {
    let mut skin = skin(1.0 / 6.0, 1.5, vec![adhesion(work(), 1e-5)]);
    let there: Vec<f64> = (0..9)
        .map(|k| (-0.4 + 0.05 * f64::from(k)) * SCALE)
        .collect();
    let back = there.iter().rev().skip(1);
    let depths = there.iter().chain(back).copied();
    let course = follow(&mut skin, &paraboloid(RADIUS, 0.0, 3.0), depths);
    let touching = |k: usize| course.steps[k].area > 0.0;
    let (came, left) = (
        (0..9).position(touching).unwrap(),
        (8..17).rposition(touching).unwrap(),
    );
    // Steps are counted from -0.4 of the scale on both ways.
    assert!(8 - left < came, "{came} {left}");
    assert!(course.steps[8 + left].force < 0.0);
    let last = &course.steps[16];
    assert!(last.force == 0.0 && last.work > 0.0, "{last:?}");
}

#[test]
fn without_work_it_is_the_base_model_and_with_it_totals_tell() {
    let product = paraboloid(RADIUS, 0.08, 3.0);
    let mut none = skin(0.25, 1.7, Vec::new());
    let base = press(&mut none, &product);
    for effect in [
        adhesion(0.0, 0.02),
        ActiveEffect::named("adhesion", 0.0).unwrap(),
    ] {
        let same = press(&mut skin(0.25, 1.7, vec![effect]), &product);
        assert_eq!(base.displacement, same.displacement);
        assert_eq!(base.nodal_force, same.nodal_force);
        assert_eq!(base.total_force, same.total_force);
        assert!(same.adhesion.iter().all(|f| *f == 0.0));
    }
    let sticky = press(&mut skin(0.25, 1.7, vec![adhesion(work(), 1e-5)]), &product);
    let (push, pull): (f64, f64) = (
        sticky.nodal_force.iter().sum(),
        sticky.adhesion.iter().sum(),
    );
    assert!(pull > 0.0 && sticky.total_force.z < base.total_force.z);
    assert!((sticky.total_force.z - (push - pull)).abs() < 1e-3 * push);
    assert!(sticky.contact_area > 1.1 * base.contact_area);
    assert!(sticky.residual.complementarity <= 1e-10);
}

#[test]
fn adhesion_moment_is_about_the_product_s_position() {
    let direction = Vec3::new(0.96, 0.0, -0.28);
    let protocol = Protocol {
        rows: vec![Row {
            time_s: 0.0,
            demand: Demand::Offset(0.12),
            slide: Vec3::zeros(),
        }],
        direction: Some(direction),
    };
    let run = Run {
        product: &paraboloid(RADIUS, 0.0, 3.0),
        posed: None,
        protocol: &protocol,
        keep: Keep::Totals,
    };
    let mut skin = skin(1.0 / 6.0, 1.7, vec![adhesion(work(), 1e-5)]);
    let contact = skin.run(&run, &Control::none()).unwrap().last;
    let pull: f64 = contact.adhesion.iter().sum();
    let axis = direction * 0.12;
    // Push and pull nearly cancel, and both do so about the paraboloid's axis.
    let off = contact.total_moment - axis.cross(&contact.total_force);
    assert!(contact.total_force.norm() < 0.5 * pull, "{pull}");
    assert!(off.norm() < 0.3 * axis.x * pull, "{off} {pull}");
}

#[test]
fn bad_numbers_are_refused_in_a_sentence() {
    let mut skin = skin(0.5, 1.7, Vec::new());
    let refused = skin.set_effects(vec![adhesion(-1e-3, 0.02)], &Control::none());
    let message = refused.unwrap_err().to_string();
    assert!(message.contains("work_j_per_m2 is -1"), "{message}");
    let refused = skin.set_effects(vec![adhesion(1e-3, 0.0)], &Control::none());
    assert!(refused.unwrap_err().to_string().contains("range_mm is 0"));
}
