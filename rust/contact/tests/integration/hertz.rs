//! Rigid spheres on flat skin: Hertz's force, contact radius and pressure (Johnson, Contact Mechanics 4.2).

use crate::scenes;

use scenes::{Bench, Dice, flat_skin, lattice, paraboloid, press_posed};
use thenar_contact::{Material, Model};
use thenar_surface::{Mesh, Product, Vec3};

const MODULUS: f64 = 0.02;
const RADIUS: f64 = 10.0;
const DEPTH: f64 = 1.0;
const CONTACT_RADIUS: f64 = 3.162_277_66;

fn skin(spacing: f64) -> (Bench, Mesh) {
    let size = 4.0 * CONTACT_RADIUS;
    (
        flat_skin(size, spacing, half_space(), Model::Layer),
        lattice(size, spacing, 0.3),
    )
}

fn indenter() -> Product {
    paraboloid(RADIUS, DEPTH, 2.2 * CONTACT_RADIUS)
}

fn half_space() -> Material {
    Material {
        g0_mpa: MODULUS,
        g_lim_mpa: MODULUS,
        thickness_mm: f64::INFINITY,
        ..Material::finger()
    }
}

/// Force and contact radius over Hertz's, minus one, for one spacing.
fn errors((skin, mesh): &mut (Bench, Mesh), product: &Product, offset: Vec3) -> (f64, f64) {
    let (radius, depth) = (RADIUS, DEPTH);
    let a = (radius * depth).sqrt();
    let exact = 16.0 / 3.0 * MODULUS * radius.sqrt() * depth.powf(1.5);
    let posed: Vec<Vec3> = mesh.positions().iter().map(|p| p + offset).collect();
    let contact = press_posed(skin, product, &posed);
    let found = (contact.contact_area / std::f64::consts::PI).sqrt();
    (contact.total_force.z / exact - 1.0, found / a - 1.0)
}

#[test]
fn force_and_radius_are_hertz_where_the_mesh_resolves_the_contact() {
    for spacing in [1.0, 0.7, 0.5, 0.26] {
        let (force, radius) = errors(&mut skin(spacing), &indenter(), Vec3::zeros());
        println!(
            "a/h {:.1}: force {:+.2} %, radius {:+.2} %",
            3.162 / spacing,
            100.0 * force,
            100.0 * radius
        );
        assert!(
            force.abs() < 0.005,
            "spacing {spacing}: force off by {force}"
        );
        assert!(
            radius.abs() < 0.03,
            "spacing {spacing}: radius off by {radius}"
        );
    }
}

/// With a dozen vertices in contact the force depends on how the lattice lies under the sphere: the mean over
/// positions is what the rule can promise.
#[test]
fn a_contact_of_a_dozen_vertices_still_has_hertz_force_on_average() {
    for (spacing, bound) in [(2.4, 0.03), (1.5, 0.012)] {
        let (mut skin, product) = (skin(spacing), indenter());
        let mut dice = Dice(3);
        let offsets =
            (0..30).map(|_| Vec3::new(dice.roll() - 0.5, dice.roll() - 0.5, 0.0) * (2.0 * spacing));
        let force: Vec<f64> = offsets.map(|o| errors(&mut skin, &product, o).0).collect();
        let mean = force.iter().sum::<f64>() / force.len() as f64;
        let spread =
            (force.iter().map(|f| (f - mean).powi(2)).sum::<f64>() / force.len() as f64).sqrt();
        println!(
            "a/h {:.1}: mean {:+.2} %, spread {:.2} %",
            3.162 / spacing,
            100.0 * mean,
            100.0 * spread
        );
        assert!(mean.abs() < bound, "spacing {spacing}: mean {mean}");
    }
}
