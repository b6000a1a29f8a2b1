//! Friction along a protocol: what sticks is remembered, what slips is lost.

use crate::scenes;

use scenes::{Bench, lattice, rubbing_skin};
use thenar_contact::{Control, Course, Demand, Keep, Protocol, Row, Run};
use thenar_surface::{Mesh, Product, Vec3};

const MU: f64 = 0.4;

fn row(time_s: f64, depth: f64, slide: f64) -> Row {
    Row {
        time_s,
        demand: Demand::Depth(depth),
        slide: Vec3::new(slide, 0.0, 0.0),
    }
}

fn follow(skin: &mut Bench, product: &Product, rows: Vec<Row>) -> Course {
    let protocol = Protocol {
        rows,
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

/// A plate, so that a slide leaves the pressure as it is.
fn plate() -> Product {
    let corner = |k: u32, z: f64| {
        let (x, y) = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)][k as usize];
        Vec3::new(30.0 * x, 30.0 * y, z)
    };
    let positions = (0..4)
        .map(|k| corner(k, 0.0))
        .chain((0..4).map(|k| corner(k, 9.0)));
    let mut triangles = vec![[0, 2, 1], [0, 3, 2], [4, 5, 6], [4, 6, 7]];
    for (a, b) in [(0, 1), (1, 2), (2, 3), (3, 0)] {
        triangles.extend([[a, b, b + 4], [a, b + 4, a + 4]]);
    }
    Product::new(Mesh::new(positions.collect(), triangles).unwrap()).unwrap()
}

#[test]
fn a_protocol_that_slides_remembers_what_sticks() {
    let mesh = lattice(10.0, 1.0, 0.3);
    let dome = mesh
        .positions()
        .iter()
        .map(|p| p - Vec3::z() * (p.norm_squared() / 24.0));
    let mesh = Mesh::new(dome.collect(), mesh.triangles().to_vec()).unwrap();
    let mut skin = rubbing_skin(&mesh, 7.0, MU);
    let product = plate();
    let there = |k: i32| f64::from(k) * 0.04;
    let out = (0..=20).map(|k| row(f64::from(k), 0.8, there(k)));
    let back = (1..=20).map(|k| row(20.0 + f64::from(k), 0.8, there(20 - k)));
    let course = follow(&mut skin, &product, out.chain(back).collect());
    let (first, far, last) = (&course.steps[0], &course.steps[20], &course.steps[40]);
    assert_eq!(first.shear, Vec3::zeros());
    assert!(
        (far.shear.x / (MU * far.force) - 1.0).abs() < 0.02,
        "{}",
        far.shear
    );
    // Back where it began the skin is sheared the other way, and has lost what slip took.
    assert!(last.shear.x < -0.5 * MU * last.force, "{}", last.shear);
    assert!(last.work > 0.0 && last.slip_loss > 0.0);
    assert!(
        (last.work - last.slip_loss - course.last.shear.unwrap().stored).abs() < 0.1 * last.work
    );
    assert!(
        course
            .steps
            .windows(2)
            .all(|w| w[1].slip_loss >= w[0].slip_loss)
    );
    assert!((last.total_force.x + last.shear.x).abs() < 0.01 * last.force);
}
