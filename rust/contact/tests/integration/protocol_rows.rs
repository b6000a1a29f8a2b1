//! Walks through a protocol one row at a time: the same as the whole, in moving postures too.

use crate::scenes;

use scenes::{Bench, flat_skin, lattice, material, paraboloid, press};
use thenar_contact::{
    ActiveEffect, Control, Course, Demand, Keep, Model, Motion, Protocol, Row, Run, Stand, Step,
    Walk,
};
use thenar_surface::{Product, Vec3};

fn skin(names: &[&str]) -> Bench {
    let mut skin = flat_skin(7.0, 1.0, material(7.0), Model::Layer);
    let effect = |name: &&str| ActiveEffect::named(name, 0.8).unwrap();
    skin.set_effects(names.iter().map(effect).collect(), &Control::none())
        .unwrap();
    skin
}

fn rows() -> Vec<Row> {
    let row = |k: i32| Row {
        time_s: 0.1 * f64::from(k),
        demand: match k {
            0..6 => Demand::Offset(0.2 * f64::from(k) - 0.2),
            6..9 => Demand::Depth(0.9),
            _ => Demand::Force(0.3),
        },
        slide: Vec3::new(0.03 * f64::from(k), 0.0, 0.0),
    };
    (0..14).map(row).collect()
}

fn run(skin: &mut Bench, product: &Product, rows: Vec<Row>) -> Course {
    let protocol = Protocol {
        rows,
        direction: Some(-Vec3::z()),
    };
    let run = Run {
        product,
        posed: None,
        protocol: &protocol,
        keep: Keep::Pressure,
    };
    skin.run(&run, &Control::none()).unwrap()
}

fn stand<'a>(product: &'a Product, posed: Option<&'a [Vec3]>) -> Stand<'a> {
    Stand {
        product,
        posed,
        motion: None,
    }
}

/// The worst of two courses' forces apart, over the largest.
fn apart(a: &[Step], b: &[Step]) -> f64 {
    let most = a.iter().map(|s| s.total_force.norm()).fold(0.0, f64::max);
    let worst = a
        .iter()
        .zip(b)
        .map(|(a, b)| (a.total_force - b.total_force).norm());
    worst.fold(0.0, f64::max) / most
}

#[test]
fn rows_one_by_one_are_the_whole_protocol_bit_for_bit() {
    let tool = paraboloid(8.0, 0.0, 9.0);
    for names in [
        &[][..],
        &["relaxation", "friction"],
        &["drainage", "adhesion"],
    ] {
        let mut skin = skin(names);
        let whole = run(&mut skin, &tool, rows());
        let mut walk = Walk::new(&skin, Some(-Vec3::z()))
            .unwrap()
            .keeping(Keep::Pressure);
        for (row, expected) in rows().iter().zip(&whole.steps) {
            let place = (&stand(&tool, None), row);
            let step = skin.advance(&mut walk, place, &Control::none()).unwrap();
            assert_eq!(step, *expected, "{names:?}");
        }
        let last = walk.contact(&skin, &stand(&tool, None)).unwrap();
        assert_eq!(last.pressure, whole.last.pressure);
        assert_eq!(last.displacement, whole.last.displacement);
    }
}

#[test]
fn other_presses_and_walks_come_between_without_a_trace() {
    let tool = paraboloid(8.0, 0.0, 9.0);
    let mut skin = skin(&["relaxation", "friction"]);
    let whole = run(&mut skin, &tool, rows());
    let mut walk = Walk::new(&skin, Some(-Vec3::z())).unwrap();
    let mut steps = Vec::new();
    for row in rows() {
        press(&mut skin, &paraboloid(5.0, 0.7, 9.0));
        let place = (&stand(&tool, None), &row);
        skin.advance(&mut walk.clone(), place, &Control::none())
            .unwrap();
        steps.push(skin.advance(&mut walk, place, &Control::none()).unwrap());
    }
    assert!(
        apart(&whole.steps, &steps) < 1e-5,
        "{}",
        apart(&whole.steps, &steps)
    );
}

#[test]
fn a_hand_and_a_product_that_move_together_feel_nothing_of_it() {
    let tool = paraboloid(8.0, 0.0, 9.0);
    let rest = lattice(7.0, 1.0, 0.3).positions().to_vec();
    for names in [
        &["relaxation", "friction"][..],
        &["cycle_softening", "adhesion"],
    ] {
        let mut skin = skin(names);
        let still = run(&mut skin, &tool, rows());
        let mut walk = Walk::new(&skin, Some(-Vec3::z())).unwrap();
        let mut steps = Vec::new();
        let mut motion = Motion::identity();
        for row in rows() {
            let angle = 0.4 * row.time_s;
            motion = Motion::new(
                Vec3::new(30.0 * angle, -5.0, 2.0),
                Vec3::new(angle, 0.5 * angle, -angle),
            );
            let moved: Vec<Vec3> = rest
                .iter()
                .map(|p| motion.rotation * p + motion.translation.vector)
                .collect();
            let there = Stand {
                product: &tool,
                posed: Some(&moved),
                motion: Some(motion),
            };
            steps.push(
                skin.advance(&mut walk, (&there, &row), &Control::none())
                    .unwrap(),
            );
        }
        assert!(
            apart(&still.steps, &steps) < 1e-6,
            "{names:?} {}",
            apart(&still.steps, &steps)
        );
        let moved: Vec<Vec3> = rest
            .iter()
            .map(|p| motion.rotation * p + motion.translation.vector)
            .collect();
        let there = Stand {
            product: &tool,
            posed: Some(&moved),
            motion: Some(motion),
        };
        let contact = walk.contact(&skin, &there).unwrap();
        let (found, expected) = (
            contact.total_force,
            motion.rotation * still.last.total_force,
        );
        assert!((found - expected).norm() < 1e-6 * expected.norm());
        let center = motion.rotation * still.last.center_of_pressure + motion.translation.vector;
        assert!((contact.center_of_pressure - center).norm() < 1e-5);
        let lever = motion.translation.vector.cross(&expected);
        let moment = motion.rotation * still.last.total_moment + lever;
        assert!((contact.total_moment - moment).norm() < 1e-5 * lever.norm());
        for (a, b) in contact.displacement.iter().zip(&still.last.displacement) {
            assert!((a - motion.rotation * b).norm() < 1e-5, "{a} {b}");
        }
    }
}

#[test]
fn moment_and_center_follow_a_product_that_slid() {
    let slide = Vec3::new(1.5, -0.8, 0.0);
    let row = Row {
        time_s: 0.0,
        demand: Demand::Offset(0.8),
        slide,
    };
    let contact = run(&mut skin(&[]), &paraboloid(8.0, 0.0, 9.0), vec![row]).last;
    assert!((contact.center_of_pressure - slide).xy().norm() < 0.15);
    let moment = slide.cross(&contact.total_force);
    let off = (contact.total_moment - moment).norm();
    assert!(off < 0.15 * moment.norm(), "{off} {moment}");
}

#[test]
fn skin_that_moves_is_a_product_that_moves_the_other_way() {
    let tool = paraboloid(8.0, 0.0, 9.0);
    let rest = lattice(7.0, 1.0, 0.3).positions().to_vec();
    let mut skin = skin(&["relaxation", "friction"]);
    let path = |k: i32| (0.15 * f64::from(k.min(6)), 0.06 * f64::from((k - 4).max(0)));
    let row = |k: i32, demand: Demand, slide: f64| Row {
        time_s: 0.1 * f64::from(k),
        demand,
        slide: Vec3::new(slide, 0.0, 0.0),
    };
    let by_product = (0..12)
        .map(|k| row(k, Demand::Offset(path(k).0), path(k).1))
        .collect();
    let expected = run(&mut skin, &tool, by_product);
    let mut walk = Walk::new(&skin, Some(-Vec3::z())).unwrap();
    let mut steps = Vec::new();
    for k in 0..12 {
        let moved: Vec<Vec3> = rest
            .iter()
            .map(|p| p - Vec3::new(path(k).1, 0.0, -path(k).0))
            .collect();
        let place = (
            &stand(&tool, Some(&moved)),
            &row(k, Demand::Offset(0.0), 0.0),
        );
        steps.push(skin.advance(&mut walk, place, &Control::none()).unwrap());
    }
    assert!(steps[11].shear.norm() > 0.02, "{}", steps[11].shear);
    // Friction's linearization aside, which sees the same travel from another place.
    assert!(
        apart(&expected.steps, &steps) < 1e-3,
        "{}",
        apart(&expected.steps, &steps)
    );
}

#[test]
fn a_row_that_fails_leaves_the_walk_where_it_stood() {
    let tool = paraboloid(8.0, 0.0, 9.0);
    let mut skin = skin(&["relaxation"]);
    let mut walk = Walk::new(&skin, Some(-Vec3::z())).unwrap();
    let all = rows();
    let take = |skin: &mut Bench, walk: &mut Walk, row: &Row| {
        skin.advance(walk, (&stand(&tool, None), row), &Control::none())
    };
    take(&mut skin, &mut walk, &all[3]).unwrap();
    let refused = take(&mut skin, &mut walk, &all[2]).unwrap_err().to_string();
    assert!(
        refused.starts_with("protocol, row 1: time_s is 0.2"),
        "{refused}"
    );
    let hard = Row {
        demand: Demand::Force(1e6),
        ..all[4]
    };
    let refused = take(&mut skin, &mut walk, &hard).unwrap_err().to_string();
    assert!(
        refused.starts_with("protocol, row 1: 1000000.000 N is not reached"),
        "{refused}"
    );
    let mut other = walk.clone();
    let after = take(&mut skin, &mut walk, &all[4]).unwrap();
    assert_eq!(after, take(&mut skin, &mut other, &all[4]).unwrap());
    skin.set_effects(Vec::new(), &Control::none()).unwrap();
    let refused = take(&mut skin, &mut walk, &all[5]).unwrap_err().to_string();
    assert!(
        refused.ends_with("effects have changed since the walk began; begin anew"),
        "{refused}"
    );
}

#[test]
fn a_walk_ends_when_its_painted_effect_changes() {
    let tool = paraboloid(8.0, 0.0, 9.0);
    let mut skin = skin(&[]);
    let mut bone = ActiveEffect::named("bone", 1.0).unwrap();
    let mut thickness = vec![f64::NAN; skin.vertices()];
    thickness[0] = 4.0;
    bone.painted = Some(thickness.clone());
    skin.set_effects(vec![bone.clone()], &Control::none())
        .unwrap();
    let mut walk = Walk::new(&skin, Some(-Vec3::z())).unwrap();
    let place = stand(&tool, None);
    for row in &rows()[..2] {
        skin.advance(&mut walk, (&place, row), &Control::none())
            .unwrap();
    }
    thickness[0] = 5.0;
    bone.painted = Some(thickness);
    skin.set_effects(vec![bone], &Control::none()).unwrap();
    let refused = skin.advance(&mut walk, (&place, &rows()[2]), &Control::none());
    assert!(
        refused
            .unwrap_err()
            .to_string()
            .contains("effects have changed")
    );
}
