//! What holds for every press: no penetration, complementarity, more depth never less force, frame independence.

use crate::scenes;

use nalgebra::{Rotation3, Vector3};
use scenes::{Bench, Dice, flat_skin, lattice, paraboloid, press, press_posed};
use thenar_contact::{
    Contact, ContactError, Control, ForceTarget, Material, Model, Press, Skin, SkinInput, Start,
    Unsolved,
};
use thenar_surface::{Mesh, Product, Vec3};

fn soft() -> Material {
    Material {
        g0_mpa: 0.01,
        g_lim_mpa: 0.02,
        thickness_mm: 7.0,
        ..Material::finger()
    }
}

fn skin_of(mesh: &Mesh, regions: Vec<i32>, materials: Vec<Material>) -> Bench {
    let input = SkinInput {
        mesh: mesh.clone(),
        regions,
        materials,
        model: Model::Layer,
    };
    Bench::from(Skin::prepare(input, &Control::none()).unwrap())
}

#[test]
fn force_grows_with_depth_through_the_limit_of_the_kernel() {
    let mut skin = flat_skin(26.0, 1.6, soft(), Model::Layer);
    let mut last = 0.0;
    for step in 1..=24 {
        let depth = 0.25 * f64::from(step);
        let contact = press(&mut skin, &paraboloid(9.0, depth, 14.0));
        assert!(
            contact.total_force.z > last,
            "{depth} mm: {} after {last}",
            contact.total_force.z
        );
        assert!(
            contact.residual.penetration_mm <= 0.02,
            "{depth} mm: {}",
            contact.residual.penetration_mm
        );
        assert!(
            contact.residual.complementarity <= 1e-10,
            "{depth} mm: {}",
            contact.residual.complementarity
        );
        last = contact.total_force.z;
    }
}

#[test]
fn a_turned_and_moved_scene_gives_the_turned_result() {
    let mesh = lattice(14.0, 1.3, 0.3);
    let product = paraboloid(9.0, 1.5, 8.0);
    let here = press(&mut skin_of(&mesh, Vec::new(), vec![soft()]), &product);
    let turn = Rotation3::from_euler_angles(0.3, -1.1, 2.0);
    let shift = Vector3::new(310.0, -20.0, 77.0);
    let moved = |m: &Mesh| {
        Mesh::new(
            m.positions().iter().map(|p| turn * p + shift).collect(),
            m.triangles().to_vec(),
        )
    };
    let there = press(
        &mut skin_of(&moved(&mesh).unwrap(), Vec::new(), vec![soft()]),
        &Product::new(moved(product.mesh()).unwrap()).unwrap(),
    );
    assert!((turn * here.total_force - there.total_force).norm() <= 1e-9 * here.total_force.norm());
    for (a, b) in here.displacement.iter().zip(&there.displacement) {
        assert!((turn * a - b).norm() <= 1e-8, "{a} {b}");
    }
}

#[test]
fn the_force_target_is_reached_and_the_offset_repeats_it() {
    let mesh = lattice(16.0, 1.4, 0.3);
    let mut skin = skin_of(&mesh, Vec::new(), vec![soft()]);
    let product = paraboloid(9.0, -3.0, 9.0);
    let force = Some(ForceTarget {
        newton: 1.5,
        direction: Some(Vec3::new(0.0, 0.0, -2.0)),
    });
    let request = Press {
        product: &product,
        posed: None,
        force,
        drag: None,
        start: Start::Fresh,
        unsolved: Unsolved::Refuse,
    };
    let found = skin.press(&request, &Control::none()).unwrap();
    assert!(
        (found.total_force.z - 1.5).abs() <= 1e-4,
        "{}",
        found.total_force.z
    );
    assert!(found.offset > 3.0 && found.offset < 8.0, "{}", found.offset);
    let lifted: Vec<Vec3> = mesh
        .positions()
        .iter()
        .map(|p| p + Vec3::new(0.0, 0.0, found.offset))
        .collect();
    let again = press_posed(&mut skin, &product, &lifted);
    assert!((again.total_force.z / found.total_force.z - 1.0).abs() < 1e-6);
    let guessed = Press {
        force: Some(ForceTarget {
            newton: 1.5,
            direction: None,
        }),
        ..request
    };
    let guessed = skin.press(&guessed, &Control::none()).unwrap();
    assert!(
        (guessed.offset - found.offset).abs() < 0.01,
        "{} {}",
        guessed.offset,
        found.offset
    );
}

#[test]
fn product_and_hand_bear_the_same_force() {
    let contact = press(
        &mut flat_skin(12.0, 1.1, soft(), Model::Layer),
        &paraboloid(9.0, 1.0, 7.0),
    );
    assert!(
        contact.residual.load_balance < 1e-12,
        "{}",
        contact.residual.load_balance
    );
    assert!(contact.total_force.z > 0.0 && contact.center_of_pressure.xy().norm() < 0.1);
    let sum: f64 = contact.nodal_force.iter().sum();
    assert!(contact.total_force.norm() <= sum + 1e-12);
}

#[test]
fn one_material_in_two_regions_is_one_skin() {
    let mesh = lattice(14.0, 1.3, 0.3);
    let halves = mesh
        .positions()
        .iter()
        .map(|p| i32::from(p.x > 0.0))
        .collect();
    let product = paraboloid(9.0, 1.5, 8.0);
    let material = Material {
        g_lim_mpa: 0.01,
        ..soft()
    };
    let whole = press(&mut skin_of(&mesh, Vec::new(), vec![material]), &product);
    let cut = press(&mut skin_of(&mesh, halves, vec![material; 2]), &product);
    assert!((cut.total_force.z / whole.total_force.z - 1.0).abs() < 1e-9);
}

#[test]
fn an_unwelded_seam_changes_nothing() {
    let mesh = lattice(14.0, 1.3, 0.3);
    let mut positions = mesh.positions().to_vec();
    let mut triangles = mesh.triangles().to_vec();
    for t in triangles
        .iter_mut()
        .filter(|t| mesh.positions()[t[0] as usize].x > 0.3)
    {
        for v in t.iter_mut() {
            positions.push(mesh.positions()[*v as usize]);
            *v = positions.len() as u32 - 1;
        }
    }
    let product = paraboloid(9.0, 1.5, 8.0);
    let whole = press(&mut skin_of(&mesh, Vec::new(), vec![soft()]), &product);
    let torn = press(
        &mut skin_of(
            &Mesh::new(positions, triangles).unwrap(),
            Vec::new(),
            vec![soft()],
        ),
        &product,
    );
    assert!((torn.total_force.z / whole.total_force.z - 1.0).abs() < 1e-9);
    assert!(torn.warnings.iter().any(|w| {
        w.to_string()
            .contains("nearer to another one than a quarter")
    }));
}

#[test]
fn a_warm_start_follows_and_a_fresh_one_forgets() {
    let mesh = lattice(14.0, 1.3, 0.3);
    let product = paraboloid(9.0, 1.5, 8.0);
    let mut skin = skin_of(&mesh, Vec::new(), vec![soft()]);
    let first = press(&mut skin, &product);
    let mut dice = Dice(5);
    for _ in 0..5 {
        let up = Vec3::new(0.0, 0.0, 0.1 * (dice.roll() - 0.5));
        let tilt = Rotation3::from_euler_angles(0.1 * (dice.roll() - 0.5), 0.05, 0.0);
        let posed: Vec<Vec3> = mesh.positions().iter().map(|p| tilt * p + up).collect();
        let warm = Press {
            product: &product,
            posed: Some(&posed),
            force: None,
            drag: None,
            start: Start::Warm,
            unsolved: Unsolved::Refuse,
        };
        let warm = skin.press(&warm, &Control::none()).unwrap();
        let fresh = press_posed(&mut skin.clone(), &product, &posed);
        assert!((warm.total_force.z / fresh.total_force.z - 1.0).abs() < 2e-3);
        let apart = warm.displacement.iter().zip(&fresh.displacement);
        let apart = apart.map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
        assert!(apart < 0.02, "displacements differ by {apart} mm");
    }
    assert_eq!(strip(press(&mut skin, &product)), strip(first));
}

#[test]
fn bad_input_is_refused_in_words() {
    let mesh = lattice(4.0, 1.0, 0.3);
    let n = mesh.positions().len();
    let prepare = |regions: Vec<i32>, material: Material| {
        let input = SkinInput {
            mesh: mesh.clone(),
            regions,
            materials: vec![material],
            model: Model::Layer,
        };
        Skin::prepare(input, &Control::none()).map(|_| ())
    };
    let thin = Material {
        thickness_mm: -1.0,
        ..soft()
    };
    assert!(matches!(
        prepare(vec![], thin),
        Err(ContactError::Material {
            name: "thickness_mm",
            ..
        })
    ));
    assert!(matches!(
        prepare(vec![1; n], soft()),
        Err(ContactError::MissingMaterial { region: 1, .. })
    ));
    assert!(matches!(
        prepare(vec![-1; n], soft()),
        Err(ContactError::NoSkin)
    ));
    assert!(matches!(
        prepare(vec![0; n - 1], soft()),
        Err(ContactError::RegionCount { .. })
    ));
    let deep = paraboloid(50.0, 30.0, 70.0);
    let mut skin = skin_of(&mesh, Vec::new(), vec![soft()]);
    let swallowed = skin.press(
        &Press {
            product: &deep,
            posed: None,
            force: None,
            drag: None,
            start: Start::Fresh,
            unsolved: Unsolved::Refuse,
        },
        &Control::none(),
    );
    assert!(matches!(swallowed, Err(ContactError::Swallowed { .. })));
}

#[test]
fn skin_too_coarse_for_its_tissue_is_refused_where_it_is_pressed() {
    let film = Material {
        thickness_mm: 0.3,
        ..soft()
    };
    let mut skin = flat_skin(8.0, 1.5, film, Model::Layer);
    let product = paraboloid(9.0, 0.1, 7.0);
    let press = Press {
        product: &product,
        posed: None,
        force: None,
        drag: None,
        start: Start::Fresh,
        unsolved: Unsolved::Refuse,
    };
    let refused = skin.press(&press, &Control::none());
    assert!(matches!(
        refused,
        Err(ContactError::TooCoarse { region: 0, .. })
    ));
}

#[test]
fn a_graded_mesh_keeps_its_fine_vertices() {
    // Spacing grows with distance from the middle: fine vertices must not count as one another.
    let mesh = lattice(16.0, 1.0, 0.2);
    let graded = |p: &Vec3| p * (0.25 + 0.75 * (p.norm() / 16.0));
    let positions = mesh.positions().iter().map(graded).collect();
    let mut skin = skin_of(
        &mesh.with_positions(positions).unwrap(),
        Vec::new(),
        vec![soft()],
    );
    let contact = press(&mut skin, &paraboloid(9.0, 1.0, 7.0));
    assert!(
        contact.warnings.iter().all(|w| !w
            .to_string()
            .contains("nearer to another one than a quarter")),
        "{:?}",
        contact.warnings
    );
}

#[test]
fn a_cancelled_press_says_so_and_leaves_the_skin_usable() {
    let mut skin = flat_skin(12.0, 1.1, soft(), Model::Layer);
    let product = paraboloid(9.0, 1.0, 7.0);
    let before = strip(press(&mut skin, &product));
    let stop = Control {
        cancelled: &|| true,
        progress: &|_, _| {},
    };
    let request = Press {
        product: &product,
        posed: None,
        force: None,
        drag: None,
        start: Start::Fresh,
        unsolved: Unsolved::Refuse,
    };
    assert_eq!(skin.press(&request, &stop), Err(ContactError::Cancelled));
    assert_eq!(strip(press(&mut skin, &product)), before);
}

fn strip(contact: Contact) -> Contact {
    Contact {
        seconds: Vec::new(),
        ..contact
    }
}
