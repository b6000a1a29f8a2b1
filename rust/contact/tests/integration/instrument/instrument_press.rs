//! A mat on a product that presses and slides: its force is the contact's, and it goes where the product goes.

use crate::scenes;

use thenar_contact::instrument::{Mat, MatLayout, loads};
use thenar_contact::{Control, Demand, Keep, Material, Model, Protocol, Row, Run};
use thenar_surface::Vec3;

/// Five by five sensels of 4 mm around the origin, normals up.
fn mat() -> Mat {
    let middle = |k: usize| 4.0 * (k as f64 - 2.0);
    let centers: Vec<Vec3> = (0..25)
        .map(|k| Vec3::new(middle(k % 5), middle(k / 5), 0.0))
        .collect();
    let layout = MatLayout {
        normals: vec![Vec3::z(); 25],
        areas: vec![16.0; 25],
        centers,
        along: None,
    };
    Mat::new(layout).unwrap()
}

#[test]
fn a_press_is_read_with_its_force_wherever_the_product_went() {
    let mut skin = scenes::flat_skin(9.0, 0.8, Material::finger_layer(), Model::Layer);
    let rest = scenes::lattice(9.0, 0.8, 0.3).positions().to_vec();
    let product = scenes::paraboloid(10.0, 0.0, 12.0);
    let mat = mat();
    let row = |time_s: f64, depth: f64, slide: f64| Row {
        time_s,
        demand: Demand::Depth(depth),
        slide: Vec3::new(slide, 0.0, 0.0),
    };
    let protocol = Protocol {
        rows: vec![row(0.0, 0.4, 0.0), row(1.0, 0.9, 0.0), row(2.0, 0.9, 1.5)],
        direction: Some(-Vec3::z()),
    };
    let run = Run {
        product: &product,
        posed: None,
        protocol: &protocol,
        keep: Keep::Loads,
    };
    let course = skin.run(&run, &Control::none()).unwrap();
    for step in &course.steps {
        let frame = mat.read(&step.loads);
        let force: f64 = step.loads.iter().map(|l| l.force_n).sum();
        assert!(force > 0.01 && (mat.force_n(&frame) / force - 1.0).abs() < 1e-9);
        // The product carries the mat along: the middle sensel stays the one pressed most.
        assert!(frame.iter().all(|p| *p <= frame[12]), "{frame:?}");
    }
    let moved: Vec<Vec3> = rest.iter().map(|p| p - Vec3::new(1.5, 0.0, 0.0)).collect();
    let (a, b) = (
        mat.read(&course.steps[2].loads),
        mat.read(&loads(&course.last, &moved)),
    );
    for (a, b) in a.iter().zip(&b) {
        assert!((a - b).abs() < 0.02 * a.max(1.0), "{a} {b}");
    }
}
