//! Skins large enough for the hierarchy: Hertz, and the same result as rows in memory would give on a coarser mesh.

use crate::scenes;

use scenes::{flat_skin, paraboloid, press};
use thenar_contact::{ContactError, Control, Material, Model, Press, Start, Unsolved};

fn half_space() -> Material {
    Material {
        g0_mpa: 0.02,
        g_lim_mpa: 0.02,
        thickness_mm: f64::INFINITY,
        poisson_ratio: 0.5,
        ..Material::finger()
    }
}

#[test]
fn a_fine_half_space_is_hertzian() {
    let mut skin = flat_skin(6.0, 0.055, half_space(), Model::Layer);
    assert!(skin.vertices() > 45_000, "{}", skin.vertices());
    let (radius, depth) = (10.0, 0.5);
    let contact = press(&mut skin, &paraboloid(radius, depth, 7.5));
    let modulus = 2.0 * 0.02 / (1.0 - 0.5);
    let force = 4.0 / 3.0 * modulus * f64::sqrt(radius) * f64::powf(depth, 1.5);
    let area = std::f64::consts::PI * radius * depth;
    assert!(
        (contact.total_force.z / force - 1.0).abs() < 2e-3,
        "{} N, {force}",
        contact.total_force.z
    );
    // The rim lies within half a spacing of the true one.
    let rim = 2.0 * 0.5 * 0.055 / f64::sqrt(radius * depth);
    assert!(
        (contact.contact_area / area - 1.0).abs() < rim,
        "{} mm2, {area}",
        contact.contact_area
    );
    assert!(contact.convergence.has_converged, "{:?}", contact.residual);
    assert!(contact.residual.complementarity <= 1e-10);
    assert!(contact.residual.penetration_mm <= 1e-3);
    let certified = contact.residual.far_field;
    assert!(certified > 0.0 && certified <= 1e-4, "{certified}");
    // Warm, from the same place: the same forces.
    let product = paraboloid(radius, depth, 7.5);
    let again = Press {
        product: &product,
        posed: None,
        force: None,
        drag: None,
        start: Start::Warm,
        unsolved: Unsolved::Refuse,
    };
    let warm = skin.press(&again, &Control::none()).unwrap();
    assert!((warm.total_force.z / contact.total_force.z - 1.0).abs() < 1e-6);
    // Stopped while its response is built, and usable after.
    let stopped = Control {
        cancelled: &|| true,
        progress: &|_, _| {},
    };
    assert_eq!(
        skin.press(&again, &stopped).unwrap_err(),
        ContactError::Cancelled
    );
    let after = skin.press(&again, &Control::none()).unwrap();
    assert!((after.total_force.z / contact.total_force.z - 1.0).abs() < 1e-6);
}
