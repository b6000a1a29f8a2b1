//! Protocols: every effect of tissue and interface by itself and with the others, painted, in one region, in every form; walks.

use thenar_contact::effects::CATALOGUE;
use thenar_contact::{
    ActiveEffect, Control, Course, Demand, Keep, Model, Motion, Protocol, Row, Run, Stand, Walk,
};
use thenar_surface::{Product, Vec3};

use crate::scenes::{Bench, flat_skin, lattice, material};
use crate::shapes::{bowl, halves, named, stiffening, switch_on};
use crate::{Case, case};

pub fn cases() -> Vec<Case> {
    let mut all = vec![
        case("protocol without effects", |bits| {
            bits.course(&followed(Vec::new(), Keep::Pressure));
        }),
        case("protocol, all effects", |bits| {
            let tissue = CATALOGUE.iter().filter(|(_, e)| !e.is_instrument());
            let some = tissue.map(|(effect, _)| ActiveEffect::new(*effect, 0.4));
            bits.course(&followed(some.collect(), Keep::Loads));
        }),
        case("protocol, memory in one region", |bits| {
            let one = |name: &str| named(name, 0.7).in_regions(&[1]);
            let some = ["relaxation", "drainage", "cycle_softening", "inclusion"].map(one);
            bits.course(&followed(some.to_vec(), Keep::Totals));
        }),
        case("protocol, painted bone", |bits| {
            let places = lattice(9.0, 1.5, 0.3);
            let thickness = |p: &Vec3| {
                if p.y > 0.0 { 4.0 + 0.1 * p.y } else { f64::NAN }
            };
            let painted = places.positions().iter().map(thickness).collect();
            let bone = named("bone", 1.0).painted(painted);
            bits.course(&followed(vec![bone], Keep::Totals));
        }),
        case("protocol, depth, force and rest", |bits| {
            let mut skin = flat_skin(7.0, 1.0, material(7.0), Model::Layer);
            let some = ["relaxation", "friction", "adhesion"].map(|name| named(name, 0.8));
            switch_on(&mut skin, some.to_vec());
            let protocol = Protocol {
                rows: rows(),
                direction: None,
            };
            let tool = bowl(8.0, 0.0, 10.0);
            bits.course(&run(&mut skin, (&tool, &protocol), Keep::Pressure));
        }),
        case("walk in moving postures", walk),
    ];
    for (effect, entry) in CATALOGUE.iter().filter(|(_, e)| !e.is_instrument()) {
        let name = format!("effect {}", entry.name);
        all.push(case(&name, move |bits| {
            let one = ActiveEffect::new(*effect, 0.8);
            bits.course(&followed(vec![one], Keep::Totals));
        }));
        for choice in entry.choices {
            let options = choice.options[1..].iter();
            for option in options.filter(|option| !NOT_FROZEN.contains(option)) {
                let name = format!("effect {}, {} {option}", entry.name, choice.name);
                all.push(case(&name, move |bits| {
                    let one = ActiveEffect::new(*effect, 0.8);
                    let one = one.choose(choice.name, option).unwrap();
                    bits.course(&followed(vec![one], Keep::Totals));
                }));
            }
        }
    }
    all
}

/// Options made on a machine of another kind than the table's: frozen where `THENAR_FREEZE=1` runs on that kind.
const NOT_FROZEN: [&str; 2] = ["touched", "layer"];

/// Presses with a slide on two regions, in and out twice.
fn followed(effects: Vec<ActiveEffect>, keep: Keep) -> Course {
    let materials = [stiffening(), material(5.0)];
    let mut skin = halves(lattice(9.0, 1.5, 0.3), materials, Model::Layer);
    switch_on(&mut skin, effects);
    let times: Vec<f64> = (0..20).map(|k| 0.1 * f64::from(k)).collect();
    let depth = |t: &f64| 1.2 * (2.5 * t).sin().abs() - 0.05;
    let depths: Vec<f64> = times.iter().map(depth).collect();
    let mut protocol = Protocol::of_depth(&times, &depths);
    for row in &mut protocol.rows {
        row.slide = Vec3::new(0.2 * row.time_s, 0.0, 0.0);
    }
    let tool = bowl(8.0, 1.0, 10.0);
    run(&mut skin, (&tool, &protocol), keep)
}

fn run(skin: &mut Bench, (product, protocol): (&Product, &Protocol), keep: Keep) -> Course {
    let run = Run {
        product,
        posed: None,
        protocol,
        keep,
    };
    skin.run(&run, &Control::none()).unwrap()
}

fn rows() -> Vec<Row> {
    let row = |k: i32| Row {
        time_s: 0.1 * f64::from(k),
        demand: match k {
            0..4 => Demand::Offset(0.25 * f64::from(k) - 0.2),
            4..7 => Demand::Depth(0.9),
            7 => Demand::Force(0.0),
            _ => Demand::Force(0.3),
        },
        slide: Vec3::new(0.03 * f64::from(k), 0.0, 0.0),
    };
    (0..11).map(row).collect()
}

/// Hand and product move together while the rows are taken, another press between them.
fn walk(bits: &mut crate::Bits) {
    let tool = bowl(8.0, 0.0, 10.0);
    let rest = lattice(7.0, 1.0, 0.3).positions().to_vec();
    let mut skin = flat_skin(7.0, 1.0, material(7.0), Model::Layer);
    let some = ["relaxation", "friction", "cycle_softening"].map(|name| named(name, 0.8));
    switch_on(&mut skin, some.to_vec());
    let mut walk = Walk::new(&skin, Some(-Vec3::z())).unwrap();
    for row in rows() {
        let angle = 0.4 * row.time_s;
        let motion = Motion::new(
            Vec3::new(30.0 * angle, -5.0, 2.0),
            Vec3::new(angle, 0.5 * angle, -angle),
        );
        let moved = |p: &Vec3| motion.rotation * p + motion.translation.vector;
        let posed: Vec<Vec3> = rest.iter().map(moved).collect();
        let stand = Stand {
            product: &tool,
            posed: Some(&posed),
            motion: Some(motion),
        };
        let step = skin.advance(&mut walk, (&stand, &row), &Control::none());
        bits.step(&step.unwrap());
        bits.contact(&crate::scenes::press(&mut skin, &bowl(5.0, 0.7, 10.0)));
        bits.contact(&walk.contact(&skin, &stand).unwrap());
    }
}
