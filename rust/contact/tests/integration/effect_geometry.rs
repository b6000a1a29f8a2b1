//! Effects that shape the response: bone under the skin and cuts between regions.

use crate::scenes;

use scenes::{Bench, lattice, paraboloid, press};
use thenar_contact::{ActiveEffect, ContactError, Control, Material, Model, Skin, SkinInput};
use thenar_surface::Mesh;

const SIZE: f64 = 16.0;

fn material(thickness_mm: f64) -> Material {
    Material {
        g0_mpa: 0.01,
        g_lim_mpa: 0.03,
        thickness_mm,
        ..Material::default()
    }
}

fn prepare(mesh: Mesh, regions: Vec<i32>, materials: Vec<Material>) -> Bench {
    let input = SkinInput {
        mesh,
        regions,
        materials,
        model: Model::Layer,
    };
    Bench::from(Skin::prepare(input, &Control::none()).unwrap())
}

/// Flat skin in two regions, parted by the plane x = 0.
fn halves() -> (Mesh, Vec<i32>) {
    let mesh = lattice(SIZE, 1.0, 0.3);
    let side = |p: &thenar_surface::Vec3| i32::from(p.x > 0.0);
    let regions = mesh.positions().iter().map(side).collect();
    (mesh, regions)
}

fn set(skin: &mut Bench, effects: Vec<ActiveEffect>) {
    skin.set_effects(effects, &Control::none()).unwrap();
}

fn named(name: &str, amplitude: f64) -> ActiveEffect {
    ActiveEffect::named(name, amplitude).unwrap()
}

#[test]
fn bone_is_the_material_of_that_thickness() {
    let tool = paraboloid(8.0, 1.0, 8.0);
    let mut skin = prepare(lattice(SIZE, 1.0, 0.3), vec![], vec![material(9.0)]);
    let base = press(&mut skin, &tool);
    for (amplitude, thickness) in [(1.0, 5.0), (0.5, 1.0 / (0.5 / 9.0 + 0.5 / 5.0))] {
        set(&mut skin, vec![named("bone", amplitude)]);
        let over_bone = press(&mut skin, &tool);
        let mut other = prepare(lattice(SIZE, 1.0, 0.3), vec![], vec![material(thickness)]);
        let expected = press(&mut other, &tool);
        let error = over_bone.total_force.norm() / expected.total_force.norm() - 1.0;
        assert!(error.abs() < 1e-6, "{amplitude}: {error}");
        assert!(over_bone.total_force.norm() > 1.05 * base.total_force.norm());
    }
    set(&mut skin, vec![]);
    let again = press(&mut skin, &tool);
    assert_eq!(base.nodal_force, again.nodal_force);
}

#[test]
fn thicker_bone_than_the_material_reaches_farther() {
    let tool = paraboloid(8.0, 1.0, 8.0);
    let mut skin = prepare(lattice(40.0, 1.6, 0.3), vec![], vec![material(3.0)]);
    let bone = named("bone", 1.0).with("thickness_mm", 12.0).unwrap();
    set(&mut skin, vec![bone]);
    let found = press(&mut skin, &tool).total_force.norm();
    let mut other = prepare(lattice(40.0, 1.6, 0.3), vec![], vec![material(12.0)]);
    let expected = press(&mut other, &tool).total_force.norm();
    assert!((found / expected - 1.0).abs() < 1e-6, "{found} {expected}");
}

#[test]
fn painted_and_sloping_bone_lie_between_their_extremes() {
    let tool = paraboloid(8.0, 1.0, 8.0);
    let mesh = lattice(SIZE, 1.0, 0.3);
    let mut skin = prepare(mesh.clone(), vec![], vec![material(9.0)]);
    let level = |skin: &mut Bench, h: f64| {
        set(
            skin,
            vec![named("bone", 1.0).with("thickness_mm", h).unwrap()],
        );
        press(skin, &tool).total_force.norm()
    };
    let [thin, middle, thick] = [4.0, 6.0, 9.0].map(|h| level(&mut skin, h));
    let painted = vec![6.0; mesh.positions().len()];
    set(&mut skin, vec![named("bone", 1.0).painted(painted)]);
    let uniform = press(&mut skin, &tool).total_force.norm();
    assert!((uniform / middle - 1.0).abs() < 1e-6, "{uniform} {middle}");
    let sloping = named("bone", 1.0)
        .with("thickness_mm", 6.0)
        .unwrap()
        .with("slope", 0.2)
        .unwrap();
    set(&mut skin, vec![sloping]);
    let pressed = press(&mut skin, &tool);
    let sloped = pressed.total_force.norm();
    assert!(thick < sloped && sloped < thin, "{thick} {sloped} {thin}");
    // Thin tissue, at negative x, bears more.
    assert!(
        pressed.center_of_pressure.x < -0.02,
        "{}",
        pressed.center_of_pressure.x
    );
}

#[test]
fn a_whole_cut_is_the_regions_alone_and_none_is_skin_in_one_piece() {
    // Nearly flat, so that neighbors across the cut do not turn the directions in which the skin yields.
    let tool = paraboloid(40.0, 0.4, 9.0);
    let (mesh, regions) = halves();
    let even = Material {
        g_lim_mpa: 0.01,
        ..material(7.0)
    };
    let materials = vec![even; 2];
    let mut whole = prepare(mesh.clone(), vec![], vec![even]);
    let one_piece = press(&mut whole, &tool).total_force.norm();
    let mut skin = prepare(mesh.clone(), regions.clone(), materials.clone());
    let tied = press(&mut skin, &tool);
    assert!((tied.total_force.norm() / one_piece - 1.0).abs() < 1e-6);
    set(&mut skin, vec![named("region_coupling", 1.0)]);
    let cut = press(&mut skin, &tool);
    for kept in 0..2 {
        let alone = |r: &i32| if *r == kept { 0 } else { -1 };
        let mut half = prepare(
            mesh.clone(),
            regions.iter().map(alone).collect(),
            vec![even],
        );
        let expected = press(&mut half, &tool).nodal_force.iter().sum::<f64>();
        let found = cut.regions[kept as usize].force;
        assert!(
            (found / expected - 1.0).abs() < 2e-3,
            "{kept}: {found} {expected}"
        );
    }
    set(&mut skin, vec![named("region_coupling", 0.5)]);
    let half_cut = press(&mut skin, &tool).total_force.norm();
    let [tied, cut] = [tied.total_force.norm(), cut.total_force.norm()];
    assert!(tied < half_cut && half_cut < cut, "{tied} {half_cut} {cut}");
}

#[test]
fn bad_numbers_are_named_with_what_is_admissible() {
    let mut skin = prepare(lattice(6.0, 1.0, 0.3), vec![], vec![material(7.0)]);
    let mut refused = |effect: ActiveEffect| {
        let error = skin
            .set_effects(vec![effect], &Control::none())
            .unwrap_err();
        assert!(skin.effects().is_empty());
        error.to_string()
    };
    let thickness = |h: f64| named("bone", 1.0).with("thickness_mm", h).unwrap();
    let sentence = refused(thickness(-1.0));
    assert_eq!(
        sentence,
        "effect bone: thickness_mm is -1, but must be from 0.05 to 1000 mm"
    );
    assert!(refused(thickness(f64::NAN)).contains("thickness_mm is NaN"));
    assert!(refused(named("bone", 1.5)).contains("amplitude is 1.5, but must be from 0 to 1"));
    assert!(refused(named("bone", 1.0).in_regions(&[3])).contains("no region 3"));
    assert!(refused(named("bone", 1.0).painted(vec![5.0])).contains("1 values are painted"));
    assert!(refused(named("region_coupling", 1.0).painted(vec![])).contains("cannot be painted"));
    let unknown = ActiveEffect::named("bones", 1.0).unwrap_err();
    assert!(
        matches!(unknown, ContactError::UnknownEffect { .. }),
        "{unknown}"
    );
    let unknown = named("bone", 1.0).with("h", 1.0).unwrap_err();
    assert!(
        unknown.to_string().contains("there are thickness_mm"),
        "{unknown}"
    );
}
