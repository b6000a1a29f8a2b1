//! The layer presets of the materials against the published half-space ones: same force where they were matched.

mod scenes;

use scenes::{flat_skin, paraboloid, press};
use thenar_contact::{Material, Model};

/// Force of a pad of the given radius on a plate: the same contact as a paraboloid of that radius on flat skin.
fn force(material: Material, radius: f64, depth: f64) -> f64 {
    let a = (radius * depth).sqrt();
    let mut skin = flat_skin(2.2 * a, a / 7.0, material, Model::Layer);
    press(&mut skin, &paraboloid(radius, depth, 2.0 * a))
        .total_force
        .z
}

fn half_space(material: Material) -> Material {
    Material {
        thickness_mm: f64::INFINITY,
        ..material
    }
}

#[test]
fn presets_over_bone_need_the_published_force_at_one_millimeter_and_at_dlim() {
    let pads = [
        ("finger", Material::finger_layer(), Material::finger(), 8.0),
        ("palm", Material::palm_layer(), Material::palm(), 40.0),
    ];
    for (name, layer, published, radius) in pads {
        for depth in [1.0, published.d_lim_mm] {
            let (over_bone, without) = (
                force(layer, radius, depth),
                force(half_space(published), radius, depth),
            );
            let unit = Material {
                g0_mpa: 1.0,
                g_lim_mpa: 1.0,
                ..layer
            };
            let wanted = without / force(unit, radius, depth);
            println!(
                "{name} {depth} mm: {over_bone:.4} N over bone, {without:.4} N published; modulus wanted {wanted:.5} MPa"
            );
            assert!(
                (over_bone / without - 1.0).abs() < 0.05,
                "{name} at {depth} mm: {over_bone} for {without}"
            );
        }
    }
}
